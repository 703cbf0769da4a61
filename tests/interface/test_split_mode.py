"""`f.augmented` and `f.reverse`: the two sweeps of an adjoint as two calls."""
from __future__ import annotations

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor
from zlib import crc32

import numpy as np
import pytest

import s2sad
from tests import corpus
from tests.custom.test_user_adjoints import helper, with_halves
from tests.harness.engines import running
from tests.harness.split_sweeps import check_split
from tests.interface.split_kernels import CASES, divides, early, made, nested, returned, squares, step, turned

ENGINES = ("numpy", "numba")
CORPUS = {name: case for name, case in corpus.cases() if not case.refused}
SAMPLED = [pytest.param(CORPUS[name], id=name) for name in dict.fromkeys((
    *(name for name in CORPUS if not crc32(name.encode()) % 40),
    "library.fft.split_step", "library.indexing_and_sorting.ufuncs", "calls.array_results.tuples-2",
    # primals that copy what is not there: None was carried
    "structures.choices.read_where_it_is_replaced", "structures.carried_choices.one_in_another-2",
    "structures.carried_choices.one_in_an_object", "structures.carried_choices.not_asked_whether_it_is_there"))]


@pytest.mark.filterwarnings("ignore:.*derivatives do not print")
@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("case", SAMPLED)
def test_sweeps_of_the_corpus_have_the_bits_of_the_joint_adjoint(case, engine):
    with running(engine) as run_under:
        check_split(case.kernel, case.arguments, case.wrt, case.of, run_under)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize(("kernel", "arguments", "options"), CASES)
def test_sweeps_have_the_bits_of_the_joint_adjoint(kernel, arguments, options, engine):
    with running(engine) as run_under:
        check_split(kernel, arguments, **{"wrt": None, "of": None} | options, engine=run_under)


@pytest.mark.parametrize("checkpoint", [None, {"k": 2}])
def test_both_halves_divide_as_numpy(checkpoint):
    check_split(divides, (np.ones(2), 0.0, 4), "u", None, "numpy", checkpoint)
    f = s2sad.differentiate(divides, wrt="u", engine="numpy", checkpoint=checkpoint)
    f.adjoint(np.ones(2), u_bar := np.zeros(2), 0.0, 4, 1.0)
    assert u_bar.tolist() == [0.0625, 0.0]


@pytest.mark.parametrize("number", [0, 4, 12, 14, 19])
def test_compiled_sweeps(number):
    kernel, arguments, options = CASES[number]
    check_split(kernel, arguments, **{"wrt": None, "of": None} | options, engine="numba")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_functions_with_an_adjoint_in_two_halves_of_their_own(engine, sign):
    check_split(helper, (sign * np.array([0.3, -0.5, 0.7]), 0.7), None, None, engine)
    check_split(with_halves, (np.array([0.4, 0.3]), np.zeros(2), 0.7), None, None, engine)


# -- how it is called -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("engine", ENGINES)
def test_arguments_may_be_written_between_the_sweeps(engine):
    f = s2sad.differentiate(squares, wrt=("u", "dt"), engine=engine)
    u, seeds, found = np.array([1.0, 3.0]), ([1.0, 0.0], [0.0, 1.0], [2.0, -1.0]), []
    value, tape = f.augmented(u, dt=0.5)
    assert value == 4.5 and u.tolist() == [1.5, 7.5]
    u[:] = np.nan
    for seed in seeds:
        u_bar = np.array(seed)
        found.append((u_bar, f.reverse(tape, u_bar, 0.5, keep=seed is not seeds[-1])))
    for seed, (u_bar, numbers) in zip(seeds, found):
        expected = np.array(seed)
        assert f.adjoint(np.array([1.0, 3.0]), expected, 0.5, 0.5) == numbers
        np.testing.assert_array_equal(u_bar, expected)


@pytest.mark.parametrize("engine", ENGINES)
def test_structures_have_structures_as_shadows(engine):
    f = s2sad.differentiate(step, wrt="state", engine=engine)

    def bar():
        made_bar = s2sad.make_zero(made()[0])
        made_bar.u[:], made_bar.t = 1.0, 1.0
        return made_bar
    args, expected, seeds = made(), bar(), (1.5, np.array([1.0, 2.0]))
    f.adjoint(args[0], expected, *args[1:], None, *seeds)
    args, own = made(), made()
    result, tape = f.augmented(*args)
    value, (doubled, number) = step(*own)
    assert (result[0], result[1][1], args[0].t) == (pytest.approx(value), number, own[0].t)
    np.testing.assert_allclose(result[1][0], doubled)
    np.testing.assert_allclose(args[0].u, own[0].u)
    args[0].u[:], args[0].t = np.nan, np.nan
    for keep in (True, False):
        found = bar()
        assert f.reverse(tape, found, *seeds, keep=keep) is None
        assert found.t == expected.t and found.u.tolist() == expected.u.tolist()


def plus(u, v):
    return np.sum(u * v)


