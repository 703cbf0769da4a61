"""How the arguments of `f.adjoint(...)` are read: which are f's own, which their shadows, which seeds.

Whether an argument has a shadow may depend on the types of all (is it written?), and which arguments are f's own on
who has a shadow; so the readings of the list are tried, the fullest first, until one is what it implies itself.
"""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np

from s2sad.binding import INEXACT, admitted
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.generated import HIDDEN, Variant
from s2sad.infer.types import Type
from s2sad.program import Request
from s2sad.selection import RETURN, Results, selected_of, selected_wrt
from s2sad.variants import State

_STRICT, _LOOSE = 4096, 32

Layout = list[tuple[str, str]]
Selection = tuple[Any, Any, str]


def arranged(state: State, mode: str, args: tuple[Any, ...], selection: Selection) -> tuple[Variant, Layout, list[Any]]:
    """The variant, (role, parameter) of every argument without the seeds, and the values of f's own arguments."""
    first: S2sadError | None = None
    valid: Request | None = None
    for strict, count in ((True, _STRICT), (False, _LOOSE)):
        for layout in islice(_layouts(state, args, mode, selection, strict), count):
            try:
                values = [admitted(name, args[k], name in state.floats)
                          for k, (role, name) in enumerate(layout) if role == "primal"]
                request = _request(state, mode, state.types(values), selection)
            except S2sadError as error:
                first = first or error
                continue
            valid = valid or request
            if _implied(state, request) == (layout, len(args) - len(layout)):
                return state.variant(request, selection[2]), layout, values
    if valid is None and first is not None:
        raise first
    raise _misread(state, mode, args, valid and state.variant(valid, selection[2]))


def _request(state: State, mode: str, types: tuple[Type, ...], selection: Selection) -> Request:
    name, parameters = state.kernel.name, state.parameters
    wrt = selected_wrt(name, parameters, types, selection[0])
    return Request(mode, types, wrt, selected_of(name, parameters, types, state.summary(types), selection[1]))


def _implied(state: State, request: Request) -> tuple[Layout, int]:
    """The layout that goes with these types, and the number of seeds."""
    layout: Layout = []
    for name, kind in zip(state.parameters, request.types):
        layout.append(("primal", name))
        wanted = name in request.wrt or name in request.of
        if wanted and kind.is_inexact and (kind.is_array or request.mode == "tangent"):
            layout.append(("shadow", name))
    seeded = request.mode == "adjoint" and RETURN in request.of
    return layout, len(Results.of(state.summary(request.types)).own) if seeded else 0


def _layouts(state: State, args: Sequence[Any], mode: str, selection: Selection, strict: bool, start: int = 0,
             done: int = 0) -> Iterator[Layout]:
    """The ways to read a list of arguments as parameters each followed, or not, by a shadow; where `strict` only by
    what could be its shadow."""
    names = state.parameters
    if done == len(names):
        yield []
        return
    if len(args) - start < len(names) - done:
        return
    name = names[done]
    may, must = _shadowed(name, args[start], mode, selection, name in state.floats)
    following = args[start + 1] if start + 1 < len(args) else None
    if may and start + 1 < len(args) and not (strict and not _alike(args[start], following)):
        for rest in _layouts(state, args, mode, selection, strict, start + 2, done + 1):
            yield [("primal", name), ("shadow", name), *rest]
    if not (strict and must):
        for rest in _layouts(state, args, mode, selection, strict, start + 1, done + 1):
            yield [("primal", name), *rest]


def _shadowed(name: str, value: Any, mode: str, selection: Selection, is_float: bool) -> tuple[bool, bool]:
    """Whether an argument may, and whether it must have a shadow."""
    wrt, of, _ = selection
    varied = wrt is None or name in wrt
    if isinstance(value, np.ndarray):
        floats = value.dtype.name in INEXACT
        return floats and (varied or of is None or name in of), floats and (varied or name in (of or ()))
    number = isinstance(value, (float, np.floating, complex)) or is_float
    shadowed = mode == "tangent" and number and varied
    return shadowed, shadowed


def _alike(value: Any, following: Any) -> bool:
    if isinstance(value, np.ndarray):
        return isinstance(following, np.ndarray) and (following.dtype, following.ndim) == (value.dtype, value.ndim)
    return isinstance(following, (int, float, complex, np.number))


def _misread(state: State, mode: str, args: Sequence[Any], variant: Variant | None) -> S2sadError:
    name = state.kernel.name
    signature = (", ".join(p.name for p in variant.parameters if not p.name.startswith(HIDDEN)) if variant else
                 f"{', '.join(state.parameters)}, with a shadow after each float array")
    message = f"'{name}.{mode}' was given {len(args)} arguments that do not fit its signature"
    return S2sadError(Diagnostic("S405", message, help=f"call {name}.{mode}({signature})"))
