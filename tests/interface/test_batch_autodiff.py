"""`autodiff` with several directions: each is what it is alone, and what does not fit changes nothing."""
from __future__ import annotations

import copy
import warnings

import numpy as np
import pytest

import s2sad
from s2sad import (
    Active, BatchDuplicated, Const, Duplicated, Forward, ForwardWithPrimal, Reverse, ReverseWithPrimal, autodiff,
)
from tests import corpus
from tests.harness.engines import one_line, running
from tests.interface import kernels

ENGINES = pytest.mark.parametrize("engine", ["numpy", "loops"])


def same(found, wanted):
    """Whether results are alike to the last digits."""
    if isinstance(wanted, (tuple, list)):
        return len(found) == len(wanted) and all(map(same, found, wanted))
    return found is None if wanted is None else np.allclose(found, wanted, rtol=1e-13, atol=1e-15, equal_nan=True)


def compare(f, args, marks, mode, width=3, seeds=None):
    """Raises AssertionError unless all directions at once are what they are one by one; `marks` has Duplicated for
    what has shadows, Active, or None."""
    rng = np.random.default_rng(5)
    shadows = [[np.array(rng.standard_normal(np.shape(a)), a.dtype) if isinstance(a, np.ndarray)
                else float(rng.standard_normal()) for _ in range(width)] if m is Duplicated else None
               for a, m in zip(args, marks)]
    wanted, left = [], []
    for k in range(width):
        own, mine = copy.deepcopy(args), [copy.deepcopy(s[k]) if s is not None else None for s in shadows]
        marked = [m(a, s) if m is Duplicated else m(a) if m is not None else a for a, m, s in zip(own, marks, mine)]
        wanted.append(autodiff(mode, f, *marked, seed=None if seeds is None else seeds[k]))
        left.append(mine)
    own = copy.deepcopy(args)
    marked = [BatchDuplicated(a, tuple(s)) if m is Duplicated else m(a) if m is not None else a
              for a, m, s in zip(own, marks, shadows)]
    found = autodiff(mode, f, *marked, seed=seeds)
    if mode.with_primal:
        assert same(found[1], wanted[0][1])
        found, wanted = found[0], [w[0] for w in wanted]
    assert same(list(zip(*found)) if mode.reverse and found else list(found), wanted if found else [])
    for k in range(width):
        for s, mine in zip(shadows, left[k]):
            assert s is None or same(s[k], mine)
    f(*(primals := copy.deepcopy(args)))
    assert same(own, primals)


U = np.array([1.0, 2.0, 0.5])


@ENGINES
@pytest.mark.parametrize(("kernel", "args", "marks", "modes", "seeds"), [
    (kernels.square, (np.zeros(3), U, 3), (Duplicated, Duplicated, None), (Forward, Reverse, ReverseWithPrimal), None),
    (kernels.scale, (U, 3.0), (Duplicated, Duplicated), (Forward, ForwardWithPrimal), None),
    (kernels.scale, (U, 3.0), (Duplicated, Active), (Reverse,), None),
    (kernels.norm, (U, 2.0), (Duplicated, Active), (Reverse, ReverseWithPrimal), None),
    (kernels.norm, (U, 2.0), (Duplicated, Active), (Reverse,), (1.0, 0.5, -2.0)),
    (kernels.norm, (U, 2.0), (Duplicated, Const), (Reverse, Forward), None),
    (kernels.grown, (U,), (Duplicated,), (Forward, ForwardWithPrimal), None),
    (kernels.grown, (U,), (Duplicated,), (Reverse, ReverseWithPrimal), tuple(np.eye(3))),
    (kernels.pair, (3.0, 4), (Duplicated, None), (Forward, ForwardWithPrimal), None)])
def test_several_directions_are_each_of_them(kernel, args, marks, modes, seeds, engine):
    with running(engine) as under:
        f = s2sad.differentiate(kernel, engine=under)
        for mode in modes:
            compare(f, args, marks, mode, seeds=seeds)


