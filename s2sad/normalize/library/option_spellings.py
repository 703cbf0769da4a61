"""option_spellings: calls with an option that changes what is computed, in the spelling that has a rule.

    np.sum(a, axis=0, where=m)              np.sum(np.where(m, a, 0), axis=0)
    np.sum(a, initial=2)                    np.sum(a) + 2
    np.sum(a, dtype=np.float64)             np.sum(np.astype(a, dtype=np.float64))
    x.astype(float, copy=False)             np.asarray(x, dtype=float)
    np.zeros_like(x, None, "F")             np.zeros_like(x, None, order="F")
    x.item(1, 2)                            x[1, 2]
    np.add.at(x, [0, 0, 1], v)              np.add.at(x, np.array([0, 0, 1]), v)
    np.linalg.matrix_power(a, 1)            np.asarray(a)           which is a itself
    np.reshape(a, (2, -1), order="F")       np.transpose(np.reshape(np.transpose(a), (-1, 2)))
    np.linalg.eigvalsh(a, UPLO="U")         np.linalg.eigvalsh(np.transpose(a))

Requires that methods are functions; `canonical_calls` applies it to each call.
"""
from __future__ import annotations

from s2sad.infer.signatures.laws import whole_number
from s2sad.rules.composed import WRITING
from s2sad.tree import (
    AST, Add, Attribute, BinOp, Call, Constant, List, Mult, Slice, Tuple, at, call, call_name, const, index, keyword,
    negate, tuple_of, walk,
)

_NEUTRAL_ELEMENT = {"numpy.sum": 0, "numpy.prod": 1}
_ACCUMULATING = ("numpy.sum", "numpy.prod", "numpy.mean", "numpy.cumsum", "numpy.cumprod", "numpy.std", "numpy.var")
_ORDER_POSITION = {"numpy.copy": 1, "numpy.full": 3, "numpy.full_like": 3, **{f"numpy.{f}": 2 for f in (
    "zeros", "ones", "empty", "zeros_like", "ones_like", "empty_like", "asarray")}}     # its position
_LAID_OUT = {"numpy.ravel": 1, "numpy.flatten": 1, "numpy.reshape": 2}     # functions with an order of elements
_FLOATS = ("builtins.float", "numpy.float64", "numpy.double")


def option_spellings(node: Call) -> AST | None:
    """The call in its other spelling, None if it has no such option."""
    called = call_name(node) or ""
    options = {str(k.arg): k.value for k in node.keywords}
    if not node.args:
        return None
    if called == "numpy.astype" and isinstance(copied := options.get("copy"), Constant):
        return _astype(node, options, copied.value)
    if called in _ACCUMULATING and getattr(options.get("dtype"), "id", "") in _FLOATS:
        made = call("numpy.astype", node.args[0], dtype=options["dtype"])
        return _without(node, ("dtype",), made)
    if called in _ORDER_POSITION and "order" not in options and len(node.args) == _ORDER_POSITION[called] + 1:
        order = at(keyword("order", node.args[-1]), node)
        return Call(node.func, node.args[:-1], [*node.keywords, order])
    if called == "numpy.copy" and "subok" in options and not _is_true(options["subok"]):
        return _without(node, ("subok",), node.args[0])
    if called == "numpy.pad":
        return _padded_with_one(node)
    if called in _NEUTRAL_ELEMENT:
        return _masked_reduction(node, called, options)
    if called in _LAID_OUT:
        return _in_order(node, called, options)
    if called in ("numpy.linalg.eigvalsh", "numpy.linalg.eigh"):
        return _triangle_read(node, called, options)
    if called == "numpy.linalg.matrix_power" and not options and [getattr(n, "value", 0) for n in node.args[1:]] == [1]:
        return call("numpy.asarray", node.args[0])
    if called in WRITING and len(node.args) > 1:
        made = [node.args[0], *map(_indices_as_arrays, node.args[1:])]
        return None if all(a is b for a, b in zip(made, node.args)) else Call(node.func, made, node.keywords)
    return None


def item(node: Call) -> AST | None:
    """`x.item(...)` of several indices as an element."""
    if not isinstance(node.func, Attribute) or node.func.attr != "item" or node.keywords or not node.args:
        return None
    places = node.args[0].elts if isinstance(node.args[0], Tuple) and len(node.args) == 1 else node.args
    return index(node.func.value, *places) if len(places) > 1 else None


