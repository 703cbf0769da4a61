"""The picture of the rooms is drawn from the code as it stands."""
from __future__ import annotations

from tests.harness.rooms import PICTURE, layers, picture, reduced, rooms


def test_current():
    assert picture(rooms()) == PICTURE.read_text(encoding="utf-8"), "python -m tests.harness.rooms draws it anew"


def test_arcs_that_follow_from_others_are_left_out():
    edges = {"a": frozenset("bcd"), "b": frozenset("c"), "c": frozenset("d"), "d": frozenset()}
    assert reduced(edges) == {"a": {"b"}, "b": {"c"}, "c": {"d"}, "d": set()}


def test_every_room_has_a_place_and_says_what_it_is():
    assert len(layers()) <= 23
    assert all(r.sentence for r in rooms())
