"""The tree: Python syntax as gast nodes, and the few functions that build and walk it.

This is the one module that touches gast. A name that was resolved to something outside the kernel has a
dotted id, which no user's name can have:

    numpy.exp, math.sqrt, builtins.range    a library's function or constant
    user.limit                              another kernel of the same program
    const.G                                 a constant of the kernel's module or closure
    runtime.grow                            a function of s2sad.runtime

Emission prints them as `np.exp`, `limit`, `G`, `grow`.
"""
from __future__ import annotations

import ast as _ast
import math
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import gast
from gast import (
    AST, Add, And, AnnAssign, Assert, Assign, Attribute, AugAssign, BinOp, BitAnd, BitOr, BitXor, BoolOp, Break,
    Call, Compare, Constant, Continue, Dict, DictComp, Div, Eq, Expr, FloorDiv, For, FunctionDef, GeneratorExp, Gt, GtE,
    If, IfExp, In, Invert, Is, IsNot, List, ListComp, Load, LShift, Lt, LtE, MatMult, Mod, Module, Mult, Name, Not,
    NotEq, NotIn, Or, Pass, Pow, Raise, Return, RShift, Slice, Starred, Store, Sub, Subscript, Tuple, UAdd, UnaryOp,
    USub, While, Yield, arguments, expr, keyword, stmt,
)

__all__ = [
    "AST", "Add", "And", "AnnAssign", "Assert", "Assign", "Attribute", "AugAssign", "BinOp", "BitAnd", "BitOr",
    "BitXor", "BoolOp", "Break", "Call", "Compare", "Constant", "Continue", "Dict", "DictComp", "Div", "Eq", "Expr",
    "FloorDiv", "For", "FunctionDef", "GeneratorExp", "Gt", "GtE", "If", "IfExp", "In", "Invert", "Is", "IsNot",
    "List", "ListComp", "Load", "LShift", "Lt", "LtE", "MatMult", "Mod", "Module", "Mult", "Name", "Not", "NotEq",
    "NotIn", "Or", "Pass", "Pow", "Raise", "Return", "RShift", "Slice", "Starred", "Store", "Sub", "Subscript",
    "Tuple", "UAdd", "UnaryOp", "USub", "While", "Yield", "arguments", "keyword", "add", "assign", "at",
    "attribute", "augment", "binary", "call", "call_name", "calls_kernel", "children", "comment", "compare",
    "const", "copy", "counted_for", "dump", "equal", "expr", "expression", "forget", "forgotten", "function",
    "head_copy", "index", "indices", "is_comment", "is_known", "is_unset", "known", "literal", "mult", "name",
    "names", "negate", "parse", "placed", "rebuild", "rename", "replica", "statements", "stmt", "stored_names",
    "sub", "substitute", "tuple_of", "unset", "user_call", "walk", "with_body", "written",
]

_LOAD, _STORE = Load(), Store()


SAID = "said"       # the kind of a text that is the kernel's own message
GUARD = "guard"     # that of one that generated code asserts before single targets


def parse(text: str) -> Module:
    """The tree of a module's text; raises SyntaxError as Python does."""
    return gast.ast_to_gast(_ast.parse(text))


def statements(text: str) -> list[AST]:
    """The statements of a piece of text, which have no place."""
    found = parse(text).body
    for node in walk(found):
        if "lineno" in getattr(node, "_attributes", ()):
            setattr(node, "lineno", None)  # noqa: B010
    return found


def expression(text: str) -> AST:
    """The tree of one expression."""
    return parse(text).body[0].value


# -- building -------------------------------------------------------------------------------------------------------

def name(identifier: str) -> Name:
    return Name(identifier, _LOAD, None, None)


def const(value: Any) -> AST:
    """A constant; a negative number is spelled as Python parses it, a minus before a constant."""
    if isinstance(value, (int, float)) and not isinstance(value, bool) and (value < 0 or str(value) == "-0.0"):
        return UnaryOp(USub(), Constant(-value, None))
    return Constant(value, None)


def comment(text: str) -> Expr:
    """A comment line, as a statement that does nothing."""
    return Expr(Constant(text, "comment"))


def forget(arrays: list[str]) -> Expr:
    """A mark that the arrays' content is not read from here on before it is written anew."""
    return Expr(Constant(" ".join(arrays), "forget"))


def forgotten(node: AST) -> list[str]:
    """The arrays of such a mark; none for any other statement."""
    marked = isinstance(node, Expr) and isinstance(node.value, Constant) and node.value.kind == "forget"
    return node.value.value.split() if marked else []


def known(test: AST) -> Assert:
    """A mark that something holds from here on, which is not asked."""
    return Assert(test, Constant("known", "known"))


