"""The expressions of one kernel while structures are taken apart.

    state.inner.k * x[0]       ->   state_inner_k * x[0]
    layers[1][0] @ x           ->   layers_1_0 @ x
    x if m is None else m * x  ->   m * x               (an argument that is not None)
    limit(state, 2.0)          ->   user.limit(state_u, state_t, 2.0)
"""
from __future__ import annotations

import difflib
import operator
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

from s2sad.diagnostics import Report
from s2sad.infer.types import UNKNOWN
from s2sad.normalize.calls import bound_arguments, user_call
from s2sad.normalize.groups import (
    CELL, NOTHING, SPELLED, Conflict, Group, Leaf, Ordinary, Plain, Value, flat, listed, nothing, pattern, spelled,
    usable,
)
from s2sad.program import Kernel, Program
from s2sad.structure import Form, Structure, is_fixed, record_fields
from s2sad.tree import (
    AST, Add, And, Attribute, BinOp, BoolOp, Call, Compare, Constant, Dict, Eq, FloorDiv, Gt, GtE, IfExp, In, Is, IsNot,
    List, Lt, LtE, Mod, Mult, Name, Not, NotEq, NotIn, Slice, Store, Sub, Subscript, Tuple, UnaryOp, USub, at,
    call_name, const, copy, keyword, name, rebuild,
)

NO = "is not supported in a kernel"
_ARITHMETIC: dict[type, Callable[[int, int], int]] = {
    Add: operator.add, Sub: operator.sub, Mult: operator.mul, FloorDiv: operator.floordiv, Mod: operator.mod}
_ORDER: dict[type, Callable[[Any, Any], bool]] = {
    Eq: operator.eq, NotEq: operator.ne, Lt: operator.lt, LtE: operator.le, Gt: operator.gt, GtE: operator.ge}


class Callee(Protocol):
    """A kernel made for arguments of one pattern."""
    title: str
    flat: dict[str, list[str]]
    taken: tuple[str, ...]
    needed: set[int]
    result: Group | None


class Maker(Protocol):
    """What one kernel asks of the pass: the program, and other kernels for patterns of arguments."""
    program: Program

    def callee(self, kernel: str, patterns: tuple[Form, ...]) -> Callee: ...


