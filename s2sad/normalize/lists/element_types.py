"""element_types: what lies in a list lies in one array here, of one number of axes and one dtype; where that would
tell, it is refused. (That the rows have one size, `views` sees to.)

    us = [2.0 * x]
    us.append(0.5)              refused: a row of the array would be filled with it

Requires structured form and types. Changes nothing.
"""
from __future__ import annotations

from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.normalize.lists.lists_of_views import ListContents, Writes
from s2sad.tree import FunctionDef, name, walk

_HELP = "give them names of their own, or make an array of each that is like the others"


def element_types(function: FunctionDef, typing: Typing, writes: Writes, report: Report) -> None:
    """Puts into the report what is put into a list and is not like what else it holds."""
    held = ListContents(function, typing, writes)
    for listed, stores in held.stores.items():
        row = typing.of(name(listed))
        if row.rank < 2:
            continue
        kinds = [typing.of(s.value) for s in stores]
        written = len({k.dtype for k in kinds if k.is_array}) > 1 and _is_written(listed, held)
        for store, kind in zip(stores, kinds):
            if kind.is_number or kind.is_array and kind.rank != row.rank - 1:
                report.error("S201", f"the list {listed!r} holds arrays of several numbers of axes", store, help=_HELP)
            elif kind.is_array and kind.dtype != row.dtype and (written or _is_single(kind, row)):
                report.error("S201", f"the list {listed!r} holds arrays of several dtypes", store, help=_HELP)


def _is_single(*kinds: Type) -> bool:
    return any(k.dtype == "float32" for k in kinds)


def _is_written(listed: str, held: ListContents) -> bool:
    """Whether an array that the list holds is written by the list, or under a name."""
    own, filling = held.views_of({listed}), {id(s) for s in held.stores[listed]}
    return any(id(s) not in filling and held.written(s) & own for s in walk(held.function.body))
