"""tuple_results: of a function of matrices that returns a tuple, each item that is used is a function of its own.

    def f(a: "float64[:, :]"):          def f(a):
        q, r = np.linalg.qr(a)              Q = orthogonal_part(a)
        return np.sum(q) + r[0, 0]          R = triangular_part(a)
                                            q = Q
                                            r = R
                                            return np.sum(q) + r[0, 0]

Requires structured form. Establishes that functions with a rule return one value; an item without a rule is left, to be
refused. The option `part`, which NumPy does not have, is the number of an item, for the expansions of these functions.
"""
from __future__ import annotations

from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.signatures.options import is_none
from s2sad.naming import Names
from s2sad.passes import Context
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Call, FunctionDef, Name, NotEq, Store, Subscript, assign, at, call, call_name,
    compare, const, copy, head_copy, keyword, name, rebuild, tuple_of, walk, with_body,
)

# the functions of the items, by the names that NumPy gives the items
_ITEMS: dict[str, dict[str, str]] = {
    "numpy.linalg.slogdet": {"sign": "runtime.det_sign", "logabsdet": "runtime.log_det"},
    "numpy.linalg.eigh": {"eigenvalues": "numpy.linalg.eigvalsh", "eigenvectors": "runtime.eigenvectors"},
    "numpy.linalg.svd": {"U": "numpy.linalg.svd.left", "S": "runtime.singular_values", "Vh": "numpy.linalg.svd.right"},
    "numpy.linalg.qr": {"Q": "runtime.orthogonal_part", "R": "runtime.triangular_part"},
    "numpy.linalg.lstsq": {"solution": "runtime.least_squares"},
}
# functions of which each item is the function with the option `part`
_NUMBERED = frozenset({f"numpy.{f}" for f in (
    "nonzero where meshgrid indices unravel_index split array_split hsplit vsplit gradient triu_indices tril_indices "
    "diag_indices histogram unique").split()})
_INDEX_PAIRS = frozenset({"numpy.triu_indices", "numpy.tril_indices", "numpy.diag_indices"})
_MAX_ITEMS = 16
_MASK = "mask"  # all items as one subscript
_OPERAND_COUNT = {"numpy.linalg.lstsq": 2}
_REDUCED = {"U": "runtime.left_vectors", "S": "runtime.singular_values", "Vh": "runtime.right_vectors"}
_COMPLETE = {"Q": "numpy.linalg.qr.orthogonal", "R": "numpy.linalg.qr.triangular"}
_IGNORED_IF_NONE = {"numpy.linalg.lstsq": "rcond"}


