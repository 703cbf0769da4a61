"""The few functions that generated code may call.

They need NumPy only, Numba compiles each as it stands, and with `--standalone` their text is written
into the generated file: no line of it is over 100 columns. Solving with a sparse matrix is for SciPy, which
compiled code calls through Python (`run/through_python.py`).
"""
from __future__ import annotations

from s2sad.runtime.arena import allocate, allocate_zeros
from s2sad.runtime.checkpoints import crowded, extend, mapped, on_disk, revolve, runs_again, thin
from s2sad.runtime.decompositions import (
    both_parts_gain, exponential, exponential_change, left_vectors, left_vectors_change, left_vectors_gain,
    orthogonal_part, orthogonal_part_change, orthogonal_part_gain, over_squares, right_vectors,
    right_vectors_change, right_vectors_gain, triangular_part, triangular_part_change, triangular_part_gain,
)
from s2sad.runtime.directions import lanes
from s2sad.runtime.exponentials import (
    cosh, exp, exp_less_one, expm1, exponent, less_one, scaled, sech_squared, sinh, tanh,
)
from s2sad.runtime.factors import (
    factor_panel, factored, factors_gain, of_matrix, solved, solved_transposed, take_row, to_matrix, update_rest,
)
from s2sad.runtime.matrices import (
    apart, cholesky_change, cholesky_gain, cofactors, det_sign, eigenvalues_change, eigenvalues_gain, eigenvectors,
    eigenvectors_change, eigenvectors_gain, from_lower, half_lower, least_squares, least_squares_change, log_det,
    power_change, singular_values, singular_values_change, singular_values_gain, to_lower,
)
from s2sad.runtime.places import places, sought
from s2sad.runtime.scalars import (
    comb, factorial, heaviside, isclose, isqrt, lcm, perm, product, remainder, whole_power, whole_product,
)
from s2sad.runtime.spans import element, position, position_down
from s2sad.runtime.sparse_matrices import (
    sparse_dense, sparse_diagonal, sparse_diagonal_gain, sparse_entries, sparse_factors,
    sparse_fits, sparse_gain, sparse_gain_in_loops, sparse_joined, sparse_left_product,
    sparse_left_product_in_loops, sparse_product, sparse_product_in_loops,
    sparse_rows, sparse_solve, sparse_span,
)
from s2sad.runtime.special import digamma, entr, expit, gammaln, kl_div, logit, rel_entr, xlog1py, xlogy
from s2sad.runtime.spread import extreme_mask, extreme_place, scattered, spread, strong_zero
from s2sad.runtime.stacked_products import flat_stack, stacked_matmul, stacked_transpose
from s2sad.runtime.stacks import grow, sized
from s2sad.runtime.sums import added, blocked_sum, pairwise_sum
from s2sad.runtime.systems import cg, dense, gmres, solved_by
from s2sad.runtime.transforms import (
    ends, fft, fft_adjoint, fitted, ifft, ifft_adjoint, irfft, irfft_adjoint, opposite, rfft, rfft_adjoint,
)
from s2sad.runtime.triangles import (
    bands_gain, bands_times, bands_transposed, solve_banded, solve_triangular, triangle, triangle_gain,
    triangle_times,
)

__all__ = [
    "added", "allocate", "allocate_zeros", "apart", "bands_gain", "bands_times", "bands_transposed",
    "blocked_sum", "both_parts_gain", "cg", "cholesky_change", "cholesky_gain", "cofactors", "comb", "cosh",
    "crowded", "dense", "det_sign", "digamma", "eigenvalues_change", "eigenvalues_gain", "eigenvectors",
    "eigenvectors_change", "eigenvectors_gain", "element", "ends", "entr", "exp", "exp_less_one", "expit",
    "expm1", "exponent", "exponential", "exponential_change", "extend", "extreme_mask", "extreme_place",
    "factor_panel", "factored", "factorial", "factors_gain", "fft", "fft_adjoint", "fitted", "flat_stack",
    "from_lower", "gammaln", "gmres", "grow", "half_lower", "heaviside", "ifft", "ifft_adjoint", "irfft",
    "irfft_adjoint", "isclose", "isqrt", "kl_div", "lanes", "lcm", "least_squares", "least_squares_change",
    "left_vectors", "left_vectors_change", "left_vectors_gain", "less_one", "log_det", "logit", "mapped", "of_matrix",
    "on_disk", "opposite", "orthogonal_part", "orthogonal_part_change", "orthogonal_part_gain",
    "over_squares", "pairwise_sum", "perm", "places", "position", "position_down", "power_change", "product",
    "rel_entr", "remainder", "revolve", "rfft", "rfft_adjoint", "right_vectors", "right_vectors_change",
    "right_vectors_gain", "runs_again", "scaled", "scattered", "sech_squared", "singular_values",
    "singular_values_change", "singular_values_gain", "sinh", "sized", "solve_banded", "solve_triangular",
    "solved", "solved_by", "solved_transposed", "sought", "sparse_dense", "sparse_diagonal",
    "sparse_diagonal_gain", "sparse_entries", "sparse_factors", "sparse_fits", "sparse_gain",
    "sparse_gain_in_loops", "sparse_joined", "sparse_left_product", "sparse_left_product_in_loops",
    "sparse_product", "sparse_product_in_loops", "sparse_rows", "sparse_solve", "sparse_span", "spread",
    "stacked_matmul", "stacked_transpose", "strong_zero", "take_row", "tanh", "thin", "to_lower", "to_matrix",
    "triangle", "triangle_gain", "triangle_times", "triangular_part", "triangular_part_change",
    "triangular_part_gain", "update_rest", "whole_power", "whole_product", "xlog1py", "xlogy",
]
