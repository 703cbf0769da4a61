"""Activity says where it cannot follow a value."""
from __future__ import annotations

import pytest

import s2sad
from s2sad.analyze.activity import activity_of
from s2sad.diagnostics import Report, Source
from s2sad.infer.inference import Typing
from s2sad.infer.types import FLOAT, Type, array
from s2sad.tree import statements


def test_a_tuple_has_no_silent_zero():
    [function] = statements("def f(x):\n    t = (x[0], 2.0)\n    y = user.h(t)\n    return y")
    given = {"x": array("float64", 1)}
    typing = Typing({**given, "t": Type("tuple", items=(FLOAT, FLOAT)), "y": FLOAT}, lambda *_: (FLOAT,),
                    Report(Source("f.py", "")), {})
    with pytest.raises(s2sad.S2sadError, match="values with derivatives stay together in a tuple or a list here"):
        activity_of(function, typing, {"x"}, {"return 0"}, lambda call: [])