def _is_true(node: AST | None) -> bool:
    return node is not None and not (isinstance(node, Constant) and not node.value)


def _astype(node: Call, options: dict[str, AST], copied: object) -> AST | None:
    dtype = node.args[1] if len(node.args) > 1 else options.get("dtype")
    if dtype is None:
        return None
    if copied:
        return _without(node, ("copy",), node.args[0])
    return call("numpy.asarray", node.args[0], dtype=dtype) if set(options) <= {"dtype", "copy"} else None


def _padded_with_one(node: Call) -> AST | None:
    """`np.pad` whose constants for the sides are one number."""
    given = next((k.value for k in node.keywords if k.arg == "constant_values"), None)
    numbers = [] if given is None else [n for n in walk(given) if not isinstance(n, (Tuple, List))]
    one = isinstance(given, (Tuple, List)) and all(isinstance(n, Constant) for n in numbers) and len(
        {n.value for n in numbers}) == 1
    return Call(node.func, node.args, [keyword(k.arg, numbers[0] if k.value is given else k.value)
                                       for k in node.keywords]) if one else None


def _masked_reduction(node: Call, called: str, options: dict[str, AST]) -> AST | None:
    """A sum or product over a mask, with an initial value: for integers NumPy converts that to an integer, so that it
    must be spelled as one."""
    where, initial = options.get("where"), options.get("initial")
    whole = isinstance(initial, Constant) and type(initial.value) is int
    if where is None and initial is None or initial is not None and not whole:
        return None
    operand = node.args[0]
    if where is not None:
        operand = call("numpy.where", where, operand, const(_NEUTRAL_ELEMENT[called]))
    made: AST = _without(node, ("where", "initial"), operand)
    if initial is None:
        return made
    return BinOp(made, Add() if called == "numpy.sum" else Mult(), initial)


def _in_order(node: Call, called: str, options: dict[str, AST]) -> AST | None:
    """A function of the elements in an order, column by column as one of the transpose."""
    operands = _LAID_OUT[called]
    given = [*node.args[operands:], *(v for k, v in options.items() if k == "order")]
    order = given[0].value if len(given) == 1 and isinstance(given[0], Constant) else None
    if order not in ("C", "F") or options.keys() - {"order"} or len(node.args) < operands:
        return None
    if order == "C":
        return Call(node.func, node.args[:operands], [])
    turned = call("numpy.transpose", node.args[0])
    if operands == 1:
        return call(called, turned)
    shape = node.args[1]
    if whole_number(shape) is not None:
        return call(called, turned, shape)
    if isinstance(shape, (Tuple, List)):
        backwards: AST = tuple_of(*reversed(shape.elts))
    elif isinstance(shape, Attribute) and shape.attr == "shape":       # of an array
        backwards = index(shape, Slice(None, None, negate(const(1))))
    else:
        return None
    return call("numpy.transpose", call(called, turned, backwards))


def _triangle_read(node: Call, called: str, options: dict[str, AST]) -> AST | None:
    """Of a symmetric matrix the lower triangle, or the upper one as that of the transpose. Eigenvectors of the
    transpose may have other signs."""
    given = [*node.args[1:], *(v for k, v in options.items() if k == "UPLO")]
    triangle = given[0].value if len(given) == 1 and isinstance(given[0], Constant) else None
    if options.keys() - {"UPLO"} or triangle not in ("L", "l", "U", "u"):
        return None
    if triangle in ("L", "l"):
        return call(called, node.args[0])
    return call(called, call("numpy.transpose", node.args[0])) if called == "numpy.linalg.eigvalsh" else None


def _without(node: Call, gone: tuple[str, ...], operand: AST) -> Call:
    return Call(node.func, [operand, *node.args[1:]], [k for k in node.keywords if k.arg not in gone])


def _indices_as_arrays(node: AST) -> AST:
    """A list as an array, also within a tuple of indices."""
    if isinstance(node, Tuple):
        parts = [_indices_as_arrays(e) for e in node.elts]
        return node if all(a is b for a, b in zip(parts, node.elts)) else tuple_of(*parts)
    return call("numpy.array", node) if isinstance(node, List) else node
