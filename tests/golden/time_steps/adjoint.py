"""Adjoint of kernel: d(u, return) / d(u, c).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    c: float64, in
    n: int64, in

It records:
    u_before in kernel_k_step_adjoint: u before `u += c * v`, 8 * u.size bytes
    u_snapshots in kernel_k_loop_adjoint: u before some steps of `for k in
        timesteps(range(n), snapshots=3):`, 8 * min(4, len(range(n))) * u.size
        bytes
"""

# ruff: noqa: PLR1716, PLR1730, RUF059, RUF100

import numpy as np

from s2sad.runtime import revolve  # isort: skip


def kernel_k_step(k, u, v, c, energy):
    for i in range(u.size):
        v[i] = np.sin(u[i]) + k
    u[...] += c * v
    energy += u[0] * u[1]
    return energy


def kernel_k_step_adjoint(k, u, u_bar, v, v_bar, c, c_bar, energy, energy_bar, result_bar):
    """Adjoint of kernel_k_step: d(u, v, return) / d(u, v, c, energy)."""
    # forward sweep: only what the reverse sweep reads
    for i in range(u.size):
        v[i] = np.sin(u[i]) + k
    u_before = np.copy(u)
    u[...] += c * v
    # reverse sweep
    # energy += u[0] * u[1]
    energy_bar_1 = result_bar
    energy_bar += energy_bar_1
    u_bar[1] += u[0] * energy_bar_1
    u_bar[0] += u[1] * energy_bar_1
    # u += c * v
    u[...] = u_before
    c_bar += np.sum(v * u_bar)
    v_bar[...] += c * u_bar
    for i in range(u.size - 1, -1, -1):
        # v[i] = np.sin(u[i]) + k
        seed = v_bar[i]
        v_bar[i] = 0.0
        u_bar[i] += np.cos(u[i]) * seed
    return c_bar, energy_bar


def kernel_k_loop_forward(n, u, v, c, energy):
    trips = len(range(n))
    held = np.empty(min(4, trips), np.int64)
    u_snapshots = np.empty((min(4, trips),) + u.shape)
    count = 0
    following = 0
    for k in range(n):
        if k == following or k == trips - 1:
            held[count] = k
            u_snapshots[count] = u
            count += 1
            following = revolve(k, trips, 3 - count)
        energy = kernel_k_step(k, u, v, c, energy)
    return energy, (held, count, trips, u_snapshots)


def kernel_k_loop_adjoint(n, u, u_bar, v, v_bar, c, c_bar, energy, energy_bar, kept):
    """Adjoint of kernel_k_loop: d(u, v, return) / d(u, v, c)."""
    held, count, trips, u_snapshots = kept
    u_again = np.empty_like(u)
    for k in range(trips - 1, -1, -1):
        # the state before this step, by the steps from the last one that is kept
        u_again[:] = u_snapshots[count - 1]
        following = revolve(held[count - 1], k + 1, 3 - count)
        for again in range(held[count - 1], k):
            if again == following:
                held[count] = again
                u_snapshots[count] = u_again
                count += 1
                following = revolve(again, k + 1, 3 - count)
            energy = kernel_k_step(again, u_again, v, c, energy)
        c_bar, energy_bar = kernel_k_step_adjoint(
            k, u_again, u_bar, v, v_bar, c, c_bar, energy, 0.0, energy_bar
        )
        if held[count - 1] == k:
            count -= 1
    return (c_bar,)


def kernel_adjoint(u, u_bar, c, n, result_bar):
    # forward sweep: only what the reverse sweep reads
    v = np.empty_like(u)
    energy = 0.0
    energy_1, kept = kernel_k_loop_forward(n, u, v, c, energy)
    # reverse sweep
    c_bar = 0.0
    v_bar = np.zeros_like(v)
    # return energy
    energy_1_bar = result_bar
    (c_bar,) = kernel_k_loop_adjoint(n, u, u_bar, v, v_bar, c, c_bar, energy, energy_1_bar, kept)
    return (c_bar,)
