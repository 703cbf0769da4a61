"""canonical_calls: calls with several spellings take the one that has a rule.

    def f(x: "float64[:]", y: "float64[:]"):    def f(x, y):
        return x.sum() + x.dot(y)                   return np.sum(x) + np.dot(x, y)

Requires structured form. Establishes that functions of arrays have the spelling under which `rules` knows them, where
they have one: a function and no method or operator, operands by position, options by name. Operands are evaluated in
the order of the text.
"""
from __future__ import annotations

from functools import reduce

from s2sad import rules
from s2sad.normalize.library.element_moves import canonical_move
from s2sad.normalize.library.option_spellings import item, option_spellings
from s2sad.normalize.library.typed_rewrites import CONJUGATING, sum_start
from s2sad.passes import Context
from s2sad.rules.spellings import other_spelling
from s2sad.tree import (
    AST, Add, Attribute, BinOp, Call, Constant, Div, Eq, FunctionDef, Gt, List, MatMult, Name, NotEq, Pow, Slice,
    Starred, Store, Sub, Subscript, Tuple, add, at, attribute, call, call_name, compare, const, copy, index, indices,
    keyword, mult, name, rebuild, tuple_of, walk, with_body,
)

_PAIRED = {"builtins.min", "builtins.max"}
_METHODS = {"sum", "mean", "max", "min", "reshape", "ravel", "transpose", "dot", "var", "std", "prod", "cumsum",
            "cumprod", "squeeze", "swapaxes", "repeat", "diagonal", "trace", "copy",
            "flatten", "take", "ptp", "astype", "argsort", "clip", "round", "searchsorted"}
_PREDICATES = {"any", "all", "argmax", "argmin"}
_REDUCING = {"linalg.norm", "median", "sort", "diff", "count_nonzero"}
_FIRST_OPERAND = {"diag", "diagflat", "tril", "triu", "roll", "flip", "searchsorted", "linalg.det", "linalg.inv",
                  "trapezoid", "average", "ediff1d"}
_PRODUCTS = {"dot", "outer", "inner", "vdot", "matmul", "where", "interp", "polyval", "convolve", "correlate", "cross",
             "kron", "linalg.solve", "setdiff1d", "einsum.matmul", "meshgrid"}
_SHAPED = {"reshape", "transpose"}
_PARTS = {"real", "imag"}  # attributes


