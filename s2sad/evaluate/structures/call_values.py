"""What calls of one kernel stand for while structures are taken apart.

    limit(state, 2.0)          ->   user.limit(state_u, state_t, 2.0)
    state.norm()               ->   user.norm(state_u)
    Orbit(x, v=0.0)            ->   a structure of x and 0.0
"""
from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any, Protocol

from s2sad.diagnostics import Report
from s2sad.live_objects.guards import class_attribute
from s2sad.infer.types import UNKNOWN
from s2sad.evaluate.argument_binding import bound_arguments, user_call
from s2sad.evaluate.structures.static_tests import NO, Decisions
from s2sad.evaluate.structures.literal_arguments import nests
from s2sad.evaluate.structures.items import parts_of, spoken
from s2sad.evaluate.structures.groups import (
    NOTHING, SPELLED, StructureValue, Leaf, Plain, Value, flat, listed, pattern, usable,
)
from s2sad.program import Kernel, Program
from s2sad.pytree import Form, PyTree, is_fixed, is_held, leaves, method_of, record_fields
from s2sad.tree import (
    AST, Attribute, BoolOp, Call, Compare, Constant, Dict, IfExp, List, Name, Not, Subscript, Tuple, UnaryOp,
    add, at, call_name, const, keyword, name,
)

_REPLACING = ("_replace", "__replace__")
Passed = dict[int, "Leaf | Plain"]


class SpecializedCallee(Protocol):
    """A kernel made for arguments of one pattern."""
    title: str
    flat: dict[str, list[str]]
    taken: tuple[str, ...]
    needed: set[int]
    result: StructureValue | None


class Maker(Protocol):
    """What one kernel asks of the pass: the program, and other kernels for patterns of arguments."""
    program: Program

    def callee(self, kernel: str, patterns: tuple[Form, ...]) -> SpecializedCallee: ...


class Unread(Exception):
    """A function of a class that must be read before the program can be taken apart."""

    def __init__(self, function: Any, made: type, name: str):
        super().__init__(function)
        self.function, self.made, self.name = function, made, name


