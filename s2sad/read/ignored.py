"""ignored: what a kernel asks for and its derivative does not do, as warnings.

    for i in prange(n):         one iteration after the other
    print("residual", r)        nothing is printed
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.diagnostics import Diagnostic, Source, Span
from s2sad.tree import AST, Attribute, Call, For, Name, walk


def ignored(tree: AST, source: Source) -> Iterator[Diagnostic]:
    """A warning for each statement of a kernel that derivatives leave out or do otherwise."""
    for node in walk(tree):
        call = node.iter if isinstance(node, For) else node
        called = _name(call.func) if isinstance(call, Call) else ""
        if isinstance(node, For) and called == "prange":
            yield Diagnostic("S201", "derivatives run this loop one iteration after the other", Span.of(source, call),
                             help="range says the same", severity="warning")
        elif called == "print" and not isinstance(node, For):
            yield Diagnostic("S201", "derivatives do not print this", Span.of(source, call), severity="warning",
                             help="call the kernel itself, or autodiff with the primal, to see it")


def _name(function: AST) -> str:
    return function.id if isinstance(function, Name) else function.attr if isinstance(function, Attribute) else ""
