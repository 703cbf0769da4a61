"""divergence: the first statement at which a derivative is wrong, found by running it with a probe at every statement.

The tangent has a value and its tangent side by side: run at shifted inputs, the values give differences, and the first
probe at which they part from the tangent is the statement. For the adjoint, adjoint times tangent summed over all
variables is the same number between any two statements; going backwards, the first statement that changes it is wrong.
"""
from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from s2sad import pipeline
from s2sad.liveness import base_name, targets
from s2sad.emit.dialect import in_dialect
from s2sad.emit.module import module_text
from s2sad.emit.origins import text_of
from s2sad.emit.primal import kernels_called, primal_functions
from s2sad.evaluate.argument_binding import result_count
from s2sad.program import Generated, Program, Request
from s2sad.report.differences import differences
from s2sad.interface.selection import RETURN, items_of_seed
from s2sad.blocks import with_blocks
from s2sad.tree import (
    AST, Assign, AugAssign, Expr, FunctionDef, Name, Return, Subscript, call, const, copy, index, indices, is_comment,
    name, rename, user_call, walk,
)
from s2sad.units import UnitDerivative, Units

_PROBE = "user.s2sad_probe"
_MOST = 1_000_000  # numbers that probes keep
_DEFINED = {"numpy.empty": "numpy.zeros", "numpy.empty_like": "numpy.zeros_like"}

Events = list[tuple[str, Any, Any]]


def wrong_tangent(program: Program, request: Request, values: Mapping[str, Any], x_dot: Mapping[str, Any]) -> str:
    """The place at which the tangent first parts from differences, in words; empty if it parts nowhere."""
    made = pipeline.derive(program, request)
    units: Units = made.facts["units"]
    instrumented = {d.function.name: _probed(d) for d in units.derived.values()}
    function, events = _loaded(made, units, instrumented)

    def run(distance: float) -> Events:
        events.clear()
        moved = {n: values[n] + distance * np.asarray(x_dot[n]) if n in x_dot else values[n] for n in values}
        function(*_arguments(made, {n: _plain(v) for n, v in moved.items()}, x_dot, {}))
        return list(events)

    first = run(0.0)
    sizes = [np.size(value) for _, value, _ in first]

    def line(distance: float) -> np.ndarray:
        found = run(distance) if distance else first
        values = [np.ravel(v) if same and np.size(v) == size else np.full(size, math.nan)
                  for (_, v, _), size, same in zip(found, sizes, _same_way(first, found))]
        return np.concatenate([np.zeros(0), *values, np.full(sum(sizes[len(found):]), math.nan)])

    expected, error = differences(line)
    at = 0
    for (where, _, dot), size in zip(first, sizes):
        found, slope, unsure = np.ravel(dot), expected[at:at + size], error[at:at + size]
        at += size
        known = np.isfinite(unsure) & np.isfinite(found)
        if np.any(np.abs(found - slope)[known] > 1e-6 * np.abs(slope[known]) + 10 * unsure[known] + 1e-13):
            return where
    return ""


def wrong_adjoint(program: Program, request: Callable[[str], Request], values: Mapping[str, Any],
                  x_dot: Mapping[str, Any], seeds: Mapping[str, Any], total: float) -> str:
    """The place at which, going backwards, adjoint times tangent first changes; empty if it does nowhere."""
    dots, order = _states(program, request("tangent"), values, x_dot, {})
    bars, _ = _states(program, request("adjoint"), values, seeds, seeds)
    place = {where: k for k, where in enumerate(order)}
    last = len(order)
    for where, state in bars.items():
        if where not in place:
            continue
        known = dots[order[place[where] - 1] if place[where] else ""]
        terms = [np.sum(_reals(bar) * _reals(known[v])) for v, bar in state.items() if v in known]
        size = sum(float(np.sum(np.abs(_reals(bar) * _reals(known[v])))) for v, bar in state.items() if v in known)
        if abs(math.fsum(terms) - total) > 1e-9 * (size + abs(total)):
            return _named(order[place[where]:last])
        last = place[where]
    return ""


