"""`gradient`, `vjp` and `jvp` of functions that take structures.

    gradient(loss, wrt="p")(state, p)      the flat call's gradients of p_k, p_w  ->  a structure like p
"""
from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

from s2sad.dispatch.arguments import describe, make_zero
from s2sad.diagnostics import warn
from s2sad.interface import batch_calls
from s2sad.interface.pytrees.flat_batches import apart, directions_of, stacked, together
from s2sad.interface.pytrees.flat_selection import Path
from s2sad.interface.pytrees.flatten import Flattened
from s2sad.interface.value_calls import ForwardCall, ReverseCall, selection_of
from s2sad.interface.selection import RETURN
from s2sad.run.memory import Memory


class FlatGradient:
    """A `gradient` of a function that takes structures."""

    def __init__(self, flattened: Flattened, f: Any, names: Sequence[str] | None,
                 way: type[ReverseCall] = ReverseCall):
        self.flattened, self.f, self.names, self.way = flattened, f, names, way

    def value_and_gradient(self, args: Sequence[Any]) -> tuple[Any, Any]:
        """The value, and the gradients as `gradient` gives them."""
        flattened = self.flattened
        with flattened.user_paths():
            paths, call, values = _reverse(flattened, self.f, args, (RETURN,), self.names, True, self.way)
            shadows, returned = call.run(values, {RETURN: 1.0})
            found = _by_argument(flattened, self.f, self.names, paths, call, args, call.gradients(shadows, returned))
        return returned[0], found[paths[0][0]] if self.is_single(paths) else found

    def zeros(self, args: Sequence[Any]) -> Any:
        """Gradients of zeros, of the make of a call's."""
        flattened = self.flattened
        with flattened.user_paths():
            paths, call, values = _reverse(flattened, self.f, args, (RETURN,), self.names, True, self.way)
            by_name = dict(zip(call.names, values))
            found = _by_argument(flattened, self.f, self.names, paths, call, args,
                                 {n: make_zero(by_name[n]) for n in call.wrt})
        return found[paths[0][0]] if self.is_single(paths) else found

    def memory(self, args: Sequence[Any]) -> Memory:
        """What a call takes."""
        with self.flattened.user_paths():
            _, call, values = _reverse(self.flattened, self.f, args, (RETURN,), self.names, True, self.way)
            return call.memory(values)

    def is_single(self, paths: Sequence[Path]) -> bool:
        """Whether there is one gradient, which is returned without a dictionary."""
        explicit = self.names is not None or selection_of(self.f)[0] is not None
        return len(paths) == 1 and (explicit or len(self.flattened.independents()) <= 1)


def vjp(flattened: Flattened, f: Any, args: Sequence[Any], seeds: Mapping[str, Any], names: Sequence[str] | None,
        batch: bool = False) -> dict[str, Any]:
    """The gradients as `vjp` gives them."""
    with flattened.user_paths():
        values = dict(zip(flattened.paths, flattened.values(args)))
        if batch:
            count, given = directions_of(seeds)
            each = [_seeds(flattened, s, values) for s in given]
            flat, kept = (stacked([e[k] for e in each]) for k in (0, 1))
        else:
            flat, kept = _seeds(flattened, seeds, values)
        paths, call, ordered = _reverse(flattened, f, args, tuple(flat), names, False)
        found = batch_calls.vjp(call, ordered, flat) if batch else call.vjp(ordered, flat)
        for name, seed in kept.items():
            if name in found:
                found[name] = found[name] + seed
        if batch:
            return together([_by_argument(flattened, f, names, paths, call, args, one)
                             for one in apart(found, len(each))], count)
        return _by_argument(flattened, f, names, paths, call, args, found)


def _seeds(flattened: Flattened, seeds: Mapping[str, Any], values: Mapping[str, Any]
           ) -> tuple[dict[str, Any], dict[str, Any]]:
    """The seeds of outputs that the kernel writes, by flat names, and those of the others."""
    flat: dict[str, Any] = {}
    kept: dict[str, Any] = {}
    for name, seed in seeds.items():
        if name == RETURN:
            flat[RETURN] = seed if flattened.result is None else flattened.result_seed(seed)
            continue
        path = flattened._selected_path(name, "seeds")
        written = flattened.written(path)
        for leaf, value in flattened.flat_parts(path, seed, "seed", values).items():
            (flat if leaf in written else kept)[leaf] = value
        for leaf in written:
            flat.setdefault(leaf, seed)  # not a float: refused as any other
    return flat, kept


