"""Spellings that mean no more than plainer ones: texts of errors and of print, and what NumPy is to warn of."""
# ruff: noqa: UP031, UP032
from __future__ import annotations

import pytest

import s2sad
from tests.corpus.language.messages_and_printing import V, printed, texts


@pytest.mark.parametrize(("n", "error", "text"), [(-1, ValueError, "'bad %d in %s' % (n, name)"),
                                                  (101, ValueError, "'bad {} '.format(n) + str(n)"),
                                                  (60, AssertionError, "'n is ' + str(n)")])
def test_errors_show_how_their_text_is_written(n, error, text):
    with pytest.raises(error) as raised:
        s2sad.vjp(s2sad.differentiate(texts, engine="numpy"), (V, n), {"return": 1.0})
    assert str(raised.value) == text


@pytest.mark.parametrize(("engine", "text"), [("numpy", "n=3 3.000e-01\ns: 3 plain a3 3!\n"),
                                              ("numba", "n=%d %.3e 3 0.3\ns: {} 3 plain a 3 3 !\n")])
def test_what_is_printed(engine, text, capfd):
    """Compiled code prints values without a format."""
    s2sad.differentiate(printed, engine=engine).primal(V, 3)
    assert capfd.readouterr().out == text