def tuple_results(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with functions of items in place of tuples."""
    free = context.names
    new = with_body(function, [rebuild(statement, _as_function) for statement in function.body])
    new.body = _TupleResults(new, free).block(new.body)
    return new


def _as_function(node: AST) -> AST | None:
    """`x.nonzero()` as a function."""
    method = isinstance(node, Call) and isinstance(node.func, Attribute) and node.func.attr == "nonzero"
    return at(call("numpy.nonzero", rebuild(node.func.value, _as_function)), node) if method else None


def item_functions(node: AST) -> dict[str, str]:
    """The functions of the items of a call's result, {} if that is no tuple or an option is unknown here."""
    called = call_name(node) or ""
    if called in _NUMBERED and (called != "numpy.where" or len(node.args) == 1 and not node.keywords):
        word = called.rpartition(".")[2]
        masked = {_MASK: "mask"} if _is_nonzero(node) or called in _INDEX_PAIRS else {}
        return {f"{word}_{k}": called for k in range(_item_count(node))} | masked
    if called not in _ITEMS:
        return {}
    written = _option(node)
    if called == "numpy.linalg.svd" and written in (("full_matrices", False), ("full_matrices", True)):
        return _ITEMS[called] if written[1] else _REDUCED
    if called == "numpy.linalg.qr" and written in (("mode", "reduced"), ("mode", "complete")):
        return _ITEMS[called] if written[1] == "reduced" else _COMPLETE
    if called == "numpy.linalg.eigh" and written is not None and written[0] == "UPLO" and written[1] in ("L", "l"):
        return _ITEMS[called]       # the triangle that is read
    left = [k for k in node.keywords if k.arg != _IGNORED_IF_NONE.get(called) or not is_none(k.value)]
    extra = node.args[_OPERAND_COUNT.get(called, 1):]
    plain = not left and all(called in _IGNORED_IF_NONE and is_none(a) for a in extra) and len(extra) <= 1
    return _ITEMS[called] if plain and len(node.args) >= _OPERAND_COUNT.get(called, 1) else {}


def _item_count(node: AST) -> int:
    """How many items a result has, `_MAX_ITEMS` if that is not known; 0 for the values of `np.unique` alone, or with
    flags that are no constants, which have no type."""
    if call_name(node) == "numpy.unique":
        items = sum(str(k.arg).startswith("return_") and getattr(k.value, "value", None) is True for k in node.keywords)
        return items + 1 if items else 0
    return 2 if call_name(node) == "numpy.histogram" else _MAX_ITEMS


def _option(node: AST) -> tuple[str, object] | None:
    """The one option of a decomposition, and its constant value."""
    if not isinstance(node, Call) or len(node.args) + len(node.keywords) != 2 or not node.args:
        return None
    if node.keywords:
        return str(node.keywords[0].arg), getattr(node.keywords[0].value, "value", None)
    first = {"numpy.linalg.svd": "full_matrices", "numpy.linalg.eigh": "UPLO"}.get(call_name(node) or "", "mode")
    return first, getattr(node.args[1], "value", None)


def _is_nonzero(node: AST) -> bool:
    """Whether the items of a result are the indices at which an array is not 0."""
    return call_name(node) in ("numpy.nonzero", "numpy.where")


class _TupleResults:
    def __init__(self, function: FunctionDef, free: Names):
        self.free = free
        self.held, self.unread, self.calls = _followed(function)
        self.names = {n: {part: free.fresh(part) for part in found} for n, found in self.held.items()}

    def block(self, block: list[AST]) -> list[AST]:
        return [made for statement in block for made in self.statement(statement)]

    def statement(self, statement: AST) -> list[AST]:
        if id(statement) in self.unread:
            return []
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and target.id in self.held:
            value = self.rewritten(statement.value)
            return [at(assign(self.names[target.id][part], _item_call(value, part, made)), statement)
                    for part, made in self.held[target.id].items()]
        if hasattr(statement, "body"):
            new = head_copy(statement)
            for field in statement._fields:
                inner = getattr(statement, field)
                if field in ("body", "orelse"):
                    setattr(new, field, self.block(inner))
                elif isinstance(inner, AST):
                    setattr(new, field, self.rewritten(inner))
            return [new]
        return [self.rewritten(statement)]

    def rewritten(self, node: AST) -> AST:
        return rebuild(node, self.part)

    def part(self, node: AST) -> AST | None:
        if _only_singular_values(node):
            return at(call("runtime.singular_values", self.rewritten(node.args[0])), node)
        if _only_triangle(node):
            return at(call("runtime.triangular_part", self.rewritten(node.args[0])), node)
        items = _item_of(node)
        if items is None:
            return None
        value, key = items
        if isinstance(value, Name) and value.id in self.held:
            held, called = self.names[value.id], self.calls[value.id]
            known = item_functions(called)
            pair = _gives_index_pair(called, key)
            found: AST = tuple_of(*(name(held[p]) for p in list(known)[:2])) if pair else name(
                held[_item_name(known, key)])
        else:
            known = item_functions(value)
            part = _item_name(known, key)
            if not part:
                return None
            called = self.rewritten(value)
            pair = _gives_index_pair(value, key)
            found = tuple_of(*(_item_call(called, p, known[p]) for p in list(known)[:2])) if pair else _item_call(
                called, part, known[part])
        return at(Subscript(self.rewritten(node.value), found, node.ctx) if key == _MASK else found, node)


def _gives_index_pair(node: AST, key: int | str) -> bool:
    """Whether a result is two arrays of indices, used as the subscript."""
    return key == _MASK and call_name(node) in _INDEX_PAIRS


def _only_singular_values(node: AST) -> bool:
    """Whether a call is `np.linalg.svd(a, compute_uv=False)`."""
    if call_name(node) != "numpy.linalg.svd" or len(node.args) != 1:
        return False
    return [(k.arg, getattr(k.value, "value", None)) for k in node.keywords] == [("compute_uv", False)]


def _only_triangle(node: AST) -> bool:
    """Whether a call is `np.linalg.qr(a, mode="r")`."""
    return call_name(node) == "numpy.linalg.qr" and _option(node) == ("mode", "r")


def _item_call(value: AST, part: str, function: str) -> AST:
    if part == _MASK:
        return at(compare(copy(value.args[0]), NotEq(), const(0)), value)
    if function in _NUMBERED:
        number = keyword("part", const(int(part.rpartition("_")[2])))
        function = "numpy.nonzero" if function == "numpy.where" else function
        return at(Call(name(function), list(map(copy, value.args)), [*map(copy, value.keywords), number]), value)
    operands = value.args[:_OPERAND_COUNT.get(call_name(value) or "", 1)]
    return at(call(function, *map(copy, operands)), value)


def _item_of(node: AST) -> tuple[AST, int | str] | None:
    """The expression of which an item is used, and the item's number or name."""
    if isinstance(node, Subscript) and (number := whole_number(node.slice)) is not None:
        return node.value, number
    if isinstance(node, Subscript) and (
            isinstance(node.slice, Name) or _is_nonzero(node.slice) or call_name(node.slice) in _INDEX_PAIRS):
        return node.slice, _MASK
    return (node.value, node.attr) if isinstance(node, Attribute) else None


def _item_name(found: dict[str, str], key: int | str) -> str:
    """The name of an item, "" if there is none that has a function."""
    if not isinstance(key, str):
        known = [part for part in found if part != _MASK]
        key = known[key] if (-len(known) if len(known) < _MAX_ITEMS else 0) <= key < len(known) else ""
    return key if found.get(key) else ""


def _followed(function: FunctionDef) -> tuple[dict[str, dict[str, str]], set[int], dict[str, AST]]:
    """The names bound once, to such a call, of which only parts with a function are read, with those parts; the
    statements that bind parts that are never read; and the calls."""
    nodes = list(walk(function.body))
    calls = {s.targets[0].id: s.value for s in nodes
             if isinstance(s, Assign) and isinstance(s.targets[0], Name) and item_functions(s.value)}
    stores = [n.id for n in nodes if isinstance(n, Name) and isinstance(n.ctx, Store)]
    loads = [n.id for n in nodes if isinstance(n, Name) and not isinstance(n.ctx, Store)]
    loads += [n.target.id for n in nodes if isinstance(n, AugAssign) and isinstance(n.target, Name)]
    unread = {id(s.value): id(s) for s in nodes if isinstance(s, Assign) and isinstance(s.targets[0], Name)
              and s.targets[0].id not in loads}
    items = [(id(n), *a) for n in nodes if (a := _item_of(n)) and isinstance(a[0], Name)]
    made, dropped = {}, set()
    for held, called in calls.items():
        found = item_functions(called)
        uses = [(node, key) for node, value, key in items if value.id == held]
        left = {unread[node] for node, _ in uses if node in unread}
        taken = {_item_name(found, key) for node, key in uses if node not in unread}
        if _MASK in taken and call_name(called) in _INDEX_PAIRS:
            taken = taken - {_MASK} | set(list(found)[:2])
        if stores.count(held) == 1 and "" not in taken and loads.count(held) == len(uses):
            made[held] = {part: f for part, f in found.items() if part in taken}
            dropped |= left
    return made, dropped, calls
