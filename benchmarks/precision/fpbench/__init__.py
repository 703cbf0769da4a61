"""Expressions of the FPBench suite (fpbench.org; N. Damouche et al., Toward a Standard Benchmark Format and Suite for
Floating-Point Analysis, NSV 2016) that are differentiable and have no loop, with their domains.

Where a domain has no bound numbers are drawn by their size, 1e-4 to 1e4.
"""
from __future__ import annotations

from benchmarks.precision.fpbench import analyzers, fptaylor, hamming
from benchmarks.precision.fpbench.domains import LISTED, Expression

__all__ = ["LISTED", "Expression", "analyzers", "fptaylor", "hamming"]