def is_known(node: AST) -> bool:
    """Whether a statement is such a mark."""
    return isinstance(node, Assert) and isinstance(node.msg, Constant) and node.msg.kind == "known"


def unset(value: float) -> Constant:
    """A number that a name holds where it is certainly bound anew before it is read, whatever it is then bound to."""
    return Constant(value, "unset")


def is_unset(node: AST) -> bool:
    return isinstance(node, Constant) and node.kind == "unset"


def is_comment(node: AST) -> bool:
    """Whether a statement is a comment line."""
    return isinstance(node, Expr) and isinstance(node.value, Constant) and node.value.kind == "comment"


def attribute(value: AST, attr: str) -> Attribute:
    return Attribute(value, attr, _LOAD)


def call(function_name: str, *args: AST, **keywords: AST) -> Call:
    return Call(name(function_name), list(args), [keyword(k, v) for k, v in keywords.items()])


def index(base: AST, *subscripts: AST) -> Subscript:
    return Subscript(base, subscripts[0] if len(subscripts) == 1 else Tuple(list(subscripts), _LOAD), _LOAD)


def tuple_of(*items: AST) -> Tuple:
    return Tuple(list(items), _LOAD)


def binary(left: AST, op: AST, right: AST) -> BinOp:
    return BinOp(left, op, right)


def add(left: AST, right: AST) -> BinOp:
    return BinOp(left, Add(), right)


def sub(left: AST, right: AST) -> BinOp:
    return BinOp(left, Sub(), right)


def mult(left: AST, right: AST) -> BinOp:
    return BinOp(left, Mult(), right)


def literal(value: Any) -> AST | None:
    """A number, a string, None or a tuple of these as an expression; None if it has no spelling."""
    value = value.item() if hasattr(value, "dtype") and not value.shape else value
    if isinstance(value, float) and not math.isfinite(value):
        spelled = name("numpy.nan" if math.isnan(value) else "numpy.inf")
        return negate(spelled) if value < 0 else spelled
    if value is None or isinstance(value, (bool, int, float, str)):
        return const(value)
    if isinstance(value, tuple):
        items = [literal(item) for item in value]
        known = [item for item in items if item is not None]
        return tuple_of(*known) if len(known) == len(items) else None
    return None


def negate(operand: AST) -> UnaryOp:
    return UnaryOp(USub(), operand)


def compare(left: AST, op: AST, right: AST) -> Compare:
    return Compare(left, [op], [right])


def _target(node: AST) -> AST:
    if isinstance(node, Name):
        return Name(node.id, _STORE, None, None)
    if isinstance(node, Subscript):
        return Subscript(node.value, node.slice, _STORE)
    if isinstance(node, (Tuple, List)):
        return type(node)([_target(item) for item in node.elts], _STORE)
    return node


def assign(target: AST | str, value: AST) -> Assign:
    return Assign([_target(name(target) if isinstance(target, str) else target)], value, None)


def augment(target: AST | str, op: AST, value: AST) -> AugAssign:
    return AugAssign(_target(name(target) if isinstance(target, str) else target), op, value)


def counted_for(variable: str, bounds: list[AST], body: list[AST]) -> For:
    """`for variable in range(*bounds)`."""
    return For(_target(name(variable)), call("builtins.range", *bounds), body, [], None)


def function(identifier: str, parameters: list[str], body: list[AST]) -> FunctionDef:
    args = [Name(p, gast.Param(), None, None) for p in parameters]
    return FunctionDef(identifier, arguments(args, [], None, [], [], None, []), body, [], None, None, [])


_PLACE = ("lineno", "col_offset", "end_lineno", "end_col_offset")
_BLOCKS = ("body", "orelse")


def at(node: AST, origin: AST) -> AST:
    """The node, with the place of the statement that it comes from (on itself and on what has none); statements in a
    block that have a place keep theirs, and what is in them."""
    place = {key: value for key in _PLACE if (value := origin.__dict__.get(key)) is not None}
    stack = [node] if place else []
    pop, push = stack.pop, stack.append
    while stack:
        current = pop()
        kind, held = type(current), current.__dict__
        if held.get("lineno") is None and kind in _placed_kinds:
            held.update(place)
        for field in _below[kind]:
            value = held.get(field)
            if type(value) is list:
                blocks = field in _BLOCKS
                stack += [n for n in value if type(n) in _below and not (
                    blocks and n.__dict__.get("lineno") is not None)]
            elif isinstance(value, AST) and type(value) in _below:
                push(value)
    return node


