"""select: a short branch that only moves numbers becomes a choice, and the loop around it has no jump to mispredict.

    if taken:                       a_bar += y_bar if taken else 0.0
        a_bar += y_bar              b_bar += 0.0 if taken else y_bar
    else:
        b_bar += y_bar

Only numbers, sums and products of names, a comparison of those: nothing that can fail and no element of an array is
moved out from under a test.
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, BoolOp, Call, Compare, Constant, For, FunctionDef, If, IfExp, Mult, Name,
    Sub, UnaryOp, USub, assign, at, augment, call_name, const, copy, dump, equal, is_comment, name, names, stored_names,
    walk,
)

CHANGES_ROUNDING = False

_LONGEST = 4
_CHEAP = {"builtins.abs", "numpy.abs", "numpy.sign", "math.fabs"}


def select(function: FunctionDef) -> FunctionDef:
    """The function with its short branches as choices, the innermost first."""
    while True:
        new = copy(function)
        new.body = _Select({p.id for p in function.args.args}).block(function.body)
        if dump(new.body) == dump(function.body):
            return new
        function = new


class _Select:
    """`bound` are the names that are bound on every way to where the pass stands."""

    def __init__(self, bound: set[str]):
        self.bound = bound
        self.binding: dict[int, tuple[AST, set[str]]] = {}      # branches with what they bind, asked for by all around

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for statement in block:
            chosen = self.chosen(statement) if isinstance(statement, If) else None
            made += [self.inside(statement)] if chosen is None else chosen
            self.bound |= self.binds(chosen or [statement])
        return made

    def inside(self, statement: AST) -> AST:
        before = set(self.bound)

        def block(inner: list[AST]) -> list[AST]:
            self.bound = before | ({statement.target.id} if isinstance(statement, For) else set())
            return self.block(inner)
        made = with_blocks(statement, block)
        self.bound = before
        return made

    def chosen(self, branch: If) -> list[AST] | None:
        """The branch as choices, None if it is not that simple."""
        parts = [s for s in [*branch.body, *branch.orelse] if not is_comment(s)]
        if not parts or len(parts) > _LONGEST or not all(map(_is_simple, parts)) or not _is_cheap(branch.test):
            return None
        sides = _values(branch.body), _values(branch.orelse)
        if sides[0] is None or sides[1] is None:
            return None
        made: list[AST] = []
        for target in dict.fromkeys([*sides[0], *sides[1]]):
            statement = _choice(target, branch.test, sides[0].get(target), sides[1].get(target), target in self.bound)
            if not self.readable(statement):
                return None
            made.append(at(statement, parts[0]))
        bound = [m.targets[0].id if isinstance(m, Assign) else m.target.id for m in made]
        if any(b in names(m) for k, m in enumerate(made) for b in bound[:k]):
            return None
        return made


    def readable(self, statement: AST) -> bool:
        """Whether a statement that is run whatever the test is reads nothing that only one way binds."""
        value = statement.value
        return isinstance(value, IfExp) or all("." in n or n in self.bound for n in names(value))

    def binds(self, block: list[AST]) -> set[str]:
        """The names that statements bind on every way through them."""
        found: set[str] = set()
        for statement in block:
            if isinstance(statement, If):
                if id(statement) not in self.binding:
                    self.binding[id(statement)] = statement, self.binds(statement.body) & self.binds(statement.orelse)
                found |= self.binding[id(statement)][1]
            elif isinstance(statement, (Assign, AugAssign)):
                found |= set(stored_names(statement))
        return found


def _values(block: list[AST]) -> dict[str, AST] | None:
    """What a side binds or adds, by name; None if a name occurs twice."""
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
    if sum(1 for n in walk(node) if isinstance(n, (BinOp, Compare, IfExp, Call))) > _LONGEST:
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


def _choice(target: str, test: AST, yes: AST | None, no: AST | None, bound: bool) -> AST:
    """One statement for what two sides do to a name; one not `bound` before is bound whatever the test is."""
    if all(s is None or isinstance(s, AugAssign) for s in (yes, no)):
        return augment(target, Add(), _either(test, _gain(yes), _gain(no)))
    only = no if yes is None else yes if no is None else None
    if only is not None and not bound:
        return assign(target, copy(only.value))
    return assign(target, _either(test, _after(target, yes), _after(target, no)))


def _either(test: AST, yes: AST, no: AST) -> AST:
    return yes if equal(yes, no) else IfExp(copy(test), yes, no)


def _gain(side: AST | None) -> AST:
    if side is None:
        return const(0.0)
    return copy(side.value) if isinstance(side.op, Add) else UnaryOp(USub(), copy(side.value))


def _after(target: str, side: AST | None) -> AST:
    if side is None:
        return name(target)
    return BinOp(name(target), side.op, copy(side.value)) if isinstance(side, AugAssign) else copy(side.value)
