"""Loops that keep snapshots in place of a tape: the same gradients, few runs of steps, and only live state is kept."""
from __future__ import annotations

from math import comb
from typing import Any

import numpy as np
import pytest

import s2sad
from s2sad import timesteps
from tests.corpus.recording import work_arrays
from tests.differentiate import time_loops
from tests.differentiate.time_loops import LOOPS, OF_A_STEP
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running


def _given(kernel, steps: int) -> tuple[Any, ...]:
    return (0.3 if kernel is time_loops.numbers_alone else np.linspace(0.1, 0.6, 6)), 0.11, steps


def _found(kernel, engine: str, steps: int, snapshots: int | None) -> tuple[Any, ...]:
    """The value and the gradients."""
    kept = None if snapshots is None else dict.fromkeys(LOOPS[kernel], snapshots)
    function = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=engine, checkpoint=kept), wrt=("u", "c"))
    value, gradients = function(*_given(kernel, steps))
    return value, gradients["u"], gradients["c"]


@pytest.mark.parametrize("kernel", LOOPS, ids=lambda k: k.__name__)
def test_gradients_are_the_same_bits(kernel):
    """With one snapshot and with more than there are steps, of loops that run not at all and often; a product that
    takes the rows of several recorded steps at once sums in the order of its processor."""
    rtol = 1e-14 if kernel is time_loops.linear else 0.0
    for steps in (0, 1, 2, 3, 7, 30)[kernel in OF_A_STEP:]:
        expected = _found(kernel, "numpy", steps, None)
        for snapshots in (1, 3, 50):
            for mine, plain in zip(_found(kernel, "numpy", steps, snapshots), expected):
                np.testing.assert_allclose(mine, plain, rtol=rtol)


@pytest.mark.parametrize("kernel", LOOPS, ids=lambda k: k.__name__)
def test_gradients_under_numba(kernel):
    """Where loops are in vectors sums may differ in their last digits from those of a loop that records, and from those
    of no other number of snapshots."""
    each = (0, 1, 2, 30)[kernel in OF_A_STEP:]
    expected = [_found(kernel, "numba", steps, None) for steps in each]
    found = [_found(kernel, "numba", steps, 3) for steps in each]
    for mine, plain in zip(found, expected):
        for one, other in zip(mine, plain):
            np.testing.assert_allclose(one, other, rtol=1e-13)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel", OF_A_STEP, ids=lambda k: k.__name__)
def test_what_no_step_binds_is_not_read(kernel, engine):
    for snapshots in (None, 3):
        with pytest.raises(UnboundLocalError):
            _found(kernel, engine, 0, snapshots)


@pytest.mark.parametrize("kernel", [time_loops.work_array, time_loops.left_by_break], ids=lambda k: k.__name__)
def test_how_many_are_kept_changes_no_digit_under_numba(kernel):
    found = [_found(kernel, "numba", 30, snapshots) for snapshots in (1, 4, 60)]
    for other in found[1:]:
        for one, two in zip(found[0], other):
            np.testing.assert_array_equal(one, two)


def marked(u, c, n):
    for k in timesteps(range(n), snapshots=4):
        for m in s2sad.timesteps(range(3), 2):
            u[m] = u[m] * np.exp(-c * u[m + 1]) + 0.01 * k
        u[0] = u[0] * u[1]
    return np.sum(u * u)


def until(u, c, n):
    t = 0.0
    for _k in timesteps(range(1000), snapshots=3):
        dt = 0.1 / (1.0 + u[0] ** 2)
        u[:] = u + dt * c * np.sin(u)
        t += dt
        if t > 0.1 * n:
            break
    return np.sum(u * u) + t


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [marked, until], ids=lambda k: k.__name__)
def test_dot_products(kernel, engine):
    measured = check_derivatives(kernel, (np.linspace(0.1, 0.6, 6), 0.2, 9), ("u", "c"), ("u", "return"), engine)
    assert measured.dot_product <= 1e-12
    assert max(measured.directional, measured.coordinates) <= 1e-7


def test_a_marked_loop_is_the_range_where_nothing_is_differentiated():
    assert list(timesteps(range(4), snapshots=2)) == [0, 1, 2, 3]
    u = np.linspace(0.1, 0.6, 6)
    assert marked(u.copy(), 0.2, 9) == s2sad.differentiate(marked, engine="numba").primal(u.copy(), 0.2, 9)


