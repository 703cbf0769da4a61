"""parts: of a function of matrices that gives a tuple, each part that is taken is a function of its own.

Requires structured form. A part that has no rule is left as it is, to be refused.

    np.linalg.slogdet(a)[1]         runtime.log_det(a)
    np.linalg.svd(a, compute_uv=False)  runtime.singular_values(a)
    items = np.linalg.eigh(a)       values = np.linalg.eigvalsh(a)
    w = items[0]                    vectors = runtime.eigenvectors(a)
    v = items[1]                    w = values
                                    v = vectors
"""
from __future__ import annotations

from s2sad.naming import Names
from s2sad.tree import (
    AST, Assign, Attribute, Call, Constant, FunctionDef, Name, Store, Subscript, assign, at, call, call_name, copy,
    name, rebuild, walk,
)

# the functions of the parts, with the names that NumPy gives the parts
_PARTS: dict[str, dict[str, str]] = {
    "numpy.linalg.slogdet": {"sign": "runtime.det_sign", "logabsdet": "runtime.log_det"},
    "numpy.linalg.eigh": {"eigenvalues": "numpy.linalg.eigvalsh", "eigenvectors": "runtime.eigenvectors"},
    "numpy.linalg.svd": {"U": "", "S": "runtime.singular_values", "Vh": ""},
    "numpy.linalg.lstsq": {"solution": "runtime.least_squares"},
}
_OPERANDS = {"numpy.linalg.lstsq": 2}
_NONE = {"numpy.linalg.lstsq": "rcond"}


def parts(function: FunctionDef, free: Names) -> FunctionDef:
    """The function with those parts."""
    new = copy(function)
    new.body = _Parts(function, free).block(function.body)
    return new


def parted(node: AST) -> dict[str, str]:
    """The functions of the parts of a call, {} if it is none that gives a tuple or its options are not the default."""
    called = call_name(node) or ""
    if called not in _PARTS:
        return {}
    left = [k for k in node.keywords if k.arg != _NONE.get(called) or not _is_none(k.value)]
    extra = node.args[_OPERANDS.get(called, 1):]
    plain = not left and all(called in _NONE and _is_none(a) for a in extra) and len(extra) <= 1
    return _PARTS[called] if plain and len(node.args) >= _OPERANDS.get(called, 1) else {}


def _is_none(node: AST) -> bool:
    return isinstance(node, Constant) and node.value is None


class _Parts:
    def __init__(self, function: FunctionDef, free: Names):
        self.free = free
        self.held, self.unread = _held(function)
        self.names = {n: {part: free.fresh(part) for part in found} for n, found in self.held.items()}

    def block(self, block: list[AST]) -> list[AST]:
        return [made for statement in block for made in self.statement(statement)]

    def statement(self, statement: AST) -> list[AST]:
        if id(statement) in self.unread:
            return []
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and target.id in self.held:
            value = self.changed(statement.value)
            return [at(assign(self.names[target.id][part], _call(value, made)), statement)
                    for part, made in self.held[target.id].items()]
        if hasattr(statement, "body"):
            new = copy(statement)
            for field in statement._fields:
                inner = getattr(statement, field)
                if field in ("body", "orelse"):
                    setattr(new, field, self.block(inner))
                elif isinstance(inner, AST):
                    setattr(new, field, self.changed(inner))
            return [new]
        return [self.changed(statement)]

    def changed(self, node: AST) -> AST:
        return rebuild(node, self.part)

    def part(self, node: AST) -> AST | None:
        if _values_alone(node):
            return at(call("runtime.singular_values", self.changed(node.args[0])), node)
        asked = _asked(node)
        if asked is None:
            return None
        value, key = asked
        if isinstance(value, Name) and value.id in self.held:
            return at(name(self.names[value.id][_named(self.held[value.id], key)]), node)
        found = parted(value)
        part = _named(found, key)
        return at(_call(self.changed(value), found[part]), node) if part else None


def _values_alone(node: AST) -> bool:
    """Whether a call is `np.linalg.svd(a, compute_uv=False)`."""
    return call_name(node) == "numpy.linalg.svd" and len(node.args) == 1 and [k.arg for k in node.keywords] == [
        "compute_uv"] and isinstance(node.keywords[0].value, Constant) and node.keywords[0].value.value is False


def _call(value: AST, function: str) -> Call:
    operands = value.args[:_OPERANDS.get(call_name(value) or "", 1)]
    return at(call(function, *map(copy, operands)), value)


def _asked(node: AST) -> tuple[AST, int | str] | None:
    """What a part is taken of, and its number or name."""
    if isinstance(node, Subscript) and isinstance(node.slice, Constant) and type(node.slice.value) is int:
        return node.value, node.slice.value
    return (node.value, node.attr) if isinstance(node, Attribute) else None


def _named(found: dict[str, str], key: int | str) -> str:
    """The name of a part, "" if there is none that has a function."""
    if not isinstance(key, str):
        key = list(found)[key] if 0 <= key < len(found) else ""
    return key if found.get(key) else ""


def _held(function: FunctionDef) -> tuple[dict[str, dict[str, str]], set[int]]:
    """The names bound once, to such a call, of which only parts with a function are read, with those parts; and the
    statements that bind parts that are never read."""
    nodes = list(walk(function.body))
    bound = {s.targets[0].id: parted(s.value) for s in nodes
             if isinstance(s, Assign) and isinstance(s.targets[0], Name) and parted(s.value)}
    stores = [n.id for n in nodes if isinstance(n, Name) and isinstance(n.ctx, Store)]
    loads = [n.id for n in nodes if isinstance(n, Name) and not isinstance(n.ctx, Store)]
    unread = {id(s.value): id(s) for s in nodes if isinstance(s, Assign) and isinstance(s.targets[0], Name)
              and s.targets[0].id not in loads}
    asked = [(id(n), *a) for n in nodes if (a := _asked(n)) and isinstance(a[0], Name)]
    made, dropped = {}, set()
    for held, found in bound.items():
        uses = [(node, key) for node, value, key in asked if value.id == held]
        left = {unread[node] for node, _ in uses if node in unread}
        taken = {_named(found, key) for node, key in uses if node not in unread}
        if stores.count(held) == 1 and "" not in taken and loads.count(held) == len(uses):
            made[held] = {part: f for part, f in found.items() if part in taken}
            dropped |= left
    return made, dropped
