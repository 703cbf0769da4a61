"""Complex numbers: what is not known to hold is refused; seeds, tangents and structures."""
from __future__ import annotations

import importlib.util

import numpy as np
import pytest

import s2sad
from tests.corpus.dtypes import complex_numbers as kernels
from tests.corpus.dtypes.complex_numbers import X, Z

pytestmark = pytest.mark.filterwarnings("error:Casting complex values")


PARTS, OTHERS = "take np.abs(z), z.real or z.imag of it", (
    "write it with +, -, *, /, functions such as np.exp, np.abs, np.conj, or with z.real and z.imag")
COMPARED = "compare np.abs(z), z.real or z.imag"
LOST = "a complex value is stored in float64, where its imaginary part is lost"
REFUSED = [
    ("return np.max(z).real", "np.max(z)", "S301", "no derivative rule for numpy.max of complex values", PARTS),
    ("return np.sum(np.sort(z)).real", "np.sort(z)", "S301", "no derivative rule for numpy.sort of complex values",
     PARTS),
    ("return math.exp(z[1])", "math.exp(z[1])", "S301", "no derivative rule for math.exp of complex values", OTHERS),
    ("return np.sum(np.where(z, 1.0, 2.0))", "np.where(z, 1.0, 2.0)", "S301",
     "no derivative rule for numpy.where of complex values", OTHERS),
    ("return np.linalg.norm(z)", "np.linalg.norm(z)", "S301",
     "no derivative rule for numpy.linalg.norm of complex values", "write np.sqrt(np.sum(np.abs(z) ** 2))"),
    ("return np.sum(x ** z).real", "x ** z", "S301",
     "no derivative rule for a complex power of a number that may be negative", "write (a + 0j) ** b"),
    ("return (z[0] % 2).real", "z[0] % 2", "S201", "an operator that is not defined for complex values", PARTS),
    ("return x[0] if z[0] > 1 else 2.0", "z[0] > 1", "S201", "a comparison of complex values", COMPARED),
    ("return not z[0]", "not z[0]", "S201", "an operator that is not defined for complex values", PARTS),
    ("return x[0] if z[0] and True else 2.0", "z[0] and True", "S201", "a complex value as a condition", COMPARED),
    ("x[:] = z", "x[:] = z", "S201", LOST, "store its real part: .real"),
    ("x += z", "x += z", "S201", LOST, "store its real part: .real"),
    ("x[:2] = [z[0], 1.0]", "x[:2] = [z[0], 1.0]", "S201", LOST, "store its real part: .real"),
    ("return np.sum(z.astype(float))", "z.astype(float)", "S201",
     "a complex value becomes float64, where its imaginary part is lost", "write z.real"),
    ("return np.array([z[0], 1.0], dtype=float)[0]", "np.array([z[0], 1.0], dtype=float)", "S201",
     "a complex value becomes float64, where its imaginary part is lost", "write z.real"),
    ("z.real[:] = x", "z.real[:] = x", "S201", "a store into .real of an array",
     "store both parts: z[...] = a + 1j * b"),
    ("z.imag = x", "z.imag", "S201", "an assignment to the attribute .imag is not supported in a kernel",
     "store both parts: z[...] = a + 1j * b"),
    ("return np.sum(np.zeros(3, dtype=np.complex64) * x).real", "np.zeros(3, dtype=np.complex64)", "S201",
     "a value of complex64", "use complex128, and no float32 beside it"),
    ("return np.abs(np.fft.rfft(z))[0]", "np.fft.rfft(z)", "S301",
     "no derivative rule for numpy.fft.rfft of complex values", OTHERS),
]


@pytest.mark.parametrize(("statement", "marked", "code", "message", "help"), REFUSED, ids=[r[0] for r in REFUSED])
def test_refused(statement, marked, code, message, help, tmp_path):
    path = tmp_path / "kernel.py"
    path.write_text(f"import math\nimport numpy as np\n\n\ndef f(z, x):\n    {statement}\n")
    spec = importlib.util.spec_from_file_location("kernel", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.differentiate(module.f, engine="numpy").adjoint_source(Z, X)
    place, line, under, remedy = str(caught.value).splitlines()[:4]
    start = 4 + statement.index(marked)
    assert place.split(":", 1)[1] == f"6:{start + 1}: error[{code}]: {message}"
    assert under.split("| ", 1)[1] == " " * start + "^" * len(marked)
    assert (line.strip(), remedy) == (f"6 |     {statement}", f"  help: {help}")


def test_a_derivative_of_ones_own_is_for_floats():
    s2sad.rule(kernels.owned, adjoint=kernels.owned_adjoint)
    with pytest.raises(s2sad.S2sadError, match="has a derivative of its own, which is not for complex values"):
        s2sad.vjp(kernels.owned, (1.0 + 1j,), {"return": 1.0})


def test_seeds_and_tangents():
    product = s2sad.differentiate(kernels.helper, engine="numpy")
    z, seed, z_dot = 1.0 - 2j, 0.5 + 0.3j, -0.7 + 1.1j
    z_bar = s2sad.vjp(product, (z, 2.0), {"return": seed}, wrt="z")["z"]
    y_dot = s2sad.jvp(product, (z, 2.0), {"z": z_dot})["return"]
    assert (np.conj(seed) * y_dot).real == pytest.approx((np.conj(z_bar) * z_dot).real, rel=1e-14)
    assert isinstance(z_bar, complex)
    assert s2sad.autodiff(s2sad.Reverse, product, s2sad.Active(z), s2sad.Const(2.0), seed=seed) == (z_bar,)
    assert s2sad.autodiff(s2sad.Forward, product, s2sad.Duplicated(z, z_dot), s2sad.Const(2.0)) == y_dot
    with pytest.raises(s2sad.S2sadError, match="the function returns a complex number"):
        s2sad.autodiff(s2sad.Reverse, product, s2sad.Active(z), s2sad.Const(2.0))
    with pytest.raises(s2sad.S2sadError, match="a gradient needs a function that returns one float"):
        s2sad.gradient(product)(z, 2.0)
    zero = s2sad.make_zero((Z, 1j))
    assert zero[0].dtype == complex and zero[1] == 0


def test_check_takes_real_and_imaginary_parts():
    assert s2sad.check(s2sad.differentiate(kernels.elements, engine="numpy"), Z, 0.1 + 0.2j, X)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_division_by_zero_is_numpys(engine):
    if engine == "numba":
        pytest.importorskip("numba")
    found = s2sad.vjp(s2sad.differentiate(kernels.quotients, engine=engine), (Z[:1], np.zeros(1, complex), 0.0),
                      {"return": 1.0})
    assert all(np.isnan(np.abs(v)).all() for v in found.values())
    unused = s2sad.vjp(s2sad.differentiate(kernels.quotients, engine=engine), (Z[:1], np.zeros(1, complex), 0.0),
                       {"return": 0.0})
    assert all(np.all(np.equal(v, 0.0)) for v in unused.values())


def test_structures():
    oscillator = kernels.Oscillator(Z.copy(), 0.5 + 0.2j, 2.0)
    assert s2sad.check(s2sad.differentiate(kernels.driven, engine="numpy"), oscillator, 3)
