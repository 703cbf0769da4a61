"""`f.augmented` and `f.reverse` with structures: a shadow is a structure of the same make, as `f.adjoint` takes it."""
from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from s2sad.interface.pytrees.flatten import Flattened
from s2sad.interface.split_calls import Augmented, Sweep, leaves_another, misfit_of_signature, split_call
from s2sad.interface.tapes import Tape
from s2sad.pytree import PyTree, assign_part, leaves, places_of


def augmented(flattened: Flattened, args: Sequence[Any], f: Any) -> Augmented:
    """The call of the flat program, and reverse sweeps that take structures."""
    with flattened.user_paths():
        for parameter in flattened.forms:
            if flattened.leaves_another(parameter):
                raise leaves_another(flattened.title, parameter)
        values = flattened.values(args)
        call = split_call(flattened.state, values, flattened.carrier(f)[1].__s2sad_selection__)
        found = call.augmented(values)
    flattened.write_back(args, dict(zip(flattened.paths, values)))
    result = found.result if flattened.result is None else flattened.result_of(found.result)
    shadowed = [p.primal for p in call.shadowed]
    kept = {n: _asked(v, n in places) for n, v in zip(flattened.paths, values)
            for places in [{flattened.names[p] for q, form in flattened.forms.items() for p in places_of(form, q)}]}
    return Augmented(result, found.entries, found.variant,
                     partial(_reverse, flattened, found.sweep, shadowed, [p.name for p in call.variant.seeds], kept))


def _asked(value: Any, whole: bool) -> Any:
    """What of an argument a shadow is compared with: the places of a sparse matrix, else the type alone."""
    if whole or not isinstance(value, np.ndarray):
        return np.copy(value) if whole else value
    return np.broadcast_to(np.zeros((), value.dtype), value.shape)


def _reverse(flattened: Flattened, sweep: Sweep, shadowed: Sequence[str], seeds: Sequence[str], values: dict[str, Any],
             tape: Tape, given: Sequence[Any], keep: bool) -> Any:
    """The reverse sweep over flat shadows; adjoints of numbers that the kernel assigns go to their fields."""
    owners = {parameter: form for parameter, form in flattened.forms.items()
              if any(flattened.names.get(path) in shadowed for path, _ in leaves(form, parameter))}
    if len(given) != len(owners) + len(seeds):
        raise misfit_of_signature(flattened.title, given, [*(f"{p}_bar" for p in owners), *seeds])
    bars: dict[str, Any] = {}
    cells: list[tuple[np.ndarray, str, Any, str | int]] = []
    with flattened.user_paths():
        for (parameter, form), value in zip(owners.items(), given):
            if not isinstance(form, PyTree):
                bars[flattened.names[parameter]] = value
                continue
            bars |= flattened.flat_parts((parameter, form, parameter), value, "shadow", values)
            cells += [(bars[n], kind, v, i) for n, kind, v, i in flattened.cells_in(form, value, parameter)
                      if n in bars]
        returned = sweep(tape, [*(bars[n] for n in shadowed), *given[len(owners):]], keep)
    for cell, kind, holder, item in cells:
        assign_part(kind, holder, item, cell[0].item())
    return returned