class Values:
    """What the expressions of one kernel stand for, given what its names do; `needed` are the places of parameters
    that are assigned and must be cells."""

    def __init__(self, kernel: Kernel, maker: Maker, report: Report):
        self.kernel, self.maker, self.report = kernel, maker, report
        self.program = maker.program
        self.env: dict[str, Value | Conflict | Ordinary] = {}
        self.needed: set[int] = set()

    def refuse(self, node: AST, message: str, help: str = "", code: str = "S201") -> None:
        self.report.error(code, message, node, help=help)

    # -- what an expression is -----------------------------------------------------------------------------------------

    def value(self, node: AST) -> Value:
        found = self.structural(node)
        if found is not None:
            return found
        return Plain(rebuild(node, lambda n: None if n is node else self._changed(n)))

    def whole(self, node: AST) -> Value:
        """The value of an expression, a tuple that is written out as a structure."""
        spelled_out = isinstance(node, (Tuple, List)) and self.structural(node) is None
        return listed(tuple(self.whole(item) for item in node.elts)) if spelled_out else self.value(node)

    def plain(self, node: AST) -> AST:
        """The expression without structures; one that stays a structure is refused."""
        return self.plainly(self.value(node), node)

    def plainly(self, value: Value, node: AST) -> AST:
        found = spelled(value, node)
        if found is not None and not (nothing(value) and isinstance(value, Leaf)):
            return found
        if isinstance(value, Leaf):
            self._unusable(value, node)
        elif isinstance(value, Group):
            self.refuse(node, f"{_called(value, node)} is {value.form}, which is used as a whole here",
                        f"name what is in it: {_parts(value)}" if value.items else "", "S203")
        return at(const(0.0), node)

    def structural(self, node: AST) -> Value | None:
        """The value of an expression that has to do with structures, None for any other."""
        seen = _SEEN.get(type(node))
        return None if seen is None else seen(self, node)

    def _changed(self, node: AST) -> AST | None:
        if isinstance(node, (Attribute, Subscript)) and isinstance(node.ctx, Store):
            return self.stored(node)
        found = self.structural(node)
        return None if found is None else self.plainly(found, node)

    def stored(self, node: AST) -> AST | None:
        """A target inside another one; field_blocks knows what may be stored where."""
        return None

    def _unusable(self, value: Leaf, node: AST) -> None:
        path = value.path or (node.id if isinstance(node, Name) else "this")
        if nothing(value):
            self.refuse(node, f"'{path}' is None here", f"test it before: if {path} is not None: ...", "S203")
        else:
            self.refuse(node, f"'{path}' is {value.type.dtype}, which a kernel cannot use",
                        "keep what the kernel reads in arrays, floats and ints", "S203")

    # -- names, fields, items ------------------------------------------------------------------------------------------

    def _name(self, node: Name) -> Value | None:
        found = None if isinstance(node.ctx, Store) else self.env.get(node.id)
        if isinstance(found, Conflict):
            self.refuse(node, f"'{node.id}' is one thing on one way to here and another on another, one of them a "
                        "structure or None", "give the two different names", "S203")
            return None
        if isinstance(found, Plain):
            return Plain(at(copy(found.node), node)) if isinstance(found.node, Constant) else None
        return None if isinstance(found, Ordinary) else found

    def _field(self, node: Attribute) -> Value | None:
        base = self.structural(node.value)
        if isinstance(base, Leaf) and not usable(base):
            self._unusable(base, node.value)
            return Plain(at(const(0.0), node))
        if not isinstance(base, Group) or isinstance(node.ctx, Store):
            return None
        return self.field_of(base, node)

    def field_of(self, base: Group, node: Attribute) -> Value:
        if base.form.kind in ("record", "named", "either"):
            if node.attr in base.form.keys:
                return base.item(node.attr)
            self._absent(base, node, f"{_called(base, node.value)} has no field '{node.attr}'", node.attr, "fields")
        else:
            numbers = all(isinstance(i, Leaf) and i.type.kind in ("number", CELL) for i in base.items)
            help = f"write {base.path}[{node.attr!r}]" if node.attr in base.form.keys else (
                f"its items are read as {_parts(base)}" if base.items and not (numbers and base.form.is_sequence) else
                f"pass numpy.array({base.path}, dtype=float)" if base.form.is_sequence else "it is empty")
            self.refuse(node, f"{_called(base, node.value)} is {base.form}, which has no attribute '{node.attr}' in a "
                        "kernel", help, "S203")
        return Plain(at(const(0.0), node))

    def _absent(self, base: Group, node: AST, message: str, key: str, what: str) -> None:
        keys = [str(k) for k in base.form.keys]
        close = difflib.get_close_matches(key, keys, 1, 0.7)
        listed = f"its {what} are {', '.join(keys)}" if keys else f"it has no {what}"
        self.refuse(node, message, f"did you mean '{close[0]}'? {listed}" if close else listed, "S202")

    def _item(self, node: Subscript) -> Value | None:
        base = self.structural(node.value)
        if isinstance(base, Leaf) and not usable(base):
            self._unusable(base, node.value)
            return Plain(at(const(0.0), node))
        if not isinstance(base, Group) or isinstance(node.ctx, Store):
            return None
        if isinstance(node.slice, Slice) and base.form.is_sequence:
            return self._slice(base, node)
        found = self.item_of(base, node)
        return Plain(at(const(0.0), node)) if found is None else found

    def item_of(self, base: Group, node: Subscript) -> Value | None:
        """The item that a subscript names; None, and a diagnostic, if it names none."""
        key = self.key(node.slice)
        form, count = base.form, len(base.items)
        if form.is_sequence and isinstance(key, int):
            if -count <= key < count:
                return base.items[key]
            self.refuse(node, f"{_called(base, node.value)} has {count} items, and no item {key}", code="S203")
        elif form.kind in ("dict", "either") and key is not None:
            if key in form.keys:
                return base.item(key)
            self._absent(base, node, f"{_called(base, node.value)} has no key {key!r}", str(key), "keys")
        elif form.kind == "record":
            self.refuse(node, f"{_called(base, node.value)} is {form}, which has no items",
                        f"its fields are read as {_parts(base)}", "S203")
        else:
            self._dynamic(base, node)
        return None

    def _dynamic(self, base: Group, node: Subscript) -> None:
        wanted = "a constant" if base.form.is_sequence else "a string that is written out"
        numbers = all(isinstance(i, Leaf) and i.type.kind in ("number", CELL) for i in base.items)
        help = f"write {_parts(base)}"
        if base.form.is_sequence:
            help = (f"pass an array: numpy.array({base.path})" if numbers and base.items else
                    f"loop over it, for item in {base.path}, or over range(len({base.path}))")
        self.refuse(node, f"an item of {_called(base, node.value)}, which is {base.form}, is picked by something other "
                    f"than {wanted}", help, "S203")

    def _slice(self, base: Group, node: Subscript) -> Value:
        written = (node.slice.lower, node.slice.upper, node.slice.step)
        bounds = [None if b is None else self.key(b) for b in written]
        if any(b is not None and not isinstance(k, int) for b, k in zip(written, bounds)) or bounds[2] == 0:
            self._dynamic(base, node)
            return Plain(at(const(0.0), node))
        return listed(base.items[slice(*[k if isinstance(k, int) else None for k in bounds])])

    def key(self, node: AST) -> int | str | None:
        """The constant that an index is, loops that are written out considered."""
        if isinstance(node, Constant):
            return node.value if type(node.value) in (int, str) else None
        if isinstance(node, Name):
            found = self.env.get(node.id)
            return self.key(found.node) if isinstance(found, Plain) and isinstance(found.node, Constant) else None
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            inner = self.key(node.operand)
            return -inner if isinstance(inner, int) else None
        if isinstance(node, BinOp) and type(node.op) in _ARITHMETIC:
            left, right = self.key(node.left), self.key(node.right)
            if isinstance(left, int) and isinstance(right, int) and (right or isinstance(node.op, (Add, Sub, Mult))):
                return _ARITHMETIC[type(node.op)](left, right)
        if call_name(node) == "builtins.len":
            found = self._length(node)
            return self.key(found.node) if isinstance(found, Plain) else None
        return None

    def _display(self, node: Tuple | List) -> Value | None:
        """A tuple that is spelled out is a structure if one of its items is one, or None."""
        if isinstance(node.ctx, Store):
            return None
        found = [self.structural(item) for item in node.elts]
        if not any(isinstance(f, (Group, Leaf)) and not (isinstance(f, Leaf) and usable(f)) for f in found):
            return None
        return listed(tuple(self.value(item) for item in node.elts))

    # -- decisions -----------------------------------------------------------------------------------------------------

    def decide(self, node: AST) -> bool | None:
        """What a test is that is known from what the arguments are made of; None if it is not."""
        if isinstance(node, Compare):
            return self._compared(node)
        if isinstance(node, UnaryOp) and isinstance(node.op, Not):
            inner = self.decide(node.operand)
            return None if inner is None else not inner
        if isinstance(node, BoolOp):
            return self._joined(node)
        if isinstance(node, (Name, Attribute, Subscript)):
            found = self.structural(node)
            if isinstance(found, Group):
                return bool(found.items) or found.form.kind == "record"
            return False if found is not None and nothing(found) else None
        return None

    def _joined(self, node: BoolOp) -> bool | None:
        found = [self.decide(node.values[0])]
        stop = not isinstance(node.op, And)          # what decides an `or` is a True, an `and` a False
        for value in node.values[1:]:
            if found[-1] is None or found[-1] is stop:
                break
            found.append(self.decide(value))
        return None if None in found else stop if stop in found else not stop

    def _compared(self, node: Compare) -> bool | None:
        op, left, right = node.ops[0], node.left, node.comparators[0]
        if len(node.ops) == 1 and type(op) in _ORDER:
            one, other = self.key(left), self.key(right)
            return bool(_ORDER[type(op)](one, other)) if type(one) is type(other) and one is not None else None
        if len(node.ops) > 1 or not isinstance(op, (Is, IsNot, In, NotIn)):
            return None
        if isinstance(op, (In, NotIn)):
            group, key = self.structural(right), self.key(left)
            if isinstance(group, Group) and group.form.kind in ("dict", "either") and key is not None:
                return (key in group.form.keys) is isinstance(op, In)
            self.refuse(node, f"'{'in' if isinstance(op, In) else 'not in'}' {NO}",
                        "write the comparisons out: " + ("x == a or x == b" if isinstance(op, In) else
                                                         "x != a and x != b"))
            return None
        operand = left if _is_none(right) else right
        if _is_none(operand):
            return isinstance(op, Is)
        return nothing(self.value(operand)) is isinstance(op, Is)

    def _test(self, node: AST) -> Value | None:
        """A comparison, a `not`, or an `and` or `or` some part of which is decided."""
        decided = self.decide(node)
        if decided is not None:
            return Plain(at(const(decided), node))
        if not isinstance(node, BoolOp):
            return None
        stop = not isinstance(node.op, And)
        kept: list[Value] = []
        for value in node.values:
            found = self.decide(value)
            if found is not None and found is not stop and (kept or value is not node.values[-1]):
                continue
            kept.append(self.value(value) if found is None else Plain(at(const(found), value)))
            if found is not None and found is stop:
                break
        if len(kept) == 1:
            return kept[0]
        parts = [self.plainly(v, n) for v, n in zip(kept, node.values)]
        return Plain(at(BoolOp(node.op, parts), node))

    def _choice(self, node: IfExp) -> Value | None:
        decided = self.decide(node.test)
        if decided is not None:
            return self.value(node.body if decided else node.orelse)
        arms = [self.structural(node.body), self.structural(node.orelse)]
        if any(isinstance(a, Group) or a is not None and nothing(a) for a in arms):
            if arms[0] == arms[1]:
                return arms[0]
            self.refuse(node, "a structure or None is chosen by a test that is known only when the kernel runs",
                        "write an if with the whole work in each branch")
        return None

    # -- calls ---------------------------------------------------------------------------------------------------------

    def _call(self, node: Call) -> Value | None:
        if user_call(node) is not None:
            callee, made, passed = self.call(node)
            if callee is not None and callee.result is not None and not plain_tuple(callee.result):
                self.refuse(node, f"'{user_call(node)}' returns a structure inside an expression",
                            "give the result a name of its own first")
            return Plain(made)
        called = call_name(node) or ""
        if called.startswith("record."):
            return self._constructed(node, called.partition(".")[2])
        if called == "builtins.len":
            return self._length(node)
        if called in ("builtins.tuple", "builtins.list") and len(node.args) == 1:
            found = self.structural(node.args[0])
            if isinstance(found, Group) and found.form.is_sequence:
                kind = called.partition(".")[2]
                form = replace(found.form, kind=kind, keys=tuple(range(len(found.items))), made=None, fixed=True)
                return Group(form, found.items, found.path)
        if isinstance(node.func, Attribute):
            base = self.structural(node.func.value)
            if isinstance(base, Group):
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
            given[key] = self.value(argument)
        for key, default in defaults.items():
            if key not in given and (default is None or type(default) in (int, float, bool, str)):
                given[key] = Plain(at(const(default), node))
        if not fit or any(k not in given for k in defaults):
            self.refuse(node, f"{title}({', '.join(defaults)}) is made with other arguments", code="S405")
            return Plain(at(const(0.0), node))
        return _group(Structure(kind, tuple(defaults), (), made, is_fixed(kind, made)),
                      [given[k] for k in defaults])

    def _dict(self, node: Dict) -> Value:
        """A dict whose keys are written out."""
        keys = tuple(k.value for k in node.keys)
        if len(set(keys)) < len(keys):
            self.refuse(node, "a dict that has one key twice", "leave one of them out")
        return _group(Structure("dict", tuple(dict.fromkeys(keys)), (), dict), [self.value(v) for v in node.values])

    def _length(self, node: Call) -> Value | None:
        found = self.structural(node.args[0]) if len(node.args) == 1 else None
        return Plain(at(const(len(found.items)), node)) if isinstance(found, Group) else None

    def _method(self, base: Group, node: Call) -> Value:
        """`p.get("k", 1.0)`, `p.items()`, `p.keys()`, `p.values()` of a dict."""
        method, count, kind = node.func.attr, len(node.args), base.form.kind
        new = {str(k.arg): self.value(k.value) for k in node.keywords} if method == "_replace" else {}
        if kind == "named" and new and not count and new.keys() <= set(base.form.keys):
            items = tuple(new.get(str(k), i) for k, i in zip(base.form.keys, base.items))
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
        self.refuse(node, f"the method '{method}' of {_called(base, node.func.value)}, which is {base.form}, {NO}",
                    f"write what it does with {_parts(base)}" if base.items else "")
        return Plain(at(const(0.0), node))

    def call(self, node: Call) -> tuple[Callee | None, Call, dict[int, Leaf]]:
        """The kernel for these arguments, the call of it on flat arguments, and the leaf given at each place."""
        called = user_call(node) or ""
        kernel = self.program.kernels[called]
        before = len(self.report.found)
        bound_arguments(node, self)  # pyright: ignore[reportArgumentType]  (says what does not fit)
        if len(self.report.found) > before:
            return None, node, {}
        given = [*zip(kernel.parameters, node.args), *((k.arg or "", k.value) for k in node.keywords)]
        values = {p: self.whole(a) for p, a in given}
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
        self._cells(node, callee, passed)
        return callee, at(Call(at(name(f"user.{callee.title}"), node), positional, keywords), node), passed

    def _pattern(self, value: Value | None, default: Any) -> Form:
        if value is None:
            return NOTHING.type if default is None else UNKNOWN
        found = pattern(value)
        return found if isinstance(found, Structure) or found.kind in ("none", "other") else UNKNOWN

    def _flat(self, value: Value, wanted: Form, origin: AST) -> list[AST]:
        """The flat arguments for one parameter."""
        if not isinstance(wanted, Structure):
            return [] if wanted.kind in ("none", "other") else [self.plainly(value, origin)]
        return [v.node if isinstance(v, Plain) else at(name(v.name), origin) for v in flat(value)]

    def _passed(self, kernel: Kernel, callee: Callee, values: dict[str, Value]) -> dict[int, Leaf]:
        """The leaves that stand at the places of the callee's flat parameters."""
        found, at_ = {}, 0
        for parameter in kernel.parameters:
            value = values.get(parameter)
            for k, leaf in enumerate(flat(value) if isinstance(value, Group) else ()):
                if isinstance(leaf, Leaf):
                    found[at_ + k] = leaf
            at_ += len(callee.flat[parameter])
        return found

    def _cells(self, node: Call, callee: Callee, passed: dict[int, Leaf]) -> None:
        """What the callee assigns must be cells here, too."""
        for place in sorted(callee.needed):
            leaf = passed.get(place)
            if leaf is not None and leaf.place >= 0:
                self.needed.add(leaf.place)
            else:
                what = f"'{leaf.path}'" if leaf is not None else "an item"
                self.refuse(node, f"'{user_call(node)}' assigns {what}, which was made in this kernel",
                            "return the new value, and assign it here")


