"""Expansions of products of floats with more than two axes: they are products of two matrices, or of two stacks of
as many.

    y = np.matmul(x, w)             rows = np.reshape(x, (x.shape[0] * x.shape[1], x.shape[2]))
                                    product = np.matmul(rows, w)
                                    y = np.reshape(product, (x.shape[0], x.shape[1], w.shape[1]))
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import paired_axes
from s2sad.normalize.library.expansions.templates import CallArguments, guard, lines, size
from s2sad.normalize.shape_guards import EQUAL
from s2sad.tree import Call, call_name


def product_expansion(node: Call, typing: Typing) -> Callable[[CallArguments], str] | None:
    """The expansion of such a call, None where it is one of two matrices or vectors."""
    called, ranks = call_name(node), [typing.of(a).rank for a in node.args]
    if called == "numpy.tensordot":
        return _tensordot if paired_axes({k.arg: k.value for k in node.keywords}.get("axes"), ranks) else None
    if called != "numpy.matmul":
        return None
    return None if max(ranks) < 3 else _matmul if min(ranks) > 2 else _flattened


def _tensordot(args: CallArguments) -> str:
    pairs = paired_axes(args.arguments["axes"], [args.rank("a"), args.rank("b")])
    assert pairs is not None
    # of one pair the product itself asks
    fits = [guard(f"{size('a', k)} == {size('b', m)}", EQUAL) for k, m in (pairs if len(pairs) > 1 else [])]
    return lines(*fits, *_product(args, pairs))


def _flattened(args: CallArguments) -> str:
    """A stack and one matrix or vector."""
    a, b = args.rank("a"), args.rank("b")
    pairs = [(a - 1, max(b - 2, 0))]
    if a > 2:
        return lines(*_product(args, pairs))
    return lines(*_product(args, pairs, "apart"), f"result = numpy.copy(numpy.moveaxis(apart, 0, {b - 2}))")


def _matmul(args: CallArguments) -> str:
    """Two stacks of as many."""
    fits = [guard(f"{size('a', k)} == {size('b', k)}", EQUAL) for k in range(args.rank("a") - 2)]
    return lines(*fits, "result = runtime.stacked_matmul(a, b)")


def _product(args: CallArguments, pairs: list[tuple[int, int]], made: str = "result") -> list[str]:
    """The lines that bind the sum over pairs of axes, of which the first operand's are its last, the second's its
    first."""
    inner = [[k for k, _ in pairs], [k for _, k in pairs]]
    outer = [[k for k in range(args.rank(x)) if k not in summed] for x, summed in zip("ab", inner)]
    whole = [size(x, k) for x, kept in zip("ab", outer) for k in kept]
    left, right = _grouped(args, "a", [outer[0], inner[0]]), _grouped(args, "b", [inner[1], outer[1]])
    product = "numpy.matmul(left, right)"
    if max(map(len, outer)) > 1:
        return [f"left = {left}", f"right = {right}", f"product = {product}",
                f"{made} = numpy.reshape(product, ({', '.join(whole)},))"]
    return [f"left = {left}", f"right = {right}", f"{made} = {product}"]


def _grouped(args: CallArguments, operand: str, groups: list[list[int]]) -> str:
    """The operand with each group of its axes as one axis; one without an axis is none."""
    order, kept = groups[0] + groups[1], [g for g in groups if g]
    turned = operand
    if order != sorted(order):
        turned = f"numpy.transpose({operand})" if len(order) == 2 else (
            f"numpy.moveaxis({operand}, {tuple(order)}, {tuple(range(len(order)))})")
    if max(map(len, kept)) == 1:
        return turned
    shape = [" * ".join(size(operand, k) for k in group) for group in kept]
    return f"numpy.reshape({turned}, ({', '.join(shape)},))"
