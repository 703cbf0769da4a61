"""`python -m benchmarks [names...] [--quick]` prints one table for each part; exit status 0 whether targets are met or
not, for a figure that missed its target is a result, too. `python -m benchmarks peers` writes `docs/performance.md`,
`python -m benchmarks precision` the first half of `docs/accuracy.md`, `python -m benchmarks robustness` the second, and
`python -m benchmarks documents` all of them."""
from __future__ import annotations

import argparse
import importlib
import platform
import sys
from collections.abc import Callable

from benchmarks import arrays, deriving, first_gradient, jacobians, memory, overhead, ratios, returning, snapshots
from benchmarks.peers import gradbench
from benchmarks.peers.__main__ import main as peers
from benchmarks.peers.machine import processor
from benchmarks.published import section as published
from benchmarks.published.cases import CASES as PUBLISHED
from benchmarks.robustness.__main__ import main as robustness
from benchmarks.tables import Table, show
from s2sad.report.timing import on_one_core

PARTS: dict[str, tuple[Callable[[bool, list[str]], list[Table]], str]] = {
    "ratios": (ratios.tables, "adjoint over the Numba primal, each kernel at its large size"),
    "arrays": (arrays.tables, "the same for kernels of whole arrays, under each engine"),
    "overhead": (overhead.tables, "what a call costs over the bare compiled one"),
    "returning": (returning.tables, "functions that return arrays, called four times a step"),
    "jacobians": (jacobians.tables, "Jacobians in primal calls, directions at once, products with Hessians"),
    "first": (first_gradient.tables, "time to the first gradient, cold and warm cache"),
    "deriving": (deriving.tables, "time to write an adjoint against the length of the kernel, with exponents"),
    "memory": (lambda quick, kernels: [*memory.tables(quick, kernels), *snapshots.tables(quick, kernels)],
               "peak memory against arrays, shadows and recorded values, and of long loops that keep snapshots"),
    "published": (published.tables, "fifty published kernels: gradients over primals, and against JAX's"),
    "gradbench": (gradbench.tables, "GradBench's evals beside C++ by hand"),
}


def _documents() -> dict[str, Callable[[list[str]], int]]:
    """What writes a document, with options of its own: `--quick` is one of all of them."""
    def precision(arguments: list[str]) -> int:
        return importlib.import_module("benchmarks.precision.__main__").main(arguments)     # needs an extra

    return {"peers": peers, "precision": precision, "robustness": robustness}


def main() -> int:
    """Runs the parts that are named, all without a name; a kernel's name means its line of `ratios` or `published`."""
    named, rest = sys.argv[1:2], sys.argv[2:]
    if named == ["documents"]:
        return max(document(rest) for document in _documents().values())
    if named and named[0] in (documents := _documents()):
        return documents[named[0]](rest)
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__, epilog="parts: " + "; ".join(
        f"{name}: {text}" for name, (_, text) in PARTS.items()))
    parser.add_argument("names", nargs="*",
                        help="parts, or kernels of the parts 'ratios' and 'published' (default: every part)")
    parser.add_argument("--quick", action="store_true", help="few rounds: to see that it works")
    options = parser.parse_args()
    kernels = [n for n in options.names if n not in PARTS]
    of_part = {"ratios": [n for n in kernels if n in ratios.TARGETS],
               "published": [n for n in kernels if n in PUBLISHED]}
    unknown = [n for n in kernels if not any(n in names for names in of_part.values())]
    if unknown:
        parser.error(f"unknown: {', '.join(unknown)}; parts are {', '.join(PARTS)}; "
                     f"kernels are {', '.join([*ratios.TARGETS, *PUBLISHED])}")
    chosen = [n for n in PARTS if n in options.names or of_part.get(n)] if options.names else list(PARTS)
    with on_one_core() as pinned:
        print(f"{processor()}, Python {platform.python_version()}, one thread{pinned}, "
              "medians of interleaved rounds\n")
        for name in chosen:
            for table in PARTS[name][0](options.quick, of_part.get(name, kernels)):
                show(table)
                sys.stdout.flush()
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
