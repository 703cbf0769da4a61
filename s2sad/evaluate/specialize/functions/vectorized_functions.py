"""vectorized_functions: a function that np.vectorize has element by element, where its results are floats.

    f = np.vectorize(lambda v, k: v / k)        y = np.reshape(np.array([v / 2.0 for v in np.ravel(x)]), np.shape(x))
    y = f(x, 2.0)

NumPy gives all results the type of the first one: what a function returns must be a float by its text, or `otypes` says
so.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.functions.library_calls import Args, Options, function, library_call
from s2sad.evaluate.specialize.sequences.known_shapes import shape
from s2sad.evaluate.specialize.values import Data, FunctionValue, LibraryValue, Reference, TupleValue, Value, constant
from s2sad.live_objects.guards import taken
from s2sad.tree import AST

_OF_FLOATS = ("exp", "expm1", "log", "log1p", "log10", "log2", "sqrt", "sin", "cos", "tan", "arcsin", "arccos",
              "arctan", "asin", "acos", "atan", "arctan2", "atan2", "sinh", "cosh", "tanh", "hypot", "cbrt")
_SAID = "np.vectorize gives all results the type of the first one, which is not seen to be a float"
_HELP = "say the type, np.vectorize(f, otypes=[float]), or write a comprehension: np.array([f(v) for v in x])"


@operation
def live_vectorized(ev: Evaluator, value: Any, name: str, node: AST, f: Frame) -> Value:
    """An object that np.vectorize has made outside of the kernel."""
    types = taken(value, "attribute", "otypes")
    if taken(value, "attribute", "signature") is not None or taken(value, "attribute", "excluded"):
        raise ev.outside_error(node, f"'{name}' is np.vectorize with a signature, or with arguments left out",
                               "write a loop")
    inner = ev.outside_value(name, taken(value, "attribute", "pyfunc"), node, f)
    return _vectorized(ev, inner, types is not None and [*types] in ([numpy.dtype(float)], ["d"]), node)


@function("numpy.vectorize")
def _vectorize(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    if not args and options.keys() <= {"otypes"}:       # a decorator
        return LibraryValue("numpy.vectorize", (), tuple(options.items()))
    types = options.get("otypes")
    said = ev.items_of(types, node, f) if isinstance(types, (Reference, TupleValue)) else []
    if len(args) != 1 or options.keys() - {"otypes"}:
        raise ev.refusal(node, "np.vectorize with other options than otypes", help="write a loop")
    return _vectorized(ev, args[0], said in ([LibraryValue("builtins.float")], [LibraryValue("numpy.float64")]), node)


def _vectorized(ev: Evaluator, inner: Value, are_said: bool, node: AST) -> Value:
    if not are_said and not (isinstance(inner, FunctionValue) and _gives_floats(ev, inner)):
        raise ev.refusal(node, _SAID, help=_HELP)
    return LibraryValue("numpy.vectorized", (inner,))


@function("numpy.vectorized")
def _called(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    """The results for arrays that are repeated along each other, and numbers."""
    inner, *given = args
    given = [a if isinstance(a, Data) else library_call(ev, "numpy.array", [a], {}, node, f) for a in given]
    if options:
        raise ev.refusal(node, "np.vectorize called with keywords", help="give the arguments by position")
    numbers = [shape(a) == () for a in given]
    if all(numbers):
        return ev.call(inner, given, {}, node, f)
    return ev.written_function("numpy.vectorized", [inner, TupleValue(tuple(map(constant, numbers))), *given], {}, node,
                               f)


# -- what a function returns, by its text ------------------------------------------------------------------------------
def _gives_floats(ev: Evaluator, inner: FunctionValue) -> bool:
    definition = inner.captured.tree
    if isinstance(definition.body, list):
        nodes = [n for s in definition.body for n in tree.walk(s)]
        if any(type(n).__name__ in ("FunctionDef", "Lambda", "Yield", "YieldFrom") for n in nodes):
            return False
        returned = [n.value for n in nodes if isinstance(n, tree.Return)]
        bound = dict(_bindings(nodes))
    else:
        returned, bound = [definition.body], {}
    before = ev.snapshot()
    frame = ev.frame_of(inner, definition)
    found = bool(returned) and all(_is_float(ev, r, bound, frame) for r in returned)
    ev.restore(before)
    return found


def _bindings(nodes: list[AST]) -> Iterator[tuple[str, AST | None]]:
    """What names are bound to that are bound once, by a plain assignment."""
    stored = [n.id for n in nodes if isinstance(n, tree.Name) and isinstance(n.ctx, tree.Store)]
    for n in nodes:
        if isinstance(n, tree.Assign) and isinstance(n.targets[0], tree.Name) and stored.count(n.targets[0].id) == 1:
            yield n.targets[0].id, n.value


def _is_float(ev: Evaluator, node: AST | None, bound: Mapping[str, AST | None], frame: Frame) -> bool:
    if isinstance(node, tree.Constant):
        return type(node.value) is float
    if isinstance(node, tree.IfExp):
        return _is_float(ev, node.body, bound, frame) and _is_float(ev, node.orelse, bound, frame)
    if isinstance(node, tree.BinOp):
        return isinstance(node.op, tree.Div) or any(_is_float(ev, n, bound, frame) for n in (node.left, node.right))
    if isinstance(node, tree.UnaryOp):
        return not isinstance(node.op, tree.Not) and _is_float(ev, node.operand, bound, frame)
    if isinstance(node, tree.Name):
        return node.id in bound and _is_float(ev, bound[node.id], bound, frame)
    if not isinstance(node, tree.Call) or not isinstance(node.func, (tree.Name, tree.Attribute)):
        return False
    called = ev.value(node.func, frame) if not {*tree.names(node.func)} & frame.local else None
    path = called.path if isinstance(called, LibraryValue) else ""
    return path == "builtins.float" or path.rpartition(".")[0] in ("numpy", "math") and path.rpartition(".")[
        2] in _OF_FLOATS
