"""Which cases are compiled: all that is emitted is, in few cases, and in those that take the least time."""
from __future__ import annotations

from tests.harness.constructs import chosen, seconds


def test_none_is_superfluous():
    """Two that have most at first are not needed where two others together have everything."""
    emitted = {"left": {"If", "add f f", "load f1 i"}, "right": {"For", "mul f f", "store f1 i f"},
               "middle": {"If", "For", "add f f", "mul f f"}}
    assert set(chosen(emitted, {})) == {"left", "right"}


def test_what_takes_less_time_is_preferred():
    factors = {".svd(f2, b)", "factored(f2)"}
    assert seconds(factors) > 10 * seconds({"add f f", "store f1 i f"})
    assert set(chosen({"dear": {"add f f", *factors}, "cheap": {"add f f"}}, {"kept": frozenset(factors)})) == {
        "kept", "cheap"}


def test_each_is_chosen_for_what_no_other_is():
    emitted = {"one": {"If", "For"}, "two": {"For", "While"}}
    found = chosen(emitted, {})
    assert sorted(c for constructs in found.values() for c in constructs) == ["For", "If", "While"]
