"""Positions of slices, as Python counts them."""
from __future__ import annotations


def element(place, size):
    """Where an element lies on an axis of this size: from the end if the place is negative. Raises IndexError where
    the axis has none there, for the array that it is a part of may have one.

    >>> element(2, 5), element(-1, 5)
    (2, 4)
    """
    if place < -size or place >= size:
        raise IndexError("index is out of bounds")
    return place + size if place < 0 else place


def position(bound, size):
    """Where a slice's bound lies on an axis of this size: from the end if negative, never beyond an end.

    >>> position(2, 5), position(-1, 5), position(9, 5), position(-9, 5)
    (2, 4, 5, 0)
    """
    if bound < 0:
        return max(bound + size, 0)
    return min(bound, size)


def position_down(bound, size):
    """The same for a slice with a negative step.

    >>> position_down(2, 5), position_down(-1, 5), position_down(9, 5), position_down(-9, 5)
    (2, 4, 4, -1)
    """
    if bound < 0:
        return max(bound + size, -1)
    return min(bound, size - 1)
