"""Split mode against the joint adjoint: the same bits, whatever is written between the sweeps, as often as is asked."""
from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np

import s2sad
from s2sad.dispatch.arguments import kernel_value
from s2sad.dispatch.cache import ProgramVersion, derivatives_of
from s2sad.dispatch.executable import Executable
from s2sad.dispatch.split_executable import SplitExecutable, arrays_in
from s2sad.interface.pytrees import flat_call
from s2sad.interface.selection import Selection, selected_of, selected_wrt
from s2sad.live_objects.unwrap import apply_functions
from s2sad.program import Request
from s2sad.run.tracebacks import with_facts
from tests.harness.seeds import generator

Seeds = tuple[dict[str, np.ndarray], list[Any]]


def check_split(function: Callable[..., Any], arguments: tuple[Any, ...], wrt: Any, of: Any, engine: str,
                checkpoint: Any = None) -> None:
    """Asserts that `augmented` does what the primal does, and that reverse sweeps over its tape have the bits of the
    joint adjoint: two over a tape that is kept and a last one, each for other seeds, after everything that a caller can
    write was written."""
    f = s2sad.differentiate(function, wrt=wrt, of=of, engine=engine, checkpoint=checkpoint)
    with_facts(_check, f, copy.deepcopy(arguments), engine)


def _check(f: Any, arguments: tuple[Any, ...], engine: str) -> None:
    given, args, keywords = apply_functions(f, arguments, {})
    found = f._derivatives if given is f else derivatives_of(given)
    state, values, carried = flat_call(found.with_constants(), f, args, keywords)
    values = [kernel_value(n, v, n in state.floats) for n, v in zip(state.parameters, values)]
    joint, split = (_variant(state, values, carried, engine, s) for s in (False, True))
    assert isinstance(split, SplitExecutable)
    by_name = _given(state, values)
    results, tape = split.augmented([by_name[n] for n in split.taken])
    _as_the_primal(state, values, engine, by_name, results)
    shapes = [np.shape(r) for r in results]
    for value in (*by_name.values(), *results):
        _spoil(value)
    rng = generator(7)
    for keep in (True, True, False):
        shadows = {p: rng.standard_normal(v.shape).astype(v.dtype) for p, v in zip(state.parameters, values)
                   if isinstance(v, np.ndarray) and v.dtype.kind in "fc"}
        places = [int(p.primal.split()[1]) for p in split.seeds]
        seeds = [rng.standard_normal(shapes[k]).astype(p.type.dtype) if p.type.is_array else rng.standard_normal()
                 for k, p in zip(places, split.seeds)]
        entries = split.intact(tape) if keep else tape
        expected = _adjoints(joint, [], _given(state, values), (shadows, seeds))
        for ours, theirs in zip(_adjoints(split, [entries], {}, (shadows, seeds)), expected, strict=True):
            np.testing.assert_array_equal(ours, theirs)


def _variant(state: ProgramVersion, values: list[Any], carried: Selection, engine: str, split: bool) -> Executable:
    types = state.types(values)
    wrt = selected_wrt("f", state.parameters, types, carried.wrt)
    of = selected_of("f", state.parameters, types, state.summary(types), carried.of)
    return state.variant(Request("adjoint", types, wrt, of, recording=carried.recording, split=split), engine)


def _given(state: ProgramVersion, values: list[Any]) -> dict[str, Any]:
    """Copies of the arguments and of the arrays of the module."""
    return copy.deepcopy({**dict(zip(state.parameters, values)), **state.arrays_by_name()})


def _adjoints(variant: Executable, tape: list[Any], given: dict[str, Any], seeds: Seeds) -> list[Any]:
    """The shadows and the adjoints of numbers, by one reverse sweep."""
    bars, ends = copy.deepcopy(seeds)
    numbers = variant.run([*tape, *variant.assemble(given, bars, ends, given)])
    return [*(bars[p] for p in variant.shadows), *numbers]


def _spoil(value: Any) -> None:
    for array in arrays_in(value):
        if array.flags.writeable:
            array.fill(np.nan if array.dtype.kind in "fc" else 1)


def _as_the_primal(state: ProgramVersion, values: list[Any], engine: str, after: dict[str, Any], results: Any) -> None:
    """Results, and what arguments hold, are those of the primal, if that does not raise as Python's numbers do."""
    own = copy.deepcopy(values)
    single = any(getattr(v, "dtype", None) == np.float32 for v in values)
    try:
        with np.errstate(all="ignore"):
            returned = state.primal(state.types(values), engine)(*own)
    except ZeroDivisionError:
        return
    expected = returned if isinstance(returned, tuple) else () if returned is None else (returned,)
    for ours, theirs in zip([*results, *(after[n] for n in state.parameters)], [*expected, *own], strict=True):
        if isinstance(theirs, (float, complex, np.ndarray, np.inexact)):
            np.testing.assert_allclose(ours, theirs, 1e-5 if single else 1e-10)
