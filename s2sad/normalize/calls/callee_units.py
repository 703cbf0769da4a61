"""callee_units: every call of a kernel names the unit for its arguments: for their types, and for aliases among them.

    def change(x, y):
        x[0] = x[0] * y[1]

is specialized for the call that passes one array twice:

    def f(x: "float64[:]", y: "float64[:]"):    def f(x, y):
        change(x, x)                                change_2(x)
        change(y, x)                                change(y, x)

Requires resolved views. Establishes that a call names what is called.
"""
from __future__ import annotations

from functools import cache

from s2sad.infer.shapes import shapes_of
from s2sad.normalize.calls.alias_specialization import alias_pairs
from s2sad.infer.path_conditions import path_conditions
from s2sad.normalize.context import NormalContext
from s2sad.tree import FunctionDef, copy, name, user_call, walk


def callee_units(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with such calls; arguments that may share elements are refused."""
    new, typing, callees = copy(function), context.typing, context.callees
    places = cache(lambda: path_conditions(new.body, shapes_of(function, typing)))
    for node in walk(new.body):
        if not user_call(node):
            continue
        unit = callees.of_call(node, typing)
        pairs = alias_pairs(node, unit.summary.written, typing, places, context.report)
        if pairs:
            node.args = [a for k, a in enumerate(node.args) if all(k != gone for gone, _ in pairs)]
            unit = callees.unit(unit.kernel.name, tuple(map(typing.argument, node.args)), pairs)
        node.func = name(f"user.{unit.title}")
    return new
