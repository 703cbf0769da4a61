"""`python -m benchmarks precision [rules expressions sums] [--quick]` measures errors and writes the tables of
`docs/accuracy.md`, and the literals of `tests/rules/partials.txt`; with `--quick` it prints them and writes nothing."""
from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable

from benchmarks.precision import arrays, document, expressions, kernels, literals, nonfinite, rules, sums
from benchmarks.tables import Table, show
from tests.docs.functions import PAGE


def _shown(name: str, tables: list[Table], quick: bool) -> None:
    if quick:
        for table in tables:
            show(table)
    else:
        document.replaced(name, tables)
        print(f"{name}: written")


def _rules(quick: bool) -> None:
    engines = ("numpy",) if quick else ("numpy", "numba")
    found = rules.measured(10 if quick else 60, engines=engines)
    _shown("rules", [*document.rules_tables(found), nonfinite.table(*nonfinite.measured(engines))], quick)
    if not quick:
        literals.write(found)


def _expressions(quick: bool) -> None:
    fpbench, _ = expressions.table(8 if quick else 40)
    found, missing = arrays.measured(("sums and differences",) if quick else tuple(PAGE))
    _shown("expressions", [kernels.table(), arrays.table(found, missing), fpbench], quick)


def _sums(quick: bool) -> None:
    _shown("sums", [sums.table(quick)], quick)


PARTS: dict[str, Callable[[bool], None]] = {"rules": _rules, "expressions": _expressions, "sums": _sums}


def main(arguments: list[str] | None = None) -> int:
    """Runs the parts that are named, all without a name."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks precision", description=__doc__)
    parser.add_argument("names", nargs="*", choices=[*PARTS, []], help="parts (default: all)")
    parser.add_argument("--quick", action="store_true", help="few points, and no compiled text: to see that it works")
    options = parser.parse_args(arguments)
    warnings.simplefilter("ignore")
    for name in options.names or PARTS:
        PARTS[name](options.quick)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
