"""operand_aliases: which names share the memory of a view that a function makes, and which that of its operand.

    du = np.reshape(dy[:k], (n, n))         view: du, row           operand: dy
    dv = np.reshape(dy[k:], (n, n))         (dv shares none of what du is a view of)
    row = du[0]
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from s2sad.liveness import base_name
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import single_values
from s2sad.normalize.views.disjoint_slices import DisjointSlices, occurrences
from s2sad.normalize.views.unsupported_views import sources
from s2sad.tree import AST, Assign, Attribute, For, FunctionDef, Name, Subscript, copy, dump, times_bound, walk


@dataclass
class OperandAliases:
    """The names on both sides; `required` are numbers that must not be negative for other parts to be others;
    `ambiguous` if a name may be on either side."""
    view: set[str]
    operand: set[str]
    ambiguous: bool
    part: AST
    disjoint: DisjointSlices
    required: list[AST] = field(default_factory=list)

    def concerned(self, told: Iterable[tuple[str, str]]) -> bool:
        """Whether the view is on one side of what tells two arrays apart."""
        return any({n, other} & self.view for n, other in told)

    def mentioned(self, node: AST | list[AST]) -> tuple[bool, bool]:
        """Whether elements of the view, and of what it is a view of, are mentioned."""
        shapes = {id(n.value) for n in walk(node) if isinstance(n, Attribute) and n.attr in ("shape", "size", "dtype")}
        found = [n for n in occurrences(node) if id(n) not in shapes]
        return (any(base_name(n) in self.view for n in found),
                any(base_name(n) in self.operand and not self.other(n) for n in found))

    def other(self, occurrence: AST) -> bool:
        """Whether a part of an array is known to be another one than that of the view."""
        if base_name(occurrence) != base_name(self.part):
            return False
        needed = self.disjoint.apart(self.part, occurrence)
        if needed:
            known = {dump(n) for n in self.required}
            self.required += [copy(n) for n in needed if dump(n) not in known]
        return needed is not None


def operand_aliases(function: FunctionDef, binding: Assign, typing: Typing) -> OperandAliases:
    """Both sides of a view."""
    values = single_values(function)
    part = binding.value.args[0]
    edges = [(s.targets[0].id, source) for s in walk(function.body) if s is not binding
             for source, _ in sources(s, typing)]
    view, operand = {binding.targets[0].id}, {base_name(part)}
    while more := {t for t, source in edges if base_name(source) in view} - view:
        view |= more
    both = OperandAliases(view, operand, False, _resolved(part), DisjointSlices(function, values))
    if base_name(part) not in values:
        both.part = Name("", part.ctx, None, None)      # what is bound anew has no parts that are known to be others
    edges = [(t, source) for t, source in edges if not both.other(source)]
    while more := {n for t, source in edges for n in (t, base_name(source))
                   if {t, base_name(source)} & operand and not {t, base_name(source)} & view} - operand:
        operand |= more
    both.ambiguous = bool(view & operand) or any(
        t in view and base_name(source) not in view for t, source in edges) or _is_bound_to_others(function, both, [
            binding.targets[0].id, *(t for t, _ in edges)])
    return both


def _is_bound_to_others(function: FunctionDef, both: OperandAliases, known: list[str]) -> bool:
    """Whether a name of either side is bound to memory of its own as well, in a branch or in a loop: then it shares
    none of the other side's. `known` are the names as often as they are bound to what is on a side."""
    times = times_bound(function.body, Assign, For)
    times.update(p.id for p in function.args.args)
    sides = Counter(known)
    return any(times[n] > sides[n] for n in both.view) or any(times[n] > max(sides[n], 1) for n in both.operand)


def _resolved(part: AST) -> AST:
    return copy(part) if isinstance(part, (Name, Subscript)) else part
