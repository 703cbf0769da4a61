"""What an argument is, is looked at in every call: arrays of every class, numbers, and what is neither."""
from __future__ import annotations

import gc
import numbers
from decimal import Decimal
from enum import IntEnum
from fractions import Fraction

import numpy as np
import pytest

import s2sad
from s2sad import Active, Const, Duplicated
from tests.dispatch.kernels import scaled


def _reverse(f, v, u, k, n):
    return s2sad.autodiff(s2sad.Reverse, f, Duplicated(v, np.zeros(v.shape)), Duplicated(u, np.zeros(u.shape)),
                          Active(k), Const(n))


DOORS = {
    "gradient": lambda f, *a: s2sad.gradient(f, "u")(*a),
    "value_and_gradient": lambda f, *a: s2sad.value_and_gradient(f, ("u", "k"))(*a),
    "vjp": lambda f, *a: s2sad.vjp(f, a, {"return": 1.0}, "u"),
    "jvp": lambda f, *a: s2sad.jvp(f, a, {"k": 1.0}),
    "adjoint": lambda f, v, u, k, n: f.adjoint(v, np.zeros(3), u, np.zeros(3), k, n, 1.0),
    "tangent": lambda f, v, u, k, n: f.tangent(v, np.zeros(3), u, np.zeros(3), k, 1.0, n),
    "autodiff": _reverse,
    "primal": lambda f, *a: f.primal(*a),
}


class Tensor:
    __slots__ = ()

    def __array__(self, dtype=None, copy=None):
        return np.ones(3)


class Own(np.ndarray):
    pass


def memory_map(values, folder, mode="r+"):
    path = folder / "values"
    path.write_bytes(values.tobytes())
    return np.memmap(path, dtype=values.dtype, mode=mode, shape=values.shape)


DTYPES = "use float64, float32, complex128, an integer type or bool"
ANY = "give an array, a float, an int, a bool, a str or None"
ARRAYS = [
    (lambda t: memory_map(np.ones(3, ">f8"), t), "has the other byte order", 'pass u.astype("float64")'),
    (lambda t: memory_map(np.ones(3, "c8"), t), "has dtype complex64", DTYPES),
    (lambda t: memory_map(np.ones(3, "f2"), t), "has dtype float16", DTYPES),
    (lambda t: np.ones(3, ">f8"), "has the other byte order", 'pass u.astype("float64")'),
    (lambda t: np.ones(3, ">i8"), "has the other byte order", 'pass u.astype("int64")'),
    (lambda t: np.array(1.0), "is an array of rank 0", "pass the number, u[()], or an array of shape (1,)"),
    (lambda t: np.ones(3, object), "has dtype object", DTYPES),
    (lambda t: np.ones(3, "m8[s]"), "has dtype timedelta64[s]", DTYPES),
    (lambda t: np.array(["a"] * 3), "has dtype <U1", DTYPES),
    (lambda t: np.ones(3, np.longdouble), f"has dtype {np.dtype(np.longdouble)}", DTYPES),
    (lambda t: np.zeros(3, [("a", "f8")]), "has dtype [('a', '<f8')]", DTYPES),
    (lambda t: np.ma.ones(3), "is a MaskedArray", "pass u.filled(...): what is masked would be read"),
    (lambda t: np.matrix([1.0, 2.0, 3.0]), "is a matrix", "pass numpy.asarray(u)"),
    (lambda t: np.rec.array(np.zeros(3, [("a", "f8")])), "is a recarray", "pass numpy.asarray(u)"),
    (lambda t: np.ones(3).view(Own), "is an Own", "pass numpy.asarray(u)"),
    (lambda t: Tensor(), "is a Tensor", "pass numpy.asarray(u)"),
    (lambda t: Decimal(1), "is a Decimal", "pass float(u)"),
    (lambda t: b"abc", "is a bytes", ANY), (lambda t: object(), "is an object", ANY),
    (lambda t: {1, 2}, "is a set", ANY), (lambda t: range(3), "is a range", ANY),
    (lambda t: np.datetime64("2000-01-01"), "is a datetime64", ANY),
]


def refused(code, message, help, call, *args):
    with pytest.raises(s2sad.S2sadError) as caught:
        call(*args)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message, found.help) == (code, message, help)


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
@pytest.mark.parametrize("door", sorted(DOORS))
def test_arrays_are_looked_at_in_later_calls(f, door, tmp_path):
    call, good = DOORS[door], (np.zeros(3), np.ones(3), 2.0, 3)
    for later in (False, True):
        for made, what, help in ARRAYS:
            u = made(tmp_path)
            if door == "autodiff" and not isinstance(u, np.ndarray):
                continue        # its shadow cannot be made
            with pytest.raises(s2sad.S2sadError) as caught:
                call(f, np.zeros(3), u, 2.0, 3)
            texts = [(d.message, d.help) for d in caught.value.diagnostics]
            if door != "autodiff" or u.dtype.name in ("float64", "complex128") and u.dtype.isnative:
                assert texts == [(f"the argument 'u' {what}", help)], later
        call(f, *good)
        call(f, np.zeros(3), memory_map(np.ones(3), tmp_path), 2.0, 3)
        call(f, np.zeros(3), memory_map(np.ones(3), tmp_path, "r"), 2.0, 3)
        call(f, memory_map(np.zeros(3), tmp_path), np.ones(3), 2.0, 3)