# -- the text, and what it does -----------------------------------------------------------------------------------
def steps_of(u, c, n):
    v = np.zeros_like(u)
    energy, t = 0.0, 0.0
    for k in range(n):
        for i in range(u.size):
            v[i] = np.sin(u[i]) + k * t
        u += c * v
        energy += np.sum(u)
        t = t + 0.1
    return energy


def _text(kernel, *args: Any, k: int) -> str:
    counter = "_k" if "_k" in kernel.__code__.co_varnames else "k"
    return s2sad.differentiate(kernel, engine="numpy", checkpoint={counter: k}).adjoint_source(*args)


def _watched(kernel, steps: int, snapshots: int) -> list[tuple[int, bytes]]:
    """The steps that the adjoint runs, in order, each with what the array holds where it begins."""
    u, ran = np.linspace(0.1, 0.6, 6), []
    space: dict[str, Any] = {}
    exec(_text(kernel, u, 0.1, steps, k=snapshots), space)
    step = space["steps_of_k_step"]

    def watched(k, u, *others):
        ran.append((k, u.tobytes()))
        return step(k, u, *others)
    space["steps_of_k_step"] = watched
    space["steps_of_adjoint"](u.copy(), np.zeros(6), 0.1, steps, 1.0)
    return ran


def test_steps_run_as_seldom_as_can_be():
    """The forward sweep runs the last step too, for what is behind the loop, and the adjoints of steps run each."""
    for steps in (1, 2, 5, 40):
        for snapshots in (1, 2, 3, 7, 50):
            repeats = 0
            while comb(snapshots + repeats, snapshots) < steps:
                repeats += 1
            least = repeats * steps - comb(snapshots + repeats, snapshots + 1)
            assert len(_watched(steps_of, steps, snapshots)) == least + 1


def advance(u, c, n):
    energy = 0.0
    for k in range(n):
        u[:] = u * (1.0 - c * u) + k * c
        energy += u[0]
    return energy


def calls_advance(u, c, n):
    first = advance(u[1:], c, n)
    for m in range(2):
        first += advance(u[:2], c * first, n + m)
    return first * np.sum(u)


def test_the_loop_of_a_helper_runs_forwards_once():
    """Also where its caller reads what it leaves, and wherever it is called from."""
    u, kept = np.linspace(0.1, 0.4, 5), s2sad.differentiate(
        calls_advance, engine="numpy", checkpoint={"advance.k": 50})
    space: dict[str, Any] = {}
    exec(kept.adjoint_source(u, 0.1, 6), space)
    ran = []
    for name, step in [(n, f) for n, f in space.items() if n.endswith("_step")]:
        space[name] = lambda *args, step=step: (ran.append(1), step(*args))[1]
    u_bar = np.zeros(5)
    space["calls_advance_adjoint"](u.copy(), u_bar, 0.1, 6, 1.0)
    assert len(ran) == 6 + 6 + 7
    np.testing.assert_array_equal(u_bar, s2sad.gradient(s2sad.differentiate(
        calls_advance, engine="numpy"), wrt="u")(u, 0.1, 6))


def test_a_step_that_runs_again_finds_the_same_bits():
    found: dict[int, set[bytes]] = {}
    for step, state in _watched(steps_of, 25, 2):
        found.setdefault(step, set()).add(state)
    assert sorted(found) == list(range(25))
    assert all(len(states) == 1 for states in found.values())


@pytest.mark.parametrize("kernel", (*work_arrays.REFILLED, *work_arrays.OTHERS), ids=lambda k: k.__name__)
def test_work_arrays_that_are_filled_are_no_state(kernel):
    """What looks like one and is read by a later step is kept."""
    loop = "k" if "k" in kernel.__code__.co_varnames else "_k"
    x = np.linspace(0.5, 1.3, 4)
    with running("loops") as engine:
        plain = s2sad.differentiate(kernel, engine=engine)
        expected = s2sad.gradient(plain, wrt="x")
        for steps in (1, 2, 9):
            for snapshots in (1, 3):
                found = s2sad.gradient(plain, wrt="x", checkpoint={loop: snapshots})
                np.testing.assert_array_equal(found(x, steps), expected(x, steps))


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_work_arrays_that_a_call_fills_are_not_recorded(engine):
    for kernel in work_arrays.REFILLED:
        text = s2sad.differentiate(kernel, engine=engine).adjoint_source(np.ones(4), 3)
        assert "u_stack" in text and "work_stack" not in text
    text = s2sad.differentiate(work_arrays.rows_of_others, engine=engine).adjoint_source(np.ones(4), 3)
    assert "work_stack" in text


