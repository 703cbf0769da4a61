"""Statements that memory does not depend on: once one has been run without an allocation, and what it binds is no
array and decides nothing, it is not run again."""
from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

_UNSPECIFIED = ("empty", "empty_like", "allocate", "sized")


class InertStatements:
    """What has been found to be so, in the functions of one text."""

    def __init__(self) -> None:
        self.found: set[ast.stmt] = set()

    def note(self, statement: ast.stmt, function: ast.FunctionDef) -> None:
        """A statement has been run, and has neither allocated nor bound an array nor called a function of the text."""
        if isinstance(statement, (ast.For, ast.If, ast.While)):
            inside = [*statement.body, *statement.orelse]
            if all(s in self.found or isinstance(s, ast.Pass) for s in inside) and not (
                    isinstance(statement, ast.For) and _names(statement.target) & deciding(function)):
                self.found.add(statement)
        elif isinstance(statement, (ast.Assign, ast.AugAssign, ast.Expr)):
            bound = {n.id for n in ast.walk(statement) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
            if not bound & deciding(function):
                self.found.add(statement)


@lru_cache(256)
def deciding(function: ast.FunctionDef) -> frozenset[str]:
    """The names of a function that sizes, trips, branches and calls depend on."""
    found = {n for node in ast.walk(function) for part in _decisions(node) for n in _names(part)}
    bindings = [(_names(target), _names(node.value) | _names(target)) for node in ast.walk(function)
                if isinstance(node, (ast.Assign, ast.AugAssign))
                for target in (node.targets if isinstance(node, ast.Assign) else [node.target])]
    while True:
        more = {n for bound, read in bindings if bound & found for n in read}
        if more <= found:
            return frozenset(found)
        found |= more


@lru_cache(256)
def unwritten(function: ast.FunctionDef) -> frozenset[str]:
    """The names of arrays of which the process has nothing in memory when they are made of unspecified content: stacks
    that grow, and those of which nothing is written, and nothing but the shape is read."""
    calls = [(_name_of(n), n.args[0]) for n in ast.walk(function) if isinstance(n, ast.Call) and n.args]
    stacks = {a.id for called, a in calls if called == "grow" and isinstance(a, ast.Name)}
    asked = [a for called, a in calls if called in ("empty_like", "zeros_like")]
    asked += [n.value for n in ast.walk(function) if isinstance(n, ast.Attribute) and n.attr in ("shape", "dtype")]
    made = {}
    for statement in ast.walk(function):
        if isinstance(statement, ast.Assign) and (name := allocated_name(statement)):
            made[name] = made.get(name, True) and _name_of(statement.value) in _UNSPECIFIED
    loads = Counter(n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load))
    shapes = Counter(n.id for n in asked if isinstance(n, ast.Name))
    return frozenset(stacks | {n for n, unspecified in made.items() if unspecified and loads[n] == shapes[n]})


def allocated_name(statement: ast.Assign) -> str:
    """The name of the array that a statement makes, by itself or with the place behind it in an arena."""
    target = statement.targets[0]
    if isinstance(target, ast.Tuple) and _name_of(statement.value) in ("allocate", "allocate_zeros"):
        target = target.elts[0]
    return target.id if isinstance(target, ast.Name) else ""


def _name_of(call: ast.AST) -> str:
    """The last part of the name of what is called."""
    called = getattr(call, "func", None)
    return getattr(called, "attr", "") or getattr(called, "id", "")


def _decisions(node: ast.AST) -> Iterator[ast.AST]:
    """The parts of a node that decide something, or of which nobody knows that they do not."""
    if isinstance(node, (ast.For, ast.comprehension)):
        yield node.iter
    elif isinstance(node, (ast.If, ast.While, ast.IfExp)):
        yield node.test
    elif isinstance(node, ast.Return) and node.value is not None:
        yield node.value
    elif isinstance(node, ast.Slice):
        yield from (p for p in (node.lower, node.upper, node.step) if p is not None)
    elif isinstance(node, ast.Call) and not _is_elementwise(node.func):
        yield from (*node.args, *(k.value for k in node.keywords))


def _is_elementwise(function: ast.expr) -> bool:
    return isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name) and (
        function.value.id == "math" or isinstance(getattr(np, function.attr, None), np.ufunc))


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
