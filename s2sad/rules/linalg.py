"""The rules of linear algebra (M. Giles, Collected matrix derivative results for forward and reverse mode AD, 2008)."""
from __future__ import annotations

from s2sad.rules.array import arrays

for _product, _law in (("matmul", "matmul"), ("dot", "dot")):       # of up to two axes they are the same
    arrays(f"numpy.{_product}(a, b)", law=_law,
           a={(2, 2): "g @ b.T", (2, 1): "numpy.outer(g, b)", (1, 2): "b @ g", (1, 1): "g * b"},
           b={(2, 2): "a.T @ g", (2, 1): "a.T @ g", (1, 2): "numpy.outer(a, g)", (1, 1): "g * a"},
           also=("numpy.einsum.matmul",) if _product == "matmul" else ())     # which repeats an axis of length 1
arrays("numpy.outer(a, b)", law="outer", a="g @ b", b="g.T @ a")
arrays("numpy.linalg.solve(a, b)", law="solution", shared={"s": "numpy.linalg.solve(a.T, g)"}, b="s",
       a={(2, 1): "-numpy.outer(s, y)", (2, 2): "-(s @ y.T)"}, tangent="numpy.linalg.solve(a, b_dot - a_dot @ y)")

# of more than two axes they become these (normalize/library/expansions/stacked_products), or sums of products
arrays("numpy.tensordot(a, b, axes=2)", law="tensor", also=("numpy.einsum.tensordot",))
arrays("runtime.stacked_matmul(a, b)", law="stacked", a="runtime.stacked_matmul(g, runtime.stacked_transpose(b))",
       b="runtime.stacked_matmul(runtime.stacked_transpose(a), g)")
arrays("runtime.stacked_transpose(a)", law="stacked transpose", a="runtime.stacked_transpose(g)")

arrays("numpy.linalg.inv(a)", law="matrix", a="-(y.T @ g @ y.T)", tangent="-(y @ a_dot @ y)")
arrays("numpy.linalg.det(a)", law="determinant", a="g * runtime.cofactors(a)",
       tangent="numpy.sum(runtime.cofactors(a) * a_dot)")
arrays("runtime.log_det(a)", law="determinant", a="g * numpy.linalg.inv(a).T",
       tangent="numpy.sum(numpy.linalg.inv(a).T * a_dot)")
arrays("runtime.det_sign(a)", law="determinant")
arrays("numpy.linalg.cholesky(a)", law="matrix", a="runtime.cholesky_gain(y, g)",
       tangent="runtime.cholesky_change(y, a_dot)")
arrays("numpy.linalg.eigvalsh(a)", law="eigenvalues", a="runtime.eigenvalues_gain(a, g)",
       tangent="runtime.eigenvalues_change(a, a_dot)")
arrays("runtime.eigenvectors(a)", law="matrix", a="runtime.eigenvectors_gain(a, y, g)",
       tangent="runtime.eigenvectors_change(a, y, a_dot)")
arrays("runtime.singular_values(a)", law="singular", a="runtime.singular_values_gain(a, g)",
       tangent="runtime.singular_values_change(a, a_dot)")
arrays("numpy.linalg.matrix_power(a, n)", law="matrix", a="runtime.power_change(a.T, n, g)",
       tangent="runtime.power_change(a, n, a_dot)")
# G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10, 1973: the rank does not change near by
arrays("numpy.linalg.pinv(a)", law="inverted", shared={"t": "g.T @ y", "s": "y @ g.T"},
       a="(g.T - a @ s) @ (y @ y.T) + (y.T @ y) @ (g.T - t @ a) - y.T @ g @ y.T",
       tangent="(y @ y.T) @ (a_dot.T - (a_dot.T @ a) @ y) + (a_dot.T - y @ (a @ a_dot.T)) @ (y.T @ y) - y @ a_dot @ y")
