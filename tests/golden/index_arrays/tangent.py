"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], in-out
    x: float64[:], in
    source: int64[:], in
    target: int64[:], in
"""


def kernel_tangent(y, y_dot, x, x_dot, source, target):
    for e in range(source.size):
        flow = x[source[e]] * x[target[e]]
        flow_dot = x[target[e]] * x_dot[source[e]] + x[source[e]] * x_dot[target[e]]
        y_dot[source[e]] -= flow_dot
        y[source[e]] -= flow
        y_dot[target[e]] += flow_dot
        y[target[e]] += flow
