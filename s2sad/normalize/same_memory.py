"""same_memory: what NumPy gives as another view of an array must not be told from a copy.

Requires functions that stand alone; refuses a name for a transposed, reshaped or spread array, or a diagonal, where it
or the array is written in place later: here it is a copy.

    c = a.T                         refused: c would change with a
    a[0] = 1.0
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.analyze.liveness import base_name
from s2sad.diagnostics import Report
from s2sad.infer.infer import Typing
from s2sad.tree import (
    AST, Assign, AugAssign, Call, For, FunctionDef, Name, Subscript, While, call_name, walk,
)

_VIEWING = {f"numpy.{f}" for f in ("transpose", "moveaxis", "swapaxes", "reshape", "ravel", "diag", "diagonal",
                                   "broadcast_to")}


def same_memory(function: FunctionDef, typing: Typing, report: Report, stores: Callable[[Call], list[AST]]) -> None:
    """Puts one diagnostic into the report for each such name; `stores` gives the arguments that a call writes."""
    order = list(walk(function.body))
    bound = [s for s in order if isinstance(s, Assign) and isinstance(s.targets[0], Name)
             and typing.of(s.targets[0]).is_array]
    roots = _roots(bound, typing)
    flow = _Flow(order)
    parameters = {p.id for p in function.args.args}
    for view in bound:
        if not _is_view(view.value, typing):
            continue
        target, source = view.targets[0].id, base_name(view.value.args[0])
        own = source not in parameters and sum(isinstance(n, Name) and n.id == source for n in order) == 2
        parts = {n for n, found in roots.items() if target in found}
        writes = [s for s in order if any(roots.get(n, {n}) & roots[target] for n in _written(s, typing, stores))]
        reads = [n for n in order if isinstance(n, Name) and n.id == target and n is not view.targets[0]]
        if not own and (any(_written(s, typing, stores) & parts for s in order) or any(
                flow.meets(view, write, read) for write in writes for read in reads)):
            report.error("S201", f"'{target}' shares its memory with an array that is written later", view,
                         help="copy it: np.copy(...), or write it where it is used")


class _Flow:
    """In what order the nodes of a function may run, by their order in the text and the loops around them."""

    def __init__(self, order: list[AST]):
        self.place = {id(node): k for k, node in enumerate(order)}
        self.loops = [{id(s) for s in walk(loop)} for loop in order if isinstance(loop, (For, While))]

    def meets(self, view: AST, write: AST, read: AST) -> bool:
        """Whether what the binding gave may be read after the write."""
        bound, written, used = (self.place[id(n)] for n in (view, write, read))
        if bound < written < used and (isinstance(write, Call) or all(n is not read for n in walk(write))):
            return True
        for loop in self.loops:
            if id(write) in loop and id(read) in loop and (id(view) not in loop or used < bound):
                return True
        return False


def _is_view(value: AST, typing: Typing) -> bool:
    """Whether an expression is a view in NumPy and a copy here; of a vector np.diag makes a matrix."""
    if not isinstance(value, Call) or call_name(value) not in _VIEWING or not isinstance(
            value.args[0], (Name, Subscript)):
        return False
    return call_name(value) != "numpy.diag" or typing.of(value.args[0]).rank == 2


def _roots(bound: list[AST], typing: Typing) -> dict[str, set[str]]:
    """For each name of an array those whose memory it may share."""
    found: dict[str, set[str]] = {}
    for _ in range(len(bound) + 1):
        before = {n: set(r) for n, r in found.items()}
        for statement in bound:
            target, value = statement.targets[0].id, statement.value
            source = value.args[0] if _is_view(value, typing) else value
            roots = found.setdefault(target, {target})
            if isinstance(source, (Name, Subscript)) and typing.of(source).is_array:
                roots |= {base_name(source)} | found.get(base_name(source), set())
        if found == before:
            break
    return found


def _written(statement: AST, typing: Typing, stores: Callable[[Call], list[AST]]) -> set[str]:
    """The arrays that a statement writes in place, as far as it may."""
    if isinstance(statement, (Assign, AugAssign)):
        target = statement.targets[0] if isinstance(statement, Assign) else statement.target
        array = isinstance(target, Subscript) or isinstance(statement, AugAssign) and typing.of(target).is_array
        return {base_name(target)} if array else set()
    if isinstance(statement, Call) and (call_name(statement) or "").startswith("user."):
        return {base_name(a) for a in stores(statement)}
    return set()
