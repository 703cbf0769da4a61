"""A kernel in structured form: the first half of normalize.

Requires a fenced tree with resolved names. Establishes, in this order: combinations of ranges are nested loops
(combined), elements are assigned one by one (chained), tuples are written out (joined), grids are of ranges (grids),
NumPy's functions are given by place what they must be given (signatures), options are numbers (settled), tables of
numbers are arrays (tables), slices have no names (sliced), lists that grow are arrays (lists), no name holds several
results (bundles), one target per assignment and pure expressions (desugar), control flow with one return and breaks in
tail position (jumps), loops that count (loops).
"""
from __future__ import annotations

from s2sad.naming import Names
from s2sad.normalize.bundles import bundles
from s2sad.normalize.chained import chained
from s2sad.normalize.combined import combined
from s2sad.normalize.desugar import desugar
from s2sad.normalize.grids import grids
from s2sad.normalize.joined import joined
from s2sad.normalize.jumps import jumps
from s2sad.normalize.lists import lists
from s2sad.normalize.loops import loops
from s2sad.normalize.memory import Memory
from s2sad.normalize.scope import Scope
from s2sad.normalize.settled import settled
from s2sad.normalize.signatures import signatures
from s2sad.normalize.sliced import sliced
from s2sad.normalize.tables import tables
from s2sad.program import Kernel, Program
from s2sad.tree import (
    AST, FunctionDef, IfExp, List, Name, Return, Tuple, at, const, copy, dump, rebuild, tuple_of, walk,
)


def structured(kernel: Kernel, names: Names, program: Program) -> FunctionDef:
    """The kernel's tree in structured form; new names come from `names`. Raises S2sadError."""
    tree = copy(kernel.tree)
    names.taken |= {node.id for node in walk(tree) if isinstance(node, Name)}
    scope = Scope(kernel, names, program, Memory(tree, program))
    flat(tree, scope)
    for step in (combined, chained, joined, grids, signatures, settled, tables, sliced, lists, bundles, desugar,
                 jumps, loops):
        scope.memory = Memory(tree, program)            # each step has made names
        tree = step(tree, scope)
        scope.report.finish()
    return tree


def flat(tree: FunctionDef, scope: Scope) -> None:
    """Every return of tuples within tuples returns their values in a row; `calls.result_structure` tells the rest. A
    list that is spelled out there is a tuple."""
    for node in walk(tree.body):
        if isinstance(node, Return) and node.value is not None:
            node.value = _as_tuples(node.value)
    returns = [n for n in walk(tree.body) if isinstance(n, Return) and isinstance(n.value, Tuple)]
    shapes = [dump(rebuild(n.value, lambda v: None if isinstance(v, Tuple) else const(0))) for n in returns]
    for node, shape in zip(returns, shapes):
        if any(isinstance(item, Tuple) for item in node.value.elts):
            if shape != shapes[0]:
                scope.refuse(node, "returns of tuples of different structure", help="return the same on every path")
            node.value = at(tuple_of(*_items(node.value)), node.value)


def _as_tuples(value: AST) -> AST:
    if isinstance(value, IfExp):
        return at(IfExp(value.test, _as_tuples(value.body), _as_tuples(value.orelse)), value)
    return at(tuple_of(*map(_as_tuples, value.elts)), value) if isinstance(value, (Tuple, List)) else value


def _items(value: AST) -> list[AST]:
    return [i for item in value.elts for i in _items(item)] if isinstance(value, Tuple) else [value]
