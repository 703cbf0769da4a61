"""positional_arguments: required arguments of NumPy's functions are positional.

    def f(x: "float64[:]"):                                     def f(x):
        return np.sum(np.clip(a=x, a_min=0.0, a_max=1.0))           return np.sum(np.clip(x, 0.0, 1.0))

Requires resolved names. Establishes that arguments for the required parameters of NumPy's functions are positional.
"""
from __future__ import annotations

import inspect
from functools import cache
from typing import Any

from s2sad.evaluate.effects import fresh_value
from s2sad.evaluate.scope import KernelScope
from s2sad.read.outside_values import library_value
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, Call, Constant, FloorDiv, For, FunctionDef, GeneratorExp, Load, Mod, Name,
    Slice, Subscript, Tuple, assign, at, attribute, call, call_name, const, copy, dump, index, indices, keyword, names,
    rebuild, tuple_of, user_call, walk,
)

# functions whose own signature is not there, or says less than how they are called
_REQUIRED = {
    "array": ("object",), "asarray": ("a",), "ascontiguousarray": ("a",), "clip": ("a", "a_min", "a_max"),
    "dot": ("a", "b"), "empty": ("shape",), "empty_like": ("prototype",), "inner": ("a", "b"), "vdot": ("a", "b"),
    "zeros": ("shape",),
}


def positional_arguments(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    new = copy(function)
    for node in walk(new.body):
        if call_name(node) == "builtins.divmod" and (len(node.args) != 2 or any(user_call(n) for n in walk(node))):
            scope.refuse(node, "divmod of what a call of a kernel gives", help="write a // b and a % b")
        if isinstance(node, Assign) and _flat_store(node) is not None and not fresh_value(node.value):
            array = _flat_target(node).value.value
            if scope.memory.affected(node.value, scope.memory.written([assign(index(array, const(0)), const(0))])):
                scope.refuse(node, "a store by number of what may share memory with the array",
                             help=f"np.put({array.id}, k, values) copies the values before")
    new.body = [rebuild(statement, _positional) for statement in new.body]
    return new


# functions and methods with a dtype and `out` before other options
_REDUCTIONS = frozenset("sum prod mean var std max min amax amin ptp cumsum cumprod nansum nanmean nanmax nanmin "
                        "nanvar nanstd median any all argmax argmin argsort".split())
# functions alone, with the number of arguments before their options
_OPERANDS = {"sort": 2, "unique": 1, "isin": 2, "setdiff1d": 2, "histogram": 2}


def _positional(node: AST) -> AST | None:
    if isinstance(node, Assign) and (stored := _flat_store(node)) is not None:
        return rebuild(stored, _positional)
    if isinstance(node, AugAssign) and (changed := _flat_change(node)) is not None:
        return _positional(changed)
    if isinstance(node, Subscript) and isinstance(node.ctx, Load) and _is_flat(node.value):
        taken = at(index(call("numpy.ravel", node.value.value), *indices(node)), node)
        return rebuild(at(call("numpy.copy", taken), node) if isinstance(node.slice, Slice) else taken, _positional)
    if isinstance(node, For) and _is_flat(node.iter) and node.iter.value.id not in names(node.body):
        return rebuild(_raveled_loop(node), _positional)
    if isinstance(node, Call) and (named := _without_defaults(node)) is not None:
        return rebuild(named, _positional)
    if call_name(node) == "builtins.divmod" and len(node.args) == 2:
        parts = [BinOp(*map(copy, (node.args[0], op, node.args[1]))) for op in (FloorDiv(), Mod())]
        return rebuild(at(tuple_of(*parts), node), _positional)
    if call_name(node) in ("builtins.any", "builtins.all") and len(node.args) == 1 and not isinstance(
            node.args[0], GeneratorExp):                # which stops early (comprehensions)
        return rebuild(at(call(f"numpy.{(call_name(node) or '')[9:]}", *node.args), node), _positional)
    if not isinstance(node, Call) or not node.keywords or not (call_name(node) or "").startswith("numpy."):
        return None
    options = {k.arg: k.value for k in node.keywords}
    args = list(node.args)
    for parameter in required_parameters(call_name(node) or "")[len(args):]:
        if parameter not in options:
            break
        args.append(options.pop(parameter))
    if len(args) == len(node.args):
        return None
    return rebuild(at(Call(node.func, args, [k for k in node.keywords if k.arg in options]), node), _positional)


@cache
def required_parameters(path: str) -> tuple[str, ...]:
    """The required parameters of a function of NumPy's, in order, as far as they have names."""
    word = path.partition(".")[2]
    if word in _REQUIRED:
        return _REQUIRED[word]
    try:
        found = inspect.signature(library_value(path)).parameters.values()
    except (TypeError, ValueError):
        return ()
    return tuple(p.name for p in found if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)
                 and p.default is p.empty)


