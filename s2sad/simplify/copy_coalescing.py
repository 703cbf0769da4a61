"""copy_coalescing: versions of one variable whose live ranges do not interfere share a name; copies between them go.

    def f(x, n):
        g = x
        for i in range(n):
            g = np.sin(g)
        return g

in its tangent:

    def f_tangent(...):                         def f_tangent(...):
        g = x                                       g = x
        g_dot = x_dot                               g_dot = x_dot
        g_1 = g                                     for i in range(n):
        g_1_dot = g_dot                                 g_1 = np.sin(g)
        for i in range(n):                              g_dot = np.cos(g) * g_dot
            g_2 = np.sin(g_1)                           g = g_1
            g_2_dot = np.cos(g_1) * g_1_dot         return (g_dot,)
            g_1 = g_2
            g_1_dot = g_2_dot
        return (g_1_dot,)

*Requires* a structured function and the families of names: which variable each version is of. *Establishes* the
shortest names: the variable's own for the first version, then `_1`, `_2`, ... The interference graph follows from
liveness on the structured tree. (Chaitin et al., Computer Languages 6, 1981.)
"""
from __future__ import annotations

from collections.abc import Callable, Mapping

from s2sad.differentiate.adjoint import REVERSE
from s2sad.liveness import Accesses, Liveness, targets
from s2sad.infer.inference import Typing
from s2sad.naming import Names
from s2sad.blocks import with_blocks
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assign, AugAssign, Call, For, FunctionDef, Name, is_comment, rename, stored_names, walk, walk_statements,
    with_body,
)

CHANGES_ROUNDING = False


