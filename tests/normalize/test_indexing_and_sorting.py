"""Functions that write an argument, and functions of places, of order and of selection, several in a kernel."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad

ENGINES = ("numpy", "numba")


def single(x):
    return np.sum(x.astype(np.float32) * x) + np.sum(np.sort(x) ** 2)


@pytest.mark.parametrize("engine", ENGINES)
def test_single_precision(engine):
    given = s2sad.gradient(s2sad.differentiate(single, engine=engine))
    x = np.array([0.5, 0.25, 0.75])
    np.testing.assert_allclose(given(x), 4.0 * x, rtol=1e-6)
    assert given(x.astype(np.float32)).dtype == np.float32


def test_a_median_of_nan():
    def kernel(x):
        return np.median(x) + np.quantile(x, 0.5)
    assert np.isnan(s2sad.value_and_gradient(kernel)(np.array([1.0, np.nan, 2.0]))[0])


REFUSED = {
    "np.sum(np.squeeze(x))": "np.squeeze",
    "np.sum(np.histogram(x, 'auto')[0] * x[:3])": "number of bins",
    "np.sum(np.linalg.eigvals(np.diag(x)))": "eigvalsh",
}


@pytest.mark.parametrize("text", REFUSED)
def test_refused_with_what_to_write(text, tmp_path):
    path = tmp_path / "kernel.py"
    path.write_text(f"import numpy as np\n\n\ndef kernel(x):\n    return {text}\n")
    spaces: dict = {}
    exec(compile(path.read_text(), str(path), "exec"), spaces)
    with pytest.raises(s2sad.S2sadError, match=r"S301.*\n(.*\n)*.*help: .*" + REFUSED[text]):
        s2sad.gradient(spaces["kernel"])(np.array([0.5, 0.9, 1.5]))


@pytest.mark.parametrize("text, what", [("np.place(x, x > 1, 1.0)", "mask"),
                                        ("np.put_along_axis(x, x > 1, x, 0)", "a loop that stores")])
def test_writing_by_number_is_refused(text, what, tmp_path):
    path = tmp_path / "kernel.py"
    path.write_text(f"import numpy as np\n\n\ndef kernel(x):\n    {text}\n")
    spaces: dict = {}
    exec(compile(path.read_text(), str(path), "exec"), spaces)
    with pytest.raises(s2sad.S2sadError, match="a call whose result is not used(.*\n)*.*help: .*" + what):
        s2sad.vjp(spaces["kernel"], (np.ones(3),), {"x": np.ones(3)})
