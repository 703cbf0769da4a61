"""The user's own functions in generated modules: which a program calls, and how Numba reaches them."""
from __future__ import annotations

import importlib
import numbers
from collections.abc import Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from s2sad.diagnostics import Report, S2sadError
from s2sad.live_objects.guards import taken
from s2sad.infer.types import FLOAT, Type
from s2sad.program import Program
from s2sad.read.linker import header_of
from s2sad.live_objects.registry import GIVEN, ROOM, RegisteredRule
from s2sad.rules import constant_result
from s2sad.run.compiled import error_model
from s2sad.run.special_functions import register, used
from s2sad.run.through_python import through_python
from s2sad.tree import Call, call_name, walk
from s2sad.units import Unit, Units

_LIBRARIES = ("numpy", "math", "builtins", "numba", "scipy")


def registered_rules(program: Program) -> tuple[RegisteredRule, ...]:
    """The registered functions that a program's kernels call, those that their partials call, and the user's own
    derivatives of its kernels."""
    called = (call_name(n) or "" for k in program.kernels.values() for n in walk(k.tree) if isinstance(n, Call))
    owned = (g for k in program.kernels.values() if k.own is not None for g in k.own.functions.values())
    return (*GIVEN.closure(dict.fromkeys(c[len(ROOM):] for c in called if c.startswith(ROOM))),
            *dict.fromkeys(owned))


def compiled_in(function: Any) -> list[str]:
    """Takes what a function that is called as it is reads from its surroundings, which Numba compiles in; the names of
    the arrays there."""
    found: list[str] = []
    seen: set[int] = set()
    waiting = [function]
    while waiting:
        value = waiting.pop()
        value = getattr(value, "py_func", value)
        if id(value) in seen or not isinstance(value, FunctionType) or _is_of_library(value.__module__):
            continue
        seen.add(id(value))
        codes = list(_codes(taken(value, "code")))
        names = dict.fromkeys(n for c in codes for n in c.co_names)
        taken(value, "attribute", "__defaults__")
        places = [*((n, taken(value, "cell", n)) for n in codes[0].co_freevars),
                  *((n, taken(value, "global", n)) for n in names)]
        places += [(n, taken(m, "own", n)) for _, m in places if isinstance(m, ModuleType)
                   and not _is_of_library(m.__name__) for n in names]
        found += [n for n, v in places if isinstance(v, np.ndarray)]
        waiting += [v for _, v in places]
    return found


def _is_of_library(module: str | None) -> bool:
    return (module or "").partition(".")[0] in _LIBRARIES


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def for_numba(function: Any, flags: dict[str, Any]) -> Any:
    """A registered function as compiled code can call it: a Python function compiled, anything else as it is."""
    register(used({"function": function}))
    if not isinstance(function, FunctionType):
        return function
    return through_python(function) or importlib.import_module("numba").njit(**flags)(function)


def checked_constants(module: ModuleType, registered: tuple[RegisteredRule, ...]) -> ModuleType:
    """A generated module for NumPy whose nondifferentiable functions raise when they return no number."""
    kinds = {id(g.function): constant_result(ROOM + g.path) for g in registered}
    space = vars(module)
    space.update({name: _number(value, kinds[id(value)] or "") for name, value in list(space.items())
                  if kinds.get(id(value))})
    return module


def _number(function: Any, kind: str) -> Any:
    accepted = {"float": numbers.Real, "int": (numbers.Integral, np.bool_), "bool": (bool, np.bool_)}[kind]

    def called(*arguments: Any, **keywords: Any) -> Any:
        result = function(*arguments, **keywords)
        if not isinstance(result, accepted):
            raise TypeError(f"{function.__name__} is held fixed by s2sad.nondifferentiable(..., result={kind!r}), but "
                            f"returned {result!r}")
        return result
    return called


