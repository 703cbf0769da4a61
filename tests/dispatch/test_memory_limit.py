"""A limit for the memory of a call: which loops keep snapshots and how many, that it is held, and what cannot be."""
from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

import s2sad
from s2sad import S2sadError, differentiate, gradient
from s2sad.dispatch.snapshot_plan import GRID
from s2sad.interface.recording_arguments import recording_of
from tests.differentiate import time_loops
from tests.interface import memory_kernels as kernels

ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])
U = np.linspace(0.1, 0.9, 2000)
SLACK = 30_000      # bytes: what is no array


def time_steps(u, c, n: int):
    for k in range(n):
        u[1:-1] = u[1:-1] + c * (u[:-2] - 2.0 * u[1:-1] + u[2:]) * u[1:-1] ** 2
        u[0] = u[0] + 0.001 * k * np.sin(u[1])
    return np.sum(u * u)


def two_models(u, c, n: int):
    for _k in range(n):
        u[:] = u + c * np.sin(u)
    v = u * u
    for _j in range(n):
        v[:] = v + c * np.cos(v) * v
    return np.sum(v)


def resized(u, n: int):
    w = u * 1.0
    for _k in range(n):
        w = np.sin(np.concatenate((w, w[:1])))
    return np.sum(w)


HELD = [(time_steps, (U, 0.1, 400), 300_000), (kernels.two_levels, (U, 60, 40), 900_000),
        (kernels.two_levels, (U, 60, 40), 200_000), (time_loops.until_a_time, (U, 0.1, 300), 400_000),
        (time_loops.of_a_helper, (U, 0.01, 24), 300_000), (two_models, (U, 0.01, 200), 700_000)]


def name_of(value):
    return getattr(value, "__name__", "")


def bare(error):
    """An error without the file that it is about."""
    return "error[" + str(error).partition("error[")[2]


def peak_of(call, *args):
    call(*args)
    seen = []
    for _ in range(3):
        tracemalloc.start()
        try:
            before = tracemalloc.get_traced_memory()[0]
            tracemalloc.reset_peak()
            call(*args)
            seen.append(tracemalloc.get_traced_memory()[1] - before)
        finally:
            tracemalloc.stop()
    return min(seen)


@pytest.mark.parametrize(("kernel", "args", "limit"), HELD, ids=name_of)
def test_a_limit_is_held_and_changes_no_bit(kernel, args, limit):
    call = gradient(differentiate(kernel, engine="numpy", checkpoint=limit), wrt="u")
    plain = gradient(differentiate(kernel, engine="numpy"), wrt="u")
    memory = call.memory(*args)
    assert memory.loops
    assert memory.is_complete
    assert limit // 3 < memory.peak <= limit < plain.memory(*args).peak or not plain.memory(*args).is_complete
    assert peak_of(call, *args) <= limit + SLACK
    np.testing.assert_array_equal(call(*args), plain(*args))


@pytest.mark.parametrize(("kernel", "args", "limit"), HELD[:4], ids=name_of)
def test_gradients_under_numba(kernel, args, limit):
    call = gradient(differentiate(kernel, engine="numba", checkpoint=limit), wrt="u")
    plain = gradient(differentiate(kernel, engine="numba"), wrt="u")
    assert call.memory(*args).peak <= limit
    np.testing.assert_allclose(call(*args), plain(*args), rtol=1e-12)


@ENGINES
def test_each_way_to_call(engine):
    f = differentiate(time_steps, engine=engine, wrt="u", checkpoint="0.3 MB")
    plain = differentiate(time_steps, engine=engine)
    expected = gradient(plain, wrt="u")(U, 0.01, 400)
    u_bar = np.zeros_like(U)
    f.adjoint(U.copy(), u_bar, 0.01, 400, 1.0)
    shadow = np.zeros_like(U)
    s2sad.autodiff(s2sad.Reverse, f, s2sad.Duplicated(U.copy(), shadow), s2sad.Const(0.01), 400)
    _, tape = f.augmented(U.copy(), 0.01, 400)
    swept = np.zeros_like(U)
    assert tape.nbytes < 300_000
    f.reverse(tape, swept, 1.0)
    bare_bar = np.zeros_like(U)
    f.compiled("adjoint", U.copy(), bare_bar, 0.01, 400, 1.0)(U.copy(), bare_bar, 0.01, 400, 1.0)
    found = [u_bar, shadow, swept, bare_bar, s2sad.value_and_gradient(f)(U, 0.01, 400)[1], gradient(f)(U, 0.01, 400),
             s2sad.vjp(f, (U, 0.01, 400), {"return": 1.0})["u"],
             s2sad.vjp(plain, (U, 0.01, 400), {"return": 1.0}, wrt="u", checkpoint="0.3 MB")["u"],
             gradient(plain, wrt="u", checkpoint=300_000)(U, 0.01, 400)]
    for each in found:
        np.testing.assert_allclose(each, expected, rtol=1e-11)
    assert "_k_loop_adjoint" in f.adjoint_source(U, 0.01, 400)
    assert "_k_loop_adjoint" not in f.adjoint_source(U, 0.01, 3)


