"""The few functions that generated code may call.

They need NumPy only, Numba compiles each as it stands, and with `--standalone` their text is written
into the generated file: no line of it is over 100 columns.
"""
from __future__ import annotations

from s2sad.runtime.factors import (
    factor_panel, factored, factors_gain, of_matrix, solved, solved_transposed, take_row, to_matrix, update_rest,
)
from s2sad.runtime.matrices import (
    apart, cholesky_change, cholesky_gain, cofactors, det_sign, eigenvalues_change, eigenvalues_gain, eigenvectors,
    eigenvectors_change, eigenvectors_gain, from_lower, half_lower, least_squares, least_squares_change, log_det,
    power_change, singular_values, singular_values_change, singular_values_gain, to_lower,
)
from s2sad.runtime.scalars import comb, factorial, heaviside, isclose, isqrt, lcm, perm, product, remainder
from s2sad.runtime.spans import position, position_down
from s2sad.runtime.special import digamma
from s2sad.runtime.spread import extreme_mask, scattered, spread
from s2sad.runtime.stacks import grow, sized
from s2sad.runtime.sums import added, blocked_sum, pairwise_sum
from s2sad.runtime.systems import cg, dense, gmres, solved_by

__all__ = [
    "added", "apart", "blocked_sum", "cg", "cholesky_change", "cholesky_gain", "cofactors", "comb", "dense",
    "det_sign", "digamma", "eigenvalues_change", "eigenvalues_gain", "eigenvectors", "eigenvectors_change",
    "eigenvectors_gain", "extreme_mask", "factor_panel", "factored", "factorial", "factors_gain", "from_lower",
    "gmres", "grow", "half_lower", "heaviside", "isclose", "isqrt", "lcm", "least_squares", "least_squares_change",
    "log_det", "of_matrix", "pairwise_sum", "perm", "position", "position_down", "power_change", "product",
    "remainder", "scattered", "singular_values", "singular_values_change", "singular_values_gain", "sized", "solved",
    "solved_by", "solved_transposed", "spread", "take_row", "to_lower", "to_matrix", "update_rest",
]
