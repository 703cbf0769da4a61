"""`python -m benchmarks.published.worker SECONDS KERNEL...` measures kernels and prints a line of JSON for each."""
from __future__ import annotations

import json
import sys

from benchmarks.published.cases import CASES
from benchmarks.published.measure import measured


def main(budget: float, names: list[str]) -> None:
    """One kernel after the other; what one raises is its line."""
    for name in names:
        try:
            found = measured(CASES[name], budget)
        except Exception as error:
            found = {"failed": f"{type(error).__name__}: {error}".splitlines()[0][:200]}
        print(json.dumps({"name": name, **found}), flush=True)


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2:])
