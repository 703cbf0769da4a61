"""einsum: products summed over named axes are products and sums.

    def f(a: "float64[:, :]", x: "float64[:]"):         def f(a, x):
        return np.sum(np.einsum("ij,j->i", a, x))           return np.sum(np.einsum.matmul(a, x))

`einsum` requires structured form, `einsum_ellipsis` and `batched_products` types too; they establish that products of
more than two axes are `np.matmul` or `np.tensordot` of floats whose sizes are equal (`expansions/stacked_products`), or
sums of elementwise products. A letter twice in one operand, but for the diagonal of a matrix, is left, to be refused.
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import permutations

from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import paired_axes
from s2sad.infer.types import Type
from s2sad.normalize.context import NormalContext
from s2sad.passes import Context
from s2sad.tree import (
    AST, Call, Constant, FunctionDef, Slice, at, call, call_name, const, index, mult, rebuild, tuple_of, walk,
    with_body,
)

_BATCH_LETTERS = "abcdefgh"
_ELLIPSIS_LETTERS = "ABCDEF"
_LETTERS = "ijklmnop"
_LAST = {"numpy.dot": 2, "numpy.inner": 1}      # sum over the last axis of the first, and the last or last but one
_REPEATING = "numpy.einsum."       # products that repeat axes of length 1
_MATMULS = ("numpy.matmul", _REPEATING + "matmul")
_TENSORDOTS = ("numpy.tensordot", _REPEATING + "tensordot")
_PRODUCTS = {*_MATMULS, *_TENSORDOTS, "numpy.outer", *_LAST}


def einsum(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with each `np.einsum` of constant subscripts as such products."""
    def change(node: AST) -> AST | None:
        if call_name(node) != "numpy.einsum" or len(node.args) < 2 or any(k.arg != "optimize" for k in node.keywords):
            return None
        subscripts, *operands = node.args
        if not isinstance(subscripts, Constant) or not isinstance(subscripts.value, str):
            return None
        inputs, output = _subscript_letters(subscripts.value)
        twice = [len(part) == 2 and part[0] == part[1] for part in inputs]
        if len(inputs) == len(operands):    # the diagonals of matrices
            operands = [call("numpy.diagonal", o) if t else o for o, t in zip(operands, twice)]
            inputs = [part[0] if t else part for part, t in zip(inputs, twice)]
        made = contraction(inputs, output, [rebuild(o, change) for o in operands], _REPEATING)
        return None if made is None else at(made, node)
    return with_body(function, [rebuild(statement, change) for statement in function.body])


