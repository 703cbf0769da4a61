"""Complex numbers: derivatives with the inner product Re(conj(a) b), and the refusal of what is not known to hold."""
import numpy as np
import pytest

from tests import complex_kernels as kernels
from tests.bulk import interpreted
from tests.derivatives import check_derivatives

RNG = np.random.default_rng(7)
Z, W = (RNG.normal(size=4) + 1j * RNG.normal(size=4) for _ in range(2))
X = RNG.uniform(0.5, 1.5, 4)
M = RNG.normal(size=(4, 4)) + 1j * RNG.normal(size=(4, 4))
CASES = [
    (kernels.arithmetic, (np.zeros(4, complex), Z, W, X, 0.3 - 0.2j), ("z", "w", "x", "s"), ("out", "return")),
    (kernels.functions, (Z, X), ("z", "x"), ("return",)),
    (kernels.elements, (Z, 0.1 + 0.2j, X), ("z", "c", "x"), ("z", "return")),
    (kernels.transfer, (X, 2.0, 0.3, 0.1), ("w", "k", "m", "c"), ("return",)),
    (kernels.products, (M, Z, W, X), ("m", "z", "w", "x"), ("return",)),
    (kernels.views, (Z, 3), ("z",), ("z", "return")),
    (kernels.mixed, (Z, X), ("z", "x"), ("x", "return")),
    (kernels.called, (Z, X), ("z", "x"), ("return",)),
    (kernels.schroedinger, (Z, X, X[::-1].copy(), 0.1, 0.5, 3), ("psi", "v", "w", "dt"), ("psi", "return")),
    (kernels.arranged, (Z, W, M, X), ("z", "w", "m", "x"), ("w", "return")),
    (kernels.helmholtz, (Z, X, 0.7), ("f", "c", "omega"), ("return",)),
]


pytestmark = pytest.mark.filterwarnings("error:Casting complex values")


@pytest.mark.parametrize("case", CASES, ids=lambda c: c[0].__name__)
@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_derivatives(case, engine):
    if engine == "numpy":
        check_derivatives(*case)
    else:       # the text for Numba, run by Python
        with interpreted():
            check_derivatives(*case, engine="numba")


@pytest.mark.parametrize("case", [c for c in CASES if c[0] in (kernels.elements, kernels.mixed, kernels.helmholtz)],
                         ids=lambda c: c[0].__name__)
def test_compiled(case):
    pytest.importorskip("numba")
    check_derivatives(*case, engine="numba")
