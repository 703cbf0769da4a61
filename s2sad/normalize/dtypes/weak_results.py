"""weak_results: which results of kernels are weak, numbers without a dtype of their own (infer/weak_types.py); others
promote float32 arrays (`float32_promotion`).

    def f(a: "float32[:]", p: "float64[:]"):    def f(a, p):
        s = a + p[0]                                s = np.float64(a) + p[0]
        return np.sum(s)                            return np.sum(s)

Requires structured form and types. Establishes that the float32 arrays of the kernel have the types that NumPy's
promotion gives them. A callee is made for types, in which a number of NumPy's and one of Python's are the same: a call
whose float32 arrays would be float64 for the numbers that are passed is refused.
"""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.weak_types import WEAK, StrongDtypes, promoted_dtype
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.normalize.calls.inline import Helpers, returned
from s2sad.normalize.context import NormalContext
from s2sad.normalize.dtypes.float32_promotion import float32_promotion, has_singles, mixtures
from s2sad.tree import Call, FunctionDef, Name, user_call, walk


Read = tuple[FunctionDef, Typing]


def weak_results(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with what NumPy would compute in float64 there; what its callees would is refused."""
    strengths = WeakResults(context.helpers, context.typing, context.known)
    wider = float32_promotion(function, context.typing, strengths.results)
    if wider is None:
        strengths.refuse(function, context.pending)
    return wider or function


def has_float32(context: NormalContext) -> bool:
    """Whether anything is of float32."""
    return context.singles or any(t.dtype == "float32" for t in context.typing.table.values())


@dataclass
class KnownResults:
    """What has been found of functions, by their names and the types, and the dtypes, that they are given."""
    read: dict[tuple[str, tuple[Type, ...]], Read] = field(default_factory=dict)
    results: dict[tuple[str, tuple[Type, ...], tuple[str, ...]], tuple[str, ...]] = field(default_factory=dict)


class WeakResults:
    """What the functions say that are called where `typing` has the types."""

    def __init__(self, helpers: Helpers, typing: Typing, known: KnownResults):
        self.helpers, self.typing, self.known = helpers, typing, known

    def results(self, node: Call, given: list[str]) -> tuple[str, ...]:
        """The dtypes of the numbers that a call returns, `WEAK` for a weak one."""
        found = self.callee(node)
        if found is None:
            return (WEAK,) * len(self.typing.call_results(node))
        tree, typing = found
        key = (*self.key(node), tuple(given))
        if key not in self.known.results:
            strong = StrongDtypes(tree, typing, self.for_typing(typing).results, _parameter_dtypes(tree, given))
            self.known.results[key] = tuple(map(strong.of, returned(tree)))
        return self.known.results[key]

    def for_typing(self, typing: Typing) -> WeakResults:
        return WeakResults(self.helpers, typing, self.known)

    def key(self, node: Call) -> tuple[str, tuple[Type, ...]]:
        return user_call(node) or "", tuple(map(self.typing.argument, node.args))

    def callee(self, node: Call) -> Read | None:
        """The function that a call calls, and its types; None if it is not read."""
        kernel, types = key = self.key(node)
        given = self.helpers.program.kernels.get(kernel)
        if given is None or given.own is not None:
            return None
        if key not in self.known.read:
            tree = self.helpers.tree(kernel, types)
            free = Names(n.id for n in walk(tree) if isinstance(n, Name))
            self.known.read[key] = self.helpers.typing(
                tree, dict(zip((p.id for p in tree.args.args), types)), given.source, free)
        return self.known.read[key]

    def refuse(self, function: FunctionDef, report: Report) -> None:
        """Reports calls whose function computes with another dtype for what it is given."""
        strong = StrongDtypes(function, self.typing, self.results)
        for node in walk(function.body):
            if not user_call(node):
                continue
            numbers = [WEAK if self.typing.of(a).is_array else strong.of(a) for a in node.args]
            found = self.callee(node) if promoted_dtype([*numbers, "float32"]) == "float64" else None
            if found is None or not has_singles(*found):
                continue
            inner = self.for_typing(found[1]).results
            if mixtures(*found, inner, _parameter_dtypes(found[0], numbers)) > mixtures(*found, inner, {}):
                report.error("S201", "a number of NumPy's with 64 bits makes float64 of float32 arrays in "
                             f"'{found[0].name}'", node, help="give it a Python number: float(p[0]), int(k[0])")


def _parameter_dtypes(tree: FunctionDef, dtypes: list[str]) -> dict[str, str]:
    """The dtypes of a function's parameters that have one."""
    return {p.id: d for p, d in zip(tree.args.args, dtypes) if d}


__all__ = ["KnownResults", "WeakResults"]
