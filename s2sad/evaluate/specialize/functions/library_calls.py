"""Calls of functions of libraries: done here over what is known, else left to the residual program.
"""
from __future__ import annotations

import builtins
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.functions.known_options import with_known_options
from s2sad.evaluate.specialize.functions.random_calls import random_call
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.sequences.known_shapes import of_call, origins, shape
from s2sad.evaluate.specialize.sequences.generators import LAZY
from s2sad.evaluate.specialize.values import (
    WITH_NONE, Data, Iteration, OpaqueValue, Reference, TupleValue, Value, constant,
)
from s2sad.tree import AST

Args = list[Value]
Options = dict[str, Value]
Known = Callable[[Evaluator, Args, Options, AST, Frame], "Value | None"]
FUNCTIONS: dict[str, Known] = {}
_MOST_SECTIONS = 16     # of which each is an expression of its own
_OF_PLACES = ("numpy.take", "numpy.take_along_axis", "numpy.delete", "numpy.put")
_STOPPING = ("builtins.any", "builtins.all", "builtins.next")       # go no further than the first item that decides


def function(*paths: str) -> Callable[[Known], Known]:
    """Registers what is done where the arguments are known; None leaves the call to the residual program."""
    def register(made: Known) -> Known:
        FUNCTIONS.update(dict.fromkeys(paths, made))
        return made
    return register


@operation
def library_call(ev: Evaluator, path: str, args: Sequence[Value], keywords: Mapping[str, Value], node: AST, f: Frame
                 ) -> Value:
    """A call of a library's function; a part of a list of the run is a list of its own."""
    args = [ev.copied_part(a, "part", node) or a if isinstance(a, Data) and a.is_list else a for a in args]
    known = FUNCTIONS.get(path)
    if known is not None:
        ev.called = path.rpartition(".")[2]
        before = ev.snapshot()
        try:
            found = known(ev, list(args), dict(keywords), node, f)
        except Unevaluated as first:
            ev.restore(before)
            if any(isinstance(a, Iteration) and a.kind in ("map", "filter") for a in args):
                return library_call(ev, path, [ev.as_comprehension(a, node, f) for a in args], keywords, node, f)
            if not any(isinstance(a, Iteration) and a.kind == "generator" for a in args):
                raise
            args = [ev.listed(a, node, f) for a in args]
            if path in _STOPPING and ev.has_acted(before):
                raise       # Python does no more than it needs to
            ev.called = path.rpartition(".")[2]
            try:
                found = known(ev, list(args), dict(keywords), node, f)
            except Unevaluated:
                raise first from None       # which says what would help
        if found is not None:
            return found
    written = ev.written_function(path, args, keywords, node, f)
    if written is not None:
        return written
    array = ev.constant_array(path, args, keywords) if ev.evaluates_module else None
    if array is not None:
        return array
    if path.startswith(("numpy.random.", "random.")):
        found = random_call(ev, path, args, keywords, node, f)
        if found is not None:
            return found
        called = node.func if isinstance(node, tree.Call) else node
        raise ev.outside_error(called, f"'{tree.written(called)}' draws random numbers, or begins a sequence of them",
                               "begin it in the kernel, rng = np.random.default_rng(1), or draw them before and give "
                               "them to the kernel as an argument: both sweeps read the same ones")
    if path.startswith("scipy.sparse."):
        ev.refused_sparse(path, False, node)
    if path.startswith(("builtins.", "math.")):
        constants = _constant(ev, path, args, keywords, node)
        if constants is not None:
            return constants
    of_list = path in ("numpy.array", "numpy.asarray") and args and ev.is_spelled_out(args[0])
    if of_list and _has_none(ev, args[0]):
        return OpaqueValue(WITH_NONE)
    args = [_as_array(ev, path, a, node, f) for a in args]
    args, keywords = with_known_options(ev, path, args, keywords, node)
    made = ev.residual_call(tree.at(tree.name(ev.library(path)), node), args, keywords, node)
    spelled = [TupleValue(tuple(ev.sequence_items(a))) if isinstance(a, Reference) and ev.is_spelled_out(a) else a
               for a in args]
    found = _of_list(ev, args[0]) if of_list else of_call(path, spelled, keywords)
    return replace(made, shape=found, origins=origins(*args), count=_results(path, args, keywords),
                   is_list=path in ("builtins.list", "builtins.sorted"))


def _has_none(ev: Evaluator, value: Value) -> bool:
    """Whether None stands in a list, or in a list in it, for what is to come."""
    if ev.is_spelled_out(value):
        return any(_has_none(ev, v) for v in ev.sequence_items(value))
    return isinstance(value, Data) and value.is_known and value.known is None


def _of_list(ev: Evaluator, value: Value) -> tuple[int | None, ...] | None:
    """The shape of an array that is made of a list."""
    if not ev.is_spelled_out(value):
        return shape(value)
    shapes = {_of_list(ev, v) for v in ev.sequence_items(value)}
    inner = shapes.pop() if len(shapes) == 1 else None
    return None if inner is None else (len(ev.sequence_items(value)), *inner)


_RESULTS = {"lstsq": 4, "qr": 2, "svd": 3, "slogdet": 2, "eigh": 2, "eig": 2}      # of numpy.linalg


def _results(path: str, args: Sequence[Value], keywords: Mapping[str, Value]) -> int | None:
    """How many results a function gives whose result is a tuple."""
    root, _, name = path.rpartition(".")
    plain = name == "lstsq" or len(args) == 1 and not keywords
    return _RESULTS.get(name) if root == "numpy.linalg" and plain else None


_PURE = ("abs", "min", "max", "round", "float", "int", "bool", "pow", "divmod", "complex", "str", "repr", "chr", "ord",
         "format", "ascii", "bin", "hex", "oct", "hash")


