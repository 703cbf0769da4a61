"""known_options: options of NumPy's functions are written in the residual program; of axes all must be known.

    for d in range(2):                          b = np.roll(a, 1, axis=0)
        b = np.roll(a, 1, axis=d)       ->      b = np.roll(a, 1, axis=1)
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from s2sad.evaluate.argument_binding import AXES, OPTIONS, parameters_of_library
from s2sad.evaluate.specialize.evaluator import Evaluator, is_spelled
from s2sad.evaluate.specialize.values import Data, TupleValue, Value, constant
from s2sad.tree import AST, Call


def with_known_options(ev: Evaluator, path: str, args: Sequence[Value], keywords: Mapping[str, Value], node: AST,
                       is_method: bool = False) -> tuple[list[Value], dict[str, Value]]:
    """The arguments with options as the constants that they are; raises Unevaluated for an axis that is not known."""
    names = parameters_of_library(path)[is_method:]
    if not path.startswith("numpy.") or not OPTIONS & {*names, *keywords}:
        return list(args), dict(keywords)
    places = node.args if isinstance(node, Call) and len(node.args) == len(args) else [node] * len(args)
    named = {k.arg: k.value for k in node.keywords} if isinstance(node, Call) else {}
    found = [_written(ev, path, n, v, p) for n, v, p in zip(names, args, places)]
    return [*found, *args[len(found):]], {k: _written(ev, path, k, v, named.get(k, node)) for k, v in keywords.items()}


def _written(ev: Evaluator, path: str, option: str, value: Value, place: AST) -> Value:
    if option not in OPTIONS:
        return value
    if isinstance(value, TupleValue):
        return replace(value, items=tuple(_written(ev, path, option, v, place) for v in value.items))
    if not isinstance(value, Data):
        return value
    if value.is_known:
        return constant(value.known) if is_spelled(value.known) else value
    if option not in AXES:
        return value
    called = "axis" if option.startswith("axis") else "axes" if option == "axes" else f"{option} axes"
    raise ev.unknown(place, f"the {called} of {path} must be a number that is written in the kernel", value,
                     help="write it, or a name that is bound once, to a number: np.sum(x, axis=1)", code="S301")