@pytest.mark.parametrize("door", sorted(DOORS))
def test_numbers_are_looked_at_in_later_calls(f, door):
    call = DOORS[door]
    args = np.zeros(3), np.ones(3)
    wide = "which does not fit 64 bits"
    said = [
        (2 ** 70, f"is {2 ** 70}, {wide}", "give a float"),
        (np.uint64(2 ** 63), f"is {2 ** 63}, {wide}", "give a float"),
        (-2 ** 63 - 1, f"is {-2 ** 63 - 1}, {wide}", "give a float"), (Decimal(3), "is a Decimal", "pass float(n)"),
        (Fraction(3), "is a Fraction", "pass float(n)"), (np.float16(3), "is a number of type float16", "give a float"),
        (np.complex64(3), "is a number of type complex64", "give a complex number"),
        (None, "is None, and a bound of range is an integer", "give an int"),
        ("3", "is a str, and a bound of range is an integer", "give an int"),
        (3.0, "is a float, and a bound of range is an integer", "give an int, or write int(n)"),
        (np.float32(3), "is a float, and a bound of range is an integer", "give an int, or write int(n)")]
    for _ in range(2):
        for n, what, help in said:
            refused("S405", f"the argument 'n' {what}", help, call, f, *args, 2.0, n)
        for n in (3, np.int64(3), np.uint8(3), np.int32(2), True, np.bool_(True)):
            call(f, *args, 2.0, n)


def test_an_integer_that_is_a_float_may_be_no_wider(f):
    g = s2sad.gradient(f, "u")
    g(np.zeros(3), np.ones(3), 2, 3)
    refused("S405", f"the argument 'k' is {2 ** 64}, which does not fit 64 bits", "give a float",
            g, np.zeros(3), np.ones(3), 2 ** 64, 3)


def test_lists_are_no_numbers_and_no_arrays(f):
    for _ in range(2):
        with pytest.raises(s2sad.S2sadError, match="a list or tuple, where a bound of range is an integer"):
            s2sad.gradient(f, "u")(np.zeros(3), np.ones(3), 2.0, [3])
        s2sad.gradient(f, "u")(np.zeros(3), np.ones(3), 2.0, 3)


def strided(*strides, shape=(3,)):
    return np.lib.stride_tricks.as_strided(np.zeros(16), shape, strides)


@pytest.mark.parametrize("door", sorted(DOORS))
@pytest.mark.parametrize("made", [
    lambda: strided(0), lambda: strided(4), lambda: strided(4, 20, shape=(3, 2))[:, 1]])
def test_an_argument_that_is_written_and_overlaps_itself(f, door, made):
    call = DOORS[door]
    for _ in range(2):
        refused("S404", "the argument 'v' overlaps itself, and it is written", "pass a copy of it",
                call, f, made(), np.ones(3), 2.0, 3)
        call(f, np.zeros((3, 2))[:, 0], made(), 2.0, 3)
        for _ in range(20):     # the check may be compiled by now
            call(f, np.zeros(3), np.ones(3), 2.0, 3)


def test_shadows_that_overlap_themselves(f):
    def call(shadow):
        return f.adjoint(np.zeros(3), np.zeros(3), np.ones(3), shadow, 2.0, 3, 1.0)

    def annotated(shadow):
        return s2sad.autodiff(s2sad.Reverse, f, Duplicated(np.zeros(3), np.zeros(3)), Duplicated(np.ones(3), shadow),
                              Active(2.0), 3)
    for door in (call, annotated):
        for _ in range(20):
            for made in (strided(0), strided(4), strided(7)):
                refused("S403", "the shadow 'u_bar' overlaps itself", "make one with s2sad.make_zero(u)", door, made)
            door(np.zeros(6)[::2])


def whole(v, u):
    v[...] = 2.0 * u


