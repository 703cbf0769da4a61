"""evaluate: what is known before types are is computed here.

In comes the tree of a kernel with resolved names, in the supported subset of Python; out goes one in which structures
are arrays and numbers, options are constants, statements have one target and loops count. Programs that are made of
more than arrays and numbers (`needs_evaluation`) are evaluated first (`specialize`); the passes here stand in the order
in which they run, with passes of `normalize` between the groups (`normalize.STRUCTURE`).
"""
from __future__ import annotations

from s2sad.evaluate.expressions.chained_assignment import chained_assignment
from s2sad.evaluate.expressions.flat_returns import flat_returns
from s2sad.evaluate.expressions.literal_concatenation import literal_concatenation
from s2sad.evaluate.expressions.single_target import single_target
from s2sad.evaluate.expressions.slice_names import slice_names
from s2sad.evaluate.expressions.static_options import static_options, unsettled
from s2sad.evaluate.expressions.tables import tables
from s2sad.evaluate.expressions.tuple_names import tuple_names
from s2sad.evaluate.expressions.type_tests import type_tests, undecided
from s2sad.evaluate.loops.counted_loops import counted_loops
from s2sad.evaluate.loops.itertools_loops import itertools_loops
from s2sad.passes import Pass, Passes

SEQUENCES: Passes = (
    Pass(flat_returns),
    Pass(itertools_loops),
    Pass(chained_assignment),
    Pass(literal_concatenation),
)
CONSTANTS: Passes = (
    Pass(static_options),
    Pass(tables),
    Pass(slice_names),
)
STATEMENTS: Passes = (
    Pass(tuple_names),
    Pass(single_target),
)
LOOPS: Passes = (
    Pass(counted_loops),
)
OPTIONS: Passes = (
    Pass(unsettled),
)
TYPE_TESTS: Passes = (
    Pass(type_tests, form="structured"),
)
LEFT: Passes = (
    Pass(undecided),
)
PASSES: Passes = (*SEQUENCES, *CONSTANTS, *STATEMENTS, *LOOPS, *OPTIONS, *TYPE_TESTS, *LEFT)

__all__ = ["CONSTANTS", "LEFT", "LOOPS", "OPTIONS", "PASSES", "SEQUENCES", "STATEMENTS", "TYPE_TESTS"]
