"""What a user sees of an error: where they called and what their kernel did, and nothing of s2sad's inside."""
from __future__ import annotations

import sys
import traceback

import numpy as np
import pytest

import s2sad
from s2sad import S2sadError, differentiate, gradient, jvp, pipeline, vjp
from s2sad.diagnostics import HOME


def refused(x):
    return np.partition(x, 1)[0]


def guarded(x, k):
    assert k > 0, "k must be positive"
    return k * np.sum(x)


X = np.ones(3)
CALLS = {
    "gradient": lambda: gradient(refused)(X),
    "a function that is none": lambda: gradient(3.0),  # pyright: ignore[reportArgumentType]
    "vjp": lambda: vjp(refused, (X,), {"return": 1.0}),
    "jvp": lambda: jvp(refused, (X,), {"x": X}),
    "adjoint": lambda: differentiate(refused).adjoint(X, X.copy(), 1.0),
    "tangent": lambda: differentiate(guarded).tangent(X),
    "adjoint_source": lambda: differentiate(refused).adjoint_source(X),
    "check": lambda: s2sad.check(refused, X),
    "explain": lambda: s2sad.explain(refused, X),
    "autodiff": lambda: s2sad.autodiff(s2sad.Reverse, refused, s2sad.Duplicated(X, X.copy())),
    "rule": lambda: s2sad.rule(3.0),
    "an argument too few": lambda: gradient(guarded)(X),
    "the kernel": lambda: gradient(differentiate(guarded, engine="numpy"))(X, -1.0),
}


def frames(call):
    with pytest.raises(Exception) as caught:
        call()
    return caught.value, traceback.extract_tb(caught.value.__traceback__)


@pytest.mark.parametrize("title", CALLS)
def test_one_frame_of_s2sad(title, monkeypatch):
    monkeypatch.delenv("S2SAD_TRACEBACK", raising=False)
    error, seen = frames(CALLS[title])
    assert len([f for f in seen if f.filename.startswith(HOME)]) == 1
    assert isinstance(error, (S2sadError, TypeError, AssertionError)) and error.__cause__ is None
    if title == "the kernel":
        assert seen[-1].line == 'assert k > 0, "k must be positive"'


def test_all_frames_where_they_are_asked_for(monkeypatch):
    monkeypatch.setenv("S2SAD_TRACEBACK", "full")
    assert len([f for f in frames(CALLS["gradient"])[1] if f.filename.startswith(HOME)]) > 5


def test_what_goes_wrong_inside_says_so_and_keeps_all(monkeypatch):
    def broken(*args, **keywords):
        return pipeline.facts(None, None, None)

    monkeypatch.setattr(pipeline, "derive", broken)
    error, _ = frames(lambda: gradient(differentiate(lambda x: x * x, engine="numpy"))(2.0))
    assert str(error).startswith("error[S901]: internal error: AttributeError: ")
    assert ", in pipeline (line " in str(error)
    assert isinstance(error.__cause__, AttributeError) and len(traceback.extract_tb(error.__cause__.__traceback__)) > 5


def test_a_refusal_in_another_file_names_the_call(tmp_path, monkeypatch):
    (tmp_path / "their_library.py").write_text("import numpy as np\n\ndef inner(x):\n    return np.partition(x, 1)[0]\n"
                                               "\ndef outer(x):\n    return inner(x)\n")
    (tmp_path / "my_kernel.py").write_text("import their_library\n\ndef loss(x):\n    y = 2.0 * x\n"
                                           "    return their_library.outer(y)\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    import my_kernel  # pyright: ignore[reportMissingImports]
    try:
        error, _ = frames(lambda: gradient(my_kernel.loss)(X))
    finally:
        for name in ("my_kernel", "their_library"):
            del sys.modules[name]
    assert str(error) == (f"{tmp_path}/their_library.py:4:12: error[S301]: no derivative rule for numpy.partition\n"
                          "  4 |     return np.partition(x, 1)[0]\n    |            ^^^^^^^^^^^^^^^^^^\n"
                          f"  note: called from {tmp_path}/my_kernel.py:5\n"
                          "  help: write np.sort(x), whose order is determined")
