"""hoist_definitions: functions that are defined in a branch or a loop, or several times, are defined once, at the
beginning.

    if opt == 1:                        g_1 = lambda d: d * a
        g = lambda d: d * a             g_2 = lambda d: d / a
    else:                               if opt == 1:
        g = lambda d: d / a                 g_which = 1
    y = g(x)                            else:
                                            g_which = 2
                                        y = g_1(x) if g_which == 1 else g_2(x)

    for i in range(3):                  g = lambda q: a * q + i
        g = lambda q: a * q + i         for i in range(3):
        s += g(x[i])                        s += g(x[i])

Python reads what a function captures when it is called, so it does not matter where it is defined; what depends on
that place, a default that is computed or a decorator, leaves a definition where it is, to be refused. One that a call
may come before is one of several, none of which has to have been reached.
"""
from __future__ import annotations

import itertools
from collections.abc import Iterable

from s2sad import tree
from s2sad.tree import AST, FunctionDef

_BLOCKS = ("body", "orelse")


def hoist_definitions(function: FunctionDef) -> FunctionDef:
    """The function in which definitions stand at its beginning, each with a name of its own."""
    if not isinstance(function, FunctionDef) or not any(
            type(n).__name__ in ("Lambda", "FunctionDef") for s in function.body for n in tree.walk(s)):
        return function
    new = tree.copy(function)
    new.body = [made for s in new.body for made in _chosen(s)]
    done: set[str] = set()
    while name := _one_moved(new, done):
        done.add(name)
    return new


def _one_moved(new: FunctionDef, done: set[str]) -> str:
    """Moves the definitions of one more name, which it gives; those of others may call it, and change with it."""
    nodes = [n for s in new.body for n in tree.walk(s)]
    found: dict[str, list[AST]] = {}
    for statement in _statements(new.body):
        if (name := defines(statement)) and name not in done and _is_plain(statement):
            found.setdefault(name, []).append(statement)
    top = {id(s) for s in new.body}
    for name, definitions in found.items():
        if len(definitions) == 1 and id(definitions[0]) in top or not _is_only_called(name, definitions, new, nodes):
            continue
        if len(definitions) == 1 and _is_ahead(definitions[0], name, new.body):
            new.body = [definitions[0], *_without(new.body, definitions[0])]
        else:
            new.body = _numbered(name, definitions, new, {n.id for n in nodes if isinstance(n, tree.Name)})
        return name
    return ""


def defines(statement: AST) -> str:
    """The name of the function that a statement defines, with `def` or as a name for a lambda; "" for any other."""
    if type(statement).__name__ == "FunctionDef":
        return statement.name
    named = isinstance(statement, tree.Assign) and len(statement.targets) == 1 and isinstance(
        statement.targets[0], tree.Name) and type(statement.value).__name__ == "Lambda"
    return statement.targets[0].id if named else ""


def _chosen(statement: AST) -> list[AST]:
    """`g = A if c else B` of two lambdas, and what is in a statement of these, as branches."""
    if type(statement).__name__ == "FunctionDef":
        return [statement]
    for field in _BLOCKS:
        if isinstance(block := getattr(statement, field, None), list):
            setattr(statement, field, [made for s in block for made in _chosen(s)])
    value = statement.value if isinstance(statement, tree.Assign) else None
    if isinstance(value, tree.IfExp) and all(type(v).__name__ in ("Lambda", "IfExp") for v in (
            value.body, value.orelse)) and any(type(v).__name__ == "Lambda" for v in tree.walk(value)):
        arms = [_chosen(tree.at(tree.Assign([tree.copy(t) for t in statement.targets], v, None), statement))
                for v in (value.body, value.orelse)]
        return [tree.at(tree.If(value.test, *arms), statement)]
    return [statement]


def _statements(block: Iterable[AST]) -> Iterable[AST]:
    """The statements of a block and of those within, without those of nested functions."""
    for statement in block:
        yield statement
        if type(statement).__name__ != "FunctionDef":
            for field in _BLOCKS:
                yield from _statements(getattr(statement, field, None) or [])


def _is_plain(statement: AST) -> bool:
    """Whether a definition means the same wherever it stands."""
    given = statement.args if type(statement).__name__ == "FunctionDef" else statement.value.args
    defaults = [d for d in (*given.defaults, *given.kw_defaults) if d is not None]
    return not getattr(statement, "decorator_list", None) and all(isinstance(d, tree.Constant) for d in defaults)


