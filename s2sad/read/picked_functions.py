"""picked_functions: a function that a name picks from a table is the one of which the key is met.

    ACT = {"tanh": np.tanh, "sin": np.sin}
    y = ACT[kind](x)                    if kind != "tanh" and kind != "sin":
                                            raise KeyError("kind")
                                        y = ACT["tanh"](x) if kind == "tanh" else ACT["sin"](x)

    act = ACT[kind]                     the same, wherever `act` is called, or given to a call
    z = act(y) + act(x)

The table is a dict of the module, or one that is written out, of functions under strings; the key is a name that is
bound once, or a parameter. Before names are resolved; what is not of this form stays, to be refused.
"""
from __future__ import annotations

from dataclasses import replace

from s2sad import tree
from s2sad.read.meaning import AST, Captured, Function, Holder, Library
from s2sad.tree import FunctionDef

_LONGEST = 16
_SIMPLE = (tree.Assign, tree.AugAssign, tree.Return, tree.Expr)


def picked_functions(captured: Captured) -> Captured:
    """The function without such tables."""
    function = captured.tree
    if not isinstance(function, FunctionDef) or not any(
            isinstance(n, tree.Subscript) for n in tree.walk(function.body)):
        return captured
    made = _Picked(captured)
    new = tree.copy(function)
    new.body = made.block(made.unnamed(new.body))
    return replace(captured, tree=new) if made.found else captured


class _Picked:
    def __init__(self, captured: Captured):
        self.captured, self.found = captured, False
        given = captured.tree.args
        parameters = [a.id for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
        self.bound = [*parameters, *tree.stored_names(captured.tree.body)]
        self.times = tree.times_bound(captured.tree.body)

    def table(self, node: AST) -> dict[str, AST]:
        """The functions that a subscript may pick, by key; none if it is no such subscript."""
        if not isinstance(node, tree.Subscript) or not isinstance(node.slice, tree.Name) or self.bound.count(
                node.slice.id) != 1 or self.times.get(node.slice.id, 0) > 1:
            return {}
        if isinstance(node.value, tree.Dict):
            keys = [getattr(k, "value", None) for k in node.value.keys]
            items: dict[str, AST] = dict(zip(map(str, keys), node.value.values))
            fits = all(isinstance(k, str) for k in keys) and all(
                isinstance(v, (tree.Name, tree.Attribute)) for v in items.values())
        else:
            meaning = self.captured.scope.lookup(node.value.id) if isinstance(
                node.value, tree.Name) and node.value.id not in self.bound else None
            keys = meaning.scope.known() if isinstance(meaning, Holder) else []
            items = {k[1:-1]: tree.Subscript(node.value, tree.const(k[1:-1]), node.ctx) for k in keys}
            fits = isinstance(meaning, Holder) and all(isinstance(meaning.scope.lookup(k), (Function, Library))
                                                       and k.startswith("[") for k in keys)
        return items if fits and 0 < len(items) <= _LONGEST else {}

    def unnamed(self, block: list[AST]) -> list[AST]:
        """The statements in which names of picked functions, which are only called, are what they stand for."""
        for s in block:
            named = s.targets[0].id if isinstance(s, tree.Assign) and len(s.targets) == 1 and isinstance(
                s.targets[0], tree.Name) else ""
            if not named or not self.table(s.value) or self.bound.count(named) != 1 or not self.stays(s):
                continue
            nodes = [n for other in block for n in tree.walk(other)]
            called = {id(p) for n in nodes if isinstance(n, tree.Call) for p in _parts(n)}
            if all(id(n) in called for n in nodes if isinstance(n, tree.Name) and n.id == named
                   and isinstance(n.ctx, tree.Load)):
                rest = [tree.substitute(other, {named: s.value}) for other in block if other is not s]
                return self.unnamed(rest)
        return block

    def stays(self, statement: AST) -> bool:
        """Whether the names of such a statement mean the same wherever it is read: none is bound anew, or a parameter
        of a function within."""
        within = {n.id for n in tree.walk(self.captured.tree.body) if isinstance(n, tree.Name)
                  and not isinstance(n.ctx, (tree.Load, tree.Store))}
        meant = {*tree.names(statement), *tree.stored_names([statement])}
        return all(self.times.get(n, 0) <= 1 and n not in within for n in meant)

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for s in block:
            if isinstance(s, _SIMPLE):
                made += self.statement(s)
                continue
            for field in ("body", "orelse"):
                if isinstance(inner := getattr(s, field, None), list) and type(s).__name__ != "FunctionDef":
                    setattr(s, field, self.block(inner))
            made.append(s)
        return made

    def statement(self, statement: AST) -> list[AST]:
        """The statement with a call for each function, after a test that the key is one of the table."""
        tests: dict[str, AST] = {}
        lazy = {id(n) for c in tree.walk(statement) if isinstance(c, (tree.IfExp, tree.BoolOp)) or type(
            c).__name__ in ("Lambda", "ListComp", "GeneratorExp", "DictComp") for n in tree.walk(c)}

        def change(node: AST) -> AST | None:
            picks = [p for p in _parts(node) if self.table(p)] if isinstance(node, tree.Call) else []
            if len({tree.written(p) for p in picks}) != 1 or id(node) in lazy:
                return None
            items, key = self.table(picks[0]), picks[0].slice.id
            self.found = True
            asked = [tree.compare(tree.name(key), tree.NotEq(), tree.const(k)) for k in items]
            fails = tree.Raise(tree.call("KeyError", tree.const(key)), None)
            test = asked[0] if len(asked) == 1 else tree.BoolOp(tree.And(), asked)
            tests[tree.written(picks[0])] = tree.at(tree.If(test, [fails], []), node)
            same = {id(p) for p in picks}
            calls = []
            for item in items.values():
                parts = {p: tree.copy(item) for p in same}
                calls.append(_with(node, parts, change))
            made = calls[-1]
            for k, one in reversed(list(zip(items, calls[:-1]))):
                made = tree.IfExp(tree.compare(tree.name(key), tree.Eq(), tree.const(k)), one, made)
            return tree.at(made, node)
        new = tree.rebuild(statement, change)
        return [*tests.values(), new]


def _parts(call: tree.Call) -> list[AST]:
    return [call.func, *call.args, *(k.value for k in call.keywords)]


def _with(node: tree.Call, parts: dict[int, AST], change) -> AST:
    """The call with other parts in place of some."""
    def part(p: AST) -> AST:
        return tree.at(parts[id(p)], p) if id(p) in parts else tree.rebuild(p, change)
    keywords = [tree.keyword(k.arg, part(k.value)) for k in node.keywords]
    return tree.at(tree.Call(part(node.func), [part(a) for a in node.args], keywords), node)
