"""evaluate: what is known before types are is computed here.

In comes the tree of a kernel with resolved names, in the supported subset of Python; out goes one in which structures
are arrays and numbers, options are constants, statements have one target and loops count. Programs that are made of
more than arrays and numbers (`needs_evaluation`) are evaluated first (`specialize`); the passes here stand in the order
in which they run, with passes of `normalize` between the groups (`normalize.STRUCTURE`).
"""
from __future__ import annotations

from s2sad.evaluate.expressions.single_target import single_target
from s2sad.evaluate.loops.counted_loops import counted_loops
from s2sad.passes import Pass, Passes

SEQUENCES: Passes = (
)
STATEMENTS: Passes = (
    Pass(single_target),
)
LOOPS: Passes = (
    Pass(counted_loops),
)
PASSES: Passes = (*SEQUENCES, *STATEMENTS, *LOOPS)

__all__ = ["LOOPS", "PASSES", "SEQUENCES", "STATEMENTS"]
