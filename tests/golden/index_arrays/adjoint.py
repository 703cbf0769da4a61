"""Adjoint of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], in-out
    x: float64[:], in
    source: int64[:], in
    target: int64[:], in

It records nothing.
"""


def kernel_adjoint(y, y_bar, x, x_bar, source, target):
    # reverse sweep
    for e in range(source.size - 1, -1, -1):
        # y[target[e]] += flow
        flow_bar = y_bar[target[e]]
        # y[source[e]] -= flow
        flow_bar -= y_bar[source[e]]
        # flow = x[source[e]] * x[target[e]]
        x_bar[source[e]] += x[target[e]] * flow_bar
        x_bar[target[e]] += x[source[e]] * flow_bar
