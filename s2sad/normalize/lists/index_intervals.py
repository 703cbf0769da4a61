"""index_intervals: between which numbers a place in a list lies, as far as the text shows it.

    k for k in range(1, n): 1 and more          t % 2: 0 to 1          1 - t % 2: 0 to 1

Requires resolved names; changes nothing.
"""
from __future__ import annotations

from s2sad.tree import (
    AST, Add, Assign, BinOp, Constant, For, FunctionDef, Mod, Name, Store, Sub, UnaryOp, USub, call_name, walk,
)

Span = tuple[int | None, int | None]
_DEEPEST = 8


class IndexIntervals:
    """The names of one function and what binds them."""

    def __init__(self, function: FunctionDef):
        self.function = function

    def from_start(self, place: AST) -> bool:
        """Whether a place is never negative."""
        low, _ = self.span(place)
        return low is not None and low >= 0

    def span(self, node: AST, depth: int = 0) -> Span:
        """What an integer is at least, and at most; None where that is not known."""
        if isinstance(node, Constant):
            return (node.value, node.value) if type(node.value) is int else (None, None)
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            low, high = self.span(node.operand, depth)
            return None if high is None else -high, None if low is None else -low
        if isinstance(node, Name):
            return self.of_name(node.id, depth)
        if not isinstance(node, BinOp):
            return None, None
        if isinstance(node.op, Mod):
            whole = type(getattr(node.right, "value", None)) is int and node.right.value > 0
            return (0, node.right.value - 1) if whole else (None, None)
        if not isinstance(node.op, (Add, Sub)):
            return None, None
        one, other = self.span(node.left, depth), self.span(node.right, depth)
        other = other if isinstance(node.op, Add) else other[::-1]
        sign = 1 if isinstance(node.op, Add) else -1
        low, high = (None if a is None or b is None else a + sign * b for a, b in zip(one, other))
        return low, high

    def of_name(self, identifier: str, depth: int) -> Span:
        low = self.least(identifier)
        if low is not None or depth > _DEEPEST:
            return low, None
        bound = [s for s in walk(self.function.body) if isinstance(s, Assign) and any(
            isinstance(t, Name) and t.id == identifier for t in s.targets)]
        once = len(bound) == self.stores(identifier) == 1 and len(bound[0].targets) == 1
        return self.span(bound[0].value, depth + 1) if once else (None, None)

    def stores(self, identifier: str) -> int:
        given = any(p.id == identifier for p in self.function.args.args)
        return given + sum(isinstance(n, Name) and n.id == identifier and isinstance(n.ctx, Store)
                           for n in walk(self.function.body))

    def least(self, identifier: str) -> int | None:
        """The least value of a name that only loops over ranges with written starts bind."""
        loops = [s for s in walk(self.function.body) if isinstance(s, For) and isinstance(s.target, Name)
                 and s.target.id == identifier]
        if not loops or len(loops) != self.stores(identifier):
            return None
        lows = [_low(s.iter) for s in loops]
        return None if None in lows else min(low for low in lows if low is not None)


def _low(iterable: AST) -> int | None:
    args = getattr(iterable, "args", [])
    if call_name(iterable) != "builtins.range" or len(args) == 3:
        return None
    if len(args) == 1:
        return 0
    return args[0].value if isinstance(args[0], Constant) and type(args[0].value) is int else None
