"""The rules of linear algebra (M. Giles, Collected matrix derivative results for forward and reverse mode AD, 2008)."""
from __future__ import annotations

from s2sad.rules.array import arrays

arrays("numpy.matmul(a, b)", law="matmul", also=("numpy.dot",),
       a={(2, 2): "g @ b.T", (2, 1): "numpy.outer(g, b)", (1, 2): "b @ g", (1, 1): "g * b"},
       b={(2, 2): "a.T @ g", (2, 1): "a.T @ g", (1, 2): "numpy.outer(a, g)", (1, 1): "g * a"})
arrays("numpy.outer(a, b)", law="outer", a="g @ b", b="g.T @ a")
arrays("numpy.linalg.solve(a, b)", law="solved", shared={"s": "numpy.linalg.solve(a.T, g)"}, b="s",
       a={(2, 1): "-numpy.outer(s, y)", (2, 2): "-(s @ y.T)"}, tangent="numpy.linalg.solve(a, b_dot - a_dot @ y)")
