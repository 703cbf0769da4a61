"""higher_order: a function that is given functions is read for these.

    def rk2(f, u, dt):              def rk2(u, dt):
        return u + dt * f(u)            return u + dt * decay(u)
    v = rk2(decay, u, 0.1)          v = rk2(u, 0.1)

    def scaled(x, act=np.tanh): ... def scaled(x): ...
    v = scaled(u)                   v = scaled(u)

What a nested function captures is given along with it. Requires a call whose function is known; for every set of
functions it is one function.
"""
from __future__ import annotations

from dataclasses import replace
from types import FunctionType

from s2sad import tree
from s2sad.diagnostics import S2sadError
from s2sad.live_objects.guards import taken
from s2sad.read.capture import captured_of
from s2sad.read.outside_values import AST, Captured, UserFunctionValue, Library, NotConstant, library_value
from s2sad.read.lambda_lifting import EnclosingNames, NestedFunction
from s2sad.live_objects.unwrap import partial_application
from s2sad.read.unique_names import unique_names
from s2sad.tree import Call, FunctionDef

Handed = dict[int | str, UserFunctionValue | Library]


def definition(function: UserFunctionValue) -> Captured:
    """What a function's handle gives, with a name for each variable; raises S2sadError."""
    return unique_names(captured_of(function.handle))


def by_default(node: Call, callee: UserFunctionValue) -> Handed:
    """The functions that a call leaves to the defaults of the callee's parameters."""
    handle = partial_application(callee.handle)[0] if isinstance(callee.handle, FunctionType) else callee.handle
    if isinstance(handle, FunctionType) and not any(map(callable, [
            *(taken(handle, "attribute", "__defaults__") or ()), *(handle.__kwdefaults__ or {}).values()])):
        return {}
    try:
        captured = definition(callee)
    except S2sadError:
        return {}                           # said where the callee is read
    if not isinstance(captured.tree, FunctionDef):
        return {}
    args = captured.tree.args
    positional = [*args.posonlyargs, *args.args]
    pairs = [*zip(positional[len(positional) - len(args.defaults):], args.defaults),
             *((a, d) for a, d in zip(args.kwonlyargs, args.kw_defaults) if d is not None)]
    given = {*(a.id for a in positional[:len(node.args)]), *(k.arg for k in node.keywords)}
    found = {a.id: _function_meant(captured, a.id, d) for a, d in pairs if a.id not in given and isinstance(
        d, (tree.Name, tree.Attribute))}
    return {n: f for n, f in found.items() if f is not None}


def _function_meant(captured: Captured, parameter: str, node: AST) -> UserFunctionValue | Library | None:
    """The function that is a parameter's default."""
    try:
        captured.default(parameter, node)
    except NotConstant as value:
        meaning = value.args[0] if value.args else None
        if isinstance(meaning, UserFunctionValue):
            return meaning
        if isinstance(meaning, Library) and meaning.path.startswith(("numpy.", "math.")):
            known = library_value(meaning.path)
            return meaning if callable(known) and not isinstance(known, type) else None
    return None


def higher_order(node: Call, callee: UserFunctionValue, given: Handed) -> tuple[UserFunctionValue, Call] | None:
    """The callee for the functions that a call gives it, by place or keyword, and the call without them; None if they
    do not fit its parameters."""
    captured = definition(callee)
    function = captured.tree
    if not isinstance(function, FunctionDef):
        return None
    positional = [a.id for a in (*function.args.posonlyargs, *function.args.args)]
    known = {*positional, *(a.id for a in function.args.kwonlyargs)}
    by_name = {positional[k] if isinstance(k, int) and k < len(positional) else k: f for k, f in given.items()}
    bound = {n.id for n in tree.walk(function.body) if isinstance(n, tree.Name) and isinstance(n.ctx, tree.Store)}
    if not set(by_name) <= known or bound & set(by_name):
        return None
    taken = {n.id for n in tree.walk(function) if isinstance(n, tree.Name)}
    inner: dict[str, UserFunctionValue | Library] = {}
    extra: list[tuple[str, str]] = []
    for parameter, f in by_name.items():
        names = []
        if isinstance(f, Library):
            inner[str(parameter)] = f
            continue
        for capture_name, here in f.given:
            made = f"{parameter}_{capture_name}"
            while made in taken:
                made += "_"
            taken.add(made)
            names.append((capture_name, made))
            extra.append((made, here))
        inner[str(parameter)] = replace(f, given=tuple(names))
    new = _without(function, set(inner), [made for made, _ in extra])
    key = ("handed", callee.key, tuple(sorted(
        (p, f.path if isinstance(f, Library) else repr(f.key)) for p, f in inner.items())))
    made = UserFunctionValue(callee.name, key, "", NestedFunction(replace(
        captured, tree=new, scope=EnclosingNames(captured.scope, inner))), callee.given)
    return made, _call_without(node, given, extra)


def _without(function: FunctionDef, gone: set[str], added: list[str]) -> FunctionDef:
    """The function without some parameters, and with others that go by keyword."""
    new = tree.copy(function)
    args = new.args
    positional = [*args.posonlyargs, *args.args]
    defaults = dict(zip([a.id for a in positional[len(positional) - len(args.defaults):]], args.defaults))
    only = [(a, d) for a, d in zip(args.kwonlyargs, args.kw_defaults) if a.id not in gone]
    args.posonlyargs = [a for a in args.posonlyargs if a.id not in gone]
    args.args = [a for a in args.args if a.id not in gone]
    args.defaults = [d for n, d in defaults.items() if n not in gone]
    args.kwonlyargs = [*(a for a, _ in only), *tree.function("_", added, []).args.args]
    args.kw_defaults = [*(d for _, d in only), *([None] * len(added))]
    return new


def _call_without(node: Call, given: Handed, extra: list[tuple[str, str]]) -> Call:
    args: list[AST] = [a for k, a in enumerate(node.args) if k not in given]
    keywords = [k for k in node.keywords if k.arg not in given]
    keywords += [tree.keyword(made, tree.at(tree.name(here), node)) for made, here in extra]
    return tree.at(Call(node.func, args, keywords), node)
