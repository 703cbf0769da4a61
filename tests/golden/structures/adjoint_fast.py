"""Adjoint of kernel: d(state_u, state_t) / d(state_u, state_t, p_k, layers_0_0, layers_1_1).

Engine: Numba. Level: fast. Arguments:
    state_u: float64[:], in-out
    state_t: float64[:], in-out
    p_k: float64, in
    layers_0_0: float64[:], in
    layers_0_1: float64, in
    layers_1_0: float64[:], in
    layers_1_1: float64, in

It records:
    state_u_stack in change_reverse: state_u before `state.u[i] += dt * p["k"] *
        state.u[i]`, 8 * state_u.size bytes
    state_u_stack in change_reverse_2: state_u before `state.u[i] += dt * p["k"] *
        state.u[i]`, 8 * state_u.size bytes
"""

import numpy as np

from s2sad.runtime import added  # isort: skip


def change_augmented(state_u, p_k, dt):
    """Forward sweep of change, which returns its tape."""
    # forward sweep
    state_u_stack = np.empty(state_u.size)
    for i in range(state_u.size):
        state_u_stack[i] = state_u[i]
        state_u[i] += dt * p_k * state_u[i]
    return (state_u_stack,)


def change_reverse(state_u, state_u_bar, p_k, dt, kept):
    """Adjoint of change: d(state_u) / d(state_u, p_k)."""
    (state_u_stack,) = kept
    # reverse sweep
    p_k_bar = 0.0
    for i in range(state_u.size):
        # state.u[i] += dt * p["k"] * state.u[i]
        state_u[i] = state_u_stack[i]
        seed = state_u_bar[i]
        p_k_bar = added(p_k_bar, dt * (state_u[i] * seed))
        state_u_bar[i] += dt * p_k * seed
    return (p_k_bar,)


def change_augmented_2(state_u, p_k, dt):
    """Forward sweep of change, which returns its tape."""
    # forward sweep
    state_u_stack = np.empty(state_u.size)
    for i in range(state_u.size):
        state_u_stack[i] = state_u[i]
        state_u[i] += dt * p_k * state_u[i]
    return (state_u_stack,)


def change_reverse_2(state_u, state_u_bar, p_k, dt, kept):
    """Adjoint of change: d(state_u) / d(state_u, p_k, dt)."""
    (state_u_stack,) = kept
    # reverse sweep
    p_k_bar = 0.0
    dt_bar = 0.0
    for i in range(state_u.size):
        # state.u[i] += dt * p["k"] * state.u[i]
        state_u[i] = state_u_stack[i]
        seed = state_u_bar[i]
        seed_2 = state_u[i] * seed
        dt_bar = added(dt_bar, p_k * seed_2)
        p_k_bar = added(p_k_bar, dt * seed_2)
        state_u_bar[i] += dt * p_k * seed
    return p_k_bar, dt_bar


def kernel_adjoint(
    state_u, state_u_bar, state_t, state_t_bar, p_k, layers_0_0, layers_0_0_bar, layers_0_1,
    layers_1_0, layers_1_1
):
    # forward sweep: only what the reverse sweep reads
    kept = change_augmented(state_u, p_k, layers_0_1)
    state_u_here = state_u[0]
    kept_2 = change_augmented_2(state_u, p_k, layers_1_1)
    # reverse sweep
    t_bar = state_t_bar[0]
    # state.t += w[1] * state.u[0]
    state_u_bar[0] += layers_1_0[1] * t_bar
    # change(state, p, b)
    gain, gain_2 = change_reverse_2(state_u, state_u_bar, p_k, layers_1_1, kept_2)
    p_k_bar = gain
    layers_1_1_bar = gain_2
    # state.t += w[1] * state.u[0]
    layers_0_0_bar[1] += state_u_here * t_bar
    state_u_bar[0] += layers_0_0[1] * t_bar
    # change(state, p, b)
    (gain,) = change_reverse(state_u, state_u_bar, p_k, layers_0_1, kept)
    p_k_bar += gain
    # def kernel
    state_t_bar[0] = t_bar
    return p_k_bar, layers_1_1_bar
