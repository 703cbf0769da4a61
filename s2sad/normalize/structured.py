"""A kernel in structured form: the first half of normalize.

Requires a fenced tree with resolved names. Establishes, in this order: slices have no names (sliced),
lists that grow are arrays (lists), no name holds several results (bundles),
one target per assignment and pure expressions (desugar), control flow with one return and breaks in tail
position (jumps), loops that count (loops).
"""
from __future__ import annotations

from s2sad.naming import Names
from s2sad.normalize.bundles import bundles
from s2sad.normalize.desugar import desugar
from s2sad.normalize.jumps import jumps
from s2sad.normalize.lists import lists
from s2sad.normalize.loops import loops
from s2sad.normalize.memory import Memory
from s2sad.normalize.scope import Scope
from s2sad.normalize.sliced import sliced
from s2sad.program import Kernel, Program
from s2sad.tree import FunctionDef, Name, copy, walk


def structured(kernel: Kernel, names: Names, program: Program) -> FunctionDef:
    """The kernel's tree in structured form; new names come from `names`. Raises S2sadError."""
    tree = copy(kernel.tree)
    names.taken |= {node.id for node in walk(tree) if isinstance(node, Name)}
    scope = Scope(kernel, names, program, Memory(tree, program))
    for step in (sliced, lists, bundles, desugar, jumps, loops):
        tree = step(tree, scope)
        scope.report.finish()
    return tree
