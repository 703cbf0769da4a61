"""call_graph: which kernel of a program calls which, with the calls themselves."""
from __future__ import annotations

from s2sad.program import Program
from s2sad.tree import Call, call_name, walk

Calls = dict[str, list[tuple[str, Call]]]


def calls(program: Program) -> Calls:
    """The calls of every kernel, each with its caller, in the order of the program. Use it as `program.once(calls)`."""
    found: Calls = {}
    for title, kernel in program.kernels.items():
        for node in walk(kernel.tree.body):
            if isinstance(node, Call) and (called := call_name(node) or "").startswith("user."):
                found.setdefault(called.removeprefix("user."), []).append((title, node))
    return found