def test_only_live_state_is_kept():
    """Neither a work array that each step fills, nor a sum that no step reads."""
    text = _text(steps_of, np.ones(4), 0.1, 5, k=3)
    assert "held, count, trips, u_snapshots, t_snapshots = kept" in text


@pytest.mark.parametrize("kernel", [time_loops.linear_until, time_loops.linear_left], ids=lambda k: k.__name__)
def test_no_step_runs_again_where_its_adjoint_reads_no_state(kernel):
    kept = s2sad.differentiate(kernel, engine="numpy", checkpoint=dict.fromkeys(LOOPS[kernel], 3))
    text = kept.adjoint_source(*_given(kernel, 5))
    loop = text[text.index(":\n", text.index("_loop_adjoint(")):text.index("def linear_", text.index("_loop_adjoint("))]
    assert "(trips,) = kept" in loop and "_step(" not in loop and "u_before" not in text


@pytest.mark.parametrize(("kernel", "kept"), [
    (time_loops.work_array, "u"), (time_loops.filled_row_by_row, "u"), (time_loops.swapped, "v u_1"),
    (time_loops.flags_and_integers, "u flag m"), (time_loops.bound_counted_down, "u n e"), (time_loops.rebound, "u_1"),
], ids=lambda p: getattr(p, "__name__", ""))
def test_what_is_kept(kernel, kept):
    for engine in ("numpy", "numba"):
        text = s2sad.differentiate(kernel, engine=engine, checkpoint=dict.fromkeys(
            LOOPS[kernel], 3)).adjoint_source(*_given(kernel, 5))
        wanted = ", ".join(["held", "count", "trips", *(f"{name}_snapshots" for name in kept.split())])
        assert f"    {wanted} = kept\n" in text


def rows(u, c, n):
    """Of `v` a step reads what the one before it has left in another row."""
    v = np.zeros((3, u.size))
    for _k in range(n):
        for i in range(2):
            v[i] = c * u + v[i + 1]
        v[2] = u * c
        u += v[0] * v[1]
    return np.sum(u)


def halves(u, c, n):
    v = np.zeros((2, u.size))
    for k in range(n):
        v[k % 2] = c * u
        u += v[0] * v[1] + c
    return np.sum(u)


@pytest.mark.parametrize("kernel", [rows, halves], ids=lambda k: k.__name__)
def test_rows_that_another_step_has_filled_are_kept(kernel):
    u = np.linspace(0.1, 0.2, 3)
    assert "v_snapshots" in _text(kernel, u, 0.1, 5, k=2)
    plain = s2sad.gradient(s2sad.differentiate(kernel, engine="numpy"), wrt=("u", "c"))(u, 0.1, 9)
    counter = "_k" if kernel is rows else "k"
    found = s2sad.gradient(kernel, wrt=("u", "c"), checkpoint={counter: 2})(u, 0.1, 9)
    for name, gradient in plain.items():
        np.testing.assert_allclose(found[name], gradient, rtol=1e-13)


def filled_either_way(u, c, n):
    f = np.zeros(u.size)
    for _k in range(n):
        for i in range(u.size):
            if u[i] > 0.3:
                f[i] = u[i] * u[i]
            else:
                f[i] = c * u[i]
        for i in range(u.size):
            u[i] += c * f[i]
    return np.sum(u)


def filled_one_way(u, c, n):
    f = np.zeros(u.size)
    for _k in range(n):
        for i in range(u.size):
            if u[i] > 0.3:
                f[i] = u[i] * u[i]
        for i in range(u.size):
            u[i] += c * u[i] * f[i]
    return np.sum(u)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_what_is_filled_whatever_way_is_taken_is_no_state(engine):
    given = np.linspace(0.1, 0.6, 6), 0.11, 9
    assert "f_snapshots" not in _text(filled_either_way, *given, k=3)
    assert "f_snapshots" in _text(filled_one_way, *given, k=3)
    with running(engine) as under:
        for kernel in (filled_either_way, filled_one_way):
            plain = s2sad.differentiate(kernel, engine=under)
            for wrt in ("u", "c"):
                expected = s2sad.gradient(plain, wrt=wrt)(*given)
                np.testing.assert_array_equal(s2sad.gradient(plain, wrt=wrt, checkpoint={"_k": 2})(*given), expected)


def euler_in_loops(u, c, n):
    f = np.zeros(u.size)
    for _k in range(n):
        for i in range(1, u.size - 1):
            f[i] = u[i - 1] * u[i + 1]
        for i in range(1, u.size - 1):
            u[i] += 0.1 * f[i]
    return np.sum(u)


