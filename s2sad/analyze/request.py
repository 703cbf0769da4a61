"""request: which derivative of a kernel is wanted."""
from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class DerivativeRequest:
    """Which parameters and results: `wrt` and `of` by name ("return 0", ... for results); `unbounded` as in
    `callee_derivatives.ActivityPattern`; if it `accumulates`, the shadows of numbers are given, and returned with what
    is added to them; `split` if the two sweeps are to be functions of their own, `halves` if these are for the sweeps
    of a caller."""
    wrt: tuple[str, ...]
    of: tuple[str, ...]
    with_primal: bool = False
    unbounded: frozenset[str] = frozenset()
    accumulates: bool = False
    split: bool = False
    halves: bool = False
