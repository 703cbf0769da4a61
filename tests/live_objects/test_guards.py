"""What is recorded while a kernel is read, and when a constant is what it was."""
from __future__ import annotations

import math

import numpy as np
import pytest

from s2sad.live_objects.guards import ABSENT, Guards, recording, same, taken
from tests.dispatch.test_guards import Colour


def test_a_reading_gets_one_value_for_a_place():
    holder = {"a": 1.0}
    with recording(Guards()) as found:
        assert taken(holder, "item", "a") == 1.0
        holder["a"] = 2.0
        assert taken(holder, "item", "a") == 1.0
    assert not found.hold()
    holder["a"] = 1.0
    assert found.hold()
    del holder["a"]
    assert not found.hold() and taken(holder, "item", "a") is ABSENT


@pytest.mark.parametrize("a, b, equal", [
    (0.0, -0.0, False), (1, 1.0, False), (True, 1, False), (math.nan, -math.nan, True), (0j, -0j, False),
    (complex(math.nan, 1.0), complex(math.nan, 1.0), True), (np.float32("nan"), np.float32("nan"), True),
    (np.float32(0.0), np.float32(-0.0), False), (np.float64(1.0), 1.0, False), ((1.0, 2), (1.0, 2), True),
    ((1.0, 2), (1.0, 2.0), False), ("a", "a", True), (Colour.RED, 2, False), ([1.0], [1.0], False)])
def test_constants_are_the_same_if_they_mean_the_same(a, b, equal):
    assert same(a, b) is equal