def _group(form: Structure, items: list[Value]) -> Group:
    """A structure that a kernel makes."""
    return Group(replace(form, items=tuple(map(pattern, items))), tuple(items), SPELLED)


def plain_tuple(result: Group) -> bool:
    """Whether a result is a tuple of values as any function may return one."""
    return result.path == SPELLED and result.form.kind == "tuple" and all(
        isinstance(i, Leaf) and usable(i) and i.place < 0 for i in result.items)


def _called(group: Group, node: AST) -> str:
    return f"'{group.path}'" if group.path != SPELLED else str(group.form).replace("a ", "the ", 1)


def _parts(group: Group) -> str:
    """The first items of a structure as one writes them."""
    shown = [i.path for i in group.items if isinstance(i, (Leaf, Group)) and i.path]
    return ", ".join(shown[:4]) + (", ..." if len(shown) > 4 else "")


def _is_none(node: AST) -> bool:
    return isinstance(node, Constant) and node.value is None


_SEEN: dict[type, Callable[[Values, Any], Value | None]] = {
    Name: Values._name, Attribute: Values._field, Subscript: Values._item, Call: Values._call, Compare: Values._test,
    BoolOp: Values._test, UnaryOp: lambda v, n: v._test(n) if isinstance(n.op, Not) else None, IfExp: Values._choice,
    Tuple: Values._display, List: Values._display, Dict: Values._dict,
}
