"""strengths: which numbers that functions of the user's return have a dtype for NumPy (infer/strong.py), and which of
their float32 arrays would be float64 for the numbers that they are given.

    y = scaled(x, p[0])         def scaled(x, s):
                                    return np.sum((x * s) ** 2)         x: float32, p: float64: refused

A function is made for types, in which a number of NumPy's and Python's own are one.
"""
from __future__ import annotations

from s2sad.diagnostics import Report
from s2sad.infer.infer import Typing
from s2sad.infer.strong import WEAK, Strong, together
from s2sad.naming import Names
from s2sad.normalize.inlined import Helpers, returned
from s2sad.normalize.widened import has_singles, mixtures
from s2sad.tree import Call, FunctionDef, Name, call_name, walk


class Strengths:
    """What the functions say that are called where `typing` has the types."""

    def __init__(self, helpers: Helpers, typing: Typing):
        self.helpers, self.typing = helpers, typing

    def results(self, node: Call, given: list[str]) -> tuple[str, ...]:
        """The dtypes of the numbers that a call returns."""
        found = self.called(node)
        if found is None:
            return (WEAK,) * len(self.typing.call_results(node))
        tree, typing = found
        strong = Strong(tree, typing, Strengths(self.helpers, typing).results, self.given(tree, given))
        return tuple(map(strong.of, returned(tree)))

    def called(self, node: Call) -> tuple[FunctionDef, Typing] | None:
        """The function that a call calls, and its types; None if it is not read."""
        kernel = (call_name(node) or "").partition(".")[2]
        source = self.helpers.program.kernels.get(kernel)
        if source is None or source.own is not None:
            return None
        tree = self.helpers.tree(kernel)
        types = dict(zip((p.id for p in tree.args.args), map(self.typing.argument, node.args)))
        return self.helpers.typing(tree, types, source.source, Names(n.id for n in walk(tree) if isinstance(n, Name)))

    def given(self, tree: FunctionDef, dtypes: list[str]) -> dict[str, str]:
        return {p.id: d for p, d in zip(tree.args.args, dtypes) if d}

    def refuse(self, function: FunctionDef, report: Report) -> None:
        """Reports calls whose function computes with another dtype for what it is given."""
        calls = [n for n in walk(function.body) if isinstance(n, Call) and (call_name(n) or "").startswith("user.")]
        strong = Strong(function, self.typing, self.results) if calls else None
        for node in calls if strong else ():
            numbers = [WEAK if self.typing.of(a).is_array else strong.of(a) for a in node.args]
            found = self.called(node) if together([*numbers, "float32"]) == "float64" else None
            if found is None or not has_singles(*found):
                continue
            inner = Strengths(self.helpers, found[1]).results
            if mixtures(*found, inner, self.given(found[0], numbers)) > mixtures(*found, inner, {}):
                report.error("S201", "a number of NumPy's with 64 bits makes float64 of float32 arrays in "
                             f"'{found[0].name}'", node, help="give it a Python number: float(p[0]), int(k[0])")


__all__ = ["Strengths"]