def canonical_calls(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with such calls in canonical form; the order of evaluation stays."""
    return with_body(function, [rebuild(statement, _canonical) for statement in function.body])


def _canonical(node: AST) -> AST | None:
    if isinstance(node, Name) and node.id == "numpy.newaxis":
        return at(const(None), node)
    if isinstance(node, BinOp):
        return _operator(node)
    if isinstance(node, Subscript):
        return _subscript(node)
    if isinstance(node, Call):
        return _call(node)
    if isinstance(node, Attribute) and (move := canonical_move(node)) is not None:
        return rebuild(at(move, node), _canonical)
    if isinstance(node, Attribute) and node.attr in _PARTS and not isinstance(node.ctx, Store):
        return at(call(f"numpy.{node.attr}", rebuild(node.value, _canonical)), node)
    return None


def _operator(node: BinOp) -> AST | None:
    if isinstance(node.op, MatMult):
        return rebuild(at(call("numpy.matmul", node.left, node.right), node), _canonical)
    if isinstance(node.op, (Sub, Div, Pow)) and any(isinstance(s, (Tuple, List)) for s in (node.left, node.right)):
        left, right = map(_literal_as_array, (node.left, node.right))
        return rebuild(at(BinOp(left, node.op, right), node), _canonical)
    return None


def _subscript(node: Subscript) -> AST | None:
    if (joined := _index_trick(node) or _open_mesh(node)) is not None:
        return rebuild(at(joined, node), _canonical)
    if any(isinstance(s, List) or _is_range(s) for s in indices(node)):
        parts = [call("numpy.array", s) if isinstance(s, List) else _range_as_array(s) for s in indices(node)]
        return rebuild(at(Subscript(node.value, index(node.value, *parts).slice, node.ctx), node), _canonical)
    return None


def _call(node: Call) -> AST | None:
    if call_name(node) in ("numpy.array", "numpy.asarray") and node.args and _is_range(node.args[0]):
        return rebuild(at(Call(name("numpy.arange"), node.args[0].args, node.keywords), node), _canonical)
    if call_name(node) == "numpy.shape" and len(node.args) == 1 and isinstance(node.args[0], Name):
        return at(attribute(node.args[0], "shape"), node)
    if call_name(node) == "numpy.reshape" and len(node.args) == 2 and isinstance(shape := node.args[1], List):
        return rebuild(at(call("numpy.reshape", node.args[0], tuple_of(*shape.elts)), node), _canonical)
    whole = _array_operands(node)
    if any(isinstance(a, (Tuple, List)) or _is_range(a) for a in whole):
        made = [*map(_literal_as_array, whole), *node.args[len(whole):]]
        return rebuild(at(Call(node.func, made, node.keywords), node), _canonical)
    if isinstance(node.func, Attribute) and (method := node.func.attr) in {*CONJUGATING, *_METHODS, *_PREDICATES}:
        if method in CONJUGATING:
            return None     # `typed_rewrites` knows whether it is the array itself
        order = [keyword("order", const("C"))] if method == "copy" and not node.args + node.keywords else []
        args = _method_arguments(node) if method in _METHODS else node.args
        called = Call(name(f"numpy.{method}"), [node.func.value, *args], [*node.keywords, *order])
        return rebuild(at(called, node), _canonical)
    other = (item(node) or canonical_move(node) or option_spellings(node) or other_spelling(node)
             or _complex_number(node) or _clip(node) or _multi_dot(node) or _block(node)
             or _arg_extremum_along_axis(node) or _extended_diff(node))
    if other is not None:
        return rebuild(at(other, node), _canonical)
    return _predicate_along_axis(node) or _array_call(node) or _scalar_call(node)


def _literal_as_array(node: AST) -> AST:
    """A tuple or a list that is spelled out, or a range, as an array; anything else as it is."""
    return call("numpy.array", node) if isinstance(node, (Tuple, List)) else _range_as_array(node)


def _is_range(node: AST) -> bool:
    return call_name(node) == "builtins.range" and not node.keywords


def _range_as_array(node: AST) -> AST:
    """A range as an array; anything else as it is."""
    return call("numpy.arange", *node.args) if _is_range(node) else node


def _index_trick(node: Subscript) -> AST | None:
    """`np.r_` and `np.c_` of arrays, numbers and ranges, as a call that concatenates them."""
    joins = {"numpy.r_": "numpy.r_", "numpy.c_": "numpy.column_stack"}
    if not isinstance(node.value, Name) or node.value.id not in joins:
        return None
    parts: list[AST] = []
    for part in indices(node):
        if isinstance(part, Slice):
            if part.upper is None or any(isinstance(n, Constant) and isinstance(n.value, complex) for n in walk(part)):
                return None
            parts.append(call("numpy.arange", part.lower or const(0), part.upper, part.step or const(1)))
        elif isinstance(part, Constant) and isinstance(part.value, str):
            return None
        else:
            parts.append(part)
    return call(joins[node.value.id], tuple_of(*parts))


def _open_mesh(node: Subscript) -> AST | None:
    """The subscripts of an open mesh, `np.ix_`, by arrays that broadcast."""
    if call_name(node.slice) != "numpy.ix_" or node.slice.keywords or not node.slice.args:
        return None
    lists = [call("numpy.array", a) if isinstance(a, (List, Tuple)) else a for a in node.slice.args]
    last = len(lists) - 1
    spread = [index(a, Slice(None, None, None), *[const(None)] * (last - k)) if k < last else a
              for k, a in enumerate(lists)]
    return Subscript(node.value, index(node.value, *spread).slice, node.ctx)


def _array_operands(node: Call) -> list[AST]:
    """The first arguments of a function that are operands, arrays or numbers, and no sequences of these."""
    called = call_name(node) or ""
    function = called.removeprefix("numpy.")
    if function == called:
        return []
    if function in _PRODUCTS or rules.find(called) is not None:
        return node.args
    if function == "searchsorted":
        return node.args[:2]
    return node.args[:1] if function in _METHODS | _PREDICATES | _REDUCING | _FIRST_OPERAND else []


def _complex_number(node: Call) -> AST | None:
    """A complex number by its real and imaginary part."""
    if call_name(node) not in ("builtins.complex", "numpy.complex128") or node.keywords or not 1 <= len(node.args) <= 2:
        return None
    real, *imaginary = node.args
    return BinOp(real, Add(), mult(const(1j), imaginary[0]) if imaginary else const(0j))


def _predicate_along_axis(node: Call) -> AST | None:
    """A predicate along an axis, as a count."""
    function = (call_name(node) or "").removeprefix("numpy.")
    options = {"axis": node.args[1]} if len(node.args) == 2 else {}
    options |= {str(k.arg): k.value for k in node.keywords}
    if function not in ("any", "all", "count_nonzero") or "axis" not in options or not options.keys() <= {
            "axis", "keepdims"} or not 1 <= len(node.args) <= 2:
        return None
    zero = compare(rebuild(node.args[0], _canonical), Eq() if function == "all" else NotEq(), const(0))
    count = call("numpy.sum", zero, **options)
    if function == "count_nonzero":
        return at(count, node)
    return at(compare(count, Eq() if function == "all" else Gt(), const(0)), node)


def _arg_extremum_along_axis(node: Call) -> AST | None:
    """The index of an extremum along an axis."""
    function = call_name(node)
    if function not in ("numpy.argmax", "numpy.argmin") or len(node.args) + len(node.keywords) < 2:
        return None
    rule = rules.find_array(f"{function}.along")
    made = rules.bound(rule, Call(name(f"{function}.along"), node.args, node.keywords)) if rule else None
    return call(function, node.args[0]) if made is not None and not made.keywords else made


def _extended_diff(node: Call) -> AST | None:
    """Differences of a concatenation: `np.diff(x, prepend=0.0)`."""
    options = {str(k.arg): k.value for k in node.keywords}
    parts = [options.pop("prepend", None), *node.args[:1], options.pop("append", None)]
    if call_name(node) != "numpy.diff" or len(parts) < 3 or parts[0] is parts[2] or len(node.args) > 1:
        return None
    whole = [p if k == 1 else call("numpy.atleast_1d", p) for k, p in enumerate(parts) if p is not None]
    axis = copy(options.get("axis", const(-1)))
    return call("numpy.diff", call("numpy.concatenate", tuple_of(*whole), axis=axis), **options)


def _method_arguments(node: Call) -> list[AST]:
    """The arguments of a method; `reshape` and `transpose` take the items of a tuple one by one, too."""
    several = node.func.attr in _SHAPED and len(node.args) > 1
    return [tuple_of(*node.args)] if several else node.args


def _array_call(node: Call) -> AST | None:
    rule = rules.find_array(call_name(node))
    ordered = rule and rules.bound(rule, node)
    if ordered is None:
        return None
    keywords = [rebuild(k, _canonical) for k in ordered.keywords]
    return at(Call(ordered.func, [rebuild(a, _canonical) for a in ordered.args], keywords), node)


def _block(node: Call) -> AST | None:
    """`np.block` of rows of matrices."""
    if call_name(node) != "numpy.block" or len(node.args) != 1 or not isinstance(node.args[0], List):
        return None
    rows = node.args[0].elts
    if not rows or not all(isinstance(row, List) for row in rows):
        return None
    return call("numpy.concatenate", tuple_of(*(call("numpy.concatenate", tuple_of(*row.elts), axis=const(1))
                                                for row in rows)))


def _clip(node: Call) -> AST | None:
    """`np.clip` by name, or with one bound: the other one is None."""
    if call_name(node) != "numpy.clip" or not 1 <= len(node.args) <= 3:
        return None
    sides: dict[str, AST] = dict(zip(("low", "high"), node.args[1:]))
    spelling = {"a_min": "low", "a_max": "high", "min": "low", "max": "high"}
    for k in node.keywords:
        if k.arg not in spelling or spelling[k.arg] in sides:
            return None
        sides[spelling[k.arg]] = k.value
    bounds = {k: v for k, v in sides.items() if not (isinstance(v, Constant) and v.value is None)}
    if len(bounds) == 2:
        return call("numpy.clip", node.args[0], bounds["low"], bounds["high"]) if node.keywords else None
    if not bounds:
        return None
    (side, bound), = bounds.items()
    return call("numpy.maximum" if side == "low" else "numpy.minimum", node.args[0], bound)


def _multi_dot(node: Call) -> AST | None:
    """The product of several matrices, from the left."""
    several = call_name(node) == "numpy.linalg.multi_dot" and len(node.args) == 1 and not node.keywords
    if not several or not isinstance(node.args[0], (List, Tuple)) or len(node.args[0].elts) < 2:
        return None
    return reduce(lambda a, b: call("numpy.matmul", a, b), node.args[0].elts)


def _item_reduction(node: Call) -> AST:
    """The minimum, the maximum or the sum of the items of one sequence; Python's sum adds rows."""
    sums = call_name(node) == "builtins.sum"
    items = node.args[0].elts if isinstance(node.args[0], (Tuple, List)) else []
    if len(items) > (not sums) and not any(isinstance(item, Starred) for item in items):
        joined = reduce(add, items, sum_start(len(items))) if sums else Call(node.func, items, [])
        return rebuild(at(joined, node), _canonical)
    if sums:
        return rebuild(at(call("numpy.sum", node.args[0], axis=const(0)), node), _canonical)
    called = "numpy.max" if call_name(node) == "builtins.max" else "numpy.min"
    return rebuild(at(call(called, node.args[0]), node), _canonical)


def _scalar_call(node: Call) -> AST | None:
    function = call_name(node)
    if node.keywords:
        return None
    if function in {*_PAIRED, "builtins.sum"} and len(node.args) == 1:
        return _item_reduction(node)
    if function == "builtins.sum" and len(node.args) == 2:
        several, first = node.args
        if isinstance(several, (Tuple, List)) and not any(isinstance(item, Starred) for item in several.elts):
            return rebuild(at(reduce(add, several.elts, first), node), _canonical)
        total = _item_reduction(at(Call(node.func, [several], []), node))
        return at(add(rebuild(first, _canonical), total), node)
    if function in _PAIRED and len(node.args) > 2:
        return at(reduce(lambda a, b: call(function, a, b), [rebuild(a, _canonical) for a in node.args]), node)
    if function == "math.log" and len(node.args) == 2:
        number, base = (call(function, rebuild(a, _canonical)) for a in node.args)
        return at(BinOp(number, Div(), base), node)
    if function == "math.prod" and len(node.args) == 1 and isinstance(node.args[0], (Tuple, List)):
        items = [rebuild(a, _canonical) for a in node.args[0].elts]
        if not any(isinstance(item, Starred) for item in items):
            return at(reduce(mult, items if len(items) > 1 else [const(1), *items]), node)
    return None