class Model:
    def __init__(self, u):
        self.u, self.time = u, 0.0

    def step(self, c):
        self.u[1:] = self.u[1:] + c * self.u[:-1] * self.u[1:]
        self.time += 0.1


def energy_of(model, c, n: int):
    for _k in range(n):
        model.step(c)
    return np.sum(model.u ** 2) * model.time


@ENGINES
def test_structures(engine):
    plain = gradient(differentiate(energy_of, engine=engine), wrt="model")(Model(U.copy()), 0.1, 300)
    call = gradient(differentiate(energy_of, engine=engine, checkpoint="0.3 MB"), wrt="model")
    assert call.memory(Model(U.copy()), 0.1, 300).loops
    np.testing.assert_allclose(call(Model(U.copy()), 0.1, 300).u, plain.u, rtol=1e-12)


def test_loops_and_numbers_follow_from_the_sizes_of_each_call():
    f = differentiate(time_steps, engine="numpy", wrt="u", checkpoint="0.3 MB")
    counts = []
    for steps in (3, 400, 5, 400, 300):
        found = f.adjoint.memory(U, 0.1, steps)
        counts.append(found.loops[0].snapshots if found.loops else 0)
        np.testing.assert_allclose(gradient(f)(U, 0.1, steps), gradient(differentiate(time_steps, engine="numpy"), wrt=(
            "u",))(U, 0.1, steps), rtol=1e-12)
    assert counts[0] == counts[2] == 0
    assert counts[1] == counts[3] == counts[4] in GRID
    assert f.adjoint.memory(U[:200], 0.1, 400).loops[0].snapshots > counts[1]


def test_what_was_recorded_for_another_call_is_not_kept_beside(monkeypatch):
    """Compiled adjoints keep their tapes: what a call of other sizes has left counts, and goes."""
    f = differentiate(time_steps, engine="numba", wrt="u", checkpoint="4 MB")
    f.adjoint(U.copy(), np.zeros_like(U), 0.1, 200, 1.0)
    assert f.adjoint.memory(U, 0.1, 200).loops == ()
    assert s2sad.clear(f) > 3_000_000
    f.adjoint(U.copy(), np.zeros_like(U), 0.1, 200, 1.0)
    f.adjoint(U.copy(), np.zeros_like(U), 0.1, 400, 1.0)
    assert f.adjoint.memory(U, 0.1, 400).loops
    assert s2sad.clear(f) < 1_000_000


def test_a_tighter_limit_than_one_loop_can_hold():
    """The inner loop records three times as much as is allowed, for one step of the outer."""
    [first, second] = sorted(gradient(differentiate(kernels.two_levels, engine="numpy", wrt="u", checkpoint=200_000)
                                      ).memory(U, 60, 40).loops, key=lambda loop: loop.loop)
    assert (first.loop, second.loop) == ("j", "k")


def test_a_loop_that_the_text_marks_keeps_fewer_than_it_says():
    def marked(u, n: int):
        for k in s2sad.timesteps(range(n), snapshots=500):
            u[:] = u + 0.01 * np.sin(u) * k
        return np.sum(u)
    f = gradient(differentiate(marked, engine="numpy", checkpoint="0.5 MB"))
    assert f.memory(U, 1000).loops[0].snapshots < 30
    np.testing.assert_array_equal(f(U, 100), gradient(differentiate(marked, engine="numpy"))(U, 100))


def test_floats_that_decide_how_many_steps_there_are():
    def until(u, dt, end):
        n = int(end / dt)
        for _k in range(n):
            u[:] = u + dt * np.sin(u)
        return np.sum(u)
    f = gradient(differentiate(until, engine="numpy", checkpoint="0.3 MB"), wrt="u")
    assert f.memory(U, 0.1, 0.5).loops == ()
    assert f.memory(U, 0.001, 0.5).loops
    assert f.memory(U, 0.1, 0.5).loops == ()


