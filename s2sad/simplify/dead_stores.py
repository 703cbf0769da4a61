"""dead_stores: a store that is overwritten before it is read goes, and a restore of what was never overwritten.

    def f(x: float64[:], y: float64[:]):
        y[0] = 3.0 * x[1]
        y[0] = x[1] * x[0]

in its tangent:

    def f_tangent(...):                                 def f_tangent(...):
        y_dot[0] = 3.0 * x_dot[1]                           y_dot[0] = x[0] * x_dot[1] + x[1] * x_dot[0]
        y[0] = 3.0 * x[1]                                   y[0] = x[1] * x[0]
        y_dot[0] = x[0] * x_dot[1] + x[1] * x_dot[0]
        y[0] = x[1] * x[0]

*Requires* a structured function. *Establishes* the same contents wherever they are read. Within one block: between the
two statements none touches the array or a name of its subscripts.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.liveness import base_name, is_whole_array, targets
from s2sad.blocks import with_blocks
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assign, AugAssign, Call, Expr, FunctionDef, Name, Subscript, call_name, calls_kernel, dump, name, names,
    stored_names, user_call, walk, with_body,
)

CHANGES_ROUNDING = False

Writes = Callable[[Call], list[str]]
Pure = Callable[[Call], bool]


def dead_stores(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function without dead stores."""
    writes, pure = context.effects.writes, context.effects.pure
    return with_body(function, _DeadStores(writes, pure).block(function.body))


class _DeadStores:
    def __init__(self, writes: Writes, pure: Pure):
        self.writes, self.pure = writes, pure

    def block(self, block: list[AST]) -> list[AST]:
        block = [with_blocks(s, self.block) for s in block]
        changed = True
        while changed:
            changed = False
            for position, statement in enumerate(block):
                before, after = block[:position], block[position + 1:]
                if self.is_overwritten(statement, after) or self.is_redundant_restore(statement, before):
                    block = before + after
                    changed = True
                    break
        return block

    def is_overwritten(self, statement: AST, rest: list[AST]) -> bool:
        """Whether a store, or a call that only writes one array, is overwritten before the array is read."""
        place = self.target_of_pure_store(statement)
        if place is None:
            return False
        array = base_name(place)
        for later in rest:
            if not _mentions(later, array):
                if (set(stored_names(later)) | self.stored_arrays(later)) & set(names(place)):
                    return False
                continue
            if not isinstance(later, Assign) or not isinstance(later.targets[0], Subscript):
                return False
            target = later.targets[0]
            reads = _mentions(later.value, array) or array in names(target.slice)
            return not reads and base_name(target) == array and (dump(target) == dump(place) or is_whole_array(target))
        return False

    def target_of_pure_store(self, statement: AST) -> AST | None:
        """The place that a statement stores into, if it has no other effect."""
        if isinstance(statement, (Assign, AugAssign)):
            target = targets(statement)[0]
            calls = calls_kernel(statement.value)
            return target if isinstance(target, Subscript) and not calls else None
        called = statement.value if isinstance(statement, Expr) else None
        if called is not None and user_call(called) and self.pure(called):
            written = set(self.writes(called))
            return name(written.pop()) if len(written) == 1 else None
        return None

    def is_redundant_restore(self, statement: AST, before: list[AST]) -> bool:
        """Whether a store puts back the content that the array has already."""
        if not isinstance(statement, Assign) or not isinstance(statement.value, Name):
            return False
        place = statement.targets[0]
        if not isinstance(place, Subscript):
            return False
        array = base_name(place)
        for earlier in reversed(before):
            if isinstance(earlier, Assign) and isinstance(earlier.targets[0], Name) and \
                    earlier.targets[0].id == statement.value.id:
                return dump(_without_copy(earlier.value)) == dump(name(array) if is_whole_array(place) else place)
            bound = set(stored_names(earlier)) | self.stored_arrays(earlier)
            if bound & {array, statement.value.id, *names(place)}:
                return False
        return False

    def stored_arrays(self, statement: AST) -> set[str]:
        found: set[str] = set()
        for part in walk(statement):
            if isinstance(part, (Assign, AugAssign)):
                found |= {base_name(t) for t in targets(part)}
            if isinstance(part, Call):
                found |= set(self.writes(part))
        return found


def _without_copy(value: AST) -> AST:
    return value.args[0] if isinstance(value, Call) and call_name(value) == "numpy.copy" else value


def _mentions(node: AST, array: str) -> bool:
    return any(isinstance(n, Name) and n.id == array for n in walk(node))
