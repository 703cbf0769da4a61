"""random_calls: sequences of random numbers that a kernel begins, by what `random_numbers` says of them."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from s2sad.evaluate.library import random_numbers
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.separate.call_view import Changes
from s2sad.evaluate.specialize.values import NONE, Data, Value
from s2sad.tree import AST

_CLASSES: dict[str, Any] = {"numpy.random.default_rng": random_numbers.Generator,
                            "numpy.random.RandomState": random_numbers.RandomState}


def random_call(ev: Evaluator, path: str, args: Sequence[Value], keywords: Mapping[str, Value], node: AST, f: Frame
                ) -> Value | None:
    """What a function of `numpy.random` gives; None for one that is not known, or goes on from a sequence that was not
    begun in the kernel."""
    name = path.rpartition(".")[2]
    if path in _CLASSES:
        if len(args) + len(keywords) != 1 or any(
                isinstance(a, Data) and a.is_known and a.known is None for a in (*args, *keywords.values())):
            return None
        return ev.constructed(ev.outside_value(name, _CLASSES[path], node, f), args, keywords, node, f)
    if not path.startswith("numpy.random.") or name not in vars(random_numbers.RandomState) | vars(
            random_numbers.Sequence) or name.startswith("_"):
        return None
    if ev.separate is not None and ev.separate.underway:
        raise Changes("it draws from the sequence that all share")
    shared = ev.shared_sequence
    if shared is None or shared.number not in ev.heap.objects:
        if name != "seed":
            return None
        if ev.guarded:      # it must have been begun, on whichever way
            raise ev.refusal(node, "the sequence that all share is begun in a loop or a branch",
                             help="make one of its own: rng = np.random.default_rng(seed)")
        ev.shared_sequence = random_call(ev, "numpy.random.RandomState", args, keywords, node, f)
        return None if ev.shared_sequence is None else NONE
    return ev.call(ev.attribute_of(shared, name, node, f), args, keywords, node, f)
