"""Adjoint of kernel: d(return) / d(u, a).

Engine: Numba. Level: fast. Arguments:
    u: float64[:], in
    a: float64, in

It records nothing.
"""

# ruff: noqa: PLR1730, RUF100

import numpy as np

from s2sad.runtime import added, allocate, allocate_zeros  # isort: skip


def kernel_adjoint_taped(u, u_bar, a, result_0_bar, result_1_bar, result_2_bar, arena):
    """Adjoint of kernel: d(return 0, return 1, return 2) / d(u, a), in given memory."""
    # forward sweep: only what the reverse sweep reads
    out, top = allocate_zeros(arena, 0, u.shape)
    for i in range(1, u.size):
        out[i] = u[i] - u[i - 1]
    slope, top = allocate(arena, top, u.shape)
    returned, top = allocate(arena, top, (max(u.shape[0] - 1, 0),))
    assert slope.shape == result_0_bar.shape, "result_0_bar does not have the shape of the result"
    assert returned.shape == result_1_bar.shape, (
        "result_1_bar does not have the shape of the result"
    )
    assert slope.shape == result_2_bar.shape, "result_2_bar does not have the shape of the result"
    # reverse sweep
    a_bar = 0.0
    out_bar, top = allocate_zeros(arena, top, u.shape)
    returned_bar, top = allocate_zeros(arena, top, returned.shape)
    for i in range(returned_bar.shape[0]):
        returned_bar_here = 0.0
        # return slope, u[1:], slope
        returned_bar_here += result_1_bar[i]
        seed = returned_bar_here
        u_bar[i + 1] += seed
    for i in range(u.shape[0]):
        slope_bar_here = 0.0
        # return slope, u[1:], slope
        slope_bar_here += result_0_bar[i]
        slope_bar_here += result_2_bar[i]
        # slope = a * differences(u)
        seed = slope_bar_here
        a_bar = added(a_bar, out[i] * seed)
        out_bar[i] += a * seed
    if 1 < u.size:
        u_bar_held = u_bar[0]
        for i in range(1, u.size):
            u_bar_held_2 = u_bar[i]
            # out[i] = v[i] - v[i - 1]
            seed = out_bar[i]
            out_bar[i] = 0.0
            u_bar_held_2 += seed
            u_bar_held -= seed
            u_bar[i - 1] = u_bar_held
            u_bar_held = u_bar_held_2
        u_bar[u.size - 1] = u_bar_held
    return a_bar, top


def kernel_adjoint(u, u_bar, a, result_0_bar, result_1_bar, result_2_bar):
    returned = kernel_adjoint_taped(
        u, u_bar, a, result_0_bar, result_1_bar, result_2_bar, np.empty(0)
    )
    return (returned[0],)