def test_one_array_for_two_arguments_and_one_shadow_for_both():
    f = s2sad.differentiate(plus, engine="numpy")
    u, u_bar = np.array([1.0, 2.0]), np.zeros(2)
    _, tape = f.augmented(u, u)
    f.reverse(tape, u_bar, u_bar, 1.0, keep=True)
    assert u_bar.tolist() == [2.0, 4.0]
    _, apart = f.augmented(u, u.copy())
    with pytest.raises(s2sad.S2sadError) as caught:
        f.reverse(apart, u_bar, u_bar, 1.0)
    assert str(caught.value) == ("error[S404]: the shadow 'u_bar' and the shadow 'v_bar' share memory\n"
                                 "  help: give each shadow memory of its own: s2sad.make_zero(x)")
    f.reverse(apart, u_bar, np.zeros(2), 1.0)       # nothing was used up


def test_a_result_is_the_caller_s():
    f = s2sad.differentiate(returned, engine="numpy")
    (y, _), tape = f.augmented(np.array([1.0, 2.0]))
    u_bar, seed = np.zeros(2), y.copy()
    y *= 0.0
    f.reverse(tape, u_bar, seed, 1.0)
    np.testing.assert_allclose(u_bar, np.exp([2.0, 4.0]) + 2.0 * np.exp([2.0, 4.0]))


def apply(rhs, u):
    return np.sum(rhs(u) * u)


def test_functions_and_methods():
    value, tape = (f := s2sad.differentiate(apply, wrt="u", engine="numpy")).augmented(np.sin, np.array([1.0]))
    f.reverse(tape, u_bar := np.zeros(1), 1.0)
    assert value == np.sin(1.0) and u_bar == pytest.approx(np.sin(1.0) + np.cos(1.0))


# -- tapes ----------------------------------------------------------------------------------------------------------
def test_a_tape_says_what_it_holds_and_is_freed():
    f = s2sad.differentiate(squares, wrt="u", engine="numpy")
    result, tape = f.augmented(np.ones(4), 0.5)
    assert repr(tape) == "<tape of squares, 64 bytes>" and tape.nbytes == 64 and result == 3.0
    with tape:
        f.reverse(tape, np.ones(4), 1.0, keep=True)
        assert tape.nbytes == 64
    assert tape.nbytes == 0 and repr(tape) == "<tape of squares, was freed>"
    tape.free()


def test_what_the_reverse_sweep_does_not_read_is_not_copied():
    f = s2sad.differentiate(turned, wrt="u", engine="numpy")
    text = s2sad.differentiate(turned, wrt="u", engine="numpy").adjoint_source(np.ones(3), 0.5, 2, split=True)
    assert "    return None, (np.empty_like(u), p, m, u_stack)\n" in text
    assert "def turned_reverse(tape, u_bar):\n    u, p, m, u_stack = tape\n    # reverse sweep\n" in text
    assert "split" not in f.adjoint_source(np.ones(3), 0.5, 2)


def refusal(call):
    with pytest.raises(s2sad.S2sadError) as caught:
        call()
    return str(caught.value)


def test_refused_tapes():
    f, g = (s2sad.differentiate(h, wrt="u", engine="numpy") for h in (squares, early))
    other = s2sad.differentiate(squares, engine="numpy")
    value, tape = f.augmented(np.ones(2), 0.5)
    u_bar = np.ones(2)
    assert refusal(lambda: f.reverse(value, u_bar, 1.0)) == (
        "error[S409]: 'squares.reverse' was given float in place of a tape\n"
        "  help: result, tape = squares.augmented(...)")
    assert refusal(lambda: g.reverse(tape, u_bar, 1.0)) == (
        "error[S409]: 'early.reverse' was given a tape of 'squares'\n"
        "  help: give what early.augmented returned beside the result")
    assert refusal(lambda: other.reverse(tape, u_bar, 1.0)) == (
        "error[S409]: 'squares.reverse' was given a tape of one with another wrt, of, engine, checkpoint or memory\n"
        "  help: give what squares.augmented returned beside the result")
    assert refusal(lambda: pickle.dumps(tape)) == refusal(lambda: copy.copy(tape)) == (
        "error[S409]: the tape of 'squares' cannot be copied or pickled\n"
        "  help: call squares.augmented where the reverse sweep is to run")
    s2sad.differentiate(squares, wrt="u", engine="numpy").reverse(tape, u_bar, 1.0)     # the same derivative
    assert refusal(lambda: f.reverse(tape, u_bar, 1.0)) == (
        "error[S409]: the tape of 'squares' was used up by a reverse sweep\n"
        "  help: say keep=True in each sweep but the last, or call squares.augmented again")
    _, tape = f.augmented(np.ones(2), 0.5)
    tape.free()
    assert refusal(lambda: f.reverse(tape, u_bar, 1.0)) == (
        "error[S409]: the tape of 'squares' was freed\n  help: call squares.augmented again")