def _reverse(flattened: Flattened, f: Any, args: Sequence[Any], outputs: tuple[str, ...], names: Sequence[str] | None,
             with_value: bool, way: type[ReverseCall] = ReverseCall) -> tuple[list[Path], ReverseCall, list[Any]]:
    values = flattened.values(args)
    inputs, carrier = flattened.carrier(f)
    paths = flattened.selected_paths(names, "wrt") if names is not None or inputs is None else inputs
    if with_value and names is None and inputs is None:
        paths = [path for path in paths if path[0] in flattened.independents()] or paths
    wrt = flattened.flat_names(paths, "wrt") if paths else None
    key = (way, with_value, outputs, wrt, carrier.__s2sad_selection__, describe(values))
    call = flattened.state.entries.get(key)
    if call is None:
        call = way(flattened.state, carrier, tuple(values), outputs, wrt, with_value)
        flattened.state.entries[key] = call
        call.warns = False
    return paths, call, values


def _by_argument(flattened: Flattened, f: Any, names: Sequence[str] | None, paths: list[Path], call: ReverseCall,
              args: Sequence[Any], found: Mapping[str, Any]) -> dict[str, Any]:
    lost = set(call.rv.generated.facts.get("independent", ()))
    explicit = names is not None or selection_of(f)[0] is not None
    for name, form, path in paths if explicit else ():
        if set(flattened.floats(form, path)) <= lost:
            warn(f"no output asked for of '{flattened.title}' depends on '{name}': its gradient is zero")
    return {path[0]: flattened.with_floats(path, args, found) for path in paths}


def jvp(flattened: Flattened, f: Any, args: Sequence[Any], tangents: Mapping[str, Any], of: Sequence[str] | None,
        batch: bool = False) -> dict[str, Any]:
    """The tangents as `jvp` gives them."""
    with flattened.user_paths():
        values = flattened.values(args)
        count, given = directions_of(tangents) if batch else (1, [tangents])
        each = [flat_tangents(flattened, one, values) for one in given]
        flat = stacked(each) if batch else each[0]
        _, carrier = flattened.carrier(f)
        outputs = flattened.outputs(of)
        key = ("forward", tuple(flat), outputs, carrier.__s2sad_selection__, describe(values))
        call = flattened.state.entries.get(key)
        if call is None:
            call = ForwardCall(flattened.state, carrier, tuple(values), tuple(flat), outputs)
            flattened.state.entries[key] = call
        outputs = of if of is not None else selection_of(f)[1]
        if batch:
            found = batch_calls.jvp(call, values, flat)
            return together([_tangents(flattened, args, outputs, one, own)
                             for one, own in zip(apart(found, len(each)), each)], count)
        return _tangents(flattened, args, outputs, call.jvp(values, flat), flat)


def flat_tangents(flattened: Flattened, tangents: Mapping[str, Any], values: Sequence[Any], what: str = "tangents"
                  ) -> dict[str, Any]:
    """The tangents of the parts of structures, by flat names; `what` they are called."""
    by_name = dict(zip(flattened.paths, values))
    flat: dict[str, Any] = {}
    for name, value in tangents.items():
        path = flattened._selected_path(name, what)
        own = flattened.flat_parts(path, value, what.removesuffix("s"), by_name)
        flat |= own or {flattened.flat_names([path], what)[0]: value}
    return flat


def _tangents(flattened: Flattened, args: Sequence[Any], of: Sequence[str] | None, found: dict[str, Any],
              tangents: Mapping[str, Any]) -> dict[str, Any]:
    """The tangents of outputs: of what a structure holds and the kernel does not write, those that it had."""
    if of is None:
        roots = {flattened.paths[n].partition(".")[0].partition("[")[0] for n in found if n != RETURN}
        of = [*(p for p in flattened.forms if p in roots), *([RETURN] if RETURN in found else [])]
    outputs: dict[str, Any] = {}
    for name in of:
        if name == RETURN:
            outputs[name] = found[RETURN] if flattened.result is None else flattened.result_of(found[RETURN])
            continue
        path = flattened._selected_path(name, "of")
        floats = flattened.floats(path[1], path[2])
        held = {n: found.get(n, copy.copy(tangents.get(n))) for n in floats}
        zeros = {n: make_zero(v) for n, v in zip(flattened.paths, flattened.values(args)) if held.get(n, 0) is None}
        outputs[name] = flattened.with_floats(path, args, {**held, **zeros})
    return outputs