def upwind(u, c, n):
    for _k in range(n):
        before = u.copy()
        for i in range(1, u.size - 1):
            u[i] = before[i] - c * before[i] * (before[i] - before[i - 1])
    return np.sum(u * u)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel", [euler_in_loops, upwind], ids=lambda k: k.__name__)
def test_the_adjoint_of_a_step_that_updates_its_state_last_runs_none(engine, kernel):
    """Nor does one that copies what the state is."""
    kept = s2sad.differentiate(kernel, wrt="u", engine=engine, checkpoint={"_k": 10})
    [loop] = kept.adjoint.memory(np.ones(4), 0.1, 1000).loops
    assert "which run 3,637 times in all, 3.64 a step; their adjoints run none" in str(loop)


def test_what_is_kept_is_told():
    kept = s2sad.differentiate(steps_of, engine="numpy", checkpoint={"k": 3})
    told = str(s2sad.explain(kept, np.ones(4), 0.1, 100))
    assert "u_snapshots: 128 bytes = 8 * min(4, len(range(n))) * u.size bytes" in told
    assert "t_snapshots: 32 bytes" in told
    assert s2sad.check(kept, np.linspace(0.1, 0.3, 4), 0.1, 9, engine="numpy")


def explicit(u, c, n):
    for k in range(n):
        u[:] = u + c * np.sin(u) * k
    return np.sum(u)


def test_where_the_adjoint_of_a_step_runs_none_is_told():
    """These are fewer runs than mixed schedules need: 3.92 a step (Maddison 2024)."""
    kept = s2sad.differentiate(explicit, engine="numpy", checkpoint={"k": 10})
    [loop] = kept.adjoint.memory(np.ones(4), 0.1, 1000).loops
    assert str(loop) == (
        "the loop over k keeps 10 snapshots of 1,000 steps, which run 3,637 times in all, 3.64 a step; their adjoints "
        "run none, for they need the states alone")
    runs = 0
    space: dict[str, Any] = {}
    exec(_text(explicit, np.ones(4), 0.1, 1000, k=10), space)
    step = space["explicit_k_step"]

    def counted(*args):
        nonlocal runs
        runs += 1
        return step(*args)
    space["explicit_k_step"] = counted
    space["explicit_adjoint"](np.ones(4), np.zeros(4), 0.1, 1000, 1.0)
    assert runs == loop.runs == 3637
    again = s2sad.differentiate(steps_of, engine="numpy", checkpoint={"k": 10})
    assert again.adjoint.memory(np.ones(4), 0.1, 1000).loops[0].runs == 4637
    none = s2sad.differentiate(time_loops.linear_left, engine="numpy", checkpoint={"k": 3})
    assert not none.adjoint.memory(np.ones(4), 0.1, 9).loops


class Model:
    def __init__(self, c: float):
        self.c, self.u = c, np.linspace(0.1, 0.5, 5)

    def run(self, n: int):
        for k in timesteps(range(n), snapshots=3):
            self.u = self.u + 0.1 * self.u * (1.0 + k) * self.c
        return np.sum(self.u)


def of_a_model(model, n: int):
    return model.run(n)


def test_a_method_that_replaces_an_array_of_its_object():
    differentiated = s2sad.differentiate(of_a_model, engine="numpy")
    assert "u_2_snapshots" in differentiated.adjoint_source(Model(0.2), 9)
    assert s2sad.check(differentiated, Model(0.2), 9, engine="numpy")


def test_all_ways_to_ask():
    u, c, n = np.linspace(0.1, 0.6, 6), 0.1, 9
    kept = s2sad.differentiate(steps_of, engine="numpy", checkpoint={"k": 3})
    expected = s2sad.gradient(s2sad.differentiate(steps_of, engine="numpy"), wrt="u")(u, c, n)
    bars = [np.zeros(6) for _ in range(2)]
    kept.adjoint(u.copy(), bars[0], c, n, 1.0)
    s2sad.autodiff(s2sad.Reverse, kept, s2sad.Duplicated(u.copy(), bars[1]), s2sad.Active(c), n, seed=1.0)
    bars += [s2sad.vjp(steps_of, (u, c, n), {"return": 1.0}, wrt="u", checkpoint={"k": 3})["u"],
             s2sad.value_and_gradient(steps_of, wrt="u", checkpoint={"k": 3})(u, c, n)[1]]
    for found in bars:
        np.testing.assert_allclose(found, expected, rtol=1e-13)
    tangent = s2sad.jvp(kept, (u, c, n), {"c": 1.0}, of="return")["return"]
    np.testing.assert_allclose(tangent, s2sad.gradient(steps_of, wrt="c")(u, c, n), rtol=1e-12)


