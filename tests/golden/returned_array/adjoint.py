"""Adjoint of kernel: d(return) / d(u, a).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in
    a: float64, in

It records nothing.
"""

import numpy as np


def kernel_adjoint(u, u_bar, a, result_0_bar, result_1_bar, result_2_bar):
    # forward sweep: only what the reverse sweep reads
    out = np.zeros_like(u)
    for i in range(1, u.size):
        out[i] = u[i] - u[i - 1]
    slope = np.empty_like(out)
    returned = np.empty(max(u.shape[0] - 1, 0))
    assert slope.shape == result_0_bar.shape, "result_0_bar does not have the shape of the result"
    assert returned.shape == result_1_bar.shape, (
        "result_1_bar does not have the shape of the result"
    )
    assert slope.shape == result_2_bar.shape, "result_2_bar does not have the shape of the result"
    # reverse sweep
    out_bar = np.zeros_like(out)
    slope_bar = np.zeros_like(slope)
    returned_bar = np.zeros_like(returned)
    # return slope, u[1:], slope
    slope_bar[...] += result_0_bar
    returned_bar[...] += result_1_bar
    slope_bar[...] += result_2_bar
    u_bar[1:] += returned_bar
    # slope = a * differences(u)
    a_bar = np.sum(out * slope_bar)
    out_bar[...] += a * slope_bar
    for i in range(u.size - 1, 0, -1):
        # out[i] = v[i] - v[i - 1]
        seed = out_bar[i]
        out_bar[i] = 0.0
        u_bar[i] += seed
        u_bar[i - 1] -= seed
    return (a_bar,)