def placed(node: AST, origin: AST) -> AST:
    """The node, with the place of another; what is below it has its own."""
    node.__dict__.update({key: value for key in _PLACE if (value := origin.__dict__.get(key)) is not None})
    return node


# -- reading --------------------------------------------------------------------------------------------------------

_BARE = {"ctx", "op", "ops", "id", "attr", "name", "arg", "kind", "type_comment"}

# the fields of each kind of node that can hold nodes: not its context (Load, Store), operators, texts and numbers
_below: dict[type, tuple[str, ...]] = {
    kind: () if kind in (Name, Constant) else tuple(f for f in kind._fields if f not in _BARE)
    for kind in vars(gast).values() if isinstance(kind, type) and issubclass(kind, AST)}
_placed_kinds = {kind for kind in _below if "lineno" in kind._attributes}
_backwards = {kind: fields[::-1] for kind, fields in _below.items()}     # as a stack takes them


def walk(node: AST | list[AST]) -> Iterator[AST]:
    """Every node below, the given one first, in the order of the text; operators belong to their expressions."""
    # most of the compiler's time goes by here, hence neither a call for each node nor a list of its children
    stack = node[::-1] if isinstance(node, list) else [node]
    pop, push, fields_of = stack.pop, stack.append, _backwards.get
    while stack:
        current = pop()
        fields = fields_of(type(current))
        if fields:
            yield current
            held = current.__dict__
            for field in fields:
                value = held.get(field)
                if value is None:
                    continue
                if type(value) is list:
                    if value:
                        stack += value[::-1]
                else:
                    push(value)
        elif fields is not None:
            yield current
        else:       # a name of `global x`, the key that `{**options}` has not
            assert not isinstance(current, AST), type(current)


# of those, the fields that hold statements
_blocks_backwards = {
    kind: tuple(f for f in fields if f in ("body", "handlers", "orelse", "finalbody", "cases"))
    for kind, fields in _backwards.items()
    if issubclass(kind, stmt) or kind.__name__ in ("ExceptHandler", "match_case")}


def walk_statements(node: AST | list[AST]) -> Iterator[AST]:
    """The statements that `walk` yields, in its order; an expression that is given is yielded alone."""
    stack = node[::-1] if isinstance(node, list) else [node]
    pop, blocks_of = stack.pop, _blocks_backwards.get
    while stack:
        current = pop()
        yield current
        for field in blocks_of(type(current), ()):
            stack += getattr(current, field)[::-1]


def children(node: AST) -> list[AST]:
    """The nodes directly below, in the order of the text, without contexts (Load, Store)."""
    found: list[AST] = []
    held = node.__dict__
    for field in _below[type(node)]:
        value = held.get(field)
        if type(value) is list:
            found += [item for item in value if type(item) in _below]
        elif isinstance(value, AST) and type(value) in _below:
            found.append(value)
    return found


def written(node: AST) -> str:
    """An expression's text as Python itself would write it, for messages."""
    return _ast.unparse(gast.gast_to_ast(copy(node)))


def names(node: AST | list[AST]) -> list[str]:
    """The undotted names that are read, in order, each once."""
    return list({n.id: None for n in walk(node) if type(n) is Name and type(n.ctx) is not Store and "." not in n.id})


def stored_names(node: AST | list[AST]) -> list[str]:
    """The names that are bound, in order, each once (element stores do not bind)."""
    return list({n.id: None for n in walk(node) if type(n) is Name and type(n.ctx) is Store})


def times_bound(node: AST | list[AST], *kinds: type[AST]) -> Counter[str]:
    """How often each name is bound; if kinds of statements are given, by these only (`x += y` binds no array anew)."""
    places = [t for s in walk(node) if isinstance(s, kinds) for t in (
        s.targets if isinstance(s, Assign) else [s.target])] if kinds else node
    return Counter(n.name if isinstance(n, FunctionDef) else n.id for n in walk(places)
                   if isinstance(n, FunctionDef) or isinstance(n, Name) and isinstance(n.ctx, Store))


def call_name(node: AST | None) -> str | None:
    """The resolved name of the function that a call calls, or None if the node is no such call."""
    return node.func.id if type(node) is Call and type(node.func) is Name else None


def user_call(node: AST | None) -> str | None:
    """The kernel that a call calls, or None if the node is no call of one."""
    called = call_name(node)
    return called[len("user."):] if called is not None and called.startswith("user.") else None


def calls_kernel(node: AST) -> bool:
    """Whether a kernel is called somewhere in a node, which may write its arguments or raise."""
    return any(user_call(n) is not None for n in walk(node))


def indices(node: Subscript) -> list[AST]:
    """The subscripts of `x[i, j]` as a list."""
    return list(node.slice.elts) if isinstance(node.slice, Tuple) else [node.slice]