def _named(suspects: list[str]) -> str:
    """The statements between two states in words: the last one, and the first if there are several."""
    first, last = suspects[0].partition(" ")[2], suspects[-1].partition(" ")[2]
    return first if len(suspects) == 1 else f"{last}, or before it, back to {first}"


# -- the tangent: a probe after every statement ---------------------------------------------------------------------

def _probed(derived: UnitDerivative) -> FunctionDef:
    """The tangent before it was simplified, with a probe after every statement that moves a tangent."""
    primals = {s: p for p, s in derived.made.shadows.items()}
    made: FunctionDef = rename(copy(derived.made.function), _DEFINED)
    made.body = _with_probes(made.body, primals, derived)
    return made


def _with_probes(block: list[AST], primals: dict[str, str], derived: UnitDerivative) -> list[AST]:
    made: list[AST] = []
    probes: list[AST] = []
    for k, statement in enumerate(block):
        if isinstance(statement, Return):
            return [*made, statement]
        made.append(with_blocks(statement, lambda inner: _with_probes(inner, primals, derived)))
        probes += _probes(statement, primals, derived)
        if _where(statement) != (_where(block[k + 1]) if k + 1 < len(block) else None):
            made += probes
            probes = []
    return made + probes


def _probes(statement: AST, primals: dict[str, str], derived: UnitDerivative) -> list[AST]:
    """The probes of one statement: (place, value, tangent) for what it moves."""
    table, found = derived.types, []
    if not isinstance(statement, (Assign, AugAssign, Expr)) or _where(statement) is None:
        return []
    moved: list[AST] = [t for t in targets(statement) if base_name(t) in primals]
    if user_call(statement.value):
        moved += [a for a in statement.value.args if base_name(a) in primals and table[base_name(a)].is_array]
    for target in moved:
        primal = primals[base_name(target)]
        if isinstance(target, Subscript):
            found.append((index(name(primal), *map(copy, indices(target))),
                          index(name(target.value.id), *map(copy, indices(target)))))
        elif isinstance(statement, Expr) or table[base_name(target)].is_number or target not in targets(statement):
            found.append((name(primal), name(base_name(target))))
    return [Expr(call(_PROBE, const(_statement_text(statement, derived)), value, dot)) for value, dot in found]


def _statement_text(statement: AST, derived: UnitDerivative) -> str:
    source = derived.unit.kernel.source
    home, line = source.home(statement.lineno)
    return f"{home.path}:{line}: {text_of(statement, source, 90)}"


def _where(statement: AST) -> tuple[int, int] | None:
    line = getattr(statement, "lineno", None)
    return None if line is None else (line, statement.col_offset)


def _same_way(first: Events, later: Events) -> list[bool]:
    """Whether the run is still on the same way at each probe."""
    found, same = [], True
    for (a, _, _), (b, _, _) in zip(first, later):
        same = same and a == b
        found.append(same)
    return found


# -- the adjoint: all variables between the statements of the entry -------------------------------------------------

def _states(program: Program, request: Request, values: Mapping[str, Any], shadows: Mapping[str, Any],
            seeds: Mapping[str, Any]) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """The shadows by primal after each top-level statement of the entry that has any, by place; the places in order."""
    made = pipeline.derive(program, request)
    units, derived = made.facts["units"], made.facts["derived"]
    entry: FunctionDef = rename(copy(derived.made.function), _DEFINED)
    entry.body, last = _with_snapshots(entry.body, derived, request.mode == "tangent")
    function, events = _loaded(made, units, {entry.name: entry})
    function(*_arguments(made, {n: _plain(v) for n, v in values.items()}, shadows, seeds))
    found = {place: {p: space[s] for p, s in derived.made.shadows.items() if s in space} for place, space, _ in events}
    return found, [*(p for p in found if p), *last]


