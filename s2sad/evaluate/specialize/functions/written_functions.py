"""written_functions: calls of functions that `evaluate/library/` says, and of those that are constant.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy

from s2sad import tree
from s2sad.evaluate.library import WITH_OPTION, WRITTEN, arrays
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.functions.library_calls import Args, Options, function, library_call
from s2sad.evaluate.specialize.values import Data, Iteration, TupleValue, Value, constant
from s2sad.evaluate.specialize.sequences.known_shapes import shape
from s2sad.read.outside_values import library_value
from s2sad.tree import AST, placed, walk

_ROOMS = [f"numpy.polynomial.{room}" for room in ("legendre", "chebyshev", "hermite", "hermite_e", "laguerre")]
_MOST_POINTS = 64       # of a quadrature, which are written out


@operation
def written_function(ev: Evaluator, path: str, args: Sequence[Value], keywords: Mapping[str, Value], node: AST, f: Frame
                     ) -> Value | None:
    """What a function gives that is written in Python; None for any other one."""
    made = WRITTEN.get(path) or _by_arguments(path, args, keywords)
    return None if made is None else called_here(ev, made, args, keywords, node, f)


@operation
def called_here(ev: Evaluator, made: Callable[..., Any], args: Sequence[Value], keywords: Mapping[str, Value],
                node: AST, f: Frame) -> Value:
    """What a function of ours gives that is read as one of the user's is; what it says is said of the call."""
    found = ev.call(ev.outside_value(made.__name__, made, node, f), args, keywords, node, f)
    return _told_here(ev, found, node) if isinstance(found, Iteration) and found.kind == "yields" else found


def _told_here(ev: Evaluator, generator: Iteration, node: AST) -> Iteration:
    """A generator whose statements stand at the call, for what is said of them."""
    frame, definition = generator.more
    if (node, definition.name) not in ev.loops_of:
        text = tree.copy(definition)
        for n in walk(text):
            placed(n, node)
        ev.loops_of[node, definition.name] = text
    return replace(generator, more=(frame, ev.loops_of[node, definition.name]))


def _by_arguments(path: str, args: Sequence[Value], keywords: Mapping[str, Value]) -> Callable[..., Any] | None:
    """The function that is for arguments which the function's own rule does not know."""
    made, options = WITH_OPTION.get(path, (None, ()))
    if made is not None and any(k in keywords for k in options):
        return made
    if path == "numpy.expand_dims" and isinstance(_at(args, keywords, 1, "axis"), TupleValue):
        return arrays.expand_dims
    if path == "numpy.unravel_index" and len(args) == 2 and not keywords and (
            isinstance(args[1], TupleValue) or isinstance(args[1], Data) and args[1].count is not None):
        return arrays.unravel_index
    if path == "numpy.stack" and _at(args, keywords, 1, "axis") is not None and isinstance(args[0], Data) and (
            args[0].is_list):
        return arrays.stack
    if path == "numpy.linspace" and any(shape(a) or isinstance(a, TupleValue) for a in (
            _at(args, keywords, 0, "start"), _at(args, keywords, 1, "stop")) if a is not None):
        return arrays.linspace
    return None


def _at(args: Sequence[Value], keywords: Mapping[str, Value], place: int, name: str) -> Value | None:
    return args[place] if len(args) > place else keywords.get(name)


@function("numpy.append")
def _append(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    """Along an axis it is a concatenation."""
    axis = _at(args, options, 2, "axis")
    if len(args) < 2 or axis is None or isinstance(axis, Data) and axis.is_known and axis.known is None:
        return None
    return library_call(ev, "numpy.concatenate", [TupleValue(tuple(args[:2]))], {"axis": axis}, node, f)


@function("numpy.polynomial.legendre.leggauss", "numpy.polynomial.chebyshev.chebgauss",
          "numpy.polynomial.hermite.hermgauss", "numpy.polynomial.hermite_e.hermegauss",
          "numpy.polynomial.laguerre.laggauss")
def _quadrature(ev: Evaluator, args: Args, options: Options, node: Any, f: Frame) -> Value:
    """Points and weights, of which there are as many as is known."""
    room = next(r for r in _ROOMS if hasattr(library_value(r), ev.called))
    count = ev.known([*args, *options.values()][0], node, "the number of points")
    if not 0 < count <= _MOST_POINTS:
        raise ev.refusal(node, f"a quadrature of {count} points", help=f"take {_MOST_POINTS} at most")
    both = getattr(library_value(room), ev.called)(count)
    return TupleValue(tuple(library_call(ev, "numpy.array", [TupleValue(tuple(constant(float(v)) for v in row))], {},
                                         node, f) for row in numpy.asarray(both)))
