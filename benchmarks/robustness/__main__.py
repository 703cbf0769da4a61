"""`python -m benchmarks robustness [--quick]` writes the second half of `docs/accuracy.md`, and what it was measured
from beside it; the exit status is 1 if a case is not as it should be."""
from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence

import numpy as np

from benchmarks.robustness import document, published, zeros
from benchmarks.tables import show


def main(arguments: Sequence[str] | None = None) -> int:
    """Measures, writes (not where it is quick) and prints the tables of cases."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks robustness", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="short runs, and nothing is written: to see that it works")
    options = parser.parse_args(arguments)
    wrong = 0
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for title, cases in (("Zeros", zeros.CASES), ("Extremes", zeros.EXTREMES), ("Kinks", zeros.KINKS),
                             ("Published", published.CASES)):
            table, failed = document.case_table(title, cases)
            show(table)
            wrong += failed
        found = document.measured(options.quick)
        if not options.quick:
            document.write(found)
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
