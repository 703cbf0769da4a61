"""needs_evaluation: whether a program that was read is made of more than arrays and numbers.

Requires a program with resolved names. Structures, attributes that are assigned, questions about what an argument is,
and tuples and lists that are given to functions are for the evaluator, which leaves a program of arrays and numbers.
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.evaluate.argument_binding import result_structure
from s2sad.evaluate.effects import bindings
from s2sad.program import Program
from s2sad.tree import (
    AST, Attribute, Compare, Dict, FunctionDef, IfExp, In, Is, IsNot, List, Name, NotIn, Slice, Store, Subscript, Tuple,
    Call, names, user_call, walk,
)


def needs_evaluation(program: Program) -> bool:
    """Whether the evaluator must say what the program is."""
    return bool(program.records) or any(
        any(map(_is_of_structures, walk(k.tree.body))) or gives_sequences(k.tree, program)
        for k in program.kernels.values())


def _is_of_structures(node: AST) -> bool:
    """Whether a node makes a structure, assigns an attribute or asks what something is."""
    if isinstance(node, Compare):
        return any(isinstance(op, (Is, IsNot, In, NotIn)) for op in node.ops)
    return isinstance(node, Dict) or isinstance(node, Attribute) and isinstance(node.ctx, Store)


def gives_sequences(function: FunctionDef, program: Program) -> bool:
    """Whether a function gives another one a tuple or a list, as far as the text shows it."""
    given = [_sliced(a) for call in walk(function.body) for a in _arguments(call)]
    if any(isinstance(a, (Tuple, List)) or _returns_several(a, program) for a in given):
        return True
    reached = _given_names(function)
    parts = {n for a in given if isinstance(a, Subscript) for n in names(a.value)}
    for target, value in bindings(function):
        bound = {n.id for n in walk(target) if isinstance(n, Name)}
        inside = any(_is_display(n) for n in walk(value) if n is not value)
        if isinstance(target, Name) and bound & reached and _is_several(value, program) or (
                not isinstance(target, Name) and bound & reached or _is_display(value) and bound & parts) and inside:
            return True
    return False


def _given_names(function: FunctionDef) -> set[str]:
    """The names that calls of user's functions are given, and those that are copied to these or put into them."""
    found = {n.id for call in walk(function.body) for a in _arguments(call) for n in _shown(a)}
    while True:
        more = {n.id for target, value in bindings(function) if isinstance(target, Name) and target.id in found
                for n in _shown(value)}
        if more <= found:
            return found
        found |= more


def _arguments(node: AST) -> list[AST]:
    """What a call of a user's function is given."""
    if not isinstance(node, Call) or user_call(node) is None:
        return []
    return [*node.args, *(k.value for k in node.keywords)]


def _sliced(value: AST) -> AST:
    """What a slice is taken of."""
    return value.value if isinstance(value, Subscript) and isinstance(value.slice, Slice) else value


def _is_display(node: AST) -> bool:
    return isinstance(node, (Tuple, List)) and not isinstance(node.ctx, Store)


def _is_several(value: AST, program: Program) -> bool:
    if isinstance(value, IfExp):
        return _is_several(value.body, program) or _is_several(value.orelse, program)
    return _is_display(value) or _returns_several(value, program)


def _returns_several(value: AST, program: Program) -> bool:
    called = user_call(value)
    return called is not None and result_structure(called, program) is not None


def _shown(value: AST) -> Iterator[Name]:
    """The names that a value is, or that stand as items in what it spells out."""
    value = _sliced(value)
    if isinstance(value, Name):
        yield value
    elif isinstance(value, (Tuple, List)):
        for item in value.elts:
            yield from _shown(item)
    elif isinstance(value, IfExp):
        yield from _shown(value.body)
        yield from _shown(value.orelse)
