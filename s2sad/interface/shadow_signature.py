"""How the arguments of `f.adjoint(...)` are read: which are f's own, which their shadows, which seeds.

Whether an argument has a shadow may depend on the types of all (is it written?), and which arguments are f's own on
who has a shadow; so the readings of the list are tried, the fullest first, until one is what it implies itself.
"""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np

from s2sad.dispatch.arguments import INEXACT, kernel_value
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.executable import HIDDEN, Executable
from s2sad.infer.types import Type
from s2sad.program import Recording, Request
from s2sad.interface.selection import RETURN, ReturnedValues, Selection, selected_of, selected_wrt
from s2sad.dispatch.cache import ProgramVersion

_STRICT, _LOOSE = 4096, 32

Layout = list[tuple[str, str]]

def match_arguments(state: ProgramVersion, mode: str, args: tuple[Any, ...], selection: Selection
                    ) -> tuple[Executable, Layout, list[Any]]:
    """The variant, (role, parameter) of every argument without the seeds, and the values of f's own arguments."""
    valid: Request | None = None
    for strict, count in ((True, _STRICT), (False, _LOOSE)):
        for layout in islice(_layouts(state, args, mode, selection, strict), count):
            try:
                values = _values(state, layout, args)
                request = _request(state, mode, state.types(values), selection)
            except S2sadError:
                continue
            valid = valid or request
            if _layout_of(state, request) == (layout, len(args) - len(layout)) and (
                    strict or _shadows_are_arrays(layout, args)):
                return state.variant(request, selection[2]), layout, values
    raise _mismatch(state, mode, args, selection, valid)


def _shadows_are_arrays(layout: Layout, args: Sequence[Any]) -> bool:
    """Whether no number is read as the shadow of an array: that is another argument."""
    return not any(role == "shadow" and isinstance(args[k - 1], np.ndarray) and isinstance(args[k], (int, float))
                   for k, (role, _) in enumerate(layout))


def _values(state: ProgramVersion, layout: Layout, args: Sequence[Any]) -> list[Any]:
    """f's own arguments in a reading of the list."""
    return [kernel_value(name, args[k], name in state.floats)
            for k, (role, name) in enumerate(layout) if role == "primal"]


def _request(state: ProgramVersion, mode: str, types: tuple[Type, ...], selection: Selection) -> Request:
    name, parameters = state.kernel.name, state.parameters
    wrt = selected_wrt(name, parameters, types, selection[0])
    of = selected_of(name, parameters, types, state.summary(types), selection.of)
    return Request(mode, types, wrt, of, recording=selection.recording if mode == "adjoint" else Recording())


def _layout_of(state: ProgramVersion, request: Request) -> tuple[Layout, int]:
    """The layout that goes with these types, and the number of seeds."""
    layout: Layout = []
    for name, kind in zip(state.parameters, request.types):
        layout.append(("primal", name))
        wanted = name in request.wrt or name in request.of
        if wanted and kind.is_inexact and (kind.is_array or request.mode == "tangent"):
            layout.append(("shadow", name))
    seeded = request.mode == "adjoint" and RETURN in request.of
    return layout, len(ReturnedValues.of(state.summary(request.types)).own) if seeded else 0


