"""`tape_dtype="float32"`: what is recorded is rounded where only partials read it, and nowhere else."""
from __future__ import annotations

import re

import numpy as np
import pytest

import s2sad
from s2sad.cli import main
from tests.corpus.recording import rounded_values as kernels
from tests.harness.engines import located, running
from tests.harness.seeds import generator

ENGINES = ("numpy", "loops")
REFUSED = "tape_dtype='float32' would round what decides this, and nothing else is recorded"
BOUND = 5e-6        # of the largest derivative; what is rounded is so by 6e-8 of itself


def gradients(kernel, arguments, engine, **options):
    """The gradients with exact and with rounded tapes, by name, and the bytes of both tapes."""
    found = []
    for dtype in ("float64", "float32"):
        with running(engine) as name:
            f = s2sad.differentiate(kernel, engine=name, tape_dtype=dtype, **options)
            seeds = {"return": 1.0}
            found.append((s2sad.vjp(f, arguments, seeds), f.adjoint.memory(*arguments).tape))
    return found


def misfit(found):
    """The largest difference of two gradients, as a fraction of the largest derivative."""
    (exact, _), (rounded, _) = found
    return max(np.max(np.abs(rounded[n] - exact[n])) / np.max(np.abs(exact[n])) for n in exact)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("kernel", "arguments"), kernels.rounded(), ids=lambda p: getattr(p, "__name__", ""))
def test_tapes_halve_and_gradients_stay(kernel, arguments, engine):
    found = gradients(kernel, arguments, engine, memory="fastest")
    assert found[1][1] * 2 == found[0][1] > 0
    assert 0.0 < misfit(found) < BOUND


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("kernel", "arguments"), kernels.deciding(), ids=lambda p: getattr(p, "__name__", ""))
def test_what_decides_is_recorded_as_it_is(kernel, arguments, engine):
    """A rounded value would go another way: the arguments lie within 1e-9 of it."""
    for memory in ("least", "balanced", "fastest"):
        try:
            assert misfit(gradients(kernel, arguments, engine, memory=memory)) < BOUND
        except s2sad.S2sadError as refused:
            assert REFUSED in located(refused)


@pytest.mark.parametrize(("kernel", "arguments"), kernels.deciding(), ids=lambda p: getattr(p, "__name__", ""))
def test_rounding_what_decides_would_show(kernel, arguments, monkeypatch):
    """The kernels of the test above find out: where everything is rounded they have another gradient."""
    monkeypatch.setattr("s2sad.analyze.tape_entries.decision_reads.DecisionReads.of", lambda self, statement: set())
    monkeypatch.setenv("S2SAD_CACHE_SIZE", "0")
    assert misfit(gradients(kernels.anew(kernel), arguments, "numpy", memory="fastest")) > 1e-3


def test_solutions_halve():
    found = gradients(kernels.solved, (generator(4).random(6), 10), "numpy", memory="fastest")
    assert found[1][1] * 2 == found[0][1] > 0
    assert 0.0 < misfit(found) < BOUND


def test_complex_numbers_halve():
    z = generator(4).random(6) + 1j * generator(5).random(6)
    found = [s2sad.differentiate(kernels.rotated, engine="numpy", tape_dtype=d) for d in ("float64", "float32")]
    tapes = [f.adjoint.memory(z, 10).tape for f in found]
    exact, rounded = (s2sad.gradient(f, wrt="z")(z, 10) for f in found)
    assert tapes[0] == 2 * tapes[1] > 0
    assert "np.complex64" in found[1].adjoint_source(z, 10)
    assert 0.0 < np.max(np.abs(exact - rounded)) < BOUND * np.max(np.abs(exact))


def test_kernels_of_float32_are_as_they_were():
    x = generator(4).random(6).astype(np.float32)
    texts = [s2sad.differentiate(kernels.product, engine="numpy", tape_dtype=d).adjoint_source(x, 10)
             for d in ("float64", "float32")]
    assert texts[0] == texts[1]


def test_explain_says_what_is_rounded_and_what_is_not():
    x = generator(4).random(6)
    f = s2sad.differentiate(kernels.one_of_two, engine="numpy", tape_dtype="float32")
    lines = [re.sub(".* push|.* bytes, ", "", line).strip() for line in str(s2sad.explain(f, x, x, 10)).splitlines()
             if "_stack: " in line]
    store = "`v[i] = abs(v[i] - 0.5) * v[i]`"
    assert sorted(lines) == ["u before `u[i] = np.sin(u[i]) * 1.1`, as float32",
                             f"v before {store}, not rounded for {store}"]


def test_snapshots_stay_as_they_are():
    x = generator(4).random(6)
    f = s2sad.differentiate(kernels.product, engine="numpy", checkpoint={"k": 3}, tape_dtype="float32")
    assert "x_snapshots = np.empty((min(4, trips),) + x.shape)\n" in f.adjoint_source(x, 10)


@pytest.mark.parametrize("engine", ENGINES)
def test_of_both_halves_too(engine):
    x, bar = generator(4).random(6), np.zeros(6)
    with running(engine) as name:
        f = s2sad.differentiate(kernels.product, engine=name, tape_dtype="float32")
        _, tape = f.augmented(x.copy(), 10)
        f.reverse(tape, bar, 1.0)
        exact = s2sad.gradient(s2sad.differentiate(kernels.product, engine=name), wrt="x")(x, 10)
    assert 0.0 < np.max(np.abs(bar - exact)) < BOUND * np.max(np.abs(exact))


# -- what is refused --------------------------------------------------------------------------------------------------

def test_what_would_round_nothing_is_refused():
    f = s2sad.differentiate(kernels.largest_of_both, engine="numpy", tape_dtype="float32")
    with pytest.raises(s2sad.S2sadError) as caught:
        f.adjoint_source(np.ones(3), 4)
    assert located(caught.value) == (
        f"S408 at `x[i] = max(x[i] - 0.1, x[i - 1] * x[i])`: {REFUSED}: record float64, and keep snapshots where the "
        "tape is too large: checkpoint={...}")


def test_another_dtype_is_refused():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(kernels.product, tape_dtype="float16")     # pyright: ignore[reportArgumentType]
    assert str(caught.value) == ("error[S408]: tape_dtype is 'float16'\n"
                                 "  help: say 'float64', 'float32'")


def test_drivers_and_the_command_take_it(capsys):
    x = generator(4).random(6)
    exact = s2sad.gradient(kernels.product, wrt="x")(x, 10)
    for rounded in (s2sad.gradient(kernels.product, wrt="x", tape_dtype="float32")(x, 10),
                    s2sad.value_and_gradient(kernels.product, wrt="x", tape_dtype="float32")(x, 10)[1],
                    s2sad.vjp(kernels.product, (x, 10), {"return": 1.0}, tape_dtype="float32")["x"]):
        assert 0.0 < np.max(np.abs(rounded - exact)) < BOUND * np.max(np.abs(exact))
    main(["adjoint", f"{kernels.__file__}:product", "--tape-dtype", "float32"])
    assert "x_stack = np.empty((len(range(n)), x.size), np.float32)\n" in capsys.readouterr().out
