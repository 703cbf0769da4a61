"""The rules of sparse matrices: their entries, with the row and the column of each, `m` rows and `n` columns.

`evaluate/specialize/sparse` writes what a kernel does with `scipy.sparse` in these.
"""
from __future__ import annotations

from s2sad.rules.array import arrays

arrays("runtime.sparse_product(data, rows, columns, x, m, n)", law="sparse product",
       data="runtime.sparse_gain(g, x, rows, columns)", x="runtime.sparse_product(data, columns, rows, g, n, m)")
arrays("runtime.sparse_left_product(x, data, rows, columns, m, n)", law="sparse left product",
       x="runtime.sparse_left_product(g, data, columns, rows, n, m)",
       data={(1, 1, 1, 1, 0, 0): "runtime.sparse_gain(x, g, rows, columns)",
             None: "runtime.sparse_gain(x.T, g.T, rows, columns)"})
arrays("runtime.sparse_solve(data, rows, columns, b, m, n, kept)", law="sparse solve",
       shared={"s": "runtime.sparse_solve(data, columns, rows, g, n, m, kept)"}, b="s",
       data="-runtime.sparse_gain(s, y, rows, columns)",
       tangent="runtime.sparse_solve(data, rows, columns, "
               "b_dot - runtime.sparse_product(data_dot, rows, columns, y, m, n), m, n, kept)")
arrays("runtime.sparse_dense(data, rows, columns, m, n)", law="sparse dense",
       data="runtime.sparse_entries(g, rows, columns)")
arrays("runtime.sparse_diagonal(data, rows, columns, m, n, size)", law="sparse diagonal",
       data="runtime.sparse_diagonal_gain(g, rows, columns, m, n)")

# parts of derivatives
arrays("runtime.sparse_gain(left, right, rows, columns)", law="sparse entries")
arrays("runtime.sparse_entries(full, rows, columns)", law="sparse entries")
arrays("runtime.sparse_diagonal_gain(g, rows, columns, m, n)", law="sparse diagonal entries")

# places
arrays("runtime.sparse_rows(ends, columns)", law="sparse rows")
arrays("runtime.sparse_span(start, size)", law="sparse span")
arrays("runtime.sparse_joined(first, second)", law="sparse joined")
