"""The arrays of a derivative for the columns of an array of directions: how they lie is what its engine wants.

    Lanes       an array with one more axis, the last, for Numba: the directions are it already
    Lists       a list of arrays, for NumPy
    Single      the array, where one direction is taken at a time

Memory is lent from a dictionary by name, so that it is the same from one call to the next.
"""
from __future__ import annotations

from typing import Any

import numpy as np

Memory = dict[str, np.ndarray]


def lent(memory: Memory, name: str, shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """An array of this shape, whatever it holds."""
    held = memory.get(name)
    if held is None or held.shape != shape or held.dtype != dtype:
        held = memory[name] = np.empty(shape, dtype)
    return held


class Lanes:
    """For Numba: one more axis, the last."""

    def __init__(self, width: int):
        self.width = width

    def zeros(self, memory: Memory, name: str, like: Any) -> Any:
        """What no direction is given of."""
        made = lent(memory, name, (*np.shape(like), self.width), getattr(like, "dtype", type(like)))
        made.fill(0.0)
        return made

    def given(self, memory: Memory, name: str, directions: np.ndarray, shape: tuple[int, ...], dtype: Any, own: bool
              ) -> Any:
        """The directions of an array or a number of this shape, in memory of its own if it is written."""
        shaped = directions.reshape(*shape, self.width)
        if not own and shaped.dtype == dtype:
            return shaped
        made = lent(memory, name, shaped.shape, dtype)
        np.copyto(made, shaped, casting="same_kind")
        return made

    def found(self, value: Any) -> np.ndarray:
        """What a derivative has left for directions, in columns."""
        return value.reshape(-1, self.width) if isinstance(value, np.ndarray) else np.full((1, self.width), value)

    def shape(self, value: Any) -> tuple[int, ...]:
        """The shape that it has for one."""
        return np.shape(value)[:-1]


class Lists:
    """For NumPy: a list by direction."""

    def __init__(self, width: int):
        self.width = width

    def zeros(self, memory: Memory, name: str, like: Any) -> Any:
        return [np.zeros(like.shape, like.dtype) if isinstance(like, np.ndarray) else 0.0 * like
                for _ in range(self.width)]

    def given(self, memory: Memory, name: str, directions: np.ndarray, shape: tuple[int, ...], dtype: Any, own: bool
              ) -> Any:
        if not shape:
            return [float(d) for d in directions[0]]
        return [np.array(d.reshape(shape), dtype, order="C") for d in directions.T]

    def found(self, value: Any) -> np.ndarray:
        if not isinstance(value, list):
            return np.full((1, self.width), value)
        return np.ascontiguousarray(np.array(value).reshape(self.width, -1).T)

    def shape(self, value: Any) -> tuple[int, ...]:
        return np.shape(value[0] if isinstance(value, list) else value)


class Single:
    """For a derivative for one direction."""
    width = 1

    def zeros(self, memory: Memory, name: str, like: Any) -> Any:
        if not isinstance(like, np.ndarray):
            return 0.0 * like
        made = lent(memory, name, like.shape, like.dtype)
        made.fill(0.0)
        return made

    def given(self, memory: Memory, name: str, directions: np.ndarray, shape: tuple[int, ...], dtype: Any, own: bool
              ) -> Any:
        if not shape:
            return float(directions[0, 0])
        made = lent(memory, name, shape, dtype)
        np.copyto(made, directions.reshape(shape), casting="same_kind")
        return made

    def found(self, value: Any) -> np.ndarray:
        return np.reshape(value, (-1, 1))

    def shape(self, value: Any) -> tuple[int, ...]:
        return np.shape(value)
