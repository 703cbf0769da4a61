"""Derivatives as functions that XLA calls: each has a handler, compiled where Numba is the engine, else of Python's.

Handlers are named by all that they do, so that an executable of XLA's that was kept on disk finds its own, and live as
long as the process.
"""
from __future__ import annotations

import hashlib
import re
import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from s2sad.bridges.bridged_kernel import BridgedKernel, Output
from s2sad.bridges.xla_frames import Layout, address, capsule, python_handler
from s2sad.bridges.xla_handlers import HandlerText, compiled_handler
from s2sad.extras import needed

_KEPT: dict[str, Any] = {}


@dataclass(frozen=True)
class Operand:
    """An argument as XLA has it: the parameter, its dtype and rank there, and what makes a value of it ("" for an
    array, which is one)."""
    name: str
    dtype: np.dtype
    rank: int
    kind: Callable[[Any], Any] | None

    def value(self, array: np.ndarray) -> Any:
        return array if self.kind is None else self.kind(array[()])


@cache
def minor_version() -> int | None:
    """The minor version of XLA's API for handlers, None where there is none with the layout that `xla_frames` knows."""
    ffi = getattr(needed("jax", "s2sad.jax"), "ffi", None)
    try:
        header = (Path(ffi.include_dir()) / "xla/ffi/api/c_api.h").read_text() if ffi is not None else ""
    except OSError:
        return None
    found = re.search(r"^#define XLA_FFI_API_MAJOR 0$.*^#define XLA_FFI_API_MINOR (\d+)$", header, re.M | re.S)
    return None if found is None else int(found[1])


class XlaCall:
    """The primal, the adjoint or the tangent of a kernel on arrays of JAX's; `operands` are the kernel's arguments."""

    def __init__(self, kernel: BridgedKernel, mode: str, operands: Sequence[Operand], constants: dict[str, Any],
                 wrt: tuple[str, ...] = (), of: tuple[str, ...] = ()):
        self.kernel, self.mode, self.operands, self.constants = kernel, mode, tuple(operands), constants
        self.wrt, self.of = wrt, of or kernel.of
        self.outputs = tuple(o for o in kernel.outputs if o.name in self.of)
        self._own = {o.name: o for o in self.operands}
        self.variant = kernel.request(mode, wrt, self.of)
        behind = {"primal": [], "adjoint": [*map(_layout, self.outputs)],
                  "tangent": [(self._own[n].dtype, self._own[n].rank) for n in wrt]}[mode]
        self.given = [*((o.dtype, o.rank) for o in self.operands), *behind]
        self.made = ([(self._own[n].dtype, self._own[n].rank) for n in wrt] if mode == "adjoint" else
                     [*map(_layout, self.outputs)])

    def run(self, given: Sequence[np.ndarray], made: Sequence[np.ndarray]) -> None:
        """Fills the results, in Python."""
        count = len(self.operands)
        by_name = {o.name: o.value(array) for o, array in zip(self.operands, given)} | self.constants
        values = [by_name[n] for n in self.kernel.names]
        found = self._found(values, given[count:])
        for result, value in zip(made, found):
            if np.shape(value) not in ((), result.shape):
                raise ValueError(f"a result of '{self.kernel.name}' is of shape {np.shape(value)}, not {result.shape} "
                                 "as was foreseen")
            result[...] = value

    def _found(self, values: list[Any], behind: Sequence[np.ndarray]) -> list[Any]:
        kernel = self.kernel
        if self.mode == "primal":
            return kernel.primal(values)
        if self.mode == "adjoint":
            seeds = [s if o.type.is_array else s[()] for o, s in zip(self.outputs, behind)]
            return kernel.vjp(values, seeds, self.wrt, self.of)
        return kernel.jvp(values, {n: self._own[n].value(t) for n, t in zip(self.wrt, behind)})

    @property
    def target(self) -> str:
        """The name under which XLA has the handler, which is made at the first call."""
        text = self._text()
        moving = uuid.uuid4().hex if self.kernel.state.registered else ""   # what calls the user's own is as that is
        does = repr((self.variant.generated.text, self.kernel.request("primal").generated.text, text, self.mode, moving,
                     self.operands, self.given, self.made, self.wrt, self.of, self.constants))
        name = f"s2sad_{self.kernel.name.rpartition('.')[2]}_{hashlib.sha256(does.encode()).hexdigest()[:24]}"
        if name not in _KEPT:
            _KEPT[name] = self._register(name, text)
        return name

    def _text(self) -> str:
        """The text of the compiled handler, "" where Python has to see each call."""
        variant, facts = self.variant, self.variant.generated.facts
        if variant.engine != "numba" or variant.limited is not None or facts.get("folders"):
            return ""
        made = HandlerText(self.kernel, variant, self.mode, {o.name: k for k, o in enumerate(self.operands)},
                           self.constants, self.wrt, self.of)
        return made.text(self.given, self.made)

    def _register(self, name: str, text: str) -> Any:
        minor = minor_version()
        assert minor is not None
        handler = python_handler(self.run, self.given, self.made, minor)
        compiled = text and compiled_handler(
            text, getattr(self.variant.module, self.variant.generated.entry), handler)
        start = compiled.address if compiled else address(handler)
        needed("jax", "s2sad.jax").ffi.register_ffi_target(name, capsule(start), platform="cpu", api_version=1)
        return self, handler, compiled

    def __call__(self, shapes: Sequence[tuple[int, ...]], *arrays: Any) -> tuple[Any, ...]:
        """The results for arrays of JAX's, or what it traces."""
        jax = needed("jax", "s2sad.jax")
        assert [(a.dtype, a.ndim) for a in arrays] == self.given    # the handler reads memory
        results = [jax.ShapeDtypeStruct(s, kind) for s, (kind, _) in zip(shapes, self.made)]

        def called(*arrays: Any) -> Any:
            made = [np.empty(r.shape, r.dtype) for r in results]
            self.run([np.asarray(a) for a in arrays], made)
            return made

        def by_callback(*arrays: Any) -> Any:
            return jax.pure_callback(called, results, *arrays, vmap_method="sequential")
        if minor_version() is None:
            return tuple(by_callback(*arrays))
        by_handler = jax.ffi.ffi_call(self.target, results, vmap_method="sequential")
        return tuple(jax.lax.platform_dependent(*arrays, cpu=by_handler, default=by_callback))


def _layout(output: Output) -> Layout:
    return np.dtype(output.type.dtype), output.type.rank

