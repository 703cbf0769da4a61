"""header: the docstring of a generated file: what is differentiated by what, types, roles, what is recorded."""
from __future__ import annotations

from s2sad.liveness import base_name, read_names, targets
from s2sad.emit.stack_report import recorded_lines
from s2sad.normalize.calls.global_arrays import hidden_name
from s2sad.program import Request
from s2sad.tree import (
    AST, Assign, AugAssign, Expr, For, FunctionDef, If, Return, Subscript, While, const, copy, user_call, walk,
)
from s2sad.units import UnitDerivative, Unit, Units


def header(derived: UnitDerivative, request: Request, units: Units) -> list[str]:
    """The lines of the docstring."""
    unit = derived.unit
    of, wrt = (", ".join(names) or "nothing" for names in (request.of, request.wrt))
    assumed = dict(request.assumed)
    engine = {"numpy": "NumPy", "numba": "Numba"}[request.engine]
    whole = f"{request.mode.capitalize()} of {unit.kernel.name}{' in two functions' if request.split else ''}"
    lines = [f"{whole}: d({of}) / d({wrt}).", "",
             f"Engine: {engine}. Level: {request.level}. Arguments:"]
    for parameter, kind in zip((p.id for p in unit.function.args.args), unit.types):
        name = hidden_name(parameter, units.program)
        shown = name.replace("array.", "the array ")
        why = f" (assumed: {assumed[parameter]})" if parameter in assumed else ""
        lines.append(f"    {shown}: {kind}, {role_of(parameter, unit, units)}{why}")
    if request.mode == "adjoint":
        lines += ["", *recorded_lines(derived, list(units.derived.values()))]
    return lines


def documented(function: FunctionDef, derived: UnitDerivative, manner: str = "") -> FunctionDef:
    """The function under a line that says what it differentiates with respect to what, and in what manner."""
    results = len(derived.unit.summary.results)
    of = ", ".join("return" if results == 1 and o.startswith("return ") else o for o in derived.request.of)
    wrt = ", ".join(derived.request.wrt)
    said = f"{derived.mode.capitalize()} of {derived.unit.kernel.name}: d({of or 'nothing'}) / d({wrt or 'nothing'})"
    return with_docstring(function, f"{said}, {manner}." if manner else f"{said}.")


def with_docstring(function: FunctionDef, said: str) -> FunctionDef:
    """The function under a line."""
    new = copy(function)
    new.body = [Expr(const(said)), *new.body]
    return new


def role_of(parameter: str, unit: Unit, units: Units) -> str:
    """Whether a parameter goes in, comes out, or both.

    "out" is an array whose elements the kernel writes and never reads; it may still leave some as they were.
    """
    position = [p.id for p in unit.function.args.args].index(parameter)
    if position not in unit.summary.written:
        return "in"
    return "in-out" if reads(unit, parameter, units) else "out"


def reads(unit: Unit, array: str, units: Units) -> bool:
    """Whether a kernel, or one that it calls, reads elements of an array."""
    return any(_reads(statement, array, units) for statement in walk(unit.function.body))


def _reads(statement: AST, array: str, units: Units) -> bool:
    if isinstance(statement, (Assign, AugAssign)):
        inner = [t.slice for t in targets(statement) if isinstance(t, Subscript)]
        return _read(statement.value, array, units) or array in read_names(inner) or (
            isinstance(statement, AugAssign) and base_name(statement.target) == array)
    if isinstance(statement, (Expr, Return)) and statement.value is not None:
        return _read(statement.value, array, units)
    if isinstance(statement, (If, While)):
        return array in read_names(statement.test)
    return isinstance(statement, For) and array in read_names(statement.iter)


def _read(value: AST, array: str, units: Units) -> bool:
    """Whether an expression reads elements; an array passed to a kernel is read if that reads it."""
    unit = units.callee(value) if user_call(value) else None
    if unit is None:
        return array in read_names(value)
    parameters = [p.id for p in unit.function.args.args]
    for parameter, argument in zip(parameters, value.args):
        if base_name(argument) == array and unit.typing.table[parameter].is_array:
            if reads(unit, parameter, units):
                return True
        elif array in read_names(argument):
            return True
    return False