# -- what cannot be had -----------------------------------------------------------------------------------------------

@ENGINES
def test_what_does_not_fit_is_refused_before_anything_is_written(engine):
    f = differentiate(time_steps, engine=engine, wrt="u", checkpoint="20 kB")
    u, u_bar = U.copy(), np.ones_like(U)
    for call in (lambda: f.adjoint(u, u_bar, 0.1, 400, 1.0), lambda: gradient(f)(u, 0.1, 400),
                 lambda: f.augmented(u, 0.1, 400), lambda: f.adjoint.memory(u, 0.1, 400)):
        with pytest.raises(S2sadError, match="S410"):
            call()
    np.testing.assert_array_equal(u, U)
    np.testing.assert_array_equal(u_bar, 1.0)


def test_says_the_least_which_is_enough():
    f = differentiate(kernels.two_levels, engine="numpy", wrt="u", checkpoint=100_000)
    with pytest.raises(S2sadError) as caught:
        f.adjoint.memory(U, 60, 40)
    assert bare(caught.value) == (
        "error[S410]: the adjoint of 'two_levels' takes 0.14 MB at least, and checkpoint allows 0.10 MB\n"
        "  note: with one snapshot of the loop over k and the loop over j\n"
        "  help: say checkpoint=144032 or more")
    f = differentiate(kernels.two_levels, engine="numpy", wrt="u", checkpoint=144_032)
    assert f.adjoint.memory(U, 60, 40).peak == 144_032


def test_copies_are_counted():
    with pytest.raises(S2sadError) as caught:
        gradient(differentiate(kernels.two_levels, engine="numpy", wrt="u", checkpoint=150_000)).memory(U, 60, 40)
    assert bare(caught.value) == (
        "error[S410]: the adjoint of 'two_levels' takes 0.18 MB at least, and checkpoint allows 0.15 MB\n"
        "  note: with one snapshot of the loop over k and the loop over j; 32,000 bytes of it are copies of arguments "
        "and shadows\n  help: say checkpoint=176032 or more")


def test_a_loop_that_cannot_keep_snapshots():
    with pytest.raises(S2sadError) as caught:
        gradient(differentiate(resized, engine="numpy", checkpoint="0.1 MB"))(U, 100)
    assert "S410" in str(caught.value)
    assert "the loop over _k keeps none: 'w' is allocated anew in a loop that keeps snapshots" in str(caught.value)


@pytest.mark.parametrize("wrong", ["1", "GB", "1 XB", "-1 MB", 0, -5, True, 1.5, "0 MB"])
def test_what_is_no_limit(wrong):
    with pytest.raises(S2sadError) as caught:
        differentiate(time_steps, checkpoint=wrong)
    assert str(caught.value) == (
        f"error[S408]: checkpoint is {wrong!r}\n  help: name loops and how many snapshots each keeps: "
        'checkpoint={"k": 20}, {"advance.k": 20} of a function that is called, {"line 14": 20} by its line; or give '
        'the memory that the call may take: checkpoint="1 GB"')


@pytest.mark.parametrize(("said", "count"), [("1 GB", 10 ** 9), ("200MB", 2 * 10 ** 8), ("1.5 kb", 1500),
                                             ("2 GiB", 2 << 30), ("12 B", 12), (17, 17), (np.int64(3), 3)])
def test_limits(said, count):
    assert recording_of(said).limit == count


# -- reports ----------------------------------------------------------------------------------------------------------

def test_explain_says_what_is_chosen_and_why():
    f = differentiate(time_steps, engine="numpy", wrt="u", checkpoint="0.3 MB")
    memory = f.adjoint.memory(U, 0.1, 400)
    lines = str(s2sad.explain(f, U, 0.1, 400)).splitlines()
    assert lines[2] == str(memory.loops[0])
    assert lines[3] == (f"takes {memory.peak / 1e6:.2f} MB of the 0.30 MB that checkpoint allows; without snapshots it "
                        "would take 6.49 MB, most of it for the loop over k")
    lines = str(s2sad.explain(f, U, 0.1, 4)).splitlines()
    assert lines[2] == "takes 0.16 MB of the 0.30 MB that checkpoint allows: all is recorded"
