"""derivative_calls: derivatives that are called in what is evaluated: s2sad.gradient(f)(x), vjp, jvp, hvp, jacobian.

    g = s2sad.gradient(energy, "x")(x, k)       ->      g = energy_adjoint(x, k)

The function that is differentiated stays one (`separate_call`); what is called beside it stands for its derivative,
whose text is made once the types of the arguments are known (`units.nested_derivatives`).
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.functions.library_calls import Args, Options, function
from s2sad.evaluate.specialize.separate.separate_call import Made, SeparateFunctions, separate_function
from s2sad.evaluate.specialize.separate.separate_functions import SeparateFunction, acts
from s2sad.evaluate.specialize.values import (
    NONE, Data, FunctionValue, LibraryValue, Reference, TupleValue, Value, constant,
)
from s2sad.liveness import targets
from s2sad.naming import Names
from s2sad.program import NestedDerivative
from s2sad.read.outside_values import UserFunctionValue
from s2sad.tree import AST

_RETURN = "return"
_MODES = {"auto": "auto", "forward": "tangent", "reverse": "adjoint"}
_RECORDS, _DENSE = "the loops of what is differentiated record", "the matrix is dense, filled by one product at a time"
_NOT_HERE = {**dict.fromkeys(("checkpoint", "memory", "tape_dtype", "batch"), _RECORDS),
             **dict.fromkeys(("sparse", "format", "check", "threads"), _DENSE)}


@dataclass(frozen=True)
class _Inner:
    """A function that is differentiated: its residual name, the names of what it takes and what it is given, by the
    user's names their places among these, of those that it was given before `bound`; whether it returns one value."""
    of: FunctionValue
    name: str
    parameters: tuple[str, ...]
    given: tuple[Data, ...]
    places: Mapping[str, int]
    bound: frozenset[str]
    returns: bool


