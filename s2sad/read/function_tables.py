"""function_tables: a function that a name picks from a table is the one of which the key is met.

    ACT = {"tanh": np.tanh, "sin": np.sin}
    y = ACT[kind](x)                    if kind != "tanh" and kind != "sin":
                                            raise KeyError("kind")
                                        y = ACT["tanh"](x) if kind == "tanh" else ACT["sin"](x)

    act = ACT[kind]                     if kind != "tanh" and kind != "sin":
                                            raise KeyError("kind")
    while act(y) > c and act(x) > c:    the same, wherever `act` is called, or given to a call

The table is a dict of the module, or one that is written out, of functions under strings; the key is a name that is
bound once, or a parameter. What picks where it is called stands where the key can be asked for before: not behind an
`and`, in an arm of a conditional expression, in a comprehension. Before names are resolved; what is not of this form
stays, to be refused.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from s2sad import tree
from s2sad.read.outside_values import AST, Captured, UserFunctionValue, Namespace, Library
from s2sad.tree import FunctionDef

Change = Callable[[AST], AST | None]
_LONGEST = 16
_BLOCKS = ("body", "orelse")
_LATE = ("Lambda", "ListComp", "GeneratorExp", "DictComp", "SetComp")
_SIMPLE = (tree.Assign, tree.AugAssign, tree.Return, tree.Expr)


def function_tables(captured: Captured) -> Captured:
    """The function without such tables."""
    function = captured.tree
    if not isinstance(function, FunctionDef) or not any(
            isinstance(n, tree.Subscript) for n in tree.walk(function.body)):
        return captured
    new = tree.copy(function)
    made = _FunctionTables(captured, new.body)
    made.names(new.body)
    new.body = made.block(new.body)
    return replace(captured, tree=new) if made.found else captured


class _FunctionTables:
    def __init__(self, captured: Captured, body: list[AST]):
        self.captured, self.found, self.body = captured, False, body
        self.named: dict[str, tree.Subscript] = {}
        given = captured.tree.args
        parameters = [a.id for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
        self.bound = [*parameters, *tree.stored_names(body)]
        self.times = tree.times_bound(body)

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
            keys = meaning.scope.known() if isinstance(meaning, Namespace) else []
            items = {k[1:-1]: tree.Subscript(node.value, tree.const(k[1:-1]), node.ctx) for k in keys}
            fits = isinstance(meaning, Namespace) and all(isinstance(meaning.scope.lookup(k), (UserFunctionValue,
                                                                                               Library))
                                                          and k.startswith("[") for k in keys)
        return items if fits and 0 < len(items) <= _LONGEST else {}

    def names(self, block: list[AST], inside: bool = False) -> None:
        """Enters the names of picked functions that are only called, where what they stand for means the same."""
        for position, s in enumerate(block):
            if type(s).__name__ == "FunctionDef":
                continue
            for field in _BLOCKS:
                self.names(getattr(s, field, None) or [], True)
            named = s.targets[0].id if isinstance(s, tree.Assign) and len(s.targets) == 1 and isinstance(
                s.targets[0], tree.Name) else ""
            later = block[position + 1:]
            if not named or not self.table(s.value) or self.bound.count(named) != 1 or not self.stays(s) or (
                    inside and set(tree.stored_names(later)) & set(tree.names(s.value))):
                continue
            nodes = [n for other in (later if inside else block) for n in tree.walk(other)]
            called = {id(p) for n in nodes if isinstance(n, tree.Call) for p in _parts(n)}
            if all(id(n) in called for n in tree.walk(self.body) if isinstance(n, tree.Name) and n.id == named
                   and isinstance(n.ctx, tree.Load)):
                self.named[named] = s.value

    def stays(self, statement: AST) -> bool:
        """Whether the names of such a statement mean the same wherever it is read: none is bound anew, or a parameter
        of a function within."""
        within = {n.id for n in tree.walk(self.body) if isinstance(n, tree.Name)
                  and not isinstance(n.ctx, (tree.Load, tree.Store))}
        meant = {*tree.names(statement), *tree.stored_names([statement])}
        return all(self.times.get(n, 0) <= 1 and n not in within for n in meant)

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for s in block:
            if isinstance(s, tree.Assign) and isinstance(s.targets[0], tree.Name) and s.targets[0].id in self.named:
                made.append(self.asked(s.value, s))
                continue
            if type(s).__name__ != "FunctionDef":
                for field in _BLOCKS:
                    if isinstance(inner := getattr(s, field, None), list):
                        setattr(s, field, self.block(inner))
            made += self.statement(s)
        return made

    def asked(self, picked: tree.Subscript, node: AST) -> AST:
        """The test that a key is one of its table."""
        self.found = True
        key = picked.slice.id
        asked = [tree.compare(tree.name(key), tree.NotEq(), tree.const(k)) for k in self.table(picked)]
        fails = tree.Raise(tree.call("KeyError", tree.const(key)), None)
        return tree.at(tree.If(asked[0] if len(asked) == 1 else tree.BoolOp(tree.And(), asked), [fails], []), node)

    def statement(self, statement: AST) -> list[AST]:
        """The statement with a call for each function, after a test of each key that it has to ask for itself."""
        tests: dict[str, AST] = {}
        first = _evaluated_first(statement)

        def called(node: tree.Call, asks: bool) -> AST | None:
            picks = [(p, own) for p in _parts(node) if (own := self.picked(p, asks)) is not None]
            if not picks:
                return None
            picked = picks[0][1]
            same = [p for p, own in picks if tree.written(own) == tree.written(picked)]
            if any(not isinstance(p, tree.Name) for p in same):
                tests.setdefault(tree.written(picked), self.asked(picked, node))
            calls = []
            for item in self.table(picked).values():
                one = _with(node, {id(p): tree.copy(item) for p in same})
                calls.append(called(one, asks) or _rebuilt(one, change))
            made = tree.at(calls[-1], node)
            for k, one in reversed(list(zip(self.table(picked), calls[:-1]))):
                test = tree.compare(tree.name(picked.slice.id), tree.Eq(), tree.const(k))
                made = tree.at(tree.IfExp(test, tree.at(one, node), made), node)
            return made

        def change(node: AST) -> AST | None:
            return called(node, id(node) in first) if isinstance(node, tree.Call) else None
        new = _outside_blocks(statement, change)
        return [*tests.values(), new]

    def picked(self, part: AST, asks: bool) -> tree.Subscript | None:
        """What a part of a call picks a function with: a name whose key was asked for, or a subscript."""
        if isinstance(part, tree.Name):
            return self.named.get(part.id)
        return part if asks and self.table(part) and isinstance(part, tree.Subscript) else None


def _evaluated_first(statement: AST) -> set[int]:
    """The nodes of a statement that are evaluated once the statement is reached, before anything that it does."""
    heads = [getattr(statement, "test" if isinstance(statement, (tree.If, tree.While)) else "iter")] if isinstance(
        statement, (tree.If, tree.While, tree.For)) else [statement] if isinstance(statement, _SIMPLE) else []
    nodes = [n for h in heads for n in tree.walk(h)]
    later = [part for n in nodes for part in (
        [n.body, n.orelse] if isinstance(n, tree.IfExp) else n.values[1:] if isinstance(n, tree.BoolOp) else
        [n] if type(n).__name__ in _LATE else n.comparators[1:] if isinstance(n, tree.Compare) else [])]
    return {id(n) for n in nodes} - {id(n) for part in later for n in tree.walk(part)}


def _outside_blocks(statement: AST, change: Change) -> AST:
    """The statement with changes in all but the statements of its blocks; those of a function are its own."""
    if type(statement).__name__ == "FunctionDef":
        return tree.rebuild(statement, change)
    kept = {id(s) for field in _BLOCKS if isinstance(b := getattr(statement, field, None), list) for s in b}
    return tree.rebuild(statement, lambda n: n if id(n) in kept else change(n))


def _rebuilt(call: tree.Call, change: Change) -> tree.Call:
    """The call with changes in its parts."""
    keywords = [tree.keyword(k.arg, tree.rebuild(k.value, change)) for k in call.keywords]
    return tree.Call(tree.rebuild(call.func, change), [tree.rebuild(a, change) for a in call.args], keywords)


def _parts(call: tree.Call) -> list[AST]:
    return [call.func, *call.args, *(k.value for k in call.keywords)]


def _with(node: tree.Call, parts: dict[int, AST]) -> tree.Call:
    """The call with other parts in place of some."""
    def part(p: AST) -> AST:
        return tree.at(parts[id(p)], p) if id(p) in parts else p
    keywords = [tree.keyword(k.arg, part(k.value)) for k in node.keywords]
    return tree.at(tree.Call(part(node.func), [part(a) for a in node.args], keywords), node)