def annotated():
    """Some kernels of the corpus whose results are arrays that they write, or one float."""
    for name, case in list(corpus.cases())[::90]:
        kinds = [float if isinstance(a, float) else isinstance(a, np.ndarray) and a.dtype == float
                 for a in case.arguments]
        if not case.refused and any(k is True for k in kinds):
            yield pytest.param(case, kinds, id=name)


@ENGINES
@pytest.mark.parametrize(("case", "kinds"), [*annotated()])
def test_of_the_corpus(case, kinds, engine):
    with running(engine) as under, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        f, asked = s2sad.differentiate(case.kernel, engine=under), []
        for mode in (Forward, Reverse):
            marks = [None if not k else Duplicated if k is True or mode is Forward else Active for k in kinds]
            alone = [m(a, np.zeros_like(a) if isinstance(a, np.ndarray) else 0.0) if m is Duplicated else
                     m(a) if m else a for a, m in zip(copy.deepcopy(case.arguments), marks)]
            try:
                autodiff(mode, f, *alone)
            except s2sad.S2sadError as refused:
                asked.append(refused.diagnostics[0].code)
                continue
            try:
                compare(f, case.arguments, marks, mode)
            except s2sad.S2sadError as refused:
                assert "takes or returns a structure" in str(refused)
        assert {*asked} <= {"S402", "S403", "S404", "S405", "S406"}


def test_one_direction_and_compiled():
    compare(s2sad.differentiate(kernels.square, engine="numba"), (np.zeros(3), U, 3), (Duplicated, Duplicated, None),
            Reverse, width=1)
    compare(s2sad.differentiate(kernels.norm, engine="numba"), (U, 2.0), (Duplicated, Active), Reverse, width=5)


DU, OTHER = np.zeros(3), np.ones(3)
FOLDED = np.lib.stride_tricks.as_strided(np.zeros(1), (3,), (0,))


@pytest.mark.parametrize(("mode", "marks", "seed", "said"), [
    (Forward, (BatchDuplicated(DU, (OTHER,)), Duplicated(U, OTHER)), None,
     "S402: the argument 'u' has one shadow, others have several: say BatchDuplicated(u, (d1, d2, ...)), with as many "
     "as these"),
    (Reverse, (BatchDuplicated(DU, (DU + 1, DU + 2)), BatchDuplicated(U, (DU + 1,))), None,
     "S402: 'du' has 2 shadows, 'u' has 1: give all of them as many"),
    (Reverse, (BatchDuplicated(DU, ()), BatchDuplicated(U, ())), None,
     "S402: the argument 'du' has no shadow: give a tuple with one for each direction: (d1, d2)"),
    (Reverse, (BatchDuplicated(DU, np.zeros((2, 3))), Const(U)), None,
     "S402: the shadows of 'du' are of type ndarray: give a tuple with one for each direction: (d1, d2)"),
    (Reverse, (BatchDuplicated(DU, (OTHER, OTHER)), Const(U)), None,
     "S404: the shadow 'du_bar[0]' and the shadow 'du_bar[1]' share memory: give each shadow memory of its own: "
     "s2sad.make_zero(x)"),
    (Forward, (Const(DU), BatchDuplicated(U, (OTHER, OTHER))), None,
     "S404: the shadow 'u_dot[0]' and the shadow 'u_dot[1]' share memory: give each shadow memory of its own: "
     "s2sad.make_zero(x)"),
    (Reverse, (BatchDuplicated(DU, (DU + 1, U)), BatchDuplicated(U, (DU + 1, DU + 2))), None,
     "S404: the argument 'u' and the shadow 'du_bar[1]' share memory: give each shadow memory of its own: "
     "s2sad.make_zero(x)"),
    (Reverse, (BatchDuplicated(DU, (DU + 1, np.ones(2))), Const(U)), None,
     "S403: the shadow 'du_bar[1]' has shape (2,), its primal 'du' has (3,): make one with s2sad.make_zero(du)"),
    (Reverse, (BatchDuplicated(DU, (DU + 1, np.ones(3, int))), Const(U)), None,
     "S403: the shadow 'du_bar[1]' has dtype int64, its primal 'du' has float64: make one with s2sad.make_zero(du)"),
    (Reverse, (BatchDuplicated(DU, (DU + 1, 2.0)), Const(U)), None,
     "S403: the shadow 'du_bar[1]' is a float, its primal 'du' is an array: make one with s2sad.make_zero(du)"),
    (Reverse, (BatchDuplicated(DU, (DU + 1, FOLDED)), Const(U)), None,
     "S403: the shadow 'du_bar[1]' overlaps itself: make one with s2sad.make_zero(du)"),
    (Reverse, (BatchDuplicated(DU, (DU + 1,)), Const(U)), (1.0,),
     "S403: a seed was given, and the function returns no float that has a shadow: leave it out"),
])
def test_what_does_not_fit(mode, marks, seed, said):
    before = copy.deepcopy([(m.value, getattr(m, "shadow", None), getattr(m, "shadows", None)) for m in marks])
    with pytest.raises(s2sad.S2sadError) as caught:
        autodiff(mode, kernels.square, *marks, 3, seed=seed)
    assert f"{caught.value.diagnostics[0].code}: {one_line(caught.value)}" == said
    for mark, (value, *shadows) in zip(marks, before):
        assert same(mark.value, value)
        assert same([getattr(mark, "shadow", None), getattr(mark, "shadows", None)], shadows)


