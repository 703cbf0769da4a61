"""The few functions that generated code may call.

They need NumPy only, Numba compiles each as it stands, and with `--standalone` their text is written
into the generated file: no line of it is over 100 columns.
"""
from __future__ import annotations

from s2sad.runtime.stacks import grow, sized
from s2sad.runtime.sums import added, blocked_sum, pairwise_sum

__all__ = ["added", "blocked_sum", "grow", "pairwise_sum", "sized"]
