"""Many programs of given objects: `python -m tests.harness.object_programs --count 20000 --engine numpy`.

Of each program: its value, its gradient along random directions against differences, that `value_and_gradient` leaves
the arguments as they were, and that `autodiff` leaves in them what Python leaves.
"""
from __future__ import annotations

import argparse
import copy
import importlib.util
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

import s2sad
from s2sad.report.differences import differences
from tests.harness.bulk import limit, smaller_texts
from tests.harness.engines import running
from tests.programs.given_objects import given, source

X = np.array([0.3, 0.7, 1.1, 1.9])
INVALID = (ArithmeticError, TypeError, IndexError, NameError, ValueError, KeyError, AttributeError, RecursionError)
NUMBERS, NUMBER = (float, int, np.bool_), count()
SAID = ("the value of autodiff", "the value", "left by autodiff", "after value_and_gradient",
        "the gradient along a direction", "the shadows along a direction")


class Invalid(Exception):
    """A program that Python does not run to a finite number, or a point at a kink."""


def loaded(text: str, folder: Path) -> Any:
    """The module of a program."""
    path = folder / f"program_{next(NUMBER)}.py"
    path.write_text(text)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    sys.modules[path.stem] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def parts(value: Any) -> Iterator[tuple[Any, Any, Any]]:
    """The holders and keys of what is in an object, in order, each with what is there."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, (list, tuple)) else (
        vars(value).items() if hasattr(value, "__dict__") and not callable(value) else ())
    for key, item in inner:
        yield value, key, item
        yield from parts(item)


def flat(value: Any) -> np.ndarray:
    """The floats of an object, those of what is in two places twice."""
    found = [np.ravel(item) for _, _, item in parts([value]) if isinstance(item, (float, np.ndarray))]
    return np.concatenate([np.zeros(0), *found])


def moved(value: Any, by: dict[Any, Any], distance: float) -> Any:
    """A copy whose floats have gone a distance in a direction: by path, of what is in two places by the first."""
    made, seen = copy.deepcopy(value), set()
    for k, (holder, key, item) in enumerate(list(parts([made]))):
        name = (id(holder), key) if isinstance(item, float) else id(item)
        if name in seen or not isinstance(item, (float, np.ndarray)):
            continue
        seen.add(name)
        if isinstance(item, np.ndarray):
            np.add(item, distance * by[k], out=item)
        elif isinstance(holder, (dict, list)):
            holder[key] = item + distance * by[k]
        else:
            setattr(holder, key, item + distance * by[k])
    return made


def directions(value: Any, rng: np.random.Generator) -> tuple[dict[int, Any], np.ndarray]:
    """A direction by place, the same in two places of one thing, and all of it flat."""
    by, seen, made = {}, {}, []
    for k, (holder, key, item) in enumerate(parts([value])):
        if isinstance(item, (float, np.ndarray)):
            name = (id(holder), key) if isinstance(item, float) else id(item)
            by[k] = seen.setdefault(name, rng.standard_normal(np.shape(item)))
            made.append(np.ravel(by[k]))
    return by, np.concatenate([np.zeros(0), *made])


def same(ours: Any, theirs: Any, what: str) -> None:
    """Raises unless two values have the same in them at the same places, and in two places what is in two places."""
    left, right = list(parts([ours])), list(parts([theirs]))

    def text(found: Any) -> str:
        return f"{what}: {found}"
    assert [k for _, k, _ in left] == [k for _, k, _ in right], text(
        f"{[k for _, k, _ in left]}, not {[k for _, k, _ in right]}")
    first: dict[int, int] = {}
    for (_, key, a), (_, _, b) in zip(left, right):
        assert type(a).__name__ == type(b).__name__ or isinstance(a, NUMBERS) and isinstance(b, NUMBERS), text(
            f"{key} is {type(a).__name__}, not {type(b).__name__}")
        if isinstance(a, (float, np.ndarray, int)):
            np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12, err_msg=text(key))
            truth = (bool, np.bool_)
            assert isinstance(a, truth) == isinstance(b, truth), text(f"{key} is {a!r}, not {b!r}")
            assert isinstance(a, (int, *truth)) <= isinstance(b, (int, *truth)), text(f"{key} is {a!r}, not {b!r}")
        if isinstance(a, np.ndarray) or hasattr(a, "__dict__") or isinstance(a, (list, dict)):
            assert first.setdefault(id(a), id(b)) == id(b), text(f"{key} is in other places")


def check(module: Any, seed: int, engine: str) -> None:
    """Raises AssertionError where s2sad is wrong, S2sadError where it refuses, Invalid where nothing can be said."""
    theirs = (X.copy(), given(module, seed))
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            value = module.f(*theirs)
    except INVALID as error:
        raise Invalid(str(error)) from error
    if not isinstance(value, (float, np.floating)) or not np.isfinite(value) or abs(value) > 1e8:
        raise Invalid("not finite")
    with running(engine) as run_under, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        f = s2sad.differentiate(module.f, engine=run_under)
        _gradient(f, module.f, (X.copy(), given(module, seed)), value, np.random.default_rng(seed))
        _autodiff(f, module.f, (X.copy(), given(module, seed)), theirs, value, np.random.default_rng(seed + 1))


def _autodiff(f: Any, function: Callable, ours: tuple, theirs: tuple, value: float, rng: np.random.Generator) -> None:
    """What is left in the arguments, and the derivative of the result and of all that is left."""
    before, bar = copy.deepcopy(ours), s2sad.make_zero(ours)
    by, direction = directions(ours, rng)
    weights, _ = directions(bar, rng)
    bar = moved(bar, weights, 1.0)
    try:
        _, found = s2sad.autodiff(s2sad.ReverseWithPrimal, f, *map(s2sad.Duplicated, ours, bar))
    except s2sad.S2sadError as error:
        if "leaves something else" in str(error):
            return
        raise
    np.testing.assert_allclose(found, value, rtol=1e-9, atol=1e-11, err_msg="the value of autodiff")
    same(ours, theirs, "left by autodiff")

    def line(h: float) -> np.ndarray:
        left = moved(before, by, h)
        total = float(function(*left))
        return np.array([total + sum(float(np.sum(weights[k] * item)) for k, (_, _, item) in enumerate(
            parts([left])) if k in weights)])
    _compare(flat(bar), direction, line, "the shadows along a direction")


def _gradient(f: Any, function: Callable, arguments: tuple, value: float, rng: np.random.Generator) -> None:
    before = copy.deepcopy(arguments)
    by, direction = directions(arguments, rng)
    ours, found = s2sad.value_and_gradient(f, wrt=("x", "s"))(*arguments)
    np.testing.assert_allclose(ours, value, rtol=1e-9, atol=1e-11, err_msg="the value")
    same(arguments, before, "after value_and_gradient")
    slopes = flat((found["x"], found["s"]))

    _compare(slopes, direction, lambda h: np.array([float(function(*moved(before, by, h)))]),
             "the gradient along a direction")


def _compare(slopes: np.ndarray, direction: np.ndarray, line: Callable[[float], np.ndarray], what: str) -> None:
    """Raises AssertionError unless the differences along a line are what the slopes say; Invalid near a kink."""
    try:
        expected, error = differences(line)
    except INVALID as raised:
        raise Invalid("at a kink") from raised
    assert slopes.shape == direction.shape, f"{what}: {slopes.size} numbers, not {direction.size}"
    magnitude = np.abs(slopes * direction).sum() + abs(expected[0])
    if not error[0] <= 1e-5 * magnitude + 1e-11:
        raise Invalid("at a kink")
    assert abs(slopes @ direction - expected[0]) <= 1e-7 * magnitude + 10 * error[0] + 1e-11, (
        f"{what}: {slopes @ direction!r}, not {expected[0]!r} +- {error[0]:.1e}")


def outcome(text: str, seed: int, engine: str, folder: Path) -> tuple[str, str, str]:
    """What became of a program: a kind, a place, a text."""
    try:
        with limit(60.0):
            check(loaded(text, folder), seed, engine)
    except (Invalid, SyntaxError) as error:
        return "invalid", str(error)[:40], ""
    except AssertionError as error:
        if "/s2sad/" in traceback.extract_tb(error.__traceback__)[-1].filename:
            return "crash", _place(error), traceback.format_exc(limit=-5)
        return "wrong", next((w for w in SAID if w in str(error)), ""), str(error)
    except s2sad.S2sadError as error:
        codes = ",".join(sorted({d.code for d in error.diagnostics}))
        kind = "crash" if "S9" in codes else "refused"
        return kind, f"{codes} {error.diagnostics[0].message[:70]}", str(error)
    except Exception as error:
        return "crash", _place(error), traceback.format_exc(limit=-5)
    return "ok", "", ""


def _place(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    names = [f"{f.filename.rsplit('/', 1)[-1]}:{f.name}" for f in frames]
    return f"{type(error).__name__} in {names[-1]}"


def smaller(text: str, seed: int, engine: str, folder: Path, failure: tuple[str, str, str], seconds: float) -> str:
    """The program, smaller, failing in the same way."""
    deadline, shrunk = time.monotonic() + seconds, True
    while shrunk and time.monotonic() < deadline:
        shrunk = False
        for other in smaller_texts(text):
            if time.monotonic() > deadline:
                break
            if len(other) < len(text) and outcome(other, seed, engine, folder)[:2] == failure[:2]:
                text, shrunk = other, True
                break
    return text


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.harness.object_programs", description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--start", type=int, default=0)
    parser.add_argument("--engine", choices=("numpy", "numba", "loops"), default="numpy")
    parser.add_argument("--shrink", type=float, default=20.0)
    parser.add_argument("--seconds", type=float, default=1e9)
    options = parser.parse_args()
    kinds, places, began = Counter[str](), Counter[tuple[str, str]](), time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for done, seed in enumerate(range(options.start, options.start + options.count), 1):
            if time.monotonic() - began > options.seconds:
                break
            text = source(seed)
            found = outcome(text, seed, options.engine, Path(folder))
            kinds[found[0]] += 1
            if found[0] != "ok":
                places[found[:2]] += 1
            if found[0] in ("wrong", "crash") and places[found[:2]] <= 2:
                small = smaller(text, seed, options.engine, Path(folder), found, options.shrink)
                final = outcome(small, seed, options.engine, Path(folder))
                print(f"==== seed {seed}: {found[:2]}\n{small}\n{final[2] or found[2]}\n", flush=True)
            if done % 200 == 0:
                print(f"-- {done}, {time.monotonic() - began:.0f} s, {dict(kinds)}", flush=True)
    for (kind, where), found in places.most_common():
        print(f"{found:6d} {kind}: {where}")
    print(dict(kinds))
    return kinds["wrong"] + kinds["crash"]


if __name__ == "__main__":
    sys.exit(1 if main() else 0)
