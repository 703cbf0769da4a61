"""The few functions that generated code may call.

They need NumPy only, Numba compiles each as it stands, and with `--standalone` their text is written
into the generated file: no line of it is over 100 columns.
"""
from __future__ import annotations

from s2sad.runtime.scalars import comb, factorial, heaviside, isclose, isqrt, lcm, perm, product, remainder
from s2sad.runtime.spans import position, position_down
from s2sad.runtime.special import digamma
from s2sad.runtime.spread import extreme_mask, scattered, spread
from s2sad.runtime.stacks import grow, sized
from s2sad.runtime.sums import added, blocked_sum, pairwise_sum

__all__ = [
    "added", "blocked_sum", "comb", "digamma", "extreme_mask", "factorial", "grow", "heaviside", "isclose", "isqrt",
    "lcm", "pairwise_sum", "perm", "position", "position_down", "product", "remainder", "scattered", "sized", "spread",
]
