"""static_options: an option that a name spells is the number that the name is bound to.

    def f(a: float64[:, :], b: float64[:, :]):      def f(a, b):
        axis = 1                                        axis = 1
        for d in range(2):                              for d in (0, 1):
            b += np.roll(a, 1, d)                           b += np.roll(a, 1, d)
        return np.sum(b, axis=axis)                     return np.sum(b, axis=1)

*Requires* resolved names. *Establishes* that an option of which the number is known is written: of a kernel is known
what it binds once, to a number that is written; a number of its module; and a parameter that every call in the program
gives the same number. A loop over axes goes through numbers that are written out, and `counted_loops` puts each in its
place.
"""
from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from typing import Any

from s2sad import rules
from s2sad.infer.bounded_arithmetic import operation
from s2sad.infer.signatures.laws import whole_number
from s2sad.evaluate.call_graph import calls
from s2sad.evaluate.effects import parameters
from s2sad.evaluate.scope import KernelScope
from s2sad.passes import Context
from s2sad.program import Kernel, Program
from s2sad.read.outside_values import library_value
from s2sad.tree import (
    AST, Add, Assign, Attribute, BinOp, Call, Constant, For, FunctionDef, GeneratorExp, List, ListComp, Mult, Name, Sub,
    Tuple, USub, UnaryOp, at, call_name, const, copy, keyword, literal, names, rebuild, stored_names, times_bound,
    tuple_of, walk, walk_statements, with_body,
)

AXES = ("axis", "axis1", "axis2", "axes", "source", "destination")
_OPTIONS = frozenset({*AXES, "keepdims", "ord", "norm", "mode", "pad_width", "reps", "side", "indexing", "dtype"})
_LONGEST = 16
UNKNOWN = object()
Numbers = Mapping[str, Any]     # what names are bound to: whole numbers, bools, texts, None


def static_options(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    known = bound(scope.program).names(function, scope.kernel)

    def walked(node: AST) -> AST | None:
        """Loops over axes."""
        if isinstance(node, (ListComp, GeneratorExp)):
            new = copy(node)
            new.generators[0].iter = _short(new.generators[0], [new.elt], known)
            return new
        if not isinstance(node, For):
            return None
        new = copy(node)
        new.body = [rebuild(s, walked) for s in node.body]
        new.orelse = [rebuild(s, walked) for s in node.orelse]
        new.iter = _short(new, new.body, known)
        return new
    return with_body(function, [rebuild(in_options(statement, known), walked) for statement in function.body])


def _short(loop: AST, body: list[AST], known: Numbers) -> AST:
    """What a loop goes through, written out if it is numbers that are options in its body."""
    numbers = counted(loop.iter, known)
    wanted = numbers is not None and isinstance(loop.target, Name) and _is_option(loop.target.id, body)
    return at(tuple_of(*map(const, numbers or ())), loop.iter) if wanted else loop.iter


def in_options(node: AST, known: Numbers) -> AST:
    """The node with numbers in place of their names where they are options of functions."""
    def change(n: AST) -> AST | None:
        if not isinstance(n, Call):
            return None
        places = _parameters(n)
        args = [_written(a, known) if p in _OPTIONS else rebuild(a, change) for p, a in zip(places, n.args)]
        args += [rebuild(a, change) for a in n.args[len(args):]]
        values = [_written(k.value, known) if k.arg in _OPTIONS else rebuild(k.value, change) for k in n.keywords]
        given = [at(keyword(k.arg, v), k.value) for k, v in zip(n.keywords, values)]
        return at(Call(rebuild(n.func, change), args, given), n)
    return rebuild(node, change)


def in_round(block: list[AST], target: AST, item: AST) -> list[AST]:
    """The statements of a loop that is written out, for one item."""
    stored = stored_names(block)
    values = {t.id: _value(i, {}) for t, i in _pairs(target, item) if t.id not in stored}
    known = {n: v for n, v in values.items() if v is not UNKNOWN}
    return [in_options(s, known) for s in block] if known else block


def unsettled(function: FunctionDef, context: Context) -> None:
    """Refuses axes that are not known.

        def f(a: float64[:, :], k: int64):
            s = np.sum(a, axis=k)
            return s[0]

    refused: the axis of numpy.sum must be a number that is written in the kernel

    *Requires* calls in the spelling that has a rule; changes nothing.
    """
    report = context.report
    for node in walk(function.body):
        rule = rules.find_array(call_name(node))
        if rule is None or not len(rule.operands) <= len(node.args) <= len(rule.operands) + len(rule.options):
            continue
        for option, given in rule.arguments(node).items():
            if option in AXES and not _is_written(given):
                called = "axis" if option.startswith("axis") else "axes" if option == "axes" else f"{option} axes"
                report.error("S301", f"the {called} of {rule.name.removesuffix('.along')} must be a number that is "
                             "written in the kernel", given if getattr(given, "lineno", None) else node,
                             help="write it, or a name that is bound once, to a number: np.sum(x, axis=1)")


def _is_written(node: AST) -> bool:
    if isinstance(node, (Tuple, List)):
        return all(map(_is_written, node.elts))
    return whole_number(node) is not None or isinstance(node, Constant) and node.value is None


def _is_option(identifier: str, block: list[AST]) -> bool:
    """Whether a name is read in an option of a call."""
    return identifier in names(options(block)) and identifier not in stored_names(block)


def _parameters(node: Call) -> tuple[str, ...]:
    """The parameters of a function of NumPy's that the arguments by place stand for."""
    called = call_name(node)
    if called is not None:
        return _signature(called)
    return _signature(f"numpy.{node.func.attr}")[1:] if isinstance(node.func, Attribute) else ()


@cache
def _signature(path: str) -> tuple[str, ...]:
    if not path.startswith("numpy."):
        return ()
    try:
        found = inspect.signature(library_value(path)).parameters.values()
    except (TypeError, ValueError):
        return ()
    return tuple(p.name for p in found if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD))