@pytest.mark.parametrize("strides, shape, overlaps", [
    ((8, 8), (3, 3), True), ((16, 8), (3, 3), True), ((24, 8), (3, 3), False), ((16, 24), (2, 3), False),
    ((16, 24), (4, 3), True), ((-8, 24), (3, 3), False), ((12, 8), (2, 2), True), ((0, 8), (1, 3), False),
    ((0, 8), (2, 3), True), ((8, 0), (3, 0), False), ((8, 40, 16), (2, 2, 2), False), ((8, 16, 24), (2, 2, 2), True),
])
def test_which_arrays_overlap_themselves(strides, shape, overlaps):
    f = s2sad.differentiate(whole, engine="numpy")
    memory = np.zeros(64)
    v = np.lib.stride_tricks.as_strided(memory[20:], shape, strides)
    offsets = np.add.outer(np.add.outer(*([np.arange(n) * s for n, s in zip(shape, strides)][:2])),
                           np.arange(shape[2]) * strides[2] if len(shape) > 2 else 0).ravel()
    assert bool(np.any(np.diff(np.sort(offsets)) < 8)) == overlaps
    call = f.adjoint, v, np.zeros(shape), np.ones(shape), np.zeros(shape)
    if overlaps:
        refused("S404", "the argument 'v' overlaps itself, and it is written", "pass a copy of it", *call)
        refused("S403", "the shadow 'v_bar' overlaps itself", "make one with s2sad.make_zero(v)",
                f.adjoint, np.zeros(shape), v, np.ones(shape), np.zeros(shape))
    else:
        f.adjoint(*call[1:])


def test_seeds_and_shadows_of_other_classes(f):
    arguments = np.zeros(3), np.ones(3), 2.0, 3
    refused("S403", "the seed of 'v' is a MaskedArray", "give an array of float64 of shape (3,)",
            lambda: s2sad.vjp(f, arguments, {"v": np.ma.ones(3)}))
    refused("S403", "the seed of 'u' is an Own", "give an array of float64 of shape (3,)",
            lambda: s2sad.jvp(f, arguments, {"u": np.ones(3).view(Own)}))
    for _ in range(2):
        refused("S403", "the shadow 'u_bar' is a MaskedArray", "make one with s2sad.make_zero(u)",
                f.adjoint, np.zeros(3), np.zeros(3), np.ones(3), np.ma.zeros(3), 2.0, 3, 1.0)
        f.adjoint(np.zeros(3), np.zeros(3), np.ones(3), np.zeros(3), 2.0, 3, 1.0)


def test_memory_maps_as_shadows(f, tmp_path):
    for _ in range(3):
        shadow = memory_map(np.zeros(3), tmp_path)
        f.adjoint(np.zeros(3), np.zeros(3), np.ones(3), shadow, 2.0, 3, 1.0)
        assert shadow.tolist() == [4.0] * 3
        s2sad.autodiff(s2sad.Reverse, f, Duplicated(np.zeros(3), np.zeros(3)), Duplicated(np.ones(3), shadow),
                       Active(2.0), 3)
        assert shadow.tolist() == [8.0] * 3


@pytest.mark.usefixtures("own_garbage")
def test_refused_calls_leave_nothing():
    f = s2sad.differentiate(scaled, engine="numpy")
    g = s2sad.gradient(f, "u")
    arguments = [(np.zeros(3), u, k, n) for u, k, n in (
        (np.ones(3), 2.0, None), (np.ones(3), 2.0, "3"), (np.ones(3), 2.0, 2 ** 70), (np.ones(3), 2.0, 1.5),
        (np.ones(3, object), 2.0, 3), (np.ones((3, 1)), 2.0, 3), (None, 2.0, 3), (np.ones(3), 2.0, [3]))]

    def refuse():
        for a in arguments:
            with pytest.raises(s2sad.S2sadError):
                g(*a)
    refuse()
    gc.collect()
    before = len(gc.get_objects())
    for _ in range(3):
        refuse()
    gc.collect()
    assert len(gc.get_objects()) < before + 100


class Place(IntEnum):
    FIRST = 1


def told_apart(x, k):
    rows = [x, 2.0 * x]
    scale = 3.0 if isinstance(k, int) else 5.0 if isinstance(k, np.integer) else 1.0
    if isinstance(k, Place):
        return 7.0 * np.sum(rows[1])
    return scale * np.sum(rows[k]) * (2.0 if isinstance(k, numbers.Integral) else 1.0) * len(str(k))


@pytest.mark.parametrize("order", [1, -1])
def test_equal_values_of_other_types_are_other_arguments(order):
    f = s2sad.differentiate(told_apart, engine="numpy")
    for k, slope in [(1, 12.0), (True, 48.0), (np.int64(1), 20.0), (Place.FIRST, 14.0), (1, 12.0)][::order]:
        assert s2sad.gradient(f, "x")(np.ones(1), k) == [slope], repr(k)


def by_keys(x, scales):
    s = 0.0
    for k, v in scales.items():
        s += np.sum(x) * v * len(str(k))
    return s


def test_equal_keys_of_other_types_are_other_arguments():
    f = s2sad.differentiate(by_keys, engine="numpy")
    for k, slope in [(1, 2.0), (True, 8.0), (1, 2.0)]:
        assert s2sad.gradient(f, "x")(np.ones(1), {k: 2.0}) == [slope], repr(k)
