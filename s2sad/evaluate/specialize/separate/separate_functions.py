"""separate_functions: residual functions beside the entry's, as reading takes them, and their names.
"""
from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.meanings import ResidualScope
from s2sad.evaluate.specialize.separate.returned_parts import is_separate
from s2sad.evaluate.specialize.values import FunctionValue
from s2sad.naming import Names
from s2sad.program import NestedDerivative
from s2sad.read.outside_values import Captured
from s2sad.tree import AST


@dataclass(frozen=True)
class SeparateFunction:
    """A residual function beside the entry's, as reading takes it; perhaps it stands for a derivative."""
    ev: Evaluator
    called: FunctionValue
    tree: Any
    nested: NestedDerivative | None = None

    def captured(self) -> Captured:
        scope = ResidualScope(self.ev.outside, self.called.captured.scope)
        return Captured(self.tree.name, self.tree, self.ev.source, scope, _no_default,
                        unsure=frozenset(self.ev.unsure))


def _no_default(parameter: str, node: AST) -> Any:
    raise KeyError(parameter)


def title_functions(ev: Evaluator, body: Sequence[AST], taken: Sequence[str]) -> None:
    """Names for the functions that stay functions, in the order in which they are called."""
    titles, met = Names(taken), set()

    def visit(block: Sequence[AST]) -> None:
        for n in tree.walk([*block]):
            if isinstance(n, tree.Call) and is_separate(n) and n.func.id not in met:
                met.add(n.func.id)
                meaning: Any = ev.outside[n.func.id]
                called, function = meaning.handle.called, meaning.handle.tree
                owner = f"{called.owner.name}_" if called.owner is not None else ""
                nested = meaning.handle.nested
                word = "" if nested is None else "_jacobian" if nested.matrix else (
                    "_gradient" if nested.mode == "adjoint" else "_derivative")
                function.name = titles.numbered(f"{owner}{called.captured.name}{word}")
                ev.outside[n.func.id] = replace(meaning, name=function.name)
                visit(function.body)
    visit(body)


def acts(s: Any, acting: Collection[str]) -> bool:
    """Whether a statement does more than to bind the function's own names."""
    if isinstance(s, tree.Assign):
        calls = isinstance(s.value, tree.Call) and is_separate(s.value) and s.value.func.id in acting
        return calls or not all(isinstance(t, (tree.Name, tree.Tuple)) for t in s.targets)
    return isinstance(s, (tree.AugAssign, tree.Expr, tree.Assert, tree.Raise))
