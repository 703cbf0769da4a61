"""What `memory` decides: which loops run again, and which calls keep their tapes; gradients are the same."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from benchmarks.kernels.cases import ARRAYS, Case
from benchmarks.peers.problems import Problem
from tests.corpus.buffers import reallocation
from tests.corpus.calls import kept_tapes
from tests.harness.engines import running

ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])
ECONOMIES = ("least", "balanced", "fastest")
LOOPED = ("glacier", "neural_diffusion", "implicit_heat")      # those whose loops for Numba differ


def _tapes(case: Case, engine: str, size: str | int = "large") -> list[int]:
    """The bytes of the tape for each economy, at a size."""
    return [s2sad.differentiate(case.function, wrt=case.wrt, of=case.of, engine=engine, memory=m).adjoint.memory(
        *case.arguments(size)).tape for m in ECONOMIES]


@ENGINES
@pytest.mark.parametrize("case", ARRAYS, ids=lambda case: case.name)
def test_less_is_recorded_where_memory_counts(case, engine):
    least, balanced, fastest = _tapes(case, engine)
    assert least <= balanced <= fastest


@pytest.mark.parametrize(("name", "engine", "ratios"), [
    ("glacier", "numpy", (1.0, 6.8)), ("implicit_heat", "numba", (0.01, 1.0)), ("lattice", "numpy", (0.46, 1.0)),
    ("neural_diffusion", "numba", (1.0, 10.0))])
def test_a_loop_runs_again_or_records(name, engine, ratios):
    """A loop with solves runs again only where memory counts most, one of sums and products also where both count."""
    [case] = [c for c in ARRAYS if c.name == name]
    least, balanced, fastest = _tapes(case, engine)
    np.testing.assert_allclose((least / balanced, fastest / balanced), ratios, rtol=0.1)


@ENGINES
def test_a_loop_with_calls_records(engine):
    """Their adjoints run the functions again already."""
    least, balanced, fastest = _tapes(Problem.of("lstm", 64).case, engine, 64)
    assert least < 0.7 * balanced and balanced == fastest


@pytest.mark.parametrize(("case", "engine"), [
    *((case, "numpy") for case in ARRAYS), *((case, "loops") for case in ARRAYS if case.name in LOOPED)],
    ids=lambda given: getattr(given, "name", given))
def test_gradients_are_the_same(case, engine):
    found = []
    for memory in ECONOMIES:
        args = case.arguments("small")
        seeds = {o: np.cos(np.arange(args[0].size)).reshape(args[0].shape) if o != "return" else 1.0 for o in case.of}
        with running(engine) as named:
            f = s2sad.differentiate(case.function, wrt=case.wrt, of=case.of, engine=named)
            found.append(s2sad.vjp(f, args, seeds, memory=memory))
    for name, gradient in found[1].items():
        for other in (found[0], found[2]):
            np.testing.assert_allclose(other[name], gradient, rtol=1e-11, atol=1e-13)


@ENGINES
def test_calls_keep_their_tapes_where_time_counts(engine):
    given = np.linspace(0.1, 0.6, 6), np.linspace(0.2, 0.9, 6), 3
    texts = [s2sad.differentiate(kept_tapes.many, wrt=("x", "w"), engine=engine, memory=m).adjoint_source(*given)
             for m in ECONOMIES]
    assert ["advance_augmented" in t for t in texts] == [False, False, True]
    f = s2sad.differentiate(kept_tapes.many, engine="numpy")
    results = [s2sad.gradient(f, wrt=("x", "w"), memory=m)(*given) for m in ECONOMIES]
    for name in ("x", "w"):
        np.testing.assert_allclose(results[2][name], results[0][name], rtol=1e-12)


def test_another_word_is_refused():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(kept_tapes.many, memory="small")    # pyright: ignore[reportArgumentType]
    assert str(caught.value) == ("error[S408]: memory is 'small'\n"
                                 "  help: say 'least', 'balanced', 'fastest'")


def test_a_driver_says_one_of_both():
    """What a driver says of memory leaves the loops as the function has them, and the other way round."""
    f = s2sad.differentiate(kept_tapes.many, memory="least", checkpoint="1 GB")
    said = s2sad.gradient(f, checkpoint="2 GB").decorator_arguments()[2], s2sad.gradient(
        f, memory="fastest").decorator_arguments()[2]
    assert [(r.memory, r.limit) for r in said] == [("least", 2_000_000_000), ("fastest", 1_000_000_000)]


@pytest.mark.parametrize(("kernel", "recorded"), [
    (reallocation.linear_only, False), (reallocation.helper_adds, False), (reallocation.linear_by_counters, False),
    (reallocation.linear_by_what_changes, True), (reallocation.stop_is_a_size, True)])
def test_sizes_that_counters_say_are_not_recorded(kernel, recorded):
    """Those of arrays that are read behind the loop are, and those that data say."""
    case = next(c for c in reallocation.cases() if c.kernel is kernel)
    text = s2sad.differentiate(kernel, wrt=case.wrt, of=case.of, engine="numba").adjoint_source(*case.arguments)
    assert ("_size_stack" in text) == recorded
