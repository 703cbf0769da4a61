"""A kernel as a function of one vector: from the floats of its `wrt` to the floats of its `of`."""
from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from s2sad.interface.selection import RETURN


def flat(value: Any) -> np.ndarray:
    """Every float in a value, in order, as float64, complex numbers as two of them; integers, bools and None do not
    count. The sum over products of two such vectors is Re(conj(a) b).

    >>> flat((1.5, 2, np.array([3.0])))
    array([1.5, 3. ])
    """
    if isinstance(value, (tuple, list)):
        return np.concatenate([np.zeros(0), *map(flat, value)])
    if isinstance(value, np.ndarray):
        if value.dtype.kind == "c":
            return value.astype("complex128").ravel().view("float64")
        return value.astype("float64").ravel() if value.dtype.kind == "f" else np.zeros(0)
    if isinstance(value, complex):
        return np.array([value.real, value.imag])
    return np.array([float(value)]) if isinstance(value, (float, np.floating)) else np.zeros(0)


def shaped(like: Any, vector: np.ndarray) -> Any:
    """The inverse of `flat`: a value with the structure and dtypes of `like`, None where that holds no float."""
    if isinstance(like, (tuple, list)):
        parts, at = [], 0
        for item in like:
            size = flat(item).size
            parts.append(shaped(item, vector[at:at + size]) if size else None)
            at += size
        return tuple(parts)
    if isinstance(like, np.ndarray):
        vector = vector.view("complex128") if like.dtype.kind == "c" else vector
        return vector.reshape(like.shape).astype(like.dtype)
    return complex(vector[0], vector[1]) if isinstance(like, complex) else float(vector[0])


def vector_of(values: Mapping[str, Any], names: Sequence[str]) -> np.ndarray:
    return np.concatenate([np.zeros(0), *(flat(values[n]) for n in names)])


def split(like: Mapping[str, Any], names: Sequence[str], vector: np.ndarray) -> dict[str, Any]:
    """The inverse of `vector_of`."""
    found, at = {}, 0
    for name in names:
        size = flat(like[name]).size
        found[name] = shaped(like[name], vector[at:at + size])
        at += size
    return found


class VectorFunction:
    """The kernel at one point; arrays of float32 are widened, so that differences are taken in float64."""

    def __init__(self, function: Callable[..., Any], arguments: Mapping[str, Any], wrt: Sequence[str],
                 of: Sequence[str]):
        self.function, self.wrt, self.of = function, tuple(wrt), tuple(of)
        self.arguments = {n: v.astype("float64") if isinstance(v, np.ndarray) and v.dtype == np.float32 else v
                          for n, v in arguments.items()}
        self.x = vector_of(self.arguments, self.wrt)
        self.outputs = self.run({})

    def run(self, changed: Mapping[str, Any]) -> dict[str, Any]:
        """The contents of the outputs after a call on copies."""
        values = copy.deepcopy({**self.arguments, **changed})
        with np.errstate(all="ignore"):
            values[RETURN] = self.function(*[values[n] for n in self.arguments])
        return {n: values[n] for n in self.of}

    def along(self, direction: np.ndarray) -> Callable[[float], np.ndarray]:
        """The outputs as a function of the distance gone in a direction."""
        def line(distance: float) -> np.ndarray:
            moved = split(self.arguments, self.wrt, self.x + distance * direction)
            return vector_of(self.run(moved), self.of)
        return line

    def scales(self) -> np.ndarray:
        """A natural step for every input: its own size, or its argument's where it is small."""
        parts = [np.zeros(0)]
        for name in self.wrt:
            size = np.abs(flat(self.arguments[name]))
            parts.append(np.maximum(size, 0.1 * (size.max(initial=0.0) or 1.0)))
        return np.concatenate(parts)

    def narrowed(self, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """The outputs with the dtypes of the arguments."""
        return {n: v.astype(arguments[n].dtype) if n in arguments and isinstance(v, np.ndarray) else v
                for n, v in self.outputs.items()}