def einsum_ellipsis(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with each `np.einsum` over operands of known ranks whose subscripts leave axes open, `...`; itself
    if there is none.

        def f(a: "float64[:, :, :]", x: "float64[:]", y: "float64[:, :]"):
            y[...] = np.einsum("...ij,j->...i", a, x)

    becomes

        def f(a, x, y):
            y[...] = np.einsum.tensordot(a, x, axes=((2,), (0,)))
    """
    typing = context.typing
    found: list[AST] = []

    def change(node: AST) -> AST | None:
        subscripts = node.args[0] if call_name(node) == "numpy.einsum" and node.args else None
        text = subscripts.value if isinstance(subscripts, Constant) else None
        if not isinstance(text, str) or "..." not in text:
            return None
        kinds = list(map(typing.of, node.args[1:]))
        spelled = _without_ellipsis(text, [k.rank for k in kinds]) if all(k.is_array for k in kinds) else None
        if spelled is None:
            return None
        found.append(node)
        return at(Call(node.func, [const(spelled), *(rebuild(a, change) for a in node.args[1:])], node.keywords), node)
    new = with_body(function, [rebuild(statement, change) for statement in function.body])
    return einsum(new, context) if found else function


def _without_ellipsis(subscripts: str, ranks: list[int]) -> str | None:
    """The subscripts with letters for `...`, of the last axes the same for all operands.

    >>> _without_ellipsis("...i,ij->...j", [3, 2]), _without_ellipsis("...i,...i", [2, 1])
    ('ABi,ij->ABj', 'Ai,i->A')
    """
    text = subscripts.replace(" ", "").replace("...", ".")
    operands, arrow, output = text.partition("->")
    inputs = operands.split(",")
    if len(inputs) != len(ranks):
        return None
    open_axes = [r - len(i.replace(".", "")) for i, r in zip(inputs, ranks)]
    most = max((n for i, n in zip(inputs, open_axes) if "." in i), default=0)
    if min(open_axes) < 0 or most > len(_ELLIPSIS_LETTERS):
        return None
    if any(n and "." not in i for i, n in zip(inputs, open_axes)):
        return None
    if not arrow:
        output = "." + "".join(sorted(c for c in set(operands) - {",", "."} if operands.count(c) == 1))
    letters = _ELLIPSIS_LETTERS[:most]
    spelled = [i.replace(".", letters[most - n:]) for i, n in zip(inputs, open_axes)]
    return ",".join(spelled) + "->" + output.replace(".", letters)


def batched_products(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with each product of stacks of matrices, and each over named axes, as one of the forms above.

        def f(w: "float64[:]", a: "float64[:, :, :]", y: "float64[:, :]"):
            y[...] = np.dot(a, w)

    becomes

        def f(w, a, y):
            y[...] = np.tensordot(a, w, axes=((2,), (0,)))
    """
    typing = context.typing
    context.guarded |= any((call_name(n) or "").startswith(_REPEATING) for n in walk(function.body))

    def change(node: AST) -> AST | None:
        called = call_name(node)
        if not isinstance(node, Call) or called not in _PRODUCTS or len(node.args) != 2:
            return None
        ranks = [typing.of(a).rank for a in node.args]
        if called == "numpy.dot" and min(ranks) < 1:
            return at(mult(*(rebuild(a, change) for a in node.args)), node)
        if called == "numpy.outer":
            return _raveled_outer(node, ranks, [rebuild(a, change) for a in node.args])
        if max(ranks) < 3 and called in _MATMULS:
            return rebuild(at(_repeating_product(node, typing), node), change) if called != "numpy.matmul" else None
        if min(ranks) < 1 or max(ranks) < 3 and called in _LAST:
            return None
        if called in _MATMULS:
            return _stacked_product(node, typing, [rebuild(a, change) for a in node.args])
        if called in _LAST:
            axes = tuple_of(const(ranks[0] - 1), const(max(ranks[1] - _LAST[called], 0)))
            node = at(call("numpy.tensordot", *node.args, axes=axes), node)
        return _tensor_product(node, typing, [rebuild(a, change) for a in node.args])
    return with_body(function, [rebuild(statement, change) for statement in function.body])


def _stacked_product(node: Call, typing: Typing, operands: list[AST]) -> AST | None:
    """`np.matmul` of stacks."""
    kinds = list(map(typing.argument, node.args))
    ranks = [k.rank for k in kinds]
    outer = _BATCH_LETTERS[:max(ranks) - 2]
    left, right = ("j" if r == 1 else outer[len(outer) - (r - 2):] + own for r, own in zip(ranks, ("ij", "jk")))
    output = outer + ("i" if ranks[0] > 1 else "") + ("k" if ranks[1] > 1 else "")
    alike = len({r for r in ranks if r > 2}) == 1 and ranks[0] > 1
    if alike and typing.of(node).is_inexact and not _repeats((left, right), kinds):
        return at(call("numpy.matmul", *operands), node)
    made = contraction([left, right], output, operands)
    return None if made is None else at(made, node)


def _tensor_product(node: Call, typing: Typing, operands: list[AST]) -> AST | None:
    """`np.tensordot` over constant axes."""
    kinds = list(map(typing.argument, node.args))
    ranks = [k.rank for k in kinds]
    pairs = paired_axes({k.arg: k.value for k in node.keywords}.get("axes"), ranks)
    if pairs is None or sum(ranks) - len(pairs) > len(_LETTERS):
        return None
    left, right = list(_LETTERS[:ranks[0]]), list(_LETTERS[ranks[0]:sum(ranks)])
    for a, b in pairs:
        right[b] = left[a]
    inputs = ["".join(left), "".join(right)]
    output = "".join(c for c in (*left, *right) if (c in left) != (c in right))
    if max(ranks) > 2 and pairs and output and typing.of(node).is_inexact and not _repeats(inputs, kinds):
        return at(_over_axes("numpy.tensordot", operands, pairs), node)
    made = contraction(inputs, output, operands)
    return None if made is None else at(made, node)


def _over_axes(called: str, operands: list[AST], pairs: list[tuple[int, int]]) -> Call:
    return call(called, *operands, axes=tuple_of(*(tuple_of(*map(const, side)) for side in zip(*pairs))))


def _repeats(inputs: Sequence[str], kinds: list[Type]) -> bool:
    """Whether an axis of known length 1 in one operand goes with one in the other that may be longer."""
    single = [{c for k, c in enumerate(part) if k in kind.ones} for part, kind in zip(inputs, kinds)]
    return any((c in single[0]) != (c in single[1]) for c in set(inputs[0]) & set(inputs[1]))


def _raveled_outer(node: Call, ranks: list[int], operands: list[AST]) -> AST | None:
    """`np.outer` of all elements."""
    if max(ranks) < 2 or min(ranks) < 1:
        return None
    return at(Call(node.func, [call("numpy.ravel", o) if r > 1 else o for o, r in zip(operands, ranks)], []), node)


def _subscript_letters(subscripts: str) -> tuple[list[str], str]:
    """The letters of the operands and of the result.

    >>> _subscript_letters("ij, jk")
    (['ij', 'jk'], 'ik')
    """
    operands, arrow, output = subscripts.replace(" ", "").partition("->")
    inputs = operands.split(",")
    return inputs, output if arrow else "".join(sorted(c for c in set(operands) - {","} if operands.count(c) == 1))


def contraction(inputs: list[str], output: str, operands: list[AST], room: str = "") -> AST | None:
    """The product of the operands, summed over the letters that the output lacks; None if it has no such form.

    The functions for products of matrices are in `room`, and so are those for products of stacks of these, which are
    sums of elementwise products where there is none.
    """
    letters = "".join(dict.fromkeys("".join(inputs)))
    plain = all(len(set(part)) == len(part) and part.isalpha() for part in inputs) and len(set(output)) == len(output)
    if not plain or not set(output) <= set(letters) or len(inputs) != len(operands) or len(letters) > 6:
        return None
    if len(operands) == 2:
        made = _matrix_product(inputs, output, operands, room) or _matrix_product(
            inputs[::-1], output, operands[::-1], room)
        made = made or (_product_of_stacks(inputs, output, operands, room) if room else None)
        if made is not None:
            return made
    if len(operands) > 2 and (made := _pairwise(inputs, output, operands, room)) is not None:
        return made
    order = _common_order(inputs, output, letters)
    if order is None:       # the axes of some operand are put in an order that all have
        order = output + "".join(c for c in letters if c not in output)
        reordered = ["".join(c for c in order if c in part) for part in inputs]
        operands = [_reordered(o, part, new) for o, part, new in zip(operands, inputs, reordered)]
        inputs = reordered
    product = reduce(mult, (_broadcast(part, order, operand) for part, operand in zip(inputs, operands)))
    axes = [const(k) for k, c in enumerate(order) if c not in output]
    if not axes:
        return product
    return call("numpy.sum", product) if not output else call(
        "numpy.sum", product, axis=axes[0] if len(axes) == 1 else tuple_of(*axes))


def _product_of_stacks(inputs: list[str], output: str, operands: list[AST], room: str) -> AST | None:
    """The product of two operands that is one of matrices for each value of the letters that all three have; None if
    it is none."""
    (one, other), (a, b) = inputs, operands
    both = [c for c in one if c in other]
    inner, outer = ("".join(c for c in both if (c in output) == kept) for kept in (False, True))
    left, right = ("".join(c for c in part if c not in both) for part in inputs)
    if not inner or not output or not set(left + right) <= set(output) or max(map(len, inputs)) < 3:
        return None
    if not outer:
        pairs = [(one.index(c), other.index(c)) for c in inner]
        return _reordered(_over_axes(room + "tensordot", [a, b], pairs), left + right, output)
    if len(left) != 1 or len(inner) != 1 or len(right) != 1:
        return None
    stacks = _reordered(a, one, outer + left + inner), _reordered(b, other, outer + inner + right)
    product = call(room + "matmul", *stacks)
    return _reordered(product, outer + left + right, output)


def _pairwise(inputs: list[str], output: str, operands: list[AST], room: str) -> AST | None:
    """The first two operands first, so that no array is larger than these two require."""
    later = {*"".join(inputs[2:]), *output}
    middle = "".join(c for c in dict.fromkeys(inputs[0] + inputs[1]) if c in later)
    first = contraction(inputs[:2], middle, operands[:2], room)
    return None if first is None else contraction([middle, *inputs[2:]], output, [first, *operands[2:]], room)


def _matrix_product(inputs: list[str], output: str, operands: list[AST], room: str) -> AST | None:
    """The product of two matrices or vectors, summed over the one letter that both have."""
    both = set(inputs[0]) & set(inputs[1])
    left, right = (part.replace(c, "") for part in inputs for c in both) if len(both) == 1 else ("", "")
    if len(both) != 1 or max(map(len, inputs)) > 2 or output != left + right:
        return None
    a, b = operands
    a = call("numpy.transpose", a) if len(inputs[0]) == 2 and inputs[0][0] in both else a
    b = call("numpy.transpose", b) if len(inputs[1]) == 2 and inputs[1][1] in both else b
    return call(f"{room or 'numpy.'}matmul", a, b)


def _repeating_product(node: Call, typing: Typing) -> AST:
    """The matrix product of `np.einsum`, in which an axis of length 1 is as long as the other one."""
    alone = [typing.argument(x) for x in node.args]
    places = [_summation_axis(x, typing, last) for x, last in zip(node.args, (True, False))]
    single = [axis in kind.ones for kind, (_, axis) in zip(map(typing.argument, (x for x, _ in places)), places)]
    if single[0] == single[1]:
        return call("numpy.matmul", *node.args)
    factors = [index(x, *(const(0) if k == axis else Slice(None, None, None) for k in range(kind.rank))) if one else
               call("numpy.sum", x, **({"axis": const(axis)} if kind.rank > 1 else {}))
               for (x, axis), one, kind in zip(places, single, alone)]
    return call("numpy.outer", *factors) if all(k.rank == 2 for k in alone) else mult(*factors)


def _summation_axis(operand: AST, typing: Typing, last: bool) -> tuple[AST, int]:
    """The array that an operand is or transposes, and which axis of it is summed over."""
    rank = typing.of(operand).rank
    axis = rank - 1 if last else max(rank - 2, 0)
    if call_name(operand) == "numpy.transpose" and len(operand.args) == 1:
        return operand.args[0], rank - 1 - axis
    return operand, axis


def _common_order(inputs: list[str], output: str, letters: str) -> str | None:
    """An order of all letters that has those of the output in their order, and each operand's, or reversed."""
    orders = [o for o in map("".join, permutations(letters)) if _is_ordered(output, o)]
    straight = next((o for o in orders if all(_is_ordered(part, o) for part in inputs)), None)
    turned = (o for o in orders if all(_is_ordered(part, o) or _is_ordered(part[::-1], o) for part in inputs))
    return straight or next(turned, None)


def _reordered(operand: AST, letters: str, wanted: str) -> AST:
    """The operand, whose axes have these letters, with its axes in another order."""
    if letters == wanted:
        return operand
    if len(letters) == 2:
        return call("numpy.transpose", operand)
    places = [letters.index(c) for c in wanted]
    return call("numpy.moveaxis", operand, tuple_of(*map(const, places)), tuple_of(*map(const, range(len(places)))))


def _is_ordered(part: str, order: str) -> bool:
    return "".join(c for c in order if c in part) == part


def _broadcast(part: str, order: str, operand: AST) -> AST:
    """The operand with its axes where the order has them."""
    if not _is_ordered(part, order):
        operand = call("numpy.transpose", operand)
    if len(part) == len(order):
        return operand
    return index(operand, *(Slice(None, None, None) if c in part else const(None) for c in order))
