"""order: the loops whose iterations may run in any order, so that the reverse sweep need not run them backwards.

Requires the structure table and the plan; a loop is free if no number and no element flows between its iterations,
except sums. What a sum overwrites may be recorded: it is restored last first, so that such a sum counts as a store.
Forwards is the order that compilers vectorise and memory prefetches.
"""
from __future__ import annotations

from s2sad.analyze.dependence import Reference
from s2sad.analyze.liveness import base_name
from s2sad.analyze.plan import Plan, Question, by_key, reads
from s2sad.analyze.structure import Place
from s2sad.analyze.values import Values
from s2sad.tree import AugAssign, Break, For


def order_free(question: Question, plan: Plan) -> frozenset[int]:
    """The ids of the loops whose iterations the reverse sweep may run in any order."""
    structure, values = question.structure, Values(question.structure)
    recorded = {id(store.statement) for store in plan.stores.values()}
    found: set[int] = set()
    for place in structure.places.values():
        loop = place.statement
        if isinstance(loop, For) and not _carries(loop, values) and not _breaks(loop, question):
            if _independent(loop, question, recorded):
                found.add(id(loop))
    return frozenset(found)


def _carries(loop: For, values: Values) -> bool:
    return any(x is loop and not all(isinstance(b, AugAssign) for b in values.structure.bindings[n][1:])
               for n, x in values.loops.items())


def _breaks(loop: For, question: Question) -> bool:
    return any(isinstance(p.statement, Break) and p.loops[-1] is loop for p in question.structure.inner[id(loop)])


def _independent(loop: For, question: Question, recorded: set[int]) -> bool:
    typing, dependence, inner = question.structure.typing, question.dependence, question.structure.inner[id(loop)]

    def is_sum(place: Place) -> bool:
        return isinstance(place.statement, AugAssign) and id(place.statement) not in recorded

    sums = [Reference.to(t, p.statement) for p in inner if is_sum(p) for t in question.writes(p.statement)]
    stores = [Reference.to(t, p.statement) for p in inner if not is_sum(p) for t in question.writes(p.statement)]
    loads = [Reference.to(x, p.statement) for p in inner for x in reads(p.statement, typing) if base_name(x)]
    stored, loaded, summed = (by_key(found, lambda r: r.array) for found in (stores, loads, sums))
    pairs = [(s, x) for s in stores for them in (stored, loaded, summed) for x in them.get(s.array, ())]
    pairs += [(s, x) for s in sums for x in loaded.get(s.array, ())]
    return not any(dependence.carried(a, b, loop) or dependence.carried(b, a, loop) for a, b in pairs)
