"""unsigned_elements: indices that come out of arrays without a negative element are unsigned in compiled code.

    def f(y, x, picked):                            def f(y, x, picked):
        for k in range(picked.shape[0]):                for k in range(picked.shape[0]):
            y[k] = x[picked[k]]                             y[k] = x[_uintp(picked[k])]

Compiled, an index is asked at each access whether it counts from the end. Where the least element of the arrays that
indices come from is known not to be negative, as it is once a call has been looked at (`dispatch/index_check.py`), that
is the same answer for all. The text stays as it is: this changes its tree, when it is loaded, line for line.
"""
from __future__ import annotations

import ast
from collections.abc import Collection, Mapping
from typing import NamedTuple


class Known(NamedTuple):
    """What is known of an integer, or an array of a rank: whether it is never negative, and made of such elements."""
    rank: int
    natural: bool = False
    read: bool = False


Knowledge = dict[str, Known]
_SIZE = Known(0, True)


def unsigned_elements(tree: ast.Module, entries: Collection[str], given: Mapping[str, Known]) -> ast.Module:
    """A module whose functions `entries` are `given` these parameters, with such indices.

    >>> tree = ast.parse("def f(x, k):\\n    for i in range(k[0], k[1]):\\n        x[3 * i] = x[i - 1]")
    >>> print(ast.unparse(unsigned_elements(tree, ["f"], {"x": Known(1), "k": Known(1, True, True)})))
    from numpy import uintp as _uintp
    <BLANKLINE>
    def f(x, k):
        for i in range(k[0], k[1]):
            x[_uintp(3 * i)] = x[i - 1]
    """
    functions = [s for s in tree.body if isinstance(s, ast.FunctionDef)]
    calls: dict[str, list[list[Known | None]]] = {}
    for function in reversed(functions):        # a function stands in front of those that call it
        parameters = [a.arg for a in function.args.args]
        known = {p: k for p, k in given.items() if p in parameters} if function.name in entries else _of_all(
            parameters, calls.get(function.name, []))
        work = _Unsigned(known)
        work.bind(function)
        for node in ast.walk(function):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                calls.setdefault(node.func.id, []).append([work.of(a) for a in node.args])
        work.visit(function)
    made = ast.ImportFrom("numpy", [ast.alias("uintp", "_uintp")], 0)
    place = next((k for k, s in enumerate(tree.body) if isinstance(s, ast.FunctionDef)), 0)
    tree.body.insert(place, ast.copy_location(made, functions[0]) if functions else made)
    return ast.fix_missing_locations(tree)


def _of_all(parameters: list[str], calls: list[list[Known | None]]) -> Knowledge:
    """What is known of parameters in all calls."""
    found = {p: _joined([c[k] if k < len(c) else None for c in calls]) for k, p in enumerate(parameters)}
    return {p: known for p, known in found.items() if known is not None}


def _joined(each: list[Known | None]) -> Known | None:
    """What is known of a name that is bound in these ways."""
    known = [k for k in each if k is not None]
    if not known or len(known) < len(each) or len({k.rank for k in known}) > 1:
        return None
    return Known(known[0].rank, all(k.natural for k in known), any(k.read for k in known))


class _Unsigned(ast.NodeTransformer):
    """One function, of whose names something is known."""

    def __init__(self, known: Knowledge):
        self.known = known

    def bind(self, function: ast.FunctionDef) -> None:
        """Finds out what is known of the names that it binds; of one that depends on itself it is nothing."""
        bound: dict[str, list[ast.expr | None]] = {}
        for node in ast.walk(function):
            if isinstance(node, ast.For) and isinstance(node.target, ast.Name):
                bound.setdefault(node.target.id, []).append(node.iter)
            elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                bound.setdefault(node.targets[0].id, []).append(node.value)
        stored = [n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]
        once = {n: v for n, v in bound.items() if stored.count(n) == len(v) and n not in self.known}
        self.known = {n: k for n, k in self.known.items() if n not in stored}
        while found := {n: k for n, values in once.items() if n not in self.known
                        and (k := _joined([self.of(v) for v in values])) is not None}:
            self.known |= found

    def of(self, node: ast.expr | None) -> Known | None:
        """What is known of an expression."""
        if isinstance(node, ast.Constant):
            return Known(0, node.value >= 0) if type(node.value) is int else None
        if isinstance(node, ast.Name):
            return self.known.get(node.id)
        if isinstance(node, ast.Attribute):
            return _SIZE if node.attr == "size" else None
        if isinstance(node, ast.UnaryOp):
            inner = self.of(node.operand)
            return inner and inner._replace(natural=False)
        if isinstance(node, ast.BinOp):
            return self._operation(node)
        if isinstance(node, ast.Subscript):
            return self._element(node)
        return self._call(node) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else None

    def _operation(self, node: ast.BinOp) -> Known | None:
        left, right = self.of(node.left), self.of(node.right)
        if left is None or right is None or left.rank or right.rank:
            return None
        keeps = isinstance(node.op, (ast.Add, ast.Mult, ast.FloorDiv, ast.Mod))
        return Known(0, keeps and left.natural and right.natural, left.read or right.read)

    def _element(self, node: ast.Subscript) -> Known | None:
        if isinstance(node.value, ast.Attribute):
            return _SIZE if node.value.attr == "shape" else None
        whole, asked = self.of(node.value), [self.of(i) for i in _indices(node) if not isinstance(i, ast.Slice)]
        if whole is None or any(i is None or i.rank for i in asked):
            return None
        return whole._replace(rank=whole.rank - len(asked))

    def _call(self, node: ast.Call) -> Known | None:
        assert isinstance(node.func, ast.Name)
        given = [self.of(a) for a in node.args]
        if node.func.id == "len":
            return _SIZE
        if node.func.id not in ("range", "min", "max") or any(g is None or g.rank for g in given):
            return None
        known = [g for g in given if g is not None]
        if node.func.id == "range":
            return self._counter(node, known)
        natural = (any if node.func.id == "max" else all)(k.natural for k in known)
        return Known(0, natural, any(k.read for k in known))

    def _counter(self, node: ast.Call, known: list[Known]) -> Known:
        """What is known of the counter of a loop: it is from its start on, or down to what is behind its stop."""
        read = any(k.read for k in known)
        if len(known) < 3:
            return Known(0, len(known) == 1 or known[0].natural, read)
        _, last, step = node.args
        if isinstance(step, ast.Constant):
            return Known(0, known[0].natural and known[2].natural, read)
        if not isinstance(step, ast.UnaryOp):
            return Known(0, False, read)
        if isinstance(last, ast.BinOp) and isinstance(last.op, ast.Sub) and ast.unparse(last.right) == "1":
            least = self.of(last.left)
            return Known(0, least is not None and least.natural, read)
        return Known(0, ast.unparse(last) == "-1", read)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        asked = [self.of(i) for i in _indices(node)]
        self.generic_visit(node)
        if isinstance(node.value, ast.Attribute):
            return node
        made = [_unsigned(i) if known is not None and known == (0, True, True) else i
                for i, known in zip(_indices(node), asked)]
        node.slice = ast.Tuple(made, ast.Load()) if isinstance(node.slice, ast.Tuple) else made[0]
        return node


def _indices(node: ast.Subscript) -> list[ast.expr]:
    return list(node.slice.elts) if isinstance(node.slice, ast.Tuple) else [node.slice]


def _unsigned(node: ast.expr) -> ast.expr:
    return ast.copy_location(ast.Call(ast.Name("_uintp", ast.Load()), [node], []), node)


__all__ = ["Known", "unsigned_elements"]
