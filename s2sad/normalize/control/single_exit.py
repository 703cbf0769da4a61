"""Control flow without `continue`, without `else` on loops, with `break` in tail position and one return.

    def f(x, n):                        def f(x, n):
        for k in range(n):                  returned = False
            if x[k] > 1.0:                  result = 0.0
                return x[k] * 2.0           for k in range(n):
        return x[0]                             if x[k] > 1.0:
                                                    result = x[k] * 2.0
                                                    returned = True
                                                    break
                                            if not returned:
                                                result = x[0]
                                            return result

Requires what desugar establishes. What follows a jump moves into the branch that does not jump; where several
branches go on, a flag says which did not. A return from inside a loop sets a flag and leaves every loop; where
the loop can be left in no other way there is none.
"""
from __future__ import annotations

from s2sad.evaluate.completion import BREAK, CONTINUE, FALL, RETURN, endless, completion
from s2sad.normalize.control.return_variables import DONE, ReturnVariables, final_return
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Assign, Break, Compare, Continue, Eq, For, FunctionDef, If, Name, Not, NotEq, Raise, Return, UnaryOp, While,
    assign, at, const, copy, function, name, names,
)


def single_exit(tree: FunctionDef, scope: KernelScope) -> FunctionDef:
    nesting = _Nesting(tree, scope)
    parameters = [a.id for a in tree.args.args]
    return at(function(tree.name, parameters, nesting.function_body(tree, parameters)), tree)