_SORT_KINDS = {"kind": ("stable", "mergesort", "quicksort", "heapsort", None), "stable": (True, False, None)}


def _without_defaults(node: Call) -> Call | None:
    """A reduction with the options behind its axis by name, without a dtype or an `out` that is None."""
    function = call_name(node) or ""
    method = node.func.attr if isinstance(node.func, Attribute) else ""
    word = method or function.removeprefix("numpy.")
    known = word in _REDUCTIONS or function.removeprefix("numpy.") in _OPERANDS
    if not known or not (method or function.startswith("numpy.")):
        return None
    parameters = list(inspect.signature(library_value(f"numpy.{word}")).parameters)[bool(method):]
    first = 1 if method else _OPERANDS.get(word, 2)
    if len(node.args) > len(parameters):
        return None
    options: list[tuple[str | None, AST]] = [*zip(parameters[first:], node.args[first:])]
    options += [(k.arg, k.value) for k in node.keywords]
    kept = [(p, v) for p, v in options if not (
        p in ("dtype", "out") and isinstance(v, Constant) and v.value is None)]
    kept = _sort_options(kept, word) if word.endswith("sort") else kept
    if len(node.args) <= first and [(p, dump(v)) for p, v in kept] == [(p, dump(v)) for p, v in options]:
        return None
    return at(Call(node.func, node.args[:first], [at(keyword(str(p), v), v) for p, v in kept]), node)


def _sort_options(options: list[tuple[str | None, AST]], function: str) -> list[tuple[str | None, AST]]:
    """The options of a sort, a stable kind under the name that both engines know."""
    kinds = [(p, getattr(v, "value", None)) for p, v in options if p in ("kind", "stable")]
    if not all(k in _SORT_KINDS[p or ""] for p, k in kinds):
        return options
    left = [(p, v) for p, v in options if p not in ("kind", "stable")]
    keeps = any(k in ("stable", "mergesort", True) for _, k in kinds) and function == "argsort"
    return [*left, ("kind", Constant("mergesort", None))] if keeps else left


# -- elements in row-major order ---------------------------------------------------------------------------------------

def _is_flat(node: AST) -> bool:
    return isinstance(node, Attribute) and node.attr == "flat" and isinstance(node.value, Name)


def _flat_target(node: Assign) -> Any:
    """What is assigned to, `x.flat` as all its elements."""
    target = node.targets[0]
    return at(index(target, Slice(None, None, None)), target) if _is_flat(target) else target


def _flat_store(node: Assign) -> AST | None:
    """A store into `x.flat` as `np.put`, which counts elements alike, and begins the values again where they end."""
    target = _flat_target(node)
    if len(node.targets) > 1 or not isinstance(target, Subscript) or not _is_flat(target.value):
        return None
    if isinstance(target.slice, (Tuple, Constant)) and type(getattr(target.slice, "value", None)) is not int:
        return None
    array, places = target.value.value, target.slice
    if isinstance(places, Slice):
        places = at(index(call("numpy.arange", attribute(copy(array), "size")), places), target)
    stored = call("numpy.put", copy(array), places, node.value)
    return at(Assign([index(array, const(...))], at(stored, node), None), node)


def _flat_change(node: AugAssign) -> AST | None:
    """`x.flat[k] *= v` as a store: what is read is a number."""
    target = node.target
    if not isinstance(target, Subscript) or not _is_flat(target.value) or any(
            isinstance(n, Call) for n in walk(target.slice)):
        return None
    read = at(index(copy(target.value), copy(target.slice)), target)
    return at(Assign([target], at(BinOp(read, node.op, node.value), node), None), node)


def _raveled_loop(node: For) -> For:
    new = copy(node)
    new.iter = at(call("numpy.ravel", node.iter.value), node.iter)
    return new
