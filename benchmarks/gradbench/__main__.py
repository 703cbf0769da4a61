"""`python -m benchmarks.gradbench` is a tool of GradBench: it reads messages from stdin and answers on stdout."""
from __future__ import annotations

import argparse
import os
import sys

from benchmarks.gradbench import function
from benchmarks.gradbench.protocol import serve


def main() -> int:
    """Answers until the eval ends; what anything else prints to stdout goes to stderr, also from compiled code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.gradbench", description=__doc__)
    parser.add_argument("--engine", choices=("auto", "numba", "numpy"), default="auto",
                        help="what runs the derivatives")
    function.ENGINE = parser.parse_args().engine
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    try:
        serve(sys.stdin, answers)
    except (BrokenPipeError, KeyboardInterrupt):
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