arrays("runtime.least_squares(a, b)", law="least", shared={"p": "numpy.linalg.pinv(a)", "s": "p.T @ g"}, b="s",
       a={(2, 1): "numpy.outer(b - a @ y, p @ s) + numpy.outer(p.T @ y, g - a.T @ s) - numpy.outer(s, y)",
          (2, 2): "(b - a @ y) @ (p @ s).T + (p.T @ y) @ (g - a.T @ s).T - s @ y.T"},
       tangent="runtime.least_squares_change(a, b, y, a_dot, b_dot)")

# triangles and bands (as scipy.linalg has them)
arrays("runtime.solve_triangular(a, b, trans=0, lower=False, unit=False)", law="solved",
       shared={"s": "runtime.solve_triangular(a, g, trans=1 - trans, lower=lower, unit=unit)"}, b="s",
       a="runtime.triangle_gain(s, y, trans, lower, unit)",
       tangent="runtime.solve_triangular(a, b_dot - runtime.triangle_times(a_dot, y, trans, lower, unit), trans=trans, "
               "lower=lower, unit=unit)")
arrays("runtime.triangle_gain(s, y, trans, lower, unit)", law="square")
arrays("runtime.triangle_times(a, y, trans, lower, unit)", law="solved")
arrays("runtime.solve_banded(a, b, lower, upper)", law="solved",
       shared={"s": "runtime.solve_banded(runtime.bands_transposed(a, lower, upper), g, upper, lower)"}, b="s",
       a="runtime.bands_gain(a, s, y, lower, upper)",
       tangent="runtime.solve_banded(a, b_dot - runtime.bands_times(a_dot, y, lower, upper), lower, upper)")
arrays("runtime.bands_transposed(a, lower, upper)", law="matrix")
arrays("runtime.bands_gain(a, s, y, lower, upper)", law="matrix")
arrays("runtime.bands_times(a, y, lower, upper)", law="solved")

# parts of decompositions
for _part, _law in (("orthogonal_part", "orthogonal"), ("triangular_part", "triangular"),
                    ("left_vectors", "orthogonal"), ("right_vectors", "triangular")):
    arrays(f"runtime.{_part}(a)", law=_law, a=f"runtime.{_part}_gain(a, g)",
           tangent=f"runtime.{_part}_change(a, a_dot)")
    arrays(f"runtime.{_part}_gain(a, g)", law="matrix")
    arrays(f"runtime.{_part}_change(a, e)", law=_law)
arrays("runtime.exponential(a)", law="matrix", a="runtime.exponential_change(a.T, g)",
       tangent="runtime.exponential_change(a, a_dot)")
arrays("runtime.exponential_change(a, e)", law="matrix")

# parts of derivatives
for _text in ("cofactors(a)", "cholesky_gain(y, g)", "cholesky_change(y, e)", "eigenvalues_gain(a, g)",
              "eigenvectors_gain(a, y, g)", "eigenvectors_change(a, y, e)", "singular_values_gain(a, g)",
              "power_change(a, n, e)"):
    arrays(f"runtime.{_text}", law="matrix")
arrays("runtime.least_squares_change(a, b, y, e, f)", law="least")
arrays("runtime.eigenvalues_change(a, e)", law="eigenvalues")
arrays("runtime.singular_values_change(a, e)", law="singular")

# a matrix factored once; the shadow of its factors is the matrix's own
arrays("runtime.factored(a)", law="factored", a="runtime.to_matrix(g)", tangent="runtime.of_matrix(a_dot)")
arrays("runtime.solved(f, b)", law="solved", shared={"s": "runtime.solved_transposed(f, g)"}, b="s",
       f="runtime.factors_gain(s, y)", tangent="runtime.solved(f, b_dot - runtime.to_matrix(f_dot) @ y)")
arrays("runtime.solved_transposed(f, b)", law="solved", shared={"s": "runtime.solved(f, g)"}, b="s",
       f="runtime.factors_gain(y, s)", tangent="runtime.solved_transposed(f, b_dot - runtime.to_matrix(f_dot).T @ y)")
arrays("runtime.factors_gain(s, y)", law="gained")
arrays("runtime.of_matrix(a)", law="factored")
arrays("runtime.to_matrix(g)", law="unfactored")