# -- what the user calls ---------------------------------------------------------------------------------------------
@function("s2sad.gradient")
def _gradient(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return _callable(ev, "s2sad.called.gradient", args, options, node)


@function("s2sad.value_and_gradient")
def _value_and_gradient(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return _callable(ev, "s2sad.called.value_and_gradient", args, options, node)


def _callable(ev: Evaluator, path: str, args: Args, options: Options, node: AST) -> LibraryValue:
    """A derivative that is called as its function is."""
    of, wrt = _arguments(ev, path.rpartition(".")[2], ("f", "wrt"), args, options, node)
    return LibraryValue(path, (of, wrt))


@function("s2sad.grad", "s2sad.value_and_grad")
def _by_position(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    """As JAX has it: of the first argument, if nothing is said."""
    title = ev.called
    of, positions = _arguments(ev, title, ("f", "argnums"), args, options, node)
    path = {"grad": "gradient", "value_and_grad": "value_and_gradient"}[title]
    return LibraryValue(f"s2sad.called.{path}", (of, constant(0) if _is_none(positions) else positions))


@function("s2sad.called.gradient", "s2sad.called.value_and_gradient")
def _called(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    of, wrt, *given = args
    with_value = ev.called == "value_and_gradient"
    inner = _inner(ev, of, given, options, wrt, node, f)
    asked = _names(ev, wrt, inner, node)
    value, found = _adjoint(ev, inner, asked, (_RETURN,), None, with_value, node)
    gradient = found[0] if len(asked) == 1 else ev.new_dict(dict(zip(asked, found)), node)
    return TupleValue((*value, gradient)) if with_value else gradient


@function("s2sad.vjp")
def _vjp(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    of, given, seeds, wrt = _arguments(ev, "vjp", ("f", "args", "seeds", "wrt"), args, options, node)
    inner = _inner(ev, of, ev.items_of(given, node, f), {}, wrt, node, f)
    weights = _by_name(ev, seeds, node, f)
    asked = _names(ev, wrt, inner, node, {*weights})
    _, found = _adjoint(ev, inner, asked, tuple(weights), list(weights.values()), False, node)
    return ev.new_dict(dict(zip(asked, found)), node)


@function("s2sad.jvp")
def _jvp(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    of, given, tangents, wanted = _arguments(ev, "jvp", ("f", "args", "tangents", "of"), args, options, node)
    along = _by_name(ev, tangents, node, f)
    inner = _inner(ev, of, ev.items_of(given, node, f), {}, along, node, f)
    outputs = _known_names(ev, wanted, inner.of, node) or (_RETURN,)
    return ev.new_dict(dict(zip(outputs, _tangent(ev, inner, along, outputs, node))), node)


@function("s2sad.hvp")
def _hvp(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    of, given, directions, wrt = _arguments(ev, "hvp", ("f", "args", "directions", "wrt"), args, options, node)
    along = _by_name(ev, directions, node, f)
    inner = _inner(ev, of, ev.items_of(given, node, f), {}, along if _is_none(wrt) else wrt, node, f)
    asked = _known_names(ev, wrt, inner.of, node) or tuple(along)
    if len(asked) != 1:
        raise ev.refusal(node, "hvp with respect to several arguments is not supported in a kernel",
                         help='call it for each: wrt="x"')
    gradient = _stands_for(ev, inner, NestedDerivative("adjoint", _places(inner, asked, ev, node), (-1,)), node)
    return _tangent(ev, replace(inner, name=gradient), along, (_RETURN,), node)[0]


@function("s2sad.jacobian")
def _jacobian(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    of, wrt, wanted, mode = _arguments(ev, "jacobian", ("f", "wrt", "of", "mode"), args, options, node)
    return LibraryValue("s2sad.called.jacobian", (of, wrt, wanted, mode))


@function("s2sad.called.jacobian")
def _called_jacobian(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    of, wrt, wanted, mode, *given = args
    inner = _inner(ev, of, given, options, wrt, node, f)
    outputs = _known_names(ev, wanted, inner.of, node) or (_RETURN,)
    asked = _names(ev, wrt, inner, node, {*outputs})
    if len(asked) != 1 or len(outputs) != 1:
        raise ev.refusal(node, "a Jacobian of several outputs, or with respect to several arguments, is not supported",
                         help='call it for each: wrt="x", of="y"')
    by = "auto" if _is_none(mode) else ev.known(mode, node, "the mode of a Jacobian")
    if by not in _MODES:
        raise ev.refusal(node, f"there is no mode {by!r}", help='"auto", "forward" or "reverse"')
    nested = NestedDerivative(_MODES[by], _places(inner, asked, ev, node), _places(inner, outputs, ev, node),
                              matrix=True)
    return _results(ev, inner, nested, [], ["jacobian"], node)[0]


_INSTEAD = {"value_and_jacobian": "call the function, and s2sad.jacobian of it",
            "hessian": 'take products with it: s2sad.hvp(f, args, {"x": v})'}


@function(*(f"s2sad.{title}" for title in _INSTEAD))
def _not_here(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    raise ev.refusal(node, f"s2sad.{ev.called} is not supported in a kernel", help=_INSTEAD[ev.called])


def _arguments(ev: Evaluator, title: str, names: Sequence[str], args: Args, options: Options, node: AST) -> list[Value]:
    """The arguments by name, None for what is not given."""
    given = {**dict(zip(names, args)), **options}
    wrong = next((k for k in given if k not in names), None)
    if len(args) > len(names) or wrong is not None:
        what = f"'{wrong}' of s2sad.{title}" if wrong else f"{len(args)} arguments of s2sad.{title}"
        advice = f"leave it out: {_NOT_HERE[wrong]}" if wrong in _NOT_HERE else ""
        raise ev.refusal(node, f"{what} is not supported in a kernel", help=advice)
    return [given.get(name, NONE) for name in names]


# -- the function that is differentiated -----------------------------------------------------------------------------
def _inner(ev: Evaluator, of: Value, args: Sequence[Value], keywords: Mapping[str, Value],
           wrt: Value | Mapping[str, Value], node: AST, f: Frame) -> _Inner:
    if not isinstance(of, FunctionValue) or of.captured is None:
        raise ev.refusal(node, f"the derivative of {ev.kind_of(of)}", help="give a function that can be read")
    of = _defined(ev, of)
    args, keywords = [*of.first, *args], {**dict(of.keywords), **keywords}
    asked = tuple(wrt) if isinstance(wrt, Mapping) else _known_names(ev, wrt, of, node)
    args, keywords, apart = _apart(ev, of, args, keywords, asked, node)
    found = separate_function(ev, of, args, keywords, node, f)
    if found is None:
        raise ev.refusal(node, f"the derivative of '{of.captured.name}' in a kernel: it must be a function of arrays "
                         "and numbers", help="let it take them as arguments, and return the one float that is meant")
    made, view = found
    leaves = [view.leaves[k] for k in made.leaves]
    places: dict[str, int] = {}
    for name, value in view.bound.items():
        alone = sum(isinstance(v, Data) and v.name == getattr(value, "name", None) for v in view.bound.values()) == 1
        place = next((k for k, leaf in enumerate(leaves) if isinstance(value, Data) and leaf.name == value.name), None)
        alone = alone and not (name in apart and made.acts and _writes(ev, made))   # the other one would be, too
        if alone and place is not None and not leaves[place].is_held:
            places[name] = place
    parameters = [a.id for a in of.captured.tree.args.args]
    bound = frozenset({*dict(of.keywords), *parameters[:len(of.first)]})
    returns = made.whole.kind == "leaf" and len(made.results) == 1
    return _Inner(view.function, made.name, tuple(leaf.name for leaf in leaves), tuple(leaf.outer for leaf in leaves),
                  places, bound, returns)


def _writes(ev: Evaluator, made: Made) -> bool:
    """Whether a function may do more than to bind its names and to add to sums, which begin with a literal."""
    meaning: Any = ev.outside[made.name]
    statements = list(tree.walk_statements(meaning.handle.tree.body))
    stored, begun, adds = Counter[str](), Counter[str](), Counter[str]()
    for statement in statements:
        bound = [n.id for t in targets(statement) for n in tree.walk(t) if isinstance(n, tree.Name)]
        stored.update(bound)
        if isinstance(statement, tree.AugAssign) and isinstance(statement.target, tree.Name):
            adds.update(bound)
        elif isinstance(statement, tree.Assign) and isinstance(statement.value, tree.Constant):
            begun.update(bound)
    sums = {n for n in begun if begun[n] + adds[n] == stored[n]}
    return any(acts(s, ev.separate.acting) for s in statements if not (
        isinstance(s, tree.AugAssign) and isinstance(s.target, tree.Name) and s.target.id in sums))


def _apart(ev: Evaluator, of: FunctionValue, args: Sequence[Value], keywords: Mapping[str, Value],
           asked: Sequence[str], node: AST) -> tuple[Sequence[Value], Mapping[str, Value], set[str]]:
    """The arguments, with what a derivative is with respect to under a name of its own where another argument is the
    same; the parameters for which this is so."""
    parameters = [a.id for a in of.captured.tree.args.args]
    bound = {**dict(zip(parameters, args)), **keywords}
    given = [v.name for v in bound.values() if isinstance(v, Data)]
    several: dict[str, Value] = {
        n: v for n, v in bound.items() if n in asked and isinstance(v, Data) and v.name and not v.is_list
        and not v.is_known and v.count is None and given.count(v.name) > 1}
    for parameter, value in several.items():
        assert isinstance(value, Data)
        same = tree.at(tree.UnaryOp(tree.UAdd(), tree.name(value.name)), node)      # of an array a new one
        bound[parameter] = ev.named(replace(value, node=same), parameter, node)
    return ([bound[n] for n in parameters[:len(args)]] if several else args,
            {n: bound[n] for n in keywords}, {*several})


def _defined(ev: Evaluator, of: FunctionValue) -> FunctionValue:
    """The function; of a lambda one that is defined."""
    definition: Any = of.captured.tree
    if type(definition).__name__ != "Lambda":
        return of
    ev.separate = ev.separate or SeparateFunctions()
    known = ev.separate.lambdas.get(id(definition))
    if known is None:
        made = tree.at(tree.FunctionDef("function", definition.args, [tree.Return(definition.body)], [], None, None,
                                        []), definition)
        known = ev.separate.lambdas[id(definition)] = replace(of.captured, tree=made)
        ev.held.append(definition)
    return replace(of, captured=known)


def _is_none(value: Value) -> bool:
    return isinstance(value, Data) and value.is_known and value.known is None


def _by_name(ev: Evaluator, value: Value, node: AST, f: Frame) -> dict[str, Value]:
    """Seeds or directions by the names of what they belong to."""
    if not isinstance(value, Reference) or ev.heap[value].kind != "dict":
        raise ev.refusal(node, f"{ev.kind_of(value)} in place of a dict by name", help='write {"x": v}')
    return {str(k): v for k, v in ev.dict_items(value, node, f).items()}


def _known_names(ev: Evaluator, value: Value, of: FunctionValue, node: AST) -> tuple[str, ...]:
    """The names that are asked for; a position counts parameters."""
    if _is_none(value):
        return ()
    items = value.items if isinstance(value, TupleValue) else list(ev.heap[value].items.values()) if isinstance(
        value, Reference) else [value]
    known = [v.known if isinstance(v, Data) else None for v in items]
    parameters = [a.id for a in of.captured.tree.args.args]
    named = [parameters[k] if type(k) is int and k < len(parameters) else k for k in known]
    if not all(isinstance(n, str) for n in named):
        raise ev.refusal(node, "what a derivative is with respect to must be known before the run",
                         help='write names: wrt="x"')
    return tuple(map(str, named))


def _names(ev: Evaluator, wrt: Value, inner: _Inner, node: AST, others: set[str] = set()) -> tuple[str, ...]:  # noqa: B006
    """What a derivative is with respect to: it is said, or there is only one."""
    found = _known_names(ev, wrt, inner.of, node) or tuple(
        p for p in inner.places if p not in others and p not in inner.bound)
    if _is_none(wrt) and len(found) != 1:
        raise ev.refusal(node, f"'{inner.of.captured.name}' takes several arguments",
                         help='say what the derivative is with respect to: wrt="x"')
    return found


def _places(inner: _Inner, asked: Sequence[str], ev: Evaluator, node: AST) -> tuple[int, ...]:
    """The places of parameters, -1 for what is returned."""
    for name in asked:
        if name == _RETURN and not inner.returns:
            raise ev.refusal(node, f"the derivative of what '{inner.of.captured.name}' returns: it is not one value "
                             "that it computes", help="let it return the one float or array that is meant")
        if name != _RETURN and name not in inner.places:
            raise ev.refusal(node, f"'{name}' is no array or number of '{inner.of.captured.name}' that it reads and "
                             "that is given by itself", help="give it as an argument of its own, np.copy(x)")
    return tuple(-1 if name == _RETURN else inner.places[name] for name in asked)


# -- the calls -------------------------------------------------------------------------------------------------------
def _adjoint(ev: Evaluator, inner: _Inner, wrt: tuple[str, ...], of: tuple[str, ...], seeds: list[Value] | None,
             with_value: bool, node: AST) -> tuple[list[Data], list[Data]]:
    """The value, if it is wanted, and the gradients."""
    nested = NestedDerivative("adjoint", _places(inner, wrt, ev, node), _places(inner, of, ev, node), with_value,
                              seeds is not None)
    hints = [*(["value"] if with_value else []), *(f"{w}_gradient" for w in wrt)]
    found = _results(ev, inner, nested, seeds or [], hints, node)
    return found[:with_value], found[with_value:]


def _tangent(ev: Evaluator, inner: _Inner, directions: Mapping[str, Value], of: tuple[str, ...], node: AST
             ) -> list[Data]:
    nested = NestedDerivative("tangent", _places(inner, [*directions], ev, node), _places(inner, of, ev, node), False,
                              True)
    hints = ["tangent" if o == _RETURN else f"{o}_tangent" for o in of]
    return _results(ev, inner, nested, list(directions.values()), hints, node)


def _results(ev: Evaluator, inner: _Inner, nested: NestedDerivative, seeds: list[Value], hints: list[str], node: AST
             ) -> list[Data]:
    """What the call of a derivative gives, under names."""
    called = _stands_for(ev, inner, nested, node)
    arguments = [ev.spelled(v, node) for v in (*inner.given, *seeds)]
    words = [ev.fresh(hint) for hint in hints]
    targets = list(map(tree.name, words))
    call = tree.at(tree.Call(tree.at(tree.name(called), node), arguments, []), node)
    ev.emit(tree.assign(targets[0] if len(targets) == 1 else tree.tuple_of(*targets), call), node)
    places = [-1] * (nested.with_value + nested.matrix) + [*_like(nested)]
    return [Data(tree.at(tree.name(w), node), shape=None if k < 0 else inner.given[k].shape)
            for w, k in zip(words, places)]


def _like(nested: NestedDerivative) -> tuple[int, ...]:
    """What results of a derivative are like, or what the axes of a matrix are like."""
    return (*nested.of, *nested.wrt) if nested.matrix else nested.wrt if nested.mode == "adjoint" else nested.of


def _stands_for(ev: Evaluator, inner: _Inner, nested: NestedDerivative, node: AST) -> str:
    """The residual name of the function that stands for a derivative: it calls what is differentiated, and gives what
    is like its results."""
    assert ev.separate is not None
    known, key = ev.separate.derivatives, (inner.name, nested)
    if key not in known:
        names = Names(inner.parameters)
        seeded = (nested.of if nested.mode == "adjoint" else nested.wrt) if nested.seeded else ()
        seeds = [names.fresh("seed") for _ in seeded]
        value = names.fresh("value")
        called = tree.call(inner.name, *map(tree.name, inner.parameters))
        like = [tree.name(value) if k < 0 else tree.binary(tree.const(0.0), tree.Mult(), tree.name(
            inner.parameters[k])) for k in _like(nested)]
        if nested.matrix:
            like = [tree.call("numpy.multiply.outer", *like)]
        results = [*([tree.name(value)] if nested.with_value else []), *like]
        body = [tree.assign(value, called) if inner.returns else tree.Expr(called),
                tree.Return(results[0] if len(results) == 1 else tree.tuple_of(*results))]
        made = tree.at(tree.function("", [*inner.parameters, *seeds], body), node)
        known[key] = f"separate.{len(ev.outside)}"
        handle = SeparateFunction(ev, inner.of, made, nested)
        ev.outside[known[key]] = UserFunctionValue(inner.of.captured.name, ("separate", id(handle)), "", handle)
    return known[key]
