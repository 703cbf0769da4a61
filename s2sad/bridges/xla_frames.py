"""The frames in which XLA's typed FFI hands arguments and results to a handler, as machine words.

The layout is that of version 0 of its C API (xla/ffi/api/c_api.h), which keeps it for all minor versions: a frame holds
the API, its arguments and its results; a buffer its data and its dimensions. A frame with an extension asks what the
handler is.
"""
from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

EXTENSION, API, ARGUMENTS, RESULTS, LENGTH = 1, 2, 9, 14, 15        # of a frame
DATA, DIMENSIONS = 3, 5                                             # of a buffer
_METADATA, _VERSION_OF_METADATA, _TRAITS = 3, 3, 4                  # of what asks, and of what answers
_ERROR_CREATE = 6                                                   # of the API
_INVALID_ARGUMENT = 3
_HANDLER = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)

Layout = tuple[np.dtype, int]
Run = Callable[[Sequence[np.ndarray], Sequence[np.ndarray]], None]


class _Error(ctypes.Structure):
    _fields_ = (("size", ctypes.c_size_t), ("extension", ctypes.c_void_p), ("message", ctypes.c_char_p),
                ("code", ctypes.c_int))


def python_handler(run: Run, given: Sequence[Layout], made: Sequence[Layout], minor: int) -> Any:
    """A handler, as ctypes calls it, that has `run` read arrays of these dtypes and ranks and fill others. What `run`
    raises becomes XLA's error. It is for the API's version 0 with this `minor` one."""
    def handler(frame: int) -> int | None:
        held = _words(frame, LENGTH)
        if held[EXTENSION]:
            return _introduce(held, minor)
        try:
            run([_array(b, *kind) for b, kind in zip(_words(held[ARGUMENTS], len(given)), given)],
                [_array(b, *kind) for b, kind in zip(_words(held[RESULTS], len(made)), made)])
        except BaseException as error:  # nothing can be raised through XLA
            return _refuse(held[API], f"{type(error).__name__}: {error}")
        return None
    return _HANDLER(handler)


def _words(address: int, count: int) -> Any:
    return (ctypes.c_size_t * count).from_address(address) if count else ()


def _array(buffer: int, dtype: np.dtype, rank: int) -> np.ndarray:
    """The array in a buffer: a view of XLA's memory."""
    held = _words(buffer, 6)
    shape = tuple(_words(held[DIMENSIONS], rank))
    size = dtype.itemsize * math.prod(shape)
    memory: Any = (ctypes.c_char * size).from_address(held[DATA]) if size else None
    return np.ndarray(shape, dtype, memory)


def _introduce(held: Any, minor: int) -> None:
    """Says of which version the handler is: two integers in one word."""
    metadata = _words(_words(held[EXTENSION], 4)[_METADATA], 5)
    metadata[_VERSION_OF_METADATA] = minor << 32
    metadata[_TRAITS] = 0


def _refuse(api: int, text: str) -> int | None:
    """XLA's error with this text."""
    create = _HANDLER(_words(api, 7)[_ERROR_CREATE])
    error = _Error(_Error.code.offset + _Error.code.size, None, text.encode(), _INVALID_ARGUMENT)
    return create(ctypes.addressof(error))


def capsule(address: int) -> Any:
    """The address of a handler as JAX takes it."""
    new = ctypes.pythonapi.PyCapsule_New
    new.restype, new.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    return new(address, None, None)


def address(handler: Any) -> int:
    """Where the machine code of a handler of ctypes begins."""
    found = ctypes.cast(handler, ctypes.c_void_p).value
    assert found is not None
    return found
