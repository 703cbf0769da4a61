"""Compiled handlers of XLA's: the generated function, called with views of XLA's buffers, without Python.

    def handler(frame):                                 `kernel` writes its first argument, which comes back
        held = words(frame, 15)
        if held[1] != 0:
            return python(frame)                        asked what it is
        x = words(held[9], 2)
        y = words(held[14], 1)
        x0, x1, y0 = array_1(x[0], float64), array_0(x[1], float64), array_1(y[0], float64)
        a0 = y0
        a0[...] = x0
        a1 = float64(x1[0])
        if not (-a0.shape[0] + 2 < 0):                      an index might be out of bounds
            return python(frame)
        try:
            kernel(a0, a1)
        except Exception:
            return python(frame)                        which raises it again, and knows what it means
        return 0
"""
from __future__ import annotations

import ctypes
import importlib
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from s2sad.bridges import xla_frames
from s2sad.bridges.bridged_kernel import BridgedKernel
from s2sad.dispatch.executable import Executable
from s2sad.dispatch.index_check import condition_text
from s2sad.infer.argument_parts import GREATEST, LEAST, Part
from s2sad.interface.selection import RETURN
from s2sad.program import Parameter

_RANKS = 8


class HandlerText:
    """The text of a handler for one derivative (`mode`) of a kernel: `operands` are the places of the kernel's values
    among the arguments by their parameters' names, behind them stand seeds or tangents."""

    def __init__(self, kernel: BridgedKernel, variant: Executable, mode: str, operands: Mapping[str, int],
                 constants: Mapping[str, Any], wrt: Sequence[str], of: Sequence[str]):
        self.kernel, self.variant, self.mode = kernel, variant, mode
        self.operands, self.constants, self.wrt = operands, constants, tuple(wrt)
        self.outputs = tuple(o for o in kernel.outputs if o.name in of)
        self.written = {*kernel.prepared.summary.written}
        self.lines: list[str] = []
        self.names = {_key(p): f"a{k}" for k, p in enumerate(variant.parameters)}
        getattr(self, f"_{mode}")()

    # -- what the derivatives take and give ----------------------------------------------------------------------------

    def _primal(self) -> None:
        for p in self.variant.parameters:
            self._value(p, self._output_of(p.name))
        self._call({k: ("returned" if len(self.kernel.prepared.results.types) == 1 else f"returned[{o.place}]")
                    for k, o in enumerate(self.outputs) if o.name == RETURN})

    def _adjoint(self) -> None:
        seeds = {(o.name, o.place): len(self.operands) + k for k, o in enumerate(self.outputs)}
        for p in self.variant.parameters:
            if p.role == "primal":
                self._value(p)
            elif p.role == "seed":
                self._given(p, seeds[RETURN, int(p.primal.removeprefix(RETURN))], copied=True)
            else:
                self._shadow(p, seeds.get((p.primal, -1)), self._place_of(p.primal))
        numbers = [n for n in self.wrt if ("shadow", n) not in self.names]
        returns = self.variant.generated.returns
        self._call({self.wrt.index(n): f"returned[{returns.index(n)}]" for n in numbers})

    def _tangent(self) -> None:
        given = {n: len(self.operands) + k for k, n in enumerate(self.wrt)}
        for p in self.variant.parameters:
            if p.role == "primal":
                self._value(p)
            elif p.type.is_array:
                self._shadow(p, given.get(p.primal), self._output_of(p.primal))
            else:
                self._given(p, given[p.primal])
        returns = self.variant.generated.returns
        found = {k: f"{RETURN} {o.place}" for k, o in enumerate(self.outputs) if o.name == RETURN}
        self.lines += [f"y{k}[...] = 0" for k, r in found.items() if r not in returns]
        self._call({k: f"returned[{returns.index(r)}]" for k, r in found.items() if r in returns})

    def _place_of(self, name: str) -> int | None:
        return self.wrt.index(name) if name in self.wrt else None

    def _output_of(self, name: str) -> int | None:
        return next((k for k, o in enumerate(self.outputs) if o.name == name), None)

    # -- lines ---------------------------------------------------------------------------------------------------------

    def _value(self, p: Parameter, result: int | None = None) -> None:
        """A value of the kernel's: where it is written a copy, in the memory of a result if it is one."""
        if p.name in self.constants:
            self.lines.append(f"{self.names['primal', p.name]} = {self.constants[p.name]!r}")
        elif result is not None and p.type.is_array:
            self._shadow(p, self.operands[p.name], result)
        else:
            self._given(p, self.operands[p.name], p.name in self.written)

    def _given(self, p: Parameter, place: int, copied: bool = False) -> None:
        name, view = self.names[_key(p)], f"x{place}"
        if not p.type.is_array:
            view = f"{p.type.dtype if p.type.dtype != 'bool' else 'bool_'}({view}[0])"
        self.lines.append(f"{name} = {f'copy({view})' if copied and p.type.is_array else view}")

    def _shadow(self, p: Parameter, start: int | None, result: int | None) -> None:
        """An array that begins as an argument or with zeros, in the memory of a result if it is one."""
        name = self.names[_key(p)]
        if result is None:
            like = self.names["primal", p.primal]
            self.lines.append(f"{name} = " + (f"zeros_like({like})" if start is None else f"copy(x{start})"))
        else:
            self.lines += [f"{name} = y{result}", f"{name}[...] = " + ("0" if start is None else f"x{start}")]

    def _call(self, results: Mapping[int, str]) -> None:
        arguments = ", ".join(self.names[_key(p)] for p in self.variant.parameters)
        self.lines.append(f"returned = kernel({arguments})" if results else f"kernel({arguments})")
        number = self.mode == "adjoint"     # of which arrays are shadows
        self.lines += [f"fill_{'number' if number or self.outputs[k].type.is_number else 'array'}(y{k}, {value})"
                       for k, value in results.items()]

    def bounds(self) -> str:
        """The condition under which no index can be out of bounds."""
        check = self.variant.check_indices
        if check is None:
            return "True"
        return "False" if check.limits is None else condition_text(check.limits, self._of_value)

    def _of_value(self, name: str, part: Part) -> str:
        """A size of a value of the kernel's, the least or the greatest of its elements, or the integer itself."""
        value = self.names["primal", name]
        return f"{part}({value})" if isinstance(part, str) else value if part is None else f"{value}.shape[{part}]"

    def text(self, given: Sequence[tuple[np.dtype, int]], made: Sequence[tuple[np.dtype, int]]) -> str:
        """The handler for arguments and results of these dtypes and ranks."""
        count = next(k for k, line in enumerate(self.lines) if "kernel(" in line)
        views = [*(f"x{k} = array_{rank}(x[{k}], {_dtype(kind)})" for k, (kind, rank) in enumerate(given)),
                 *(f"y{k} = array_{rank}(y[{k}], {_dtype(kind)})" for k, (kind, rank) in enumerate(made))]
        return "\n".join([
            "def handler(frame):", "    held = words(frame, 15)",
            "    if held[1] != 0:", "        return python(frame)",
            f"    x = words(held[9], {len(given)})", f"    y = words(held[14], {len(made)})",
            *(f"    {line}" for line in (*views, *self.lines[:count])),
            f"    if not ({self.bounds()}):", "        return python(frame)",
            "    try:", *(f"        {line}" for line in self.lines[count:]),
            "    except Exception:", "        return python(frame)", "    return 0", ""])