def _with_snapshots(body: list[AST], derived: UnitDerivative, whole: bool) -> tuple[list[AST], list[str]]:
    """The body with a probe of all local variables after each group of statements that deals with shadows: of the
    `whole` body or of the reverse sweep; and the place of its return."""
    marks = [k for k, s in enumerate(body) if is_comment(s)]
    start = 0 if whole or not marks else marks[-1] + 1
    shadows = set(derived.made.shadows.values())
    made, deals = [*body[:start], *([_snapshot("")] if whole else [])], False
    for k, statement in enumerate(body[start:], start):
        made.append(statement)
        if _where(statement) is None:
            continue
        place = f"{statement.lineno}.{statement.col_offset} {_statement_text(statement, derived)}"
        if isinstance(statement, Return):
            return made, [place] if whole else []
        deals = deals or any(isinstance(n, Name) and n.id in shadows for n in walk(statement))
        if deals and _where(statement) != next((_where(s) for s in body[k + 1:] if _where(s)), None):
            made.append(_snapshot(place))
            deals = False
    return made, []


def _snapshot(place: str) -> AST:
    return Expr(call(_PROBE, const(place), call("builtins.locals"), const(0)))


# -- running --------------------------------------------------------------------------------------------------------

def _loaded(made: Generated, units: Units, replaced: Mapping[str, FunctionDef]) -> tuple[Callable[..., Any], Events]:
    """The entry of the module with some functions replaced, and the list into which its probes write."""
    functions = [f for d in units.derived.values() for f in (*d.beside, replaced.get(d.function.name, d.function))]
    functions = primal_functions(units, kernels_called(functions, units)) + functions
    text = module_text(in_dialect(functions, units), header=["A derivative with probes."],
                       constants=units.program.constants, standalone=False)
    events: Events = []
    kept = [0]

    def probe(where: str, value: Any, dot: Any) -> None:
        state = isinstance(value, dict)
        kept[0] = 0 if not events else kept[0] + np.size(dot)
        if kept[0] < _MOST:
            held = (float, complex, np.ndarray)
            events.append((where, {k: np.copy(v) for k, v in value.items() if isinstance(v, held)} if state
                           else _reals(value), _reals(dot)))

    space: dict[str, Any] = {"s2sad_probe": probe}
    exec(compile(text, f"<{made.entry} with probes>", "exec"), space)
    return space[made.entry], events


def _arguments(made: Generated, values: Mapping[str, Any], shadows: Mapping[str, Any],
               seeds: Mapping[str, Any]) -> list[Any]:
    """Private copies of the arguments; missing shadows are zero."""
    arguments: list[Any] = []
    for parameter in made.parameters:
        value = values.get(parameter.name if parameter.role == "primal" else parameter.primal)
        if parameter.role == "primal":
            arguments.append(np.array(value) if isinstance(value, np.ndarray) else value)
        elif parameter.role == "shadow":
            shadow = shadows.get(parameter.primal)
            arguments.append((np.zeros_like(value) if shadow is None else np.array(shadow))
                             if isinstance(value, np.ndarray) else _number(value)(shadow or 0.0))
        else:
            program = made.facts["units"].program
            count, seed = result_count(program.entry, program), seeds.get(RETURN)
            row = [seed] if count < 2 else items_of_seed(seed, count)
            arguments.append(row[int(parameter.primal.split()[1])])
    return arguments


def _number(value: Any) -> Any:
    return complex if isinstance(value, complex) else float


def _reals(value: Any) -> np.ndarray:
    """A copy of numbers as floats, of complex ones two of them."""
    found = np.array(value)
    return np.ravel(found).view(float) if np.iscomplexobj(found) else found.astype(float)


def _plain(value: Any) -> Any:
    """A number that was moved is a plain float again."""
    return float(value) if isinstance(value, np.floating) else value
