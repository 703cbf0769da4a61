"""splits: what `np.split` and `np.vsplit` give as slices of their operand, which they are.

    a = np.split(x, 2, part=0)              assert x.shape[0] % 2 == 0
                                            a = x[:1 * (x.shape[0] // 2)]

Requires structured form in which functions of whole arrays stand alone.
"""
from __future__ import annotations

from s2sad import rules
from s2sad.blocks import with_blocks
from s2sad.infer.signatures.laws import whole_number
from s2sad.normalize.library.expansions.templates import SECTIONS
from s2sad.tree import (
    AST, Assert, Assign, BinOp, Eq, FloorDiv, FunctionDef, List, Mod, Name, Slice, Subscript, Tuple, assign, at,
    attribute, call_name, compare, const, copy, index, mult, with_body,
)

_SPLIT = {"numpy.split": None, "numpy.vsplit": 0}


def splits(function: FunctionDef) -> FunctionDef:
    """The function with such slices."""
    def block(given: list[AST]) -> list[AST]:
        return [at(made, s) for s in given for made in _statement(with_blocks(s, block))]
    return with_body(function, block(function.body))


def _statement(statement: AST) -> list[AST]:
    called = call_name(statement.value) if isinstance(statement, Assign) else None
    if called not in _SPLIT or not isinstance(statement.value.args[0], (Name, Subscript)) or not isinstance(
            statement.targets[0], Name):
        return [statement]
    rule = rules.find_array(called)
    assert rule is not None
    given = rule.arguments(statement.value)
    axis = _SPLIT[called] if _SPLIT[called] is not None else whole_number(given["axis"])
    number, asked, array = whole_number(given["part"]), given["sections"], given["x"]
    if axis is None or axis < 0 or number is None:
        return [statement]
    size = index(attribute(copy(array), "shape"), const(axis))
    if isinstance(asked, (Tuple, List)):
        bounds = [None, *asked.elts, None]
        low, high, before = bounds[number], bounds[number + 1], []
    else:
        before = [Assert(compare(BinOp(size, Mod(), copy(asked)), Eq(), const(0)), const(SECTIONS))]
        low, high = (mult(const(k), BinOp(copy(size), FloorDiv(), copy(asked))) if k else None
                     for k in (number, number + 1))
    whole = [Slice(None, None, None) for _ in range(axis)]
    part = index(copy(array), *whole, Slice(low and copy(low), high and copy(high), None))
    return [*before, assign(statement.targets[0], part)]