def _key(p: Parameter) -> tuple[str, str]:
    """The role of a parameter, and whose."""
    return p.role, p.name if p.role == "primal" else p.primal


def _dtype(kind: np.dtype) -> str:
    return "bool_" if kind.name == "bool" else kind.name


def compiled_handler(text: str, kernel: Callable[..., Any], python: Any) -> Any:
    """The handler of a text; it hands to `python` what it cannot do, and what might leave arrays."""
    numba = importlib.import_module("numba")
    space = {**_tools(), "kernel": kernel, "python": _as_integers(python)}
    exec(text, space)  # noqa: S102
    return numba.cfunc(numba.int64(numba.int64))(space["handler"])


def _as_integers(handler: Any) -> Any:
    """A handler of ctypes as compiled code calls it."""
    return ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(xla_frames.address(handler))


@cache
def _tools() -> dict[str, Any]:
    """What the texts call: views of memory by its address."""
    numba, extending = importlib.import_module("numba"), importlib.import_module("numba.extending")
    types, carray = numba.types, numba.carray

    @extending.intrinsic
    def pointer(typing: Any, address: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return builder.inttoptr(args[0], context.get_value_type(types.voidptr))
        return types.voidptr(types.int64), code

    @numba.njit
    def words(address, count):
        return carray(pointer(address), count, np.int64)

    @numba.njit
    def least(array):
        found = 0
        for k, element in enumerate(array.flat):
            found = element if k == 0 else min(found, element)
        return found

    @numba.njit
    def greatest(array):
        found = 0
        for k, element in enumerate(array.flat):
            found = element if k == 0 else max(found, element)
        return found

    @numba.njit
    def fill_number(result, value):
        result[0] = value

    @numba.njit
    def fill_array(result, value):
        if result.shape != value.shape:
            raise ValueError("a result is of another shape than was foreseen")
        result[...] = value

    space: dict[str, Any] = {"words": words, "carray": carray, "pointer": pointer, "fill_number": fill_number,
                             "fill_array": fill_array, "copy": np.copy, "zeros_like": np.zeros_like,
                             LEAST: least, GREATEST: greatest}
    space |= {n: getattr(np, n) for n in ("bool_", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32",
                                          "uint64", "float32", "float64", "complex128")}
    for rank in range(_RANKS + 1):
        shape = ", ".join(f"d[{k}]" for k in range(rank)) if rank else "1"
        exec(_VIEW.format(rank=rank, shape=shape, data=xla_frames.DATA, dimensions=xla_frames.DIMENSIONS), space)
        space[f"array_{rank}"] = numba.njit(space[f"array_{rank}"])
    return space


_VIEW = """
def array_{rank}(buffer, dtype):
    b = words(buffer, 6)
    d = words(b[{dimensions}], {rank})
    return carray(pointer(b[{data}]), ({shape},), dtype)
"""