# -- what is refused ------------------------------------------------------------------------------------------------
def _refused(kernel, checkpoint: Any, *args: Any) -> str:
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(kernel, checkpoint=checkpoint)(*args)
    return "\n".join(line for line in str(caught.value).splitlines() if " | " not in line)


def two_loops(u, n):
    for _k in range(n):
        u *= 1.1
    for _k in range(n):
        u *= 0.9
    while u[0] > 1.0:
        u *= 0.5
    return np.sum(u)


def _line(kernel, behind: int) -> int:
    return kernel.__code__.co_firstlineno + behind


def test_a_loop_that_is_not_there():
    first = _line(two_loops, 1)
    assert _refused(two_loops, {"m": 3}, np.ones(3), 4) == (
        "error[S408]: checkpoint names 'm', which is no loop of 'two_loops'\n"
        f'  help: its loops are "_k", "line {first + 4}"')
    assert _refused(time_loops.of_a_helper, {"k": 3}, np.ones(3), 0.1, 4) == (
        "error[S408]: checkpoint names 'k', which is no loop of 'of_a_helper'\n"
        '  help: its loops are "decay.i", "helper.k"')


def test_a_name_of_two_loops():
    first = _line(two_loops, 1)
    assert _refused(two_loops, {"_k": 3}, np.ones(3), 4).endswith(
        "error[S408]: checkpoint names '_k', and 2 loops of 'two_loops' are called so\n"
        f'  help: say which one: "line {first}", "line {first + 2}"')
    found = s2sad.gradient(two_loops, checkpoint={f"line {first + 2}": 2})(np.ones(3), 4)
    np.testing.assert_allclose(found, s2sad.gradient(two_loops)(np.ones(3), 4), rtol=1e-14)


@pytest.mark.parametrize(("checkpoint", "said"), [
    ("k", "checkpoint is 'k'"), ({"k": 2.5}, "checkpoint holds 'k': 2.5"),
    ({"k": True}, "checkpoint holds 'k': True")])
def test_what_is_no_number_of_snapshots(checkpoint, said):
    assert _refused(two_loops, checkpoint, np.ones(3), 4) == (
        f'error[S408]: {said}\n  help: name loops and how many snapshots each keeps: checkpoint={{"k": 20}}, '
        '{"advance.k": 20} of a function that is called, {"line 14": 20} by its line; or give '
        'the memory that the call may take: checkpoint="1 GB"')


def test_no_snapshots():
    assert _refused(two_loops, {"k": 0}, np.ones(3), 4) == (
        "error[S408]: checkpoint holds 'k': 0, and a loop keeps one snapshot at least\n"
        "  help: more snapshots are fewer steps that run again")


def size_of_the_last(u, n):
    for k in range(n):
        w = np.zeros(k + 1)
        u[0] += w.size * u[1]
    return u[w.size - 1]


def test_a_size_that_is_read_behind_the_loop():
    assert "error[S201]: 'w' is allocated anew in a loop that keeps snapshots" in _refused(
        size_of_the_last, {"k": 3}, np.ones(9), 4)


@s2sad.rule(a="b", b="a")
def not_compiled(a, b):
    return eval("a * b")


def calls_not_compiled(u, c, n):
    for k in range(n):
        u[k] = not_compiled(u[k], c)
    return np.sum(u)


def test_a_rule_that_numba_cannot_compile_is_refused_at_its_call():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(calls_not_compiled, engine="numba", checkpoint={"k": 2}), wrt="u")(
            np.ones(4), 0.5, 4)
    said = str(caught.value)
    assert f"error[S407]: Numba cannot compile '{__name__}.not_compiled'\n" in said
    assert f"|         u[k] = not_compiled(u[k], c)\n      |                {21 * '^'}\n" in said


def said_how_often(u, n):
    for _k in timesteps(range(n), "often"):
        u *= 0.5
    return np.sum(u)


def test_a_mark_that_says_no_number():
    assert _refused(said_how_often, None, np.ones(3), 4).endswith(
        "error[S408]: how many snapshots a loop keeps is no positive number here\n"
        "  help: write the number: timesteps(range(n), snapshots=20)")