def _is_only_called(name: str, definitions: list[AST], function: FunctionDef, nodes: list[AST]) -> bool:
    """Whether a name is bound by its definitions alone, and otherwise called, or given to a call."""
    given = function.args
    parameters = [a.id for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    own = {id(d.targets[0]) for d in definitions if isinstance(d, tree.Assign)}
    named = [n for n in nodes if isinstance(n, tree.Name) and n.id == name and id(n) not in own]
    others = [n for n in nodes if type(n).__name__ == "FunctionDef" and n.name == name
              and not any(n is d for d in definitions)]
    called = {id(part) for n in nodes if isinstance(n, tree.Call) for part in _parts(n)}
    return name not in parameters and not others and all(id(n) in called for n in named)


def _parts(call: tree.Call) -> list[AST]:
    return [call.func, *call.args, *(k.value for k in call.keywords)]


def _is_ahead(definition: AST, name: str, block: list[AST]) -> bool:
    """Whether a definition stands in a block before all that reads its name."""
    for position, statement in enumerate(block):
        if statement is definition:
            return True
        if any(n is definition for n in tree.walk(statement)):
            after = [n for s in block[position + 1:] for n in tree.walk(s)]
            blocks = [getattr(statement, f, None) or [] for f in _BLOCKS]
            inner = [b for b in blocks if any(n is definition for s in b for n in tree.walk(s))]
            head = [n for c in tree.children(statement) if not any(c is s for b in blocks for s in b)
                    for n in tree.walk(c)]
            after += head
            return len(inner) == 1 and not _reads(after, name) and _is_ahead(definition, name, inner[0])
        if _reads(tree.walk(statement), name):
            return False
    return False


def _reads(nodes: Iterable[AST], name: str) -> bool:
    return any(isinstance(n, tree.Name) and n.id == name for n in nodes)


def _without(block: list[AST], definition: AST) -> list[AST]:
    """The block without a definition that is in it, or in one within."""
    return [made for s in block for made in _replaced(s, {id(definition): tree.Pass()})]


def _replaced(statement: AST, by: dict[int, AST]) -> list[AST]:
    if id(statement) in by:
        return [tree.at(by[id(statement)], statement)]
    if type(statement).__name__ != "FunctionDef":
        for field in _BLOCKS:
            if isinstance(block := getattr(statement, field, None), list):
                setattr(statement, field, [made for s in block for made in _replaced(s, by)])
    return [statement]


def _numbered(name: str, definitions: list[AST], function: FunctionDef, taken: set[str]) -> list[AST]:
    """The body with a name for each definition, and a number that tells which was the last."""
    free = (n for k in itertools.count() for n in [f"{name}_which{'_' * k}"] if n not in taken)
    which = next(free)
    ones: list[str] = []
    by: dict[int, AST] = {}
    for number, definition in enumerate(definitions, 1):
        ones.append(next(n for k in itertools.count() for n in [f"{name}_{number}{'_' * k}"] if n not in taken))
        by[id(definition)] = tree.assign(which, tree.const(number))
    body = [made for s in function.body for made in _replaced(s, by)]
    named = [_renamed(d, one) for d, one in zip(definitions, ones)]

    def change(node: AST) -> AST | None:
        if not isinstance(node, tree.Call) or not any(isinstance(p, tree.Name) and p.id == name for p in _parts(node)):
            return None
        inner = tree.Call(*(tree.rebuild(p, change) if not isinstance(p, (list, tree.Name)) else
                            [tree.rebuild(i, change) for i in p] if isinstance(p, list) else p
                            for p in (node.func, node.args, node.keywords)))
        calls = [tree.at(tree.rename(inner, {name: one}), node) for one in ones]
        made = calls[-1]
        for number, one in reversed(list(enumerate(calls[:-1], 1))):
            test = tree.compare(tree.name(which), tree.Eq(), tree.const(number))
            made = tree.at(tree.IfExp(test, one, made), node)
        return made
    return [tree.rebuild(s, change) for s in (*named, *body)]


def _renamed(definition: AST, name: str) -> AST:
    """The definition under another name."""
    new = tree.copy(definition)
    if isinstance(new, tree.Assign):
        new.targets = [tree.at(tree.Name(name, tree.Store(), None, None), definition)]
    else:
        new.name = name
    return new
