"""A size of -1 of a reshape is what is left, however it is spelled; a number that may be -1 unseen is an error."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.corpus.library.reshape_sizes import array, given


def given_and_written(w, k):
    t = w.reshape(k)
    t[0] = 3.0
    return np.sum(w ** 2)


def made(w):
    return np.sum(np.reshape(w * 2.0, (w.shape[0] - 3, 4))[1:] ** 2)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_a_size_that_turns_out_negative_is_an_error(engine):
    for kernel, args in ((given, (array(), -1)), (given_and_written, (array(), -1)), (made, (array(),))):
        text = s2sad.differentiate(kernel, wrt="w", engine=engine).adjoint_source(*args)
        assert "a size of np.reshape is negative: write -1 where it stands" in text