def copy_coalescing(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with shared names; the context has every name's new one."""
    made, context.renamed = coalesced(function, dict(context.family), context.live_out, context.effects.writes,
                                      context.parameters(function), context.names, context.shadows)
    return made


def split_temporaries(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function in which a temporary of both sweeps has a name in each.

        def f(x: float64[:], n):
            for k in range(n):
                for i in range(1, x.size):
                    x[i] = x[i] * x[i - 1]

    in its adjoint:

        def f_adjoint(...):                             def f_adjoint(...):
            ...                                             ...
            for k in range(n - 1, -1, -1):                  for k in range(n - 1, -1, -1):
                for i in range(x.size - 1, 0, -1):              for i in range(x.size - 1, 0, -1):
                    x[i] = x_stack[k, i - 1]                        x[i] = x_stack[k, i - 1]
                    x_here = x[i]                                   x_here_3 = x[i]
                    x_here_2 = x[i - 1]                             x_here_4 = x[i - 1]
                    seed = x_bar[i]                                 seed = x_bar[i]
                    x_here_bar = x_here_2 * seed                    x_here_bar = x_here_4 * seed
                    x_here_2_bar = x_here * seed                    x_here_2_bar = x_here_3 * seed
                    ...                                             ...
    """
    kept = {*context.family} | context.parameters(function)
    return split_live_ranges(function, set(_temporaries(context, kept)), context.names, context.typing, REVERSE)


def share_temporaries(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function in which names made for one purpose, never needed at once, are one name.

        def f(x: float64[:], y: float64[:]):
            y[0] = x[0] * y[0]
            y[1] = y[1] * x[1]

    in its adjoint:

        def f_adjoint(...):                 def f_adjoint(...):
            ...                                 ...
            seed = y_bar[1]                     seed = y_bar[1]
            x_bar[1] += y[1] * seed             x_bar[1] += y[1] * seed
            y_bar[1] = x[1] * seed              y_bar[1] = x[1] * seed
            seed_2 = y_bar[0]                   seed = y_bar[0]
            x_bar[0] += y[0] * seed_2           x_bar[0] += y[0] * seed
            y_bar[0] = x[0] * seed_2            y_bar[0] = x[0] * seed
    """
    kept = {*context.renamed.values()} | context.parameters(function)
    return coalesce_temporaries(function, _temporaries(context, kept), context.live_out, context.effects.writes)


def _temporaries(context: DerivativeContext, kept: set[str]) -> dict[str, str]:
    """The numbers that were named for one use, by what was wished for and their type."""
    types = context.typing.table
    return {n: f"{w} {types[n].dtype}" for n, w in context.names.hints.items()
            if n not in kept and n in types and types[n].is_number}


def coalesced(function: FunctionDef, family: Mapping[str, str], live_out: set[str],
              writes: Callable[[Call], list[str]], fixed: set[str], names: Names, shadows: Mapping[str, str]
              ) -> tuple[FunctionDef, dict[str, str]]:
    """The function with shared names, and every name's new one; `fixed` (its parameters) keep theirs.

    `shadows` tells of which primal a shadow is: it is called after what that is called now.
    """
    live = Liveness(function, live_out, Accesses(), strong=False)
    interference = _interferences(function, live, family)
    classes = {n: n for n in family}
    for a, b in _copies(function, family):
        ra, rb = _representative(classes, a), _representative(classes, b)
        if ra != rb and rb not in interference.get(ra, set()) and not (ra in fixed and rb in fixed):
            keep, gone = (rb, ra) if rb in fixed else (ra, rb)
            classes[gone] = keep
            interference.setdefault(keep, set()).update(interference.get(gone, set()))
            for other in interference.get(gone, set()):
                interference.setdefault(other, set()).add(keep)
    roots = {n: _representative(classes, n) for n in family}
    shared = rename(function, {n: r for n, r in roots.items() if n != r})
    shared.body = _without_self_copies(shared.body)
    primals = {n: f for n, f in family.items() if n not in shadows}
    short = _numbered_names(shared, primals, fixed, names)
    made = rename(shared, short)
    present = {n.id for n in walk(made) if isinstance(n, Name)}
    called = {s: f"{_current_name(p, roots, short, family, present)}_{family[s].rpartition('_')[2]}"
              for s, p in shadows.items() if s in family}
    if more := _numbered_names(made, called, fixed, names):
        short |= more
        made = rename(shared, short)
    return made, {n: short.get(r, r) for n, r in roots.items()}


def _current_name(primal: str, roots: Mapping[str, str], short: Mapping[str, str], family: Mapping[str, str],
                  present: set[str]) -> str:
    """The name that a primal has now; the user's variable if no version of it is left."""
    root = roots.get(primal, primal)
    now = short.get(root, root)
    return now if now in present else family.get(primal, now)


def _representative(classes: dict[str, str], name: str) -> str:
    while classes[name] != name:
        name = classes[name]
    return name


def _interferences(function: FunctionDef, live: Liveness, family: Mapping[str, str]) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}

    def define(name: str, after: set[str], source: str | None) -> None:
        for other in after:
            if other != name and other != source and family.get(other) == family[name]:
                found.setdefault(name, set()).add(other)
                found.setdefault(other, set()).add(name)

    for parameter in function.args.args:
        if parameter.id in family:
            define(parameter.id, live.start, None)
    for statement in walk_statements(function.body):
        if not isinstance(statement, (Assign, AugAssign, For)):
            continue
        source = statement.value.id if isinstance(statement, Assign) and isinstance(statement.value, Name) else None
        after = live.after[id(statement)] if not isinstance(statement, For) else live.entry.get(id(statement), set())
        for target in targets(statement):
            if isinstance(target, Name) and target.id in family:
                define(target.id, after, source)
    return found


def _copies(function: FunctionDef, family: Mapping[str, str]) -> list[tuple[str, str]]:
    """The copies between versions of one variable, those in the innermost loops first."""
    found: list[tuple[int, int, str, str]] = []

    def visit(block: list[AST], depth: int) -> None:
        for statement in block:
            if isinstance(statement, Assign) and isinstance(statement.value, Name) and isinstance(
                    statement.targets[0], Name):
                a, b = statement.targets[0].id, statement.value.id
                if a in family and family.get(b) == family[a]:
                    found.append((-depth, len(found), a, b))
            for inner in ("body", "orelse"):
                visit(getattr(statement, inner, None) or [], depth + (not hasattr(statement, "test")))
    visit(function.body, 0)
    return [(a, b) for _, _, a, b in sorted(found)]


def _without_self_copies(block: list[AST]) -> list[AST]:
    kept = [with_blocks(s, _without_self_copies) for s in block]
    return [s for s in kept if not (isinstance(s, Assign) and isinstance(s.targets[0], Name)
                                    and isinstance(s.value, Name) and s.targets[0].id == s.value.id)]


def _numbered_names(function: FunctionDef, family: Mapping[str, str], fixed: set[str], names: Names) -> dict[str, str]:
    """New names in the order of appearance: the variable's own, then numbered ones."""
    order = list(dict.fromkeys(n.id for n in walk(function.body) if isinstance(n, Name) and n.id in family
                               and n.id not in fixed))
    present = {n.id for n in walk(function) if isinstance(n, Name)}
    made = set(family) | {n for n in names.hints if n not in present}
    taken = (present - set(order)) | fixed | (names.taken - made)
    mapping: dict[str, str] = {}
    for name in order:
        wanted, number = family[name], 0
        while wanted in taken:
            number += 1
            wanted = f"{family[name]}_{number}"
        taken.add(wanted)
        mapping[name] = wanted
    return {a: b for a, b in mapping.items() if a != b}


def coalesce_temporaries(function: FunctionDef, family: Mapping[str, str], live_out: set[str],
                         writes: Callable[[Call], list[str]]) -> FunctionDef:
    """The function in which temporaries of one purpose (`family`) whose live ranges do not interfere share a name.

        seed = y_bar[i]                 seed = y_bar[i]
        ...                             ...
        seed_2 = z_bar[i]               seed = z_bar[i]
    """
    live = Liveness(function, live_out, Accesses(), strong=False)
    interference = _interferences(function, live, family)
    order = list(dict.fromkeys(n.id for n in walk(function.body) if isinstance(n, Name) and n.id in family))
    classes: dict[str, list[list[str]]] = {}
    for name in order:
        groups = classes.setdefault(family[name], [])
        home = next((g for g in groups if not any(m in interference.get(name, set()) for m in g)), None)
        if home is None:
            groups.append([name])
        else:
            home.append(name)
    return rename(function, _names_by_class(function, classes, set(order)))


def _names_by_class(function: FunctionDef, classes: Mapping[str, list[list[str]]], order: set[str]) -> dict[str, str]:
    taken = {n.id for n in walk(function) if isinstance(n, Name)} - order
    mapping: dict[str, str] = {}
    for purpose, groups in classes.items():
        wanted, number = purpose.split()[0], 1
        for group in groups:
            made = wanted
            while made in taken:
                number += 1
                made = f"{wanted}_{number}"
            taken.add(made)
            mapping |= {n: made for n in group if n != made}
    return mapping


def split_live_ranges(function: FunctionDef, temporaries: set[str], names: Names, typing: Typing,
                      mark: str) -> FunctionDef:
    """The function in which a temporary that is bound before the comment `mark` and again behind it has a name for each
    of these live ranges."""
    start = next((k for k, s in enumerate(function.body) if is_comment(s) and s.value.value == mark), None)
    if start is None:
        return function
    first, second = function.body[:start], function.body[start:]
    counted = {s.target.id for s in walk_statements(second) if isinstance(s, AugAssign) and isinstance(s.target, Name)}
    apart = (temporaries - counted) & set(stored_names(first))
    both = [n for n in stored_names(second) if n in apart]
    mapping = {n: typing.declare(names.fresh(names.hints.get(n, n)), typing.table[n]) for n in both}
    return with_body(function, first + rename(second, mapping))
