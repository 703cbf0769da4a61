"""`python -m benchmarks.gradbench` is a tool of GradBench: it reads messages from stdin and answers on stdout."""
from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from benchmarks.gradbench import function
from benchmarks.gradbench.protocol import serve
from benchmarks.tables import show
from s2sad.report.timing import on_one_core


def main() -> int:
    """Answers until the eval ends, or measures."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.gradbench", description=__doc__)
    parser.add_argument("--engine", choices=("auto", "numba", "numpy"), default="auto",
                        help="what runs the derivatives")
    parser.add_argument("--measure", action="store_true", help="time the evals beside C++ by hand instead")
    parser.add_argument("--quick", action="store_true", help="with --measure: few rounds")
    parser.add_argument("--to", type=Path, help="with --measure: the document into which the table is put")
    options = parser.parse_args()
    function.ENGINE = options.engine
    return measured(options.quick, options.to) if options.measure else answered()


def answered() -> int:
    """What anything else prints to stdout goes to stderr, also from compiled code."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    try:
        serve(sys.stdin, answers)
    except (BrokenPipeError, KeyboardInterrupt):
        return 1
    return 0


def measured(quick: bool, path: Path | None) -> int:
    """The tables, printed and put into the document."""
    from benchmarks.gradbench import measure    # the tool needs none of what it loads

    with on_one_core():
        for table in measure.tables(quick, []):
            show(table)
            if path is not None:
                measure.write(table, path)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
