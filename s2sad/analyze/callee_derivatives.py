"""callee_derivatives: which derivative of its callee a call needs, and what that reads."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from s2sad.liveness import base_name, targets
from s2sad.analyze.uses import OperandUses, is_active
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.tree import AST, Call, user_call


@dataclass(frozen=True)
class ActivityPattern:
    """What a call requires of the callee's derivative: positions of active arguments and of active results; whether
    "values" and "seeds" at its boundary can be infinite or nan (`unbounded`, see `unbounded_values`); whether the two
    sweeps are wanted as `halves`."""
    kernel: str
    types: tuple[Type, ...]
    arguments: tuple[int, ...]
    results: tuple[int, ...]
    unbounded: frozenset[str] = frozenset()
    halves: bool = False


@dataclass(frozen=True)
class CalleeDerivative:
    """A derivative of a callee: its name, the positions with shadows, with seeds, and with returned adjoints;
    `reads` and `writes` are the positions of arrays whose content it reads at its start, and overwrites.

    Of an adjoint in two halves `forward` is the name of the first, which returns the `results` and one more, that the
    call takes as its last argument. The halves are a user's own (`is_own`), those of a loop that keeps snapshots, or
    the sweeps of a function, with a tape of the weight `tape`; 0 if that spares no run. An implicit function's adjoint
    and a reverse sweep see the state that the function leaves (`after`); the former takes the results `values`.
    """
    name: str
    shadows: tuple[int, ...]
    seeds: tuple[int, ...]
    returns: tuple[int, ...]
    reads: tuple[int, ...]
    writes: tuple[int, ...]
    forward: str = ""
    results: int = 0
    after: bool = False
    values: tuple[int, ...] = ()
    is_own: bool = False
    tape: int = 0


Derive = Callable[[ActivityPattern], CalleeDerivative]


def is_kernel_call(statement: AST) -> bool:
    """Whether a statement calls another kernel."""
    return user_call(getattr(statement, "value", None)) is not None


def activity_pattern(statement: AST, typing: Typing, active: frozenset[str],
            unbounded: Callable[[AST], frozenset[str]] = lambda statement: frozenset()) -> ActivityPattern:
    """The pattern of a statement's call, by the active names around it."""
    called: Call = statement.value
    bound = [base_name(t) for t in targets(statement)]
    return ActivityPattern(user_call(called) or "", tuple(map(typing.argument, called.args)),
                           tuple(k for k, a in enumerate(called.args) if is_active(a, typing, active)),
                           tuple(k for k, b in enumerate(bound) if b in active and typing.table[b].is_inexact),
                           unbounded(statement))


def call_adjoint(statement: AST, typing: Typing, active: frozenset[str], derive: Derive,
                 unbounded: Callable[[AST], frozenset[str]], halves: bool) -> CalleeDerivative | None:
    """The adjoint of a call, in two `halves` if they are wanted; None if nothing of it is active."""
    pattern = activity_pattern(statement, typing, active, unbounded)
    if not pattern.arguments and not pattern.results:
        return None
    return derive(replace(pattern, halves=halves))


def call_uses(statement: AST, typing: Typing, callee: CalleeDerivative, found: OperandUses) -> None:
    """What the adjoint of a call reads: its numbers, and the arrays whose content the callee's adjoint reads."""
    for position, argument in enumerate(statement.value.args):
        if typing.of(argument).is_array:
            found.place(argument, typing)
            if position in callee.reads:
                found.loads.append(argument)
        else:
            found.value(argument, typing)
    bound = targets(statement)
    for position in callee.values:
        found.value(bound[position], typing)
