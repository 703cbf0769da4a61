"""needs_evaluation: whether a program that was read is made of more than arrays and numbers.

    a, b = b, (a, x)[k]         the tuple that a variable picks from is a value of its own, that of the targets none
    us = [x, y]                 neither is the list that a function of arrays is given: np.concatenate([x, y])

Requires a program with resolved names. Structures, tuples and lists as values of their own, slices under names,
attributes that are assigned, questions about what an argument is, options that a name stands for, comprehensions and
loops through anything but a range are for the evaluator, which leaves a program of arrays and numbers.
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.evaluate.argument_binding import OPTIONS, parameters_of_library, result_count
from s2sad.evaluate.library import WITH_OPTION, WRITTEN
from s2sad.evaluate.library.lists import METHODS
from s2sad.program import Program
from s2sad.tree import (
    AST, Assign, Attribute, Call, Compare, Constant, Dict, Expr, For, FunctionDef, GeneratorExp, In, Is, IsNot, List,
    ListComp, Name, NotIn, Return, Slice, Starred, Store, Subscript, Tuple, call_name, user_call, walk,
)

_ASKED = ("builtins.isinstance", "numpy.isscalar", "numpy.ndim")
_SHAPED = ("numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full")
_SLICES = ("builtins.slice", "numpy.s_", "numpy.index_exp")


def needs_evaluation(program: Program) -> bool:
    """Whether the evaluator must say what the program is."""
    by_default = any(isinstance(d, tuple) for k in program.kernels.values() for d in k.defaults.values())
    return bool(program.records) or by_default or any(
        _is_evaluated(k.tree, program) for k in program.kernels.values())


def _is_evaluated(function: FunctionDef, program: Program) -> bool:
    spelled: set[int] = set()       # what belongs to the spelling of a node around it
    lists = {n.func.value.id for n in walk(function.body) if isinstance(n, Call) and isinstance(n.func, Attribute)
             and n.func.attr == "append" and isinstance(n.func.value, Name)}
    for node in walk(function.body):
        if lists and _is_of_list(node, lists) or _asks(node) or _is_together(
                node, program) and id(node) not in spelled or _returns_nothing(node, program):
            return True
        spelled.update(map(id, _spelled(node)))
    return False


def _is_of_list(node: AST, lists: set[str]) -> bool:
    """Whether a node takes a part of a list that grows, orders it or changes it within."""
    if isinstance(node, Subscript):
        return isinstance(node.value, Name) and node.value.id in lists and isinstance(node.slice, Slice)
    if not isinstance(node, Call):
        return False
    of = node.func.value if isinstance(node.func, Attribute) and node.func.attr in METHODS else (
        node.args[0] if call_name(node) == "builtins.sorted" and node.args else None)
    return isinstance(of, Name) and of.id in lists and (call_name(node) is not None or not (
        node.func.attr == "pop" and all(isinstance(a, Constant) for a in node.args)))


def _asks(node: AST) -> bool:
    """Whether a node makes a structure or a slice, assigns an attribute, asks what something is, names an option, goes
    through anything but a range."""
    if isinstance(node, Compare):
        return any(isinstance(op, (Is, IsNot, In, NotIn)) for op in node.ops)
    if isinstance(node, Name):
        return node.id in _SLICES
    if isinstance(node, Attribute):
        return isinstance(node.ctx, Store) or node.attr == "ndim"
    if isinstance(node, Assign):
        nothing = isinstance(node.value, Constant) and node.value.value is None
        return nothing or len(node.targets) > 1 and any(isinstance(t, Subscript) for t in node.targets)
    if isinstance(node, Subscript):
        return call_name(node.value) == "builtins.zip"      # a module's rows of numbers
    if isinstance(node, Call):
        return _is_written(node) or call_name(node) in _ASKED or _is_shaped_outside(node) or any(
            option in OPTIONS and not _is_known(value) for option, value in arguments_by_name(node))
    if isinstance(node, For):
        return call_name(node.iter) != "builtins.range"
    return isinstance(node, (Dict, GeneratorExp, ListComp))


def _is_shaped_outside(node: Call) -> bool:
    """Whether a shape that something gets is a tuple or a list of a module, which is an array of numbers elsewhere."""
    given = [*arguments_by_name(node), *(("shape", a) for a in node.args[:1] if call_name(node) in _SHAPED)]
    return any(option == "shape" and isinstance(value, Name) and value.id.startswith("array.")
               for option, value in given)


def _is_written(node: Call) -> bool:
    """Whether a call may be one of what the evaluator reads a function for."""
    called = call_name(node) or (f"numpy.{node.func.attr}" if isinstance(node.func, Attribute) else "")
    _, options = WITH_OPTION.get(called, (None, ()))
    if any(k.arg in options for k in node.keywords):
        return True
    path, given = call_name(node) or "", [*node.args, *(k.value for k in node.keywords)]
    if path == "numpy.append":
        return len(given) > 2
    if path in ("numpy.linspace", "numpy.expand_dims"):
        return any(isinstance(a, (List, Subscript, Tuple)) for a in given[:2])
    return path in WRITTEN or called in WRITTEN or path == "numpy.unravel_index" or (
        path.startswith("numpy.polynomial.") and path.endswith("gauss"))


def _is_known(option: AST) -> bool:
    """Whether an option is written where it is given."""
    return not any(isinstance(n, Name) and not n.id.startswith(("builtins.", "numpy.")) for n in walk(option))


def _is_together(node: AST, program: Program) -> bool:
    """Whether several values are one for a node: a tuple, a list, what a function returns that gives several."""
    if isinstance(node, (Tuple, List)):
        return not isinstance(node.ctx, Store)
    if isinstance(node, Starred) or call_name(node) in ("builtins.divmod", "numpy.meshgrid"):
        return True
    called = user_call(node)
    return called is not None and result_count(called, program) > 1


def _returns_nothing(node: AST, program: Program) -> bool:
    """Whether what a function gives is returned that gives nothing."""
    called = user_call(node.value) if isinstance(node, Return) else None
    return called is not None and result_count(called, program) == 0 and program.kernels[called].own is None


def _spelled(node: AST) -> Iterator[AST]:
    """What belongs to the spelling of a node: the tuples of an assignment, of a return and of a subscript, the displays
    that a function of arrays is given."""
    if isinstance(node, Assign):
        for target in node.targets:
            yield from _side_by_side(target, node.value)
        if isinstance(node.value, List) and not node.value.elts:
            yield node.value        # a list that grows
    elif isinstance(node, (Return, Expr)) and isinstance(node.value, (Tuple, Call)):
        yield from () if isinstance(node.value, Tuple) and len(node.value.elts) == 1 else (node.value,)
    elif isinstance(node, Subscript):
        yield from _displays(node.slice)
    elif isinstance(node, Call) and _is_of_arrays(node):
        for given in [*node.args, *(k.value for k in node.keywords)]:
            yield from _displays(given)
    elif isinstance(node, (Tuple, List)) and isinstance(node.ctx, Store):
        yield from node.elts
    elif isinstance(node, Call) and call_name(node) == "builtins.isinstance":
        yield from node.args


def _side_by_side(target: AST, value: AST) -> Iterator[AST]:
    """The displays and calls of which a target takes each item by itself."""
    if isinstance(target, (Tuple, List)) and not any(isinstance(t, Starred) for t in target.elts):
        yield value
        if isinstance(value, (Tuple, List)):
            for t, v in zip(target.elts, value.elts):
                yield from _side_by_side(t, v)


def _displays(value: AST) -> Iterator[AST]:
    if isinstance(value, (Tuple, List)):
        yield value
        for item in value.elts:
            yield from _displays(item)


def _is_of_arrays(node: Call) -> bool:
    """Whether a call is one of a library's function or of an array's method."""
    called = call_name(node) or ""
    if isinstance(node.func, Attribute):
        return node.func.attr not in ("append", "insert", "extend")
    return not called.startswith(("user.", "builtins."))


def arguments_by_name(node: Call) -> Iterator[tuple[str, AST]]:
    """The arguments of a function of NumPy's, or of an array's method, by the names of its parameters."""
    called = call_name(node)
    places = parameters_of_library(called) if called is not None else parameters_of_library(
        f"numpy.{node.func.attr}")[1:] if isinstance(node.func, Attribute) else ()
    yield from zip(places, node.args)
    yield from ((k.arg, k.value) for k in node.keywords if k.arg)