def _constant(ev: Evaluator, path: str, args: Sequence[Value], keywords: Mapping[str, Value], node: AST
              ) -> Value | None:
    """A function of Python's of what is known; None where something is not, or where it would raise."""
    room, _, name = path.rpartition(".")
    made = getattr(math if room == "math" else builtins, name, None)
    if room == "builtins" and name not in _PURE or made is None:
        return None
    values = [_known_value(ev, a) for a in (*args, *keywords.values())]
    if not values or any(v is _NOT for v in values):
        return None
    if room == "math" and not all(isinstance(v, int) for v in values):
        return None         # of floats: the run's own
    try:
        found = made(*values[:len(args)], **dict(zip(keywords, values[len(args):])))
    except (ArithmeticError, ValueError, TypeError) as error:
        ev.throws(type(error), node)
        return None
    if isinstance(found, tuple):
        return TupleValue(tuple(map(constant, found)))
    return constant(found) if isinstance(found, (bool, int, float, str)) else None


_NOT: Any = object()


def _known_value(ev: Evaluator, value: Value) -> Any:
    if isinstance(value, Data):
        return value.known if value.is_known else _NOT
    items = value.items if isinstance(value, TupleValue) else list(
        ev.heap[value].items.values()) if isinstance(value, Reference) and ev.heap[value].kind == "list" else None
    found = [_known_value(ev, v) for v in items] if items is not None else [_NOT]
    return _NOT if any(v is _NOT for v in found) else tuple(found)


def _as_array(ev: Evaluator, path: str, value: Value, node: AST, f: Frame) -> Value:
    """What is gone through by a function of arrays, written out; the array of a range."""
    if isinstance(value, Iteration) and value.kind == "range" and path in _OF_PLACES:
        return library_call(ev, "numpy.arange", value.parts, {}, node, f)
    lazy = isinstance(value, Iteration) and value.kind in (
        *LAZY, "map", "filter", "keys", "values", "items", "zip", "enumerate")
    if lazy and not (path.startswith("builtins.") and ev.stays_one(value)):
        return ev.listed(value, node, f)
    return value


@function("numpy.split", "numpy.array_split", "numpy.hsplit", "numpy.vsplit")
def _sections(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    """A list of as many parts as are asked for, where their number is known."""
    given = args[1] if len(args) > 1 else options.get("indices_or_sections")
    ends = given.items if isinstance(given, TupleValue) else ev.sequence_items(given) if isinstance(
        given, Reference) and ev.is_spelled_out(given) else None
    count = len(ends) + 1 if ends is not None else given.known if isinstance(given, Data) else None
    if isinstance(given, Data) and not given.is_known and given.demands:
        raise ev.unknown(node, "how many parts there are must be known before the run", given)
    if type(count) is not int or not 0 < count <= _MOST_SECTIONS:
        return None
    return _parts(ev, count, "sections", args, options, node, f)


@function("numpy.roll")
def _rolled(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    """Shifts along several axes that are an array, one by one."""
    rest = [*args[2:], *(v for k, v in options.items() if k == "axis")]
    shift = args[1] if len(args) > 1 else options.get("shift")
    if not (isinstance(shift, Data) and shift.shape != () and rest and isinstance(rest[0], TupleValue)):
        return None
    if len(shape(shift) or ()) != 1:
        return None
    shifts = TupleValue(tuple(ev.item_of(shift, constant(k), node, f) for k in range(len(rest[0].items))))
    return library_call(ev, "numpy.roll", [args[0], shifts, rest[0]], {}, node, f)


@function("numpy.meshgrid")
def _grid(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    """A list of an array for each axis."""
    args = [a if isinstance(a, Data) else library_call(ev, "numpy.array", [a], {}, node, f) for a in args]
    sparse, way = options.get("sparse"), options.get("indexing", constant("xy"))
    if isinstance(sparse, Data) and sparse.known is True and isinstance(way, Data) and way.known in ("xy", "ij"):
        order = [*range(len(args))]
        order[:2] = reversed(order[:2]) if way.known == "xy" else order[:2]
        return ev.list_of([_along(ev, a, order[k], len(args), node, f) for k, a in enumerate(args)], node)
    ev.called = "meshgrid"
    return _parts(ev, len(args), "grid", args, options, node, f)


def _along(ev: Evaluator, vector: Value, axis: int, rank: int, node: AST, f: Frame) -> Value:
    """A copy of a vector along one of so many axes."""
    sizes = TupleValue(tuple(constant(-1 if k == axis else 1) for k in range(rank)))
    laid = library_call(ev, "numpy.reshape", [vector, sizes], {}, node, f)
    return library_call(ev, "numpy.copy", [laid], {}, node, f)


def _parts(ev: Evaluator, count: int, wanted: str, args: Args, options: Options, node: AST, f: Frame) -> Value:
    """A list of what a function gives that gives so many arrays."""
    called = tree.at(tree.name(ev.library(f"numpy.{ev.called}")), node)
    args, options = with_known_options(ev, f"numpy.{ev.called}", args, options, node)
    whole = ev.named(ev.residual_call(called, args, options, node), wanted, node)
    return ev.list_of([ev.item_of(whole, constant(k), node, f) for k in range(count)], node)


@function("numpy.ix_")
def _open_mesh(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    """The subscripts of the elements in some rows and columns."""
    if len(args) != 2:
        return None
    rows, columns = (a if isinstance(a, Data) and not a.is_list else library_call(
        ev, "numpy.array", [a], {}, node, f) for a in args)
    whole, new = tree.Slice(None, None, None), tree.const(None)
    return TupleValue((Data(tree.at(tree.index(ev.spelled(rows, node), whole, new), node)),
                       Data(tree.at(tree.index(ev.spelled(columns, node), new, whole), node))))