def compilable(units: Units) -> None:
    """Refuses, at its place, each call of a registered function that Numba cannot compile; raises S2sadError."""
    for unit in units.made.values():
        report = Report(unit.kernel.source)
        calls = {call_name(n) or "": n for tree in (unit.function, unit.kernel.tree) for n in walk(tree)
                 if isinstance(n, Call)}                # at its place in the user's text, where it is there
        types = {call_name(n): tuple(map(unit.typing.of, n.args)) for n in walk(unit.function) if isinstance(n, Call)}
        for name in sorted(n for n in calls if n.startswith(ROOM) and n in types):
            node = calls[name]
            for rule in GIVEN.closure([name[len(ROOM):]]):
                own = ROOM + rule.path == name
                if not _compiles(rule, types[name] if own else None):
                    whose = "" if own else ", which the derivative calls"
                    report.error("S407", f"Numba cannot compile '{rule.path}'{whose}", node,
                                 help='engine="numpy" calls it as it is')
        report.finish()


def uncompiled(units: Units) -> S2sadError | None:
    """Which derivative of the user's own Numba cannot compile, at the function that it belongs to; None if it can
    compile all of them."""
    for unit in units.made.values():
        what = None if unit.kernel.own is None else _uncompiled(unit)
        if what is not None and unit.kernel.own is not None:
            report, own = Report(unit.kernel.source), unit.kernel.own
            report.error("S407", f"Numba cannot compile '{own.functions[what].path}', the {what} of '{own.title}'",
                         header_of(unit.kernel.tree), help='engine="numpy" calls it as it is')
            return S2sadError(*report.found)
    return None


def _uncompiled(unit: Unit) -> str | None:
    """Which of the user's functions that belong to a unit Numba cannot compile, by what it does."""
    numba, owner = importlib.import_module("numba"), unit.owner
    kept = None
    for what, rule in owner.own.functions.items():
        if what == "solver":
            continue
        types = [kept if role == "kept" else _numba_type(numba, owner.types.get(p, FLOAT))
                 for role, p in owner.own.roles[what]]
        fails, result = _compilation(rule, types)
        if fails:
            return what
        if what == "forward":
            kept = result[-1] if owner.results and isinstance(result, numba.types.BaseTuple) else result
    return None


def _compilation(rule: RegisteredRule, types: list[Any]) -> tuple[bool, Any]:
    """Whether Numba fails to compile a function for these types, and the type of what it returns."""
    function = for_numba(rule.function, {"error_model": error_model()})
    try:
        if not hasattr(function, "compile"):
            return False, None
        function.compile(tuple(types))
        return False, function.overloads[tuple(types)].signature.return_type
    except Exception:  # as in `_compiles`
        return True, None


def _compiles(rule: RegisteredRule, types: tuple[Type, ...] | None) -> bool:
    """Whether Numba compiles a call with arguments of these types; None: as many floats as a Python function takes."""
    numba = importlib.import_module("numba")
    function = for_numba(rule.function, {"error_model": error_model()})
    if types is None:
        count = rule.plain.__code__.co_argcount if isinstance(rule.plain, FunctionType) else None
        if count is None:
            return any(_compiles(rule, (FLOAT,) * n) for n in (1, 2, 3))
        types = (FLOAT,) * count

    def reached(*arguments: Any) -> Any:
        return function(*arguments)
    try:
        taken = numba.types.StarArgTuple([_numba_type(numba, t) for t in types])
        compiled = numba.njit(error_model=error_model())(reached)
        compiled.compile((taken,))
    except Exception:  # whatever it is: Numba raises more than its own errors on code that it does not know
        return False
    kinds = {"float": numba.types.Number, "int": numba.types.Integer, "bool": numba.types.Boolean}
    kind = kinds.get(constant_result(ROOM + rule.path) or "")
    return kind is None or isinstance(compiled.nopython_signatures[0].return_type, (kind, numba.types.Boolean))


def _numba_type(numba: Any, kind: Type) -> Any:
    scalar = numba.boolean if kind.dtype == "bool" else getattr(numba, kind.dtype)
    return numba.types.Array(scalar, kind.rank, "C") if kind.is_array else scalar