def _layouts(state: ProgramVersion, args: Sequence[Any], mode: str, selection: Selection, strict: bool, start: int = 0,
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
    may, must = _shadow_options(name, args[start], mode, selection, name in state.floats)
    following = args[start + 1] if start + 1 < len(args) else None
    if may and start + 1 < len(args) and not (strict and not _could_be_shadow(args[start], following)):
        for rest in _layouts(state, args, mode, selection, strict, start + 2, done + 1):
            yield [("primal", name), ("shadow", name), *rest]
    if not (strict and must):
        for rest in _layouts(state, args, mode, selection, strict, start + 1, done + 1):
            yield [("primal", name), *rest]


def _shadow_options(name: str, value: Any, mode: str, selection: Selection, is_float: bool) -> tuple[bool, bool]:
    """Whether an argument may, and whether it must have a shadow."""
    wrt, of = selection.wrt, selection.of
    varied = wrt is None or name in wrt
    if isinstance(value, np.ndarray):
        floats = value.dtype.name in INEXACT
        return floats and (varied or of is None or name in of), floats and (varied or name in (of or ()))
    number = isinstance(value, (float, np.floating, complex)) or is_float
    shadowed = mode == "tangent" and number and varied
    return shadowed, shadowed


def _could_be_shadow(value: Any, following: Any) -> bool:
    if isinstance(value, np.ndarray):
        return isinstance(following, np.ndarray) and (following.dtype, following.ndim) == (value.dtype, value.ndim)
    return isinstance(following, (int, float, complex, np.number))


def _mismatch(state: ProgramVersion, mode: str, args: Sequence[Any], selection: Selection,
             valid: Request | None) -> S2sadError:
    """What is wrong with a list of arguments that cannot be read: a shadow or a seed that is missing, else an argument
    of its own, else what the signature is."""
    lacking: dict[tuple[tuple[str, ...], int], Request] = {}
    first: S2sadError | None = None
    for layout in islice(_matching_layouts(state, args, mode, selection), _LOOSE):
        try:
            request = _request(state, mode, state.types(_values(state, layout, args)), selection)
        except S2sadError as error:
            first = first or error
            continue
        implied, seeds = _layout_of(state, request)
        absent = tuple(name for role, name in implied if role == "shadow" and (role, name) not in layout)
        short = seeds - (len(args) - len(layout))
        if {*layout} <= {*implied} and not (absent and short < 0):
            lacking.setdefault((absent, short), request)
    fewest = min((len(absent) + abs(short) for absent, short in lacking), default=0)
    nearest = {k: r for k, r in lacking.items() if len(k[0]) + abs(k[1]) == fewest}
    if first is not None and not nearest:
        return first
    request = next(iter(nearest.values()), valid)
    variant = request and state.variant(request, selection[2])
    name, order = state.kernel.name, state.parameters.index
    signature = (", ".join(p.name for p in variant.parameters if not p.name.startswith(HIDDEN)) if variant else
                 f"{', '.join(state.parameters)}, with a shadow after each float array")
    missing = " or ".join(_missing(absent, short, variant) for absent, short in sorted(
        nearest, key=lambda k: [order(n) for n in k[0]]) if variant and short >= 0)
    message = f"'{name}.{mode}' was given {len(args)} arguments {f'without {missing}' if missing else _UNFIT}"
    note = f"given were {', '.join(map(argument_text, args))}" if args and not missing else ""
    return S2sadError(Diagnostic("S405", message, note=note, help=f"call {name}.{mode}({signature})"))


_UNFIT = "that do not fit its signature"


def _missing(absent: Sequence[str], short: int, variant: Executable) -> str:
    """Which shadows and seeds are missing: `the shadow 'u_bar' of 'u'`."""
    shadows = {p: v.name for p, v in variant.shadows.items()}
    return " and ".join([*(f"the shadow '{shadows.get(n, n)}' of '{n}'" for n in absent),
                         *(f"the seed '{p.name}'" for p in variant.seeds[len(variant.seeds) - short:] if short)])


def argument_text(value: Any) -> str:
    """An argument by its type and shape."""
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} of shape {value.shape}"
    return "None" if value is None else type(value).__name__


def _matching_layouts(state: ProgramVersion, args: Sequence[Any], mode: str, selection: Selection) -> Iterator[Layout]:
    """The readings in which each shadow that is there has the shape of its primal, the fullest first."""
    for layout in islice(_layouts(state, args, mode, selection, False), _STRICT):
        if all(role == "primal" or _same_shape(args[k - 1], args[k]) for k, (role, _) in enumerate(layout)):
            yield layout


def _same_shape(value: Any, following: Any) -> bool:
    if isinstance(value, np.ndarray):
        return isinstance(following, np.ndarray) and following.shape == value.shape
    return not isinstance(following, np.ndarray)
