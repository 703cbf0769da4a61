"""itertools_loops: loops and comprehensions through combinations of ranges become nested ones.

    def f(a: float64[:, :], n: int64):
        s = sum(a[i, j] for i, j in itertools.product(range(n), range(n)))
        for i, j in itertools.product(range(n), range(1, n)):
            s += a[i, j]
        for i, j in itertools.combinations(range(n), 2):
            s += a[i, j]
        return s

becomes

    def f(a, n):
        s = sum((a[i_2, j_2] for i_2 in range(0, n) for j_2 in range(0, n)))
        for i, j_place in np.ndindex(n, len(range(1, n))):
            j = 1 + j_place
            s += a[i, j]
        for i_first in range(0, n):
            for j_first in range(i_first + 1, n):
                i = i_first
                j = j_first
                s += a[i, j]
        return s

*Requires* resolved names. *Establishes* that no loop goes through combinations: what goes through anything but ranges
without a step, or is left by `break` where loops would be nested, is refused.
"""
from __future__ import annotations

from s2sad.evaluate.completion import BREAK, completion
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Attribute, Call, Constant, For, FunctionDef, GeneratorExp, ListComp, Name, Subscript, Tuple, add, assign, at,
    call, call_name, const, copy, name, names, rebuild, stored_names, walk, with_body,
)

_PRODUCT, _AFTER = "itertools.product", {"itertools.combinations": 1, "itertools.combinations_with_replacement": 0}
_HELP = "write nested loops over ranges: for i in range(n): for j in range(i + 1, n)"
Range = tuple[AST, AST]     # its first number and its end


def itertools_loops(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function without combinations; those that cannot be nested are reported."""
    def change(node: AST) -> AST | None:
        if isinstance(node, For) and _combines(node.iter):
            return _loop(rebuild(node, lambda n: None if n is node else change(n)), scope)
        if isinstance(node, (GeneratorExp, ListComp)) and any(_combines(g.iter) for g in node.generators):
            new = copy(node)
            new.generators = [made for g in node.generators for made in _generators(g, scope)]
            return rebuild(new, lambda n: None if n is new else change(n))
        return None
    new = with_body(function, [rebuild(statement, change) for statement in function.body])
    for node in walk(new.body):
        if _combines(node):
            scope.refuse(node, "combinations other than of ranges, each with a name in a loop of its own", help=_HELP)
    return new


def _combines(node: AST) -> bool:
    called = call_name(node)
    return called == _PRODUCT or called in _AFTER


def _ranges(node: AST, target: AST) -> list[Range]:
    """The ranges that are combined, one for each name; none if they are not known."""
    if not isinstance(node, Call) or not isinstance(target, Tuple) or not all(
            isinstance(t, Name) for t in target.elts) or len({t.id for t in target.elts}) < len(target.elts):
        return []
    given, most = {k.arg: k.value for k in node.keywords}, len(target.elts) + 1
    if call_name(node) == _PRODUCT:
        times = given.pop("repeat", const(1))
        known = isinstance(times, Constant) and type(times.value) is int and not given
        parts = node.args * min(times.value, most) if known else []
    else:
        count = node.args[1] if len(node.args) == 2 and not given else given.pop("r", const(0))
        known = isinstance(count, Constant) and type(count.value) is int
        parts = node.args[:1] * min(count.value, most) if known else []
    found = [_range(p) for p in parts]
    return [f for f in found if f is not None] if len(found) == len(target.elts) and None not in found else []


def _range(node: AST) -> Range | None:
    if call_name(node) != "builtins.range" or not isinstance(node, Call) or len(node.args) not in (1, 2):
        return None
    simple = all(map(_lasts, (n for a in node.args for n in walk(a))))
    return (node.args[0] if len(node.args) == 2 else const(0), node.args[-1]) if simple else None


def _lasts(node: AST) -> bool:
    """Whether a part of a bound is a number that a store into an array cannot change."""
    if isinstance(node, Subscript):
        return isinstance(node.value, Attribute) and node.value.attr == "shape"
    return not isinstance(node, Call) or call_name(node) == "builtins.len"


def _generators(generator: AST, scope: KernelScope) -> list[AST]:
    """The generators in place of one, with its conditions behind the last."""
    if not _combines(generator.iter):
        return [generator]
    found = _ranges(generator.iter, generator.target)
    if not found:
        return [generator]
    made: list[AST] = []
    for k, (target, bounds) in enumerate(zip(generator.target.elts, found)):
        new = copy(generator)
        new.target, new.ifs = target, generator.ifs if k == len(found) - 1 else []
        new.iter = at(_counted(generator.iter, generator.target.elts[k - 1] if k else None, bounds), generator.iter)
        made.append(new)
    return made


def _counted(node: AST, before: AST | None, bounds: Range) -> AST:
    """The range of one name, which begins behind the one before in a combination."""
    step = _AFTER.get(call_name(node) or "")
    low = copy(bounds[0])
    if step is not None and isinstance(before, Name):
        low = add(name(before.id), const(step)) if step else name(before.id)
    return call("builtins.range", low, copy(bounds[1]))


def _loop(node: For, scope: KernelScope) -> AST:
    found = _ranges(node.iter, node.target)
    if not found:
        return node
    nested = call_name(node.iter) != _PRODUCT
    changed = set(stored_names(node.body)) | set(stored_names([node.target]))
    if changed & set(names(node.iter)) or nested and (BREAK in completion(node.body) or node.orelse):
        return node
    targets = [t.id for t in node.target.elts]
    if nested:
        return _nested(node, found, [scope.fresh(f"{t}_first") for t in targets], targets)
    places = [t if isinstance(low, Constant) and low.value == 0 else scope.fresh(f"{t}_place")
              for t, (low, _) in zip(targets, found)]
    bound = [assign(t, add(copy(low), name(p))) for t, p, (low, _) in zip(targets, places, found) if t != p]
    sizes = [call("builtins.len", call("builtins.range", copy(low), copy(high))) if t != p else copy(high)
             for t, p, (low, high) in zip(targets, places, found)]
    new = copy(node)
    new.target = at(Tuple([Name(p, t.ctx, None, None) for p, t in zip(places, node.target.elts)], node.target.ctx),
                    node.target)
    new.iter = at(call("numpy.ndindex", *sizes), node.iter)
    new.body = [*(at(s, node) for s in bound), *node.body]
    return new


def _nested(node: For, found: list[Range], counters: list[str], targets: list[str]) -> AST:
    body: list[AST] = [*(at(assign(t, name(c)), node) for t, c in zip(targets, counters)), *node.body]
    for k in range(len(found) - 1, -1, -1):
        over = at(_counted(node.iter, name(counters[k - 1]) if k else None, found[k]), node.iter)
        stored = Name(counters[k], node.target.elts[k].ctx, None, None)
        body = [at(For(stored, over, body, [], None), node)]
    return body[0]
