"""The chapter on GradBench: the table of its evals, beside C++ by hand."""
from __future__ import annotations

from benchmarks.gradbench.measure import tables
from benchmarks.peers.sections import of_tables

SECTION = of_tables("gradbench", "GradBench", tables, minutes=6.0)
