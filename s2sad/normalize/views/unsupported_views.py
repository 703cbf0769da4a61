"""unsupported_views: what NumPy's functions give as a view of their operand is here an array of its own; where that
would tell, it is refused.

Requires structured form in which functions of whole arrays stand alone, after `in_step`, which keeps most of these
views and their operands alike; changes nothing.

    w = np.diagonal(m)              w = np.diagonal(m)
    m[0] = 2.0; y[:] = w[1]         m[0] = 2.0                      refused: NumPy reads the new m in w
"""
from __future__ import annotations

from collections.abc import Callable, Iterator

from s2sad.liveness import Liveness, base_name, read_names, targets
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import whole_number
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, AugAssign, Call, Expr, FunctionDef, IfExp, List, Name, Subscript, Tuple, call_name, walk,
)

SHOWN = {f"numpy.{f}" for f in (
    "transpose", "reshape", "ravel", "flip", "fliplr", "flipud", "rot90", "asarray", "ascontiguousarray", "squeeze",
    "swapaxes", "moveaxis", "expand_dims", "atleast_1d", "atleast_2d", "broadcast_to", "diagonal", "diag",
    "split", "array_split", "hsplit", "vsplit", "real", "imag")}
_SLICED = {f"numpy.{f}" for f in ("squeeze", "expand_dims", "atleast_1d", "atleast_2d")}  # `pieces` writes subscripts
_ALIASES = {"numpy.asarray", "numpy.ascontiguousarray"}
Links = dict[str, dict[str, bool]]
Writes = Callable[[Call], list[str]]


def shows(node: AST) -> bool:
    """Whether a call may give a view of its first argument, or that itself, as the first power of a matrix is (one that
    is written is spelled so)."""
    power = call_name(node) == "numpy.linalg.matrix_power" and whole_number(node.args[1]) is None
    return isinstance(node, Call) and bool(node.args) and (call_name(node) in SHOWN or power)


def unsupported_views(function: FunctionDef, context: NormalContext) -> None:
    """Reports the writes after which such an array and its operand would differ from NumPy's."""
    typing, writes, report = context.typing, context.written_arrays, context.report
    for statement in dict.fromkeys(s for s, _, _ in differing(function, typing, writes)):
        report.error("S201", "an array is written that NumPy shares with another one, which is a view of it by a "
                     "function", statement, help="write into the array itself, or take a copy: np.copy(...)")


def differing(function: FunctionDef, typing: Typing, writes: Writes) -> Iterator[tuple[AST, str, str]]:
    """The statements that write an array, its name, and the one of another array that then is not what it is in
    NumPy."""
    links = _links(function, typing)
    if not any(shown for above in links.values() for shown in above.values()):
        return
    parameters = {p.id for p in function.args.args}
    live = Liveness(function, parameters, writes, lambda called: False, strong=False)
    for statement in walk(function.body):
        if not isinstance(statement, (Assign, AugAssign, Expr)):
            continue
        value = statement.value
        called = isinstance(value, Call) and (call_name(value) or "").startswith("user.")
        near = live.after[id(statement)] | parameters | (read_names(value) if called else set())
        for n in sorted(written_names(statement, typing, writes)):
            yield from ((statement, n, other) for other in sorted(near) if _differ(n, other, links))


def written_names(statement: AST, typing: Typing, writes: Writes) -> set[str]:
    """The arrays whose elements a simple statement writes."""
    value = getattr(statement, "value", None)
    called = isinstance(value, Call) and (call_name(value) or "").startswith("user.")
    return {base_name(t) for t in targets(statement) if isinstance(t, Subscript) or isinstance(
        statement, AugAssign) and typing.of(t).is_array} | set(writes(value) if called else ())


def sources(statement: AST, typing: Typing) -> list[tuple[AST, bool]]:
    """The arrays that the name which a statement binds may be a view of; true where a function shows it."""
    if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Name):
        return []
    value, called = statement.value, call_name(statement.value)
    if isinstance(value, (Tuple, List, IfExp)):
        return [(n, False) for n in walk(value) if isinstance(n, Name) and typing.of(n).is_array]
    if called == "numpy.diag" and typing.of(value.args[0]).rank == 1:
        return []  # a matrix is made
    if called in _ALIASES and typing.of(value).dtype != typing.of(value.args[0]).dtype:
        return []  # a copy in another dtype
    shown = shows(value)
    source = value.args[0] if shown else value
    is_array = isinstance(source, (Name, Subscript)) and typing.of(source).is_array
    return [(source, shown and called not in _SLICED)] if is_array else []


def _links(function: FunctionDef, typing: Typing) -> Links:
    """The names that each name may be a view of; true where a function shows it."""
    direct: dict[str, set[tuple[str, bool]]] = {}
    for statement in walk(function.body):
        for source, shown in sources(statement, typing):
            direct.setdefault(statement.targets[0].id, set()).add((base_name(source), shown))
    return {n: _above(n, direct) for n in direct}


def _above(identifier: str, direct: dict[str, set[tuple[str, bool]]]) -> dict[str, bool]:
    found: dict[str, bool] = {}
    waiting: list[tuple[str, bool]] = sorted(direct[identifier])
    while waiting:
        above, shown = waiting.pop()
        if above in found and (found[above] or not shown):
            continue
        found[above] = shown
        waiting += [(n, shown or s) for n, s in sorted(direct.get(above, ()))]
    return found


def _differ(written: str, other: str, links: Links) -> bool:
    """Whether two names share an array in NumPy that here they do not share."""
    first, second = ({n: False, **links.get(n, {})} for n in (written, other))
    common = [first[n] or second[n] for n in first if n in second]
    if written == other:
        return first[written]
    return bool(common) and all(common)

