"""Derivatives for many directions at once compared with those for each: `compare_batches`.

    python -m tests.harness.batches --engine loops      every case of the corpus
"""
from __future__ import annotations

import argparse
import copy
import warnings
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

import s2sad
from s2sad.interface import batch_calls
from tests.harness.derivatives import VectorFunction, _split, _vector
from tests.harness.engines import running
from tests.harness.seeds import generator

Values = dict[str, Any]


def _stacked(values: list[Any]) -> Any:
    """Values of one make with one more axis, the first."""
    first = values[0]
    if isinstance(first, dict):
        return {n: _stacked([v[n] for v in values]) for n in first}
    if isinstance(first, (tuple, list)):
        return type(first)(_stacked([v[k] for v in values]) for k in range(len(first)))
    return None if first is None else np.array(values)


def _same(found: Any, expected: Any, what: str, tolerance: float) -> None:
    if isinstance(expected, dict):
        assert found.keys() == expected.keys(), f"{what}: {list(found)}, not {list(expected)}"
        for name in expected:
            _same(found[name], expected[name], f"{what} of {name}", tolerance)
    elif isinstance(expected, (tuple, list)):
        assert len(found) == len(expected)
        for one, other in zip(found, expected):
            _same(one, other, what, tolerance)
    elif expected is not None:
        assert found.shape == expected.shape and found.dtype == expected.dtype, (
            f"{what}: {found.dtype}{found.shape}, not {expected.dtype}{expected.shape}")
        scale = np.abs(expected).max(initial=0.0, where=np.isfinite(expected))
        close = np.isclose(found, expected, rtol=tolerance, atol=tolerance * scale, equal_nan=True)
        assert close.all(), f"{what}: {found[~close]}, not {expected[~close]}"


def compare_batches(function: Callable[..., Any], arguments: tuple[Any, ...], wrt: tuple[str, ...],
                    of: tuple[str, ...], engine: str = "numpy", count: int = 3, tolerance: float = 1e-15
                    ) -> tuple[bool, bool]:
    """Raises AssertionError unless tangents and adjoints for many directions are those for each, the arguments as they
    were. Whether tangents, and adjoints, were made for all at once."""
    with running(engine) as run_under, warnings.catch_warnings():
        warnings.simplefilter("ignore", s2sad.S2sadWarning)
        subject = VectorFunction(function, arguments, wrt, of)
        rng = generator(1)
        f = s2sad.differentiate(function, engine=run_under)
        args = tuple(copy.deepcopy(subject.given).values())
        before = copy.deepcopy(args)
        made: list[bool] = []
        tolerance = 1e-5 if subject.is_single() else tolerance
        with _watched(made):
            along = [_split(subject.given, wrt, rng.standard_normal(subject.x.size)) for _ in range(count)]
            _same(s2sad.jvp(f, args, _stacked(along), of=of, batch=True),
                  _stacked([s2sad.jvp(f, args, d, of=of) for d in along]), "tangent", tolerance)
            size = _vector(subject.outputs, of).size
            seeds = [_split(subject.outputs, of, rng.standard_normal(size)) for _ in range(count)]
            _same(s2sad.vjp(f, args, _stacked(seeds), wrt=wrt, batch=True),
                  _stacked([s2sad.vjp(f, args, s, wrt=wrt) for s in seeds]), "adjoint", max(tolerance, 1e-13))
        for one, other in zip(before, args):
            assert np.array_equal(np.asarray(one), np.asarray(other)) or one == other or np.isnan(
                np.asarray(one, float)).any(), "an argument was changed"
    return made[0], made[1]


class _watched:
    """Notes which batches are run at once."""

    def __init__(self, made: list[bool]):
        self.made, self.original = made, batch_calls.BatchCall.run

    def __enter__(self) -> None:
        original, made = self.original, self.made

        def run(batch: Any, *arguments: Any) -> Any:
            made.append(batch.many is not None)
            return original(batch, *arguments)
        batch_calls.BatchCall.run = run

    def __exit__(self, *_: Any) -> None:
        batch_calls.BatchCall.run = self.original


def main() -> None:
    """Compares every case of the corpus and prints what differs."""
    from tests.corpus import cases
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--engine", default="loops", choices=("numpy", "loops", "numba"))
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("-k", default="")
    asked = parser.parse_args()
    found: Counter[str] = Counter()
    chosen = [(n, c) for n, c in cases() if not c.refused and asked.k in n]
    for name, case in chosen[asked.first::asked.every]:
        wrt = (case.wrt,) if isinstance(case.wrt, str) else case.wrt
        try:
            if wrt is None:
                raise s2sad.S2sadError
            made = compare_batches(case.kernel, case.arguments, tuple(wrt), tuple(case.of or ("return",)), asked.engine)
            result = "all at once" if all(made) else f"one by one {made}"
            if not all(made):
                print(name, result, flush=True)
        except AssertionError as error:
            result = "differs"
            print(name, result, str(error)[:300], flush=True)
        except s2sad.S2sadError as error:
            result = "refused"
            print(name, result, str(error)[:200] if error.diagnostics else "", flush=True)
        except Exception as error:  # noqa: BLE001
            result = "crashed"
            print(name, result, type(error).__name__, str(error)[:300], flush=True)
        found[result] += 1
    print(dict(found))


if __name__ == "__main__":
    main()
