"""viewing: what NumPy's functions give as a view of their operand is here an array of its own; where that would tell,
it is refused.

Requires structured form in which functions of whole arrays stand alone; changes nothing.

    w = m.T                         w = np.transpose(m)
    w[0] = 1.0                      w[0] = 1.0                      refused: NumPy writes m
    m[0] = 2.0; y[:] = w[1]         m[0] = 2.0                      refused: NumPy reads the new m in w
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.analyze.liveness import Liveness, base_name, read_names, targets
from s2sad.diagnostics import Report
from s2sad.infer.infer import Typing
from s2sad.tree import Assign, AugAssign, Call, Expr, FunctionDef, Name, Subscript, call_name, walk

SHOWN = {f"numpy.{f}" for f in (
    "transpose", "reshape", "ravel", "flip", "fliplr", "flipud", "rot90", "asarray", "ascontiguousarray", "squeeze",
    "swapaxes", "moveaxis", "expand_dims", "atleast_1d", "atleast_2d", "broadcast_to", "diagonal", "diag",
    "split", "array_split", "hsplit", "vsplit", "real", "imag")}
Links = dict[str, dict[str, bool]]


def viewing(function: FunctionDef, typing: Typing, writes: Callable[[Call], list[str]], report: Report) -> None:
    """Reports the writes after which such an array and its operand would differ from NumPy's."""
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
        written = {base_name(t) for t in targets(statement) if isinstance(t, Subscript) or isinstance(
            statement, AugAssign) and typing.of(t).is_array} | set(writes(value) if called else ())
        near = live.after[id(statement)] | parameters | (read_names(value) if called else set())
        if any(_differ(n, other, links) for n in written for other in sorted(near)):
            report.error("S201", "an array is written that NumPy shares with another one, which is a view of it by a "
                         "function", statement, help="write into the array itself, or take a copy: np.copy(...)")


def _links(function: FunctionDef, typing: Typing) -> Links:
    """The names that each name may be a view of; true where a function shows it."""
    direct: dict[str, set[tuple[str, bool]]] = {}
    for statement in walk(function.body):
        if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Name):
            continue
        value, shown = statement.value, call_name(statement.value) in SHOWN
        if call_name(value) == "numpy.diag" and typing.of(value.args[0]).rank == 1:
            continue  # a matrix is made
        source = value.args[0] if shown and isinstance(value, Call) and value.args else value
        if isinstance(source, (Name, Subscript)) and typing.of(source).is_array:
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