class _Nesting:
    """One function's control flow; `_flag_is_bound` says that the flag of returns is certainly bound at this point."""

    def __init__(self, tree: FunctionDef, scope: KernelScope):
        self._scope = scope
        self._results = ReturnVariables(tree, scope)
        self._returned = ""
        self._flag_is_bound = False

    def function_body(self, tree: FunctionDef, parameters: list[str]) -> list[AST]:
        last = tree.body[-1] if tree.body else tree
        if self._results.single:
            return [*self._clean(self._nest(tree.body[:-1])), *final_return(last, self._scope)]
        body = self._replace(self._nest(tree.body), {Return: self._results.store})
        body = self._clean(_without_unread(body, self._returned))
        end = self._results.end(last)
        return [*self._results.with_initial_values(body, parameters, body[0] if body else end), end]

    # -- nesting: every jump into tail position -----------------------------------------------------------------------

    def _nest(self, statements: list[AST]) -> list[AST]:
        new: list[AST] = []
        for position, node in enumerate(statements):
            rest = statements[position + 1:]
            if isinstance(node, (Break, Continue, Return, Raise)):
                return [*new, node]
            if isinstance(node, (For, While)):
                loop, after = self._loop(node)
                new += loop
                if after:
                    return new + self._nest(after + rest)
            elif isinstance(node, If):
                if completion([node]) & {BREAK, CONTINUE, RETURN} and rest:
                    return new + self._branch(node, rest)
                new.append(self._if(node, node.body, node.orelse))
            else:
                new.append(node)
        return new

    def _if(self, node: If, body: list[AST], orelse: list[AST]) -> If:
        return at(If(node.test, self._nest(body), self._nest(orelse)), node)

    def _branch(self, node: If, rest: list[AST]) -> list[AST]:
        if FALL not in completion(node.body):
            return [self._if(node, node.body, node.orelse + rest)]
        if FALL not in completion(node.orelse):
            return [self._if(node, node.body + rest, node.orelse)]
        return self._flagged(node, rest)

    def _flagged(self, node: If, rest: list[AST]) -> list[AST]:
        """Several branches go on and another does not: a flag per kind of jump, asked before the rest."""
        kinds = completion([node])
        flags = {kind: self._scope.fresh(wanted) for kind, wanted in
                 ((BREAK, "stopped"), (CONTINUE, "skipped")) if kind in kinds}
        new = [at(assign(flag, const(False)), node) for flag in flags.values()]
        change = {}
        if BREAK in kinds:
            change[Break] = lambda jump: [at(assign(flags[BREAK], const(True)), jump)]
        if CONTINUE in kinds:
            change[Continue] = lambda jump: [at(assign(flags[CONTINUE], const(True)), jump)]
        if RETURN in kinds:
            change[Return] = self._set_flag
        was_bound = self._initialize_flag(RETURN in kinds, node, new)
        [nested] = self._replace([self._if(node, node.body, node.orelse)], change)
        self._flag_is_bound = was_bound
        asked = [at(If(name(flags[kind]), [jump], []), node) for kind, jump in
                 ((BREAK, Break()), (CONTINUE, Continue())) if kind in flags]
        if RETURN in kinds:
            asked.append(self._return_if_flagged(node))
        return [*new, nested, *self._nest(asked + rest)]

    # -- loops --------------------------------------------------------------------------------------------------------

    def _loop(self, node: AST) -> tuple[list[AST], list[AST]]:
        """The finished loop, and statements that come after it and still are to be nested."""
        inside = completion(node.body)
        new: list[AST] = []
        orelse = [] if endless(node) else node.orelse
        broken = self._scope.fresh("broken") if orelse and BREAK in inside else ""
        if broken:
            new.append(at(assign(broken, const(False)), node))
        was_bound = self._initialize_flag(RETURN in inside and not self._only_returns(node, inside), node, new)
        body = self._nest(node.body)
        self._flag_is_bound = was_bound
        change = {Continue: lambda jump: [], Return: lambda jump: [*self._set_flag(jump), at(Break(), jump)]}
        if broken:
            change[Break] = lambda jump: [at(assign(broken, const(True)), jump), jump]
        body = self._clean(self._replace(body, change))
        new.append(at(For(node.target, node.iter, body, [], None) if isinstance(node, For)
                      else While(node.test, body, []), node))
        after: list[AST] = []
        if RETURN in inside:
            after.append(at(Return(name(DONE)), node) if self._only_returns(node, inside) else
                         self._return_if_flagged(node))
        if broken:
            after.append(at(If(UnaryOp(Not(), name(broken)), orelse, []), node))
        else:
            after += orelse
        return new, after

    def _only_returns(self, node: AST, inside: frozenset[str]) -> bool:
        return endless(node) and BREAK not in inside

    # -- flags and leaves ---------------------------------------------------------------------------------------------

    def _flag(self) -> str:
        self._returned = self._returned or self._scope.fresh("returned")
        return self._returned

    def _initialize_flag(self, needed: bool, node: AST, before: list[AST]) -> bool:
        """Binds the flag of returns before a statement, unless it is bound; whether it was bound."""
        was_bound = self._flag_is_bound
        if needed and not was_bound:
            before.append(at(assign(self._flag(), const(False)), node))
            self._flag_is_bound = True
        return was_bound

    def _return_if_flagged(self, node: AST) -> If:
        return at(If(name(self._flag()), [at(Return(name(DONE)), node)], []), node)

    def _set_flag(self, jump: Return) -> list[AST]:
        if isinstance(jump.value, Name) and jump.value.id == DONE:
            return []
        return [*self._results.store(jump), at(assign(self._flag(), const(True)), jump)]

    def _replace(self, statements: list[AST], change: dict) -> list[AST]:
        """Other statements for the jumps of these (nested, so in the tails of branches); loops are finished."""
        new: list[AST] = []
        for node in statements:
            if type(node) in change:
                new += change[type(node)](node)
            elif isinstance(node, If):
                arms = self._replace(node.body, change), self._replace(node.orelse, change)
                new.append(at(If(node.test, *arms), node))
            else:
                new.append(node)
        return new

    def _clean(self, statements: list[AST]) -> list[AST]:
        """No empty branches, no unreachable or empty loops."""
        new: list[AST] = []
        for node in statements:
            if isinstance(node, If):
                body, orelse = self._clean(node.body), self._clean(node.orelse)
                if body or orelse:
                    new.append(at(If(node.test, body, orelse) if body else If(negated(node.test), orelse, []), node))
            elif isinstance(node, While) and not node.body:
                self._scope.refuse(node, "a loop that changes nothing", help="give it a body that ends it")
            else:
                new.append(node)
        return new


def negated(test: AST) -> AST:
    """The opposite of a condition; `a < b` has none but `not`, as for NaN neither holds."""
    if isinstance(test, UnaryOp) and isinstance(test.op, Not):
        return test.operand
    if isinstance(test, Compare) and len(test.ops) == 1 and isinstance(test.ops[0], (Eq, NotEq)):
        return Compare(test.left, [NotEq() if isinstance(test.ops[0], Eq) else Eq()], test.comparators)
    return UnaryOp(Not(), copy(test))


def _without_unread(statements: list[AST], flag: str) -> list[AST]:
    """The statements without the assignments of a flag that nothing reads."""
    if not flag or flag in names(statements):
        return statements
    new: list[AST] = []
    for node in statements:
        if isinstance(node, Assign) and isinstance(node.targets[0], Name) and node.targets[0].id == flag:
            continue
        for field in ("body", "orelse"):
            if hasattr(node, field) and isinstance(node, (If, For, While)):
                setattr(node, field, _without_unread(getattr(node, field), flag))
        new.append(node)
    return new