@pytest.mark.parametrize(("marks", "seed", "said"), [
    ((BatchDuplicated(U, (DU + 1, DU + 2)), Active(1.0)), (1.0,),
     "S403: the seed is of 1, there are 2 directions: give a tuple of one seed for each"),
    ((BatchDuplicated(U, (DU + 1, DU + 2)), Active(1.0)), 1.0,
     "S403: the seed is no tuple, there are 2 directions: give a tuple of one seed for each"),
    ((BatchDuplicated(U, (DU + 1, DU + 2)), Duplicated(1.0, 1.0)), None,
     "S402: the argument 'c' has one shadow, others have several: say BatchDuplicated(c, (d1, d2, ...)), with as many "
     "as these"),
    ((Const(U), BatchDuplicated(1.0, (1.0, 2.0))), None,
     "S402: the argument 'c' is a float, which cannot be Duplicated in reverse: use Active(c)"),
])
def test_seeds_and_numbers_that_do_not_fit(marks, seed, said):
    with pytest.raises(s2sad.S2sadError) as caught:
        autodiff(Reverse, kernels.norm, *marks, seed=seed)
    assert f"{caught.value.diagnostics[0].code}: {one_line(caught.value)}" == said


def of_a_structure(p, u):
    return p["k"] * u[0]


def test_a_structure_has_one_direction():
    with pytest.raises(s2sad.S2sadError) as caught:
        autodiff(Reverse, of_a_structure, Const({"k": 1.0}), BatchDuplicated(U, (DU + 1,)))
    assert one_line(caught.value) == (
        "'of_a_structure' takes or returns a structure, and an argument is BatchDuplicated: call once for each "
        "direction with Duplicated(x, shadow)")


def test_what_the_function_raises_leaves_all_as_it_was():
    f = s2sad.differentiate(kernels.guarded, engine="numpy")
    u, shadows = np.array([1.0, 5.0]), (np.ones(2), np.full(2, 2.0))
    with pytest.raises(AssertionError):
        autodiff(Reverse, f, BatchDuplicated(u, shadows), Const(4.0))
    assert u.tolist() == [1.0, 5.0] and [s.tolist() for s in shadows] == [[1.0, 1.0], [2.0, 2.0]]
