"""type_table: the types of all names, once it is clear what contradicts itself.

Requires structured form (`declared_types`), one name a binding (`inferred_types`); establishes `context.typing`, whose
table the passes that make names add to. Changes nothing.
"""
from __future__ import annotations

from dataclasses import replace

from s2sad.infer.inference import inference
from s2sad.normalize.context import NormalContext
from s2sad.tree import FunctionDef


def reported_types(function: FunctionDef, context: NormalContext) -> None:
    """From here on what an expression contradicts is said when its type is asked for."""
    context.typing = context.typed(context.typing.with_ones(), context.report)


def declared_types(function: FunctionDef, context: NormalContext) -> None:
    """Refuses types that contradict each other, where no check has refused more precisely.

        def f(x: "float64[:]", n: int):
            a = x[0]
            if n > 1:
                a = "no"
            return a

    refused: 'a' is bound to float64 and to text
    """
    context.report.found += context.pending.found
    context.typing = context.typed(context.typing.with_ones(), context.report, final=True)


def inferred_types(function: FunctionDef, context: NormalContext) -> None:
    """The types of the names that `single_assignment` has made."""
    table = inference(function, context.given, context.callees.call_types, context.report, context.typing.constants)
    found = {n: replace(t, ones=ones) if t.is_array and (ones := context.typing.ones.get(n)) else t
             for n, t in table.items()}
    context.typing = context.typed(found, context.report)