_UNSAID = ("ctx", "type_comment", "annotation", "kind")


def dump(node: Any) -> str:
    """A text that is the same for equal trees, and only for them; places and contexts do not count."""
    kind = type(node)
    if kind is Name:
        return f"Name({node.id!r})"
    if kind is list:
        return "[" + ", ".join([dump(item) for item in node]) + "]"
    if kind is Constant:
        return f"{type(node.value).__name__} {node.value!r}"
    if not isinstance(node, AST):
        return repr(node)
    return f"{kind.__name__}({', '.join([dump(getattr(node, f)) for f in kind._fields if f not in _UNSAID])})"


def equal(a: AST, b: AST) -> bool:
    return type(a) is type(b) and dump(a) == dump(b)


# -- changing -------------------------------------------------------------------------------------------------------

Change = Callable[[AST], "AST | None"]
_Made = dict[int, tuple[Any, Change, Any]]      # by `id`: a node, the change, and what it is with that change


class _Nested(threading.local):
    """What the change that runs now has itself rebuilt; None outside."""
    made: _Made | None = None


_nested = _Nested()
_new = AST.__new__


def _rebuild(node: Any, change: Change, known: _Made | None, made: _Made) -> Any:
    if known and (found := known.get(id(node))) is not None and found[1] == change:
        return found[2]
    kind = type(node)
    if kind is list:
        return [_rebuild(item, change, known, made) for item in node]
    fields = _below.get(kind)
    if fields is None:
        return node
    changed = change(node)
    if made:
        own = made.copy()
        made.clear()
        known = {**known, **own} if known else own
    if changed is not None:
        return changed
    new, held = _new(kind), node.__dict__.copy()
    for field in fields:
        value = held.get(field)
        if value is not None:
            held[field] = _rebuild(value, change, known, made)
    new.__dict__ = held
    return new


def replica(node: AST, below: Callable[[Any, str], Any]) -> AST:
    """A node of the same kind and place, which has `below(value, field)` in its fields; contexts and operators are
    shared."""
    kind = type(node)
    new, held = AST.__new__(kind), node.__dict__.copy()
    for field in _below[kind]:
        value = held.get(field)
        if value is not None:
            held[field] = below(value, field)
    new.__dict__ = held
    return new


def copy(node: Any) -> Any:
    """A deep copy, places included."""
    kind = type(node)
    if kind is list:
        return [copy(item) for item in node]
    fields = _below.get(kind)
    if fields is None:
        return node
    new, held = _new(kind), node.__dict__.copy()
    for field in fields:
        value = held.get(field)
        if value is not None:
            held[field] = copy(value)
    new.__dict__ = held
    return new


def head_copy(statement: AST) -> AST:
    """A copy of a statement whose blocks are the given one's, for who is to replace them."""
    return replica(statement, lambda value, field: value if field in _BLOCKS else copy(value))


def with_body(function: FunctionDef, body: list[AST]) -> FunctionDef:
    """A copy of a function with other statements in place of its own, which are not copied."""
    return replica(function, lambda value, field: body if field == "body" else copy(value))


def substitute(node: Any, mapping: Mapping[str, AST]) -> Any:
    """A copy in which names that are read are replaced by expressions."""
    kind = type(node)
    if kind is list:
        return [substitute(item, mapping) for item in node]
    if kind is Name and node.id in mapping and type(node.ctx) is not Store:
        return copy(mapping[node.id])
    return replica(node, lambda value, _: substitute(value, mapping)) if kind in _below else node


def rename(node: Any, mapping: Mapping[str, str]) -> Any:
    """A copy in which names have other identifiers, where read and where bound."""
    kind = type(node)
    if kind is list:
        return [rename(item, mapping) for item in node]
    fields = _below.get(kind)
    if fields is None:
        return node
    new, held = _new(kind), node.__dict__.copy()
    if kind is Name and node.id in mapping:
        held |= {"id": mapping[node.id], "annotation": None, "type_comment": None}
    for field in fields:
        value = held.get(field)
        if value is not None:
            held[field] = rename(value, mapping)
    new.__dict__ = held
    return new


def rebuild(node: Any, change: Change) -> Any:
    """A copy in which every node for which `change` gives another is replaced by that, outermost first.

    What `change` has itself rebuilt below a node that it then leaves is not rebuilt once more: the time would double
    with each such node in another.
    """
    around, _nested.made = _nested.made, {}
    try:
        made = _rebuild(node, change, None, _nested.made)
    finally:
        _nested.made = around
    if around is not None:
        around[id(node)] = node, change, made
    return made
