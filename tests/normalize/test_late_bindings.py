"""Arrays that only some iterations bind: random loops, in which names share arrays that are written before and after,
compute what Python computes, raise where it raises, or are refused."""
from __future__ import annotations

from random import Random

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running
from tests.harness.kernel_files import kernel_file

PLACE = "k % 4"
ARRAYS = (f"x * y[{PLACE}]", "w", "w[::-1]", "x.copy()", f"np.sin(x) + y[{PLACE}]", "w * (s + 1.0)")
STORES = ("z[0] += 1.0", "w[1] *= 1.1", "z = z + 1.0", "x[2] += 0.1")
TESTS = (f"y[{PLACE}] > 0.8", f"z[0] > y[{PLACE}]", "k > 1")
BINDINGS = ("z", "w", "z.copy()", "z[::-1]", "z * 2.0", "w + x")
INSIDE = ("break", "z[1] = 0.5", "best[0] = z[1] * 3.0", "continue")
LATER = ("z[0] += 1.0", "s += z[1]", "w[0] = s", "s += 0.3")
BEHIND = ("s += np.sum(best ** 2)", "best[0] = 2.0", "s += best[0] * x[1]", "w[0] = 3.0")


def written(rng):
    """The lines of a kernel."""
    def maybe(odds, lines, indent):
        return [indent + rng.choice(lines)] if rng.random() < odds else []
    lines, outer = [rng.choice(("w = x * 2.0", "w = x")), *maybe(0.3, ("best = None",), "")], ""
    nested = rng.random() < 0.3
    if nested:
        lines, outer = [*lines, "for t in range(2):"], "    "
    inner = outer + "    "
    if rng.random() < 0.3:
        lines += [f"{outer}k = 0", f"{outer}while k < n:", f"{inner}k += 1"]
    else:
        lines.append(f"{outer}for k in range({rng.choice(('n', '4'))}):")
    lines += [f"{inner}z = {rng.choice(ARRAYS)}", *maybe(0.3, STORES, inner), f"{inner}if {rng.choice(TESTS)}:"]
    lines += [f"{inner}    best = {rng.choice(BINDINGS)}", *maybe(0.3, INSIDE, f"{inner}    ")]
    lines += maybe(0.5, LATER, inner)
    lines += maybe(0.5, ("s += best[0]", "best[1] += 1.0", "best = best * 1.5"), outer) if nested else []
    return [*lines, rng.choice(BEHIND)]


def loaded(path, lines):
    return kernel_file(path, "f(x, y, n)", ["s = 0.0", *lines], "s + best[1] * np.sum(x * w)")


def value_of(function, *arguments):
    try:
        return function(*arguments)
    except (UnboundLocalError, TypeError):
        return None
    except s2sad.S2sadError as error:       # where the numbers of a call say that it is so in each run
        assert "is None here" in str(error)     # noqa: PT017
        return None


def compare(f, derivative, rng, n):
    """Asserts that a derivative is that of the kernel, or raises as it does; False where differences are too rough."""
    x, y, u, v = rng.random(4) + 0.2, rng.random(4) + 0.3, rng.standard_normal(4), rng.standard_normal(4)
    wanted, found = value_of(f, x.copy(), y.copy(), n), value_of(derivative, x.copy(), y.copy(), n)
    assert (wanted is None) == (found is None)
    if found is None:
        return True
    assert np.isclose(found[0], wanted, rtol=1e-10)

    def slope(h):
        return (f(x + h * u, y + h * v, n) - f(x - h * u, y - h * v, n)) / (2 * h)
    expected = (64 * slope(2.5e-5) - 20 * slope(5e-5) + slope(1e-4)) / 45
    same = np.isclose(found[1]["x"] @ u + found[1]["y"] @ v, expected, rtol=1e-5, atol=1e-6)
    assert same or not np.isclose(slope(1e-4), slope(1e-5), rtol=1e-3, atol=1e-6)      # a kink is near
    return same


@pytest.mark.parametrize("seed", range(60))
@pytest.mark.filterwarnings("ignore::s2sad.S2sadWarning")
def test_any_loop(seed, tmp_path):
    f, rng = loaded(tmp_path / "kernel.py", written(Random(seed))), np.random.default_rng(seed)
    with running("loops" if seed % 4 == 0 else "numpy") as engine:
        derivative = s2sad.value_and_gradient(s2sad.differentiate(f, engine=engine), wrt=("x", "y"))
        try:
            derivative(np.ones(4), np.ones(4), 4)
        except s2sad.S2sadError as error:
            assert "may stand for" in str(error) or "none" in str(error).lower()        # noqa: PT017
            return
        except (UnboundLocalError, TypeError):
            pass
        assert sum(compare(f, derivative, rng, n) for n in (0, 1, 2, 4)) >= 3