class CallValues(Decisions):
    """What the expressions of one kernel stand for; `needed` are the places of parameters that are assigned and must be
    cells."""

    def __init__(self, kernel: Kernel, maker: Maker, report: Report):
        super().__init__(kernel, report)
        self.maker, self.program = maker, maker.program
        self.needed: set[int] = set()
        self.nests = nests(kernel.tree, maker.program)

    def as_call(self, node: AST) -> Call | None:
        """A call of a kernel: as it is, or what a method's call means, `user.norm(state)` for `state.norm()`."""
        if not isinstance(node, Call) or user_call(node) is not None:
            return node if isinstance(node, Call) else None
        base = self.structural(node.func.value) if isinstance(node.func, Attribute) else None
        return self._of_class(base, node.func, node) if isinstance(base, StructureValue) else None

    def _of_class(self, base: StructureValue, place: Attribute, node: AST) -> Call | None:
        """The call that a method or a property of a structure's class means."""
        found = method_of(base.form.made, place.attr) if base.form.made and place.attr not in base.form.keys else None
        if found is None or base.form.kind not in ("record", "named") or (found[1] == "property") is isinstance(
                node, Call) or found[0].__module__ in ("collections", "builtins", "dataclasses") or (
                place.attr in _REPLACING):
            return None
        title = self.program.methods.get(found[0])
        if title is None:
            raise Unread(found[0], base.form.made or object, place.attr)
        given = [] if found[1] == "static" else [place.value]
        arguments, keywords = (node.args, node.keywords) if isinstance(node, Call) else ([], [])
        return at(Call(at(name(f"user.{title}"), place), [*given, *arguments], keywords), node)

    def property_of(self, base: StructureValue, node: Attribute) -> Value | None:
        called = self._of_class(base, node, node)
        return self._constant_of(base, node) if called is None else self._call(called)

    def _constant_of(self, base: StructureValue, node: Attribute) -> Value | None:
        """A number or string that a structure's class holds, under a name that is no field."""
        made = base.form.made if node.attr not in base.form.keys else None
        value = class_attribute(made, node.attr) if made else None
        if type(value) not in (int, float, bool, str) or base.form.kind not in ("record", "named"):
            return None
        return Plain(at(const(value), node))

    def _call(self, node: Call) -> Value | None:
        method = self.as_call(node)
        if method is not None:
            callee, made, _ = self.call(method)
            if callee is not None and callee.result is not None and not plain_tuple(callee.result):
                self.refuse(node, f"'{user_call(method)}' returns a structure inside an expression",
                            "give the result a name of its own first")
            return Plain(made)
        if (known := self.decide(node)) is not None:
            return Plain(at(const(known), node))
        called = call_name(node) or ""
        if called.startswith("record."):
            return self._constructed(node, called.partition(".")[2])
        if called == "builtins.len":
            return self._length(node)
        if called in ("builtins.max", "builtins.min", "builtins.sum") and len(node.args) == 1 and not node.keywords:
            return self._over_items(called, node)
        if called in ("builtins.tuple", "builtins.list") and len(node.args) == 1:
            found = self.structural(node.args[0])
            if isinstance(found, StructureValue) and found.form.is_sequence:
                kind = called.partition(".")[2]
                form = replace(found.form, kind=kind, keys=tuple(range(len(found.items))), made=None, fixed=True)
                return StructureValue(form, found.items, found.path)
        if isinstance(node.func, Attribute):
            base = self.structural(node.func.value)
            if isinstance(base, StructureValue):
                return self._method(base, node)
        return None

    def _constructed(self, node: Call, title: str) -> Value:
        """`State(u, t=0.0)` of a class that only holds fields."""
        made = self.program.records[title]
        kind, defaults = record_fields(made) or ("record", {})
        given: dict[str, Value] = {}
        pairs = [*zip(defaults, node.args), *((k.arg or "", k.value) for k in node.keywords)]
        fit = len(node.args) <= len(defaults) and len({k for k, _ in pairs}) == len(pairs) and all(
            k in defaults for k, _ in pairs)
        for key, argument in pairs:
            given[key] = self.now(self.whole(argument), argument, not is_fixed(kind, made))
        for key, default in defaults.items():
            if key not in given and (default is None or type(default) in (int, float, bool, str)):
                given[key] = Plain(at(const(default), node))
        if not fit or any(k not in given for k in defaults):
            self.refuse(node, f"{title}({', '.join(defaults)}) is made with other arguments", code="S405")
            return Plain(at(const(0.0), node))
        return _group(PyTree(kind, tuple(defaults), (), made, is_fixed(kind, made)),
                      [given[k] for k in defaults])

    def _over_items(self, called: str, node: Call) -> Value | None:
        """`max(p)`, `min(p)` and `sum(p)` of a structure's items."""
        found = self.structural(node.args[0])
        if not isinstance(found, StructureValue) or not found.form.is_sequence or len(found.items) < 2:
            return None
        items = [self.plainly(item, node.args[0]) for item in found.items]
        if called != "builtins.sum":
            return Plain(at(Call(node.func, items, []), node))
        return Plain(at(functools.reduce(add, items), node))

    def _dict(self, node: Dict) -> Value:
        """A dict whose keys are written out."""
        keys = tuple(k.value for k in node.keys)
        if len(set(keys)) < len(keys):
            self.refuse(node, "a dict that has one key twice", "leave one of them out")
        return _group(PyTree("dict", tuple(dict.fromkeys(keys)), (), dict),
                      [self.now(self.whole(v), v, True) for v in node.values])

    def _method(self, base: StructureValue, node: Call) -> Value:
        """`p.get("k", 1.0)`, `p.items()`, `p.keys()`, `p.values()` of a dict."""
        method, count, kind = node.func.attr, len(node.args), base.form.kind
        own = kind == "record" and not base.form.fixed
        given = node.keywords if method in _REPLACING else []
        new = {str(k.arg): self.now(self.whole(k.value), k.value, own) for k in given}
        if new and not count and new.keys() <= set(base.form.keys) and _has_fields(base.form, method):
            items = tuple(new[str(k)] if k in new else self.now(i, node, own) for k, i in zip(
                base.form.keys, base.items))
            return replace(base, items=items, path=SPELLED)
        if kind == "dict" and not node.keywords:
            key = self.key(node.args[0]) if method == "get" and 1 <= count <= 2 else None
            if key is not None:
                if key in base.form.keys:
                    return base.item(key)
                return self.value(node.args[1]) if count == 2 else NOTHING
            keys = tuple(Plain(at(const(k), node)) for k in base.form.keys)
            pairs = tuple(listed((k, v)) for k, v in zip(keys, base.items))
            views = {"keys": keys, "values": base.items, "items": pairs}
            if method in views and not count:
                return listed(views[method])
        method = method.strip("_") if method == "__replace__" else method
        self.refuse(node, f"the method '{method}' of {spoken(base)}, which is {base.form}, {NO}",
                    f"write what it does with {parts_of(base)}" if base.items else "")
        return Plain(at(const(0.0), node))

    def call(self, node: Call) -> tuple[SpecializedCallee | None, Call, Passed]:
        """The kernel for these arguments, the call of it on flat arguments, and what is given at each place."""
        called = user_call(node) or ""
        kernel = self.program.kernels[called]
        before = len(self.report.found)
        bound_arguments(node, self)  # pyright: ignore[reportArgumentType]  (says what does not fit)
        if len(self.report.found) > before:
            return None, node, {}
        given = [*zip(kernel.parameters, node.args), *((k.arg or "", k.value) for k in node.keywords)]
        values = {p: self.argument(a) for p, a in given}
        patterns = tuple(self._pattern(values.get(p), kernel.defaults.get(p, 0)) for p in kernel.parameters)
        callee = self.maker.callee(called, patterns)
        positional, keywords = [], []
        for k, (parameter, argument) in enumerate(given):
            made = self._flat(values[parameter], patterns[kernel.parameters.index(parameter)], argument)
            pairs = [(n, a) for n, a in zip(callee.flat[parameter], made) if n in callee.taken]
            if k < len(node.args):
                positional += [a for _, a in pairs]
            else:
                keywords += [keyword(n, a) for n, a in pairs]
        passed = self._passed(kernel, callee, values)
        self._cells(node, callee, passed, [path for p, form in zip(kernel.parameters, patterns)
                                           for path, kind in leaves(form, p) if is_held(kind)])
        return callee, at(Call(at(name(f"user.{callee.title}"), node), positional, keywords), node), passed

    def _pattern(self, value: Value | None, default: Any) -> Form:
        if value is None:
            return NOTHING.type if default is None else UNKNOWN
        found = pattern(value)
        return found if isinstance(found, PyTree) or found.kind in ("none", "other") else UNKNOWN

    def _flat(self, value: Value, wanted: Form, origin: AST) -> list[AST]:
        """The flat arguments for one parameter."""
        if not isinstance(wanted, PyTree):
            return [] if wanted.kind in ("none", "other") else [self.plainly(value, origin)]
        return [v.node if isinstance(v, Plain) else at(name(v.name), origin) for v in flat(value)]

    def _passed(self, kernel: Kernel, callee: SpecializedCallee, values: dict[str, Value]) -> Passed:
        """The leaves and constants that stand at the places of the callee's flat parameters."""
        found, at_ = {}, 0
        for parameter in kernel.parameters:
            value = values.get(parameter)
            for k, leaf in enumerate(flat(value) if isinstance(value, StructureValue) else ()):
                if isinstance(leaf, Leaf) or isinstance(leaf.node, Constant):
                    found[at_ + k] = leaf
            at_ += len(callee.flat[parameter])
        return found

    def _cells(self, node: Call, callee: SpecializedCallee, passed: Passed, paths: list[str]) -> None:
        """What the callee assigns must be cells here, too."""
        for place in sorted(callee.needed):
            leaf = passed.get(place)
            if isinstance(leaf, Leaf) and leaf.place >= 0:
                self.needed.add(leaf.place)
            else:
                what = f"'{leaf.path if isinstance(leaf, Leaf) else paths[place]}'"
                self.refuse(node, f"'{user_call(node)}' assigns {what}, which was made in this kernel",
                            "return the new value, and assign it here")


def _group(form: PyTree, items: list[Value]) -> StructureValue:
    """A structure that a kernel makes."""
    return StructureValue(replace(form, items=tuple(map(pattern, items))), tuple(items), SPELLED)


def _has_fields(form: PyTree, method: str) -> bool:
    """Whether a structure is one whose fields a method replaces: a named tuple, or a dataclass that only has fields."""
    return form.kind == "named" or method == "__replace__" and form.kind == "record" and form.made is not None and (
        tuple((record_fields(form.made) or ("", {}))[1]) == form.keys)


def plain_tuple(result: StructureValue) -> bool:
    """Whether a result is a tuple or a list of values as any function may return one."""
    return result.path == SPELLED and result.form.kind in ("tuple", "list") and all(
        isinstance(i, Leaf) and usable(i) and i.place < 0 for i in result.items)


CallValues.seen = {
    Name: CallValues._name, Attribute: CallValues._field, Subscript: CallValues._item, Call: CallValues._call,
                   Compare: CallValues._test,
    BoolOp: CallValues._test, UnaryOp: lambda v, n: v._test(n) if isinstance(n.op, Not) else None,
    IfExp: CallValues._choice,
    Tuple: CallValues._display, List: CallValues._display, Dict: CallValues._dict,
}
