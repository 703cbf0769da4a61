"""void_returns: calls of kernels without results that are returned stand alone.

    def step(u): u[0] = u[1]                def step(u): u[0] = u[1]
    def run(u):                             def run(u):
        return step(u)                          step(u)
                                                return

Requires resolved names.
"""
from __future__ import annotations

from dataclasses import replace

from s2sad import tree
from s2sad.program import Kernel
from s2sad.tree import AST


def void_returns(kernels: dict[str, Kernel]) -> dict[str, Kernel]:
    """The kernels, of which callees are first, without such returns."""
    kernels = dict(kernels)

    def gives(kernel: Kernel) -> bool:
        return kernel.own is not None or any(
            isinstance(n, tree.Return) and n.value is not None for n in tree.walk(kernel.tree.body))
    without = {n for n, k in kernels.items() if not gives(k)}

    def block(statements: list[AST]) -> list[AST]:
        made: list[AST] = []
        for s in statements:
            called = (tree.call_name(s.value) or "").removeprefix("user.") if isinstance(s, tree.Return) else ""
            if called in without:
                made += [tree.at(tree.Expr(s.value), s), tree.at(tree.Return(None), s)]
                continue
            for field in ("body", "orelse"):
                if isinstance(inner := getattr(s, field, None), list):
                    setattr(s, field, block(inner))
            made.append(s)
        return made
    for n, kernel in list(kernels.items()):
        returned = {(tree.call_name(s.value) or "").removeprefix("user.") for s in tree.walk(kernel.tree.body)
                    if isinstance(s, tree.Return)}
        if returned & without:
            definition = tree.copy(kernel.tree)
            definition.body = block(definition.body)
            kernels[n] = replace(kernel, tree=definition)
            without |= set() if gives(kernels[n]) else {n}
    return kernels
