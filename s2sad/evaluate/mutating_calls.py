"""mutating_calls: calls that write one of their arguments are stores.

    x.fill(v)                           x[...] = v
    np.copyto(x, v, where=m)            x[...] = np.where(m, v, x)
    np.exp(u, out=x)                    x[...] = np.exp(u)
    np.add(u, v, x)                     x[...] = np.add(u, v)
    np.divide(u, v, out=x, where=m)     x[...] = np.where(m, np.divide(u, v), x)
    a.sum(axis=0, out=x)                x[...] = a.sum(axis=0)
    np.nan_to_num(x, copy=False)        x[...] = np.nan_to_num(x)
    x.sort()                            x[...] = np.sort(x)
    np.fill_diagonal(x, v)              x[...] = np.fill_diagonal(x, v)
    np.add.at(x, k, v)                  x[...] = np.add.at(x, k, v)

The last two have no result in NumPy: here it is `x` as they leave it, and `pieces` writes them out on `x` itself.
"""
from __future__ import annotations

import numpy

from s2sad.read.outside_values import library_value
from s2sad.rules.composed import WRITING
from s2sad.tree import (
    AST, Attribute, Call, Constant, List, Name, Subscript, Tuple, at, call, call_name, const, copy, index, keyword,
    name,
)

# where `out` stands; after the operands of ufuncs
_POSITIONAL = {"numpy.dot": 2, "numpy.matmul": 2, "numpy.clip": 3, "numpy.max": 2, "numpy.min": 2, "numpy.amax": 2,
               "numpy.amin": 2, "numpy.round": 2, "numpy.around": 2, "numpy.any": 2, "numpy.all": 2, "numpy.sum": 3,
               "numpy.mean": 3, "numpy.prod": 3, "numpy.cumsum": 3, "numpy.cumprod": 3, "numpy.var": 3, "numpy.std": 3}
_LIBRARIES = ("numpy.", "scipy.special.")
# what NumPy writes by the number of an element in the order of rows: said, and what to write instead
UNSUPPORTED = {"numpy.place": "write x[mask] = values",
               "numpy.put_along_axis": "write a loop that stores the elements"}


def stored_by_call(node: Call) -> tuple[AST, AST] | None:
    """The place that a call fills and what it fills it with; None if it is no such call."""
    called = call_name(node)
    if isinstance(node.func, Attribute) and node.func.attr == "fill" and len(node.args) == 1 and not node.keywords:
        return _whole(node.func.value), node.args[0]
    if isinstance(node.func, Attribute) and node.func.attr == "sort" and len(node.args) < 2:
        return _whole(node.func.value), at(Call(name("numpy.sort"), [copy(node.func.value), *node.args],
                                                node.keywords), node)
    if isinstance(node.func, Attribute) and node.func.attr == "put" and len(node.args) == 2 and not node.keywords:
        return _whole(node.func.value), at(call("numpy.put", copy(node.func.value), *node.args), node)
    if called == "numpy.place" and (value := _one(node)) is not None:
        return _whole(node.args[0]), at(call("numpy.putmask", *node.args[:2], value), node)
    if called == "numpy.copyto" and len(node.args) == 2:
        return _copied(node)
    if called in WRITING and node.args:
        return _whole(node.args[0]), node
    return stored_out(node)


def stored_out(node: AST) -> tuple[AST, AST] | None:
    """The same for a call that is given an array for its result."""
    called = call_name(node) or ""
    method = isinstance(node, Call) and isinstance(node.func, Attribute)
    if not isinstance(node, Call) or not (called.startswith(_LIBRARIES) or method):
        return None
    place = _position(called)
    given = {k.arg: k.value for k in node.keywords}
    out, args = given.pop("out", None), node.args
    if (own := changed(node)) is not None:
        others = [keyword(k, v) for k, v in zip(("nan", "posinf", "neginf"), node.args[2:])]
        return _whole(own), at(Call(node.func, [own], [*others, *(k for k in node.keywords if k.arg != "copy")]), node)
    if isinstance(out, Tuple) and len(out.elts) == 1:
        out = out.elts[0]
    if out is None and place is not None and len(args) == place + 1:
        args, out = args[:place], args[place]
    if out is None or isinstance(out, Constant) and out.value is None:
        return None
    # of a reduction `where` picks what is reduced
    elementwise = called.startswith("scipy.") or isinstance(library_value(called), numpy.ufunc)
    where = given.pop("where", None) if elementwise else None
    keywords = [k for k in node.keywords if k.arg in given]
    value = at(Call(node.func, args, keywords), node)
    return _whole(out), value if where is None else at(call("numpy.where", where, value, copy(out)), node)


def changed(node: AST) -> AST | None:
    """The array that a call leaves its result in, as it is told not to copy; None if there is no such array."""
    if call_name(node) != "numpy.nan_to_num" or not isinstance(node, Call) or not node.args:
        return None
    copies = [*node.args[1:2], *(k.value for k in node.keywords if k.arg == "copy")]
    kept = any(isinstance(c, Constant) and c.value is False for c in copies)
    return node.args[0] if kept and isinstance(node.args[0], (Name, Subscript, Attribute, Call)) else None


def _position(called: str) -> int | None:
    """The number of the argument that may be the array for the result."""
    found = library_value(called)
    return found.nin if isinstance(found, numpy.ufunc) and found.nout == 1 else _POSITIONAL.get(called)


def _one(node: Call) -> AST | None:
    """The one value that `np.place` repeats."""
    written = len(node.args) == 3 and not node.keywords and isinstance(node.args[2], (List, Tuple))
    return node.args[2].elts[0] if written and len(node.args[2].elts) == 1 else None


def _copied(node: Call) -> tuple[AST, AST] | None:
    target, value = node.args
    given = {k.arg: k.value for k in node.keywords}
    if not given:
        return _whole(target), value
    return (_whole(target), at(call("numpy.where", given["where"], value, copy(target)), node)) \
        if given.keys() == {"where"} else None


def _whole(target: AST) -> AST:
    return index(target, const(...))