@pytest.mark.parametrize(("given", "said"), [
    ((), "error[S405]: 'returned.reverse' was given nothing behind the tape, and takes 3\n"
         "  help: call returned.reverse(tape, u_bar, result_0_bar, result_1_bar)"),
    ((np.ones(2), np.ones(2)),
     "error[S405]: 'returned.reverse' was given 2 arguments behind the tape, and takes 3\n"
     "  note: given were an array of float64 of shape (2,), an array of float64 of shape (2,)\n"
     "  help: call returned.reverse(tape, u_bar, result_0_bar, result_1_bar)"),
    ((np.ones(3), np.ones(2), 1.0), "error[S403]: the shadow 'u_bar' has shape (3,), its primal 'u' has (2,)\n"
                                    "  help: make one with s2sad.make_zero(u)"),
    ((np.ones(2), np.ones(3), 1.0),
     "error[S403]: the seed 'result_0_bar' has shape (3,), what 'returned' returns there has (2,)\n"
     "  help: give an array of its shape"),
    ((np.ones(2, np.float32), np.ones(2), 1.0),
     "error[S403]: the shadow 'u_bar' has dtype float32, its primal 'u' has float64\n"
     "  help: make one with s2sad.make_zero(u)"),
    ((np.ones(2), np.ones(2), None), "error[S403]: the seed of 'return' is of type NoneType, not a float\n"
                                     "  help: give a float")])
def test_refused_shadows_leave_the_tape(given, said):
    f = s2sad.differentiate(returned, engine="numpy")
    _, tape = f.augmented(np.array([0.0, 0.0]))
    before = [np.copy(g) for g in given if isinstance(g, np.ndarray)]
    assert refusal(lambda: f.reverse(tape, *given)) == said
    assert all(np.array_equal(b, g) for b, g in zip(before, given))
    f.reverse(tape, u_bar := np.zeros(2), np.ones(2), 1.0)
    assert u_bar.tolist() == [3.0, 3.0]


def replaced(state, u):
    state.u = 2.0 * u




def sharing_forward(u, t):
    u *= t
    return np.ravel(u)


def sharing_reverse(kept, u, u_bar, t):
    u_bar *= t
    return kept[0] * u_bar[1]


@s2sad.rule(forward=sharing_forward, reverse=sharing_reverse)
def sharing(u, t):
    u *= t


def shares(u, t):
    sharing(u, t)


def test_what_may_change_between_the_sweeps_is_refused():
    f = s2sad.differentiate(shares, engine="numba")
    assert refusal(lambda: f.augmented(np.ones(2), 0.5)) == (
        "error[S409]: 'shares' calls a function with an adjoint of its own, and what that saves shares memory with the "
        "argument 'u', which may change before the reverse sweep\n  help: let its first half save a copy")
    f = s2sad.differentiate(replaced, engine="numpy")
    assert refusal(lambda: f.augmented(made()[0], np.ones(2))) == (
        "error[S409]: 'replaced' leaves something else in 'state' than was there, which replaced.augmented does not "
        "do\n  help: use s2sad.vjp, which changes no argument, or write arrays in place")


def raising(u):
    for i in range(u.size):
        u[i] = u[i] * u[i]
        if u[i] > 5.0:
            raise ValueError("too much")


@pytest.mark.parametrize("engine", ENGINES)
def test_what_the_kernel_raises_comes_through(engine):
    f = s2sad.differentiate(raising, engine=engine)
    with pytest.raises(ValueError, match="too much"):
        f.augmented(np.array([1.0, 3.0]))
    _, tape = f.augmented(np.array([1.0, 2.0]))
    f.reverse(tape, u_bar := np.ones(2))
    assert u_bar.tolist() == [2.0, 4.0]


def printing(u):
    for i in range(u.size):
        u[i] *= u[i]
        print("at", i)


@pytest.mark.filterwarnings("ignore:.*derivatives do not print")
def test_the_first_half_prints_as_the_primal(capsys):
    f = s2sad.differentiate(printing, engine="numpy")
    _, tape = f.augmented(np.ones(2))
    assert capsys.readouterr().out == "at 0\nat 1\n"
    f.reverse(tape, np.ones(2))
    assert not capsys.readouterr().out


@pytest.mark.parametrize("engine", ENGINES)
def test_threads_have_tapes_of_their_own_or_share_one(engine):
    f = s2sad.differentiate(nested, wrt="u", engine=engine, checkpoint={"j": 2})
    arguments = [np.linspace(0.1, 1.0, 50) * k for k in range(1, 9)]
    f.reverse(f.augmented(arguments[0].copy(), 0.7, 9, 5)[1], np.zeros(50), 1.0)

    def own(u):
        _, tape = f.augmented(u.copy(), 0.7, 9, 5)
        f.reverse(tape, bar := np.ones(50), 1.0)
        return bar

    def expected(u, seed=1.0):
        f.adjoint(u.copy(), bar := np.ones(50), 0.7, 9, 5, seed)
        return bar
    _, shared = f.augmented(arguments[0].copy(), 0.7, 9, 5)

    def another(seed):
        f.reverse(shared, bar := np.ones(50), seed, keep=True)
        return bar
    with ThreadPoolExecutor(4) as pool:
        bars, others = list(pool.map(own, arguments)), list(pool.map(another, range(1, 9)))
    for found, u in zip(bars, arguments):
        np.testing.assert_array_equal(found, expected(u))
    for found, seed in zip(others, range(1, 9)):
        np.testing.assert_array_equal(found, expected(arguments[0], float(seed)))
