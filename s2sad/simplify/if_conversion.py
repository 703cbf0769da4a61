"""if_conversion: a short branch that only moves numbers becomes conditional expressions: no jump to mispredict.

    def f(x, p):
        s = 0.0
        for i in range(x.size):
            d = x[i]
            if d < p:
                d = p
            s += d * d
        return s

in its adjoint:

    def f_adjoint(...):                     def f_adjoint(...):
        ...                                     ...
        for i in range(x.size):                 for i in range(x.size):
            ...                                     ...
            taken = d < p                           taken = d < p
            if taken:                               d = p if taken else d
                d = p                               d_bar_1 = 2.0 * (d * s_bar)
            d_bar_1 = 2.0 * (d * s_bar)             p_bar += d_bar_1 if taken else 0.0
            if taken:                               d_bar += 0.0 if taken else d_bar_1
                p_bar += d_bar_1                    x_bar[i] += d_bar
            else:                               return (p_bar,)
                d_bar += d_bar_1
            x_bar[i] += d_bar
        return (p_bar,)

*Requires* a structured function. *Establishes* the same values: only sums, products and comparisons of names are
speculated; nothing that can fail and no element of an array moves out from under its test.
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.passes import Context
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, BoolOp, Call, Compare, Constant, For, FunctionDef, If, IfExp, Mult, Name, Sub,
    USub, UnaryOp, assign, at, augment, call_name, const, copy, equal, is_comment, name, names, stored_names,
    walk, with_body,
)

CHANGES_ROUNDING = False

_MOST_STATEMENTS = 4
_CHEAP = {"builtins.abs", "numpy.abs", "numpy.sign", "math.fabs"}


def if_conversion(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with its short branches converted, the innermost first."""
    while True:
        converting = _IfConversion({p.id for p in function.args.args})
        function = with_body(function, converting.block(function.body))
        if not converting.changed:
            return function


class _IfConversion:
    """One round; `bound` are the names that are bound on every path to the current statement, `changed` says whether
    any branch was converted."""

    def __init__(self, bound: set[str]):
        self.bound, self.changed = bound, False
        self.binding: dict[int, tuple[AST, set[str]]] = {}      # what each branch binds: every enclosing one asks

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for statement in block:
            converted = self.converted(statement) if isinstance(statement, If) else None
            made += [self.nested(statement)] if converted is None else converted
            self.changed = self.changed or converted is not None
            self.bound |= self.definitely_bound(converted or [statement])
        return made

    def nested(self, statement: AST) -> AST:
        before = set(self.bound)

        def block(inner: list[AST]) -> list[AST]:
            self.bound = before | ({statement.target.id} if isinstance(statement, For) else set())
            return self.block(inner)
        made = with_blocks(statement, block)
        self.bound = before
        return made

    def converted(self, branch: If) -> list[AST] | None:
        """The branch as conditional expressions, None if it is not that simple."""
        parts = [s for s in [*branch.body, *branch.orelse] if not is_comment(s)]
        if not parts or len(parts) > _MOST_STATEMENTS or not all(map(_is_simple, parts)) or not _is_cheap(branch.test):
            return None
        sides = _effects_by_name(branch.body), _effects_by_name(branch.orelse)
        if sides[0] is None or sides[1] is None:
            return None
        made: list[AST] = []
        for target in dict.fromkeys([*sides[0], *sides[1]]):
            statement = _select_statement(target, branch.test, sides[0].get(target), sides[1].get(target),
                                          target in self.bound)
            if not self.operands_are_bound(statement):
                return None
            made.append(at(statement, parts[0]))
        bound = [m.targets[0].id if isinstance(m, Assign) else m.target.id for m in made]
        if any(b in names(m) for k, m in enumerate(made) for b in bound[:k]):
            return None
        return made

    def operands_are_bound(self, statement: AST) -> bool:
        """Whether a speculated statement reads only names that every path binds."""
        value = statement.value
        return isinstance(value, IfExp) or all("." in n or n in self.bound for n in names(value))

    def definitely_bound(self, block: list[AST]) -> set[str]:
        """The names that statements bind on every path through them."""
        found: set[str] = set()
        for statement in block:
            if isinstance(statement, If):
                if id(statement) not in self.binding:
                    both = self.definitely_bound(statement.body) & self.definitely_bound(statement.orelse)
                    self.binding[id(statement)] = statement, both
                found |= self.binding[id(statement)][1]
            elif isinstance(statement, (Assign, AugAssign)):
                found |= set(stored_names(statement))
        return found


def _effects_by_name(block: list[AST]) -> dict[str, AST] | None:
    """The statement of a side that binds or increments each name; None if one name has two."""
    found: dict[str, AST] = {}
    for statement in block:
        if is_comment(statement):
            continue
        target = statement.targets[0].id if isinstance(statement, Assign) else statement.target.id
        if target in found or any(n in found for n in names(statement.value)):
            return None
        found[target] = statement
    return found


def _is_simple(statement: AST) -> bool:
    if isinstance(statement, AugAssign):
        return (isinstance(statement.target, Name) and isinstance(statement.op, (Add, Sub))
                and statement.target.id not in names(statement.value) and _is_cheap(statement.value))
    return isinstance(statement, Assign) and isinstance(statement.targets[0], Name) and _is_cheap(statement.value)


def _is_cheap(node: AST) -> bool:
    """Whether an expression cannot fail and costs next to nothing."""
    if sum(1 for n in walk(node) if isinstance(n, (BinOp, Compare, IfExp, Call))) > _MOST_STATEMENTS:
        return False
    for part in walk(node):
        if isinstance(part, Call) and call_name(part) not in _CHEAP:
            return False
        if isinstance(part, BinOp) and not isinstance(part.op, (Add, Sub, Mult)):
            return False
        if type(part).__name__ in ("Subscript", "Attribute", "Tuple", "Pow"):
            return False
        if isinstance(part, BoolOp) and not all(isinstance(v, (Name, Compare, Constant, UnaryOp)) for v in part.values):
            return False
    return True


def _select_statement(target: str, test: AST, yes: AST | None, no: AST | None, bound: bool) -> AST:
    """One statement for what two sides do to a name; where it was not `bound` before, the only value there is,
    unconditionally."""
    if all(s is None or isinstance(s, AugAssign) for s in (yes, no)):
        return augment(target, Add(), _select(test, _increment(yes), _increment(no)))
    only = no if yes is None else yes if no is None else None
    if only is not None and not bound:
        return assign(target, copy(only.value))
    return assign(target, _select(test, _value_after(target, yes), _value_after(target, no)))


def _select(test: AST, yes: AST, no: AST) -> AST:
    return yes if equal(yes, no) else IfExp(copy(test), yes, no)


def _increment(side: AST | None) -> AST:
    if side is None:
        return const(0.0)
    return copy(side.value) if isinstance(side.op, Add) else UnaryOp(USub(), copy(side.value))


def _value_after(target: str, side: AST | None) -> AST:
    if side is None:
        return name(target)
    return BinOp(name(target), side.op, copy(side.value)) if isinstance(side, AugAssign) else copy(side.value)