class StaticValues:
    """What the names of a program's kernels are known to be: found once for each kernel, callers first."""

    def __init__(self, program: Program):
        self.program, self._calls = program, program.once(calls)
        self._known: dict[str, dict[str, Any]] = {}
        self._given: dict[str, dict[str, Any]] = {}

    def known(self, kernel: Kernel) -> dict[str, Any]:
        """What the names of a kernel are known to be, as it was read."""
        if kernel.name not in self._known:
            self._known[kernel.name] = self.names(kernel.tree, kernel)
        return self._known[kernel.name]

    def names(self, function: FunctionDef, kernel: Kernel) -> dict[str, Any]:
        """What the names of a kernel are known to be, in the form that it has now."""
        known: dict[str, Any] = {f"const.{n}": v for n, v in self.program.constants.items() if _is_plain(v)}
        stores, given, own = times_bound(function.body), self.given(kernel.name), parameters(function)
        known |= {p: given[p] for p in own if p not in stores and p in given}
        for bound, what in _bindings(function):
            found = _value(what, known)
            if stores[bound.id] == 1 and bound.id not in own and found is not UNKNOWN:
                known[bound.id] = found
        return known

    def given(self, title: str) -> dict[str, Any]:
        """What all calls of a kernel give its parameters, where they give the same."""
        if title not in self._given:
            self._given[title] = {}
            kernel = self.program.kernels[title]
            if title != self.program.entry and kernel.own is None:
                each = [self._arguments(kernel, caller, made) for caller, made in self._calls.get(title, ())]
                first = each[0] if each else {}
                self._given[title] = {p: v for p, v in first.items() if all(
                    p in a and type(a[p]) is type(v) and a[p] == v for a in each)}
        return self._given[title]

    def _arguments(self, kernel: Kernel, caller: str, node: Call) -> dict[str, Any]:
        known = self.known(self.program.kernels[caller])
        found = ((p, argument(node, kernel, p, known)) for p in kernel.parameters)
        return {p: v for p, v in found if v is not UNKNOWN}


def bound(program: Program) -> StaticValues:
    """What the names of all kernels are known to be."""
    return program.once(StaticValues)


def _bindings(function: FunctionDef) -> Iterator[tuple[Name, AST]]:
    """The names that assignments bind."""
    for node in walk_statements(function.body):
        for target in node.targets if isinstance(node, Assign) else []:
            yield from _pairs(target, node.value)


def _pairs(target: AST, value: AST) -> Iterator[tuple[Name, AST]]:
    """The names that are bound, those of tuples within tuples one by one, with what they are bound to."""
    if isinstance(target, Name):
        yield target, value
    elif isinstance(target, Tuple) and isinstance(value, (Tuple, List)) and len(target.elts) == len(value.elts):
        for t, v in zip(target.elts, value.elts):
            yield from _pairs(t, v)


def argument(node: Call, kernel: Kernel, parameter: str, known: Numbers) -> Any:
    """What a call gives a parameter."""
    given = {**dict(zip(kernel.parameters, node.args)), **{str(k.arg): k.value for k in node.keywords}}
    default = kernel.defaults.get(parameter, UNKNOWN)
    return _value(given[parameter], known) if parameter in given else default if _is_plain(default) else UNKNOWN


def options(block: list[AST]) -> list[AST]:
    """The arguments of calls that are options."""
    found: list[AST] = []
    for node in walk(block):
        if isinstance(node, Call):
            found += [a for p, a in zip(_parameters(node), node.args) if p in _OPTIONS]
            found += [k.value for k in node.keywords if k.arg in _OPTIONS]
    return found


def _is_plain(value: Any) -> bool:
    return value is None or type(value) in (int, bool, str) or type(value) is tuple and all(map(_is_plain, value))


def counted(iterable: AST, known: Numbers) -> Sequence[int] | None:
    """The numbers of a short range of which all bounds are known, or of a tuple."""
    if isinstance(iterable, (Tuple, List)):
        items = [_value(i, known) for i in iterable.elts]
        return items if all(type(i) is int for i in items) else None
    if call_name(iterable) != "builtins.range" or iterable.keywords or not 1 <= len(iterable.args) <= 3:
        return None
    bounds = [_value(a, known) for a in iterable.args]
    if any(type(b) is not int for b in bounds) or bounds[2:] == [0]:
        return None
    return found if len(found := range(*bounds)) <= _LONGEST else None


def _written(node: AST, known: Numbers) -> AST:
    """An option with its number written out, if it is known."""
    if isinstance(node, Constant):
        return node
    value = _value(node, known)
    made = None if value is UNKNOWN else literal(value)
    return rebuild(node, lambda n: None) if made is None else at(made, node)


def _value(node: AST, known: Numbers) -> Any:
    """What an expression of known names is."""
    if isinstance(node, Constant):
        return node.value if _is_plain(node.value) else UNKNOWN
    if isinstance(node, Name):
        return known.get(node.id, UNKNOWN)
    if isinstance(node, Tuple):
        items = tuple(_value(i, known) for i in node.elts)
        return UNKNOWN if any(i is UNKNOWN for i in items) else items
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        operand = _value(node.operand, known)
        return -operand if type(operand) is int else UNKNOWN
    if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub, Mult)):
        left, right = _value(node.left, known), _value(node.right, known)
        if type(left) is type(right) is int:
            with suppress(OverflowError):
                return operation(type(node.op).__name__, left, right)
    return UNKNOWN
