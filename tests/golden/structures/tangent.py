"""Tangent of kernel: d(state_u, state_t) / d(state_u, state_t, p_k, layers_0_0, layers_1_1).

Engine: NumPy. Level: plain. Arguments:
    state_u: float64[:], in-out
    state_t: float64[:], in-out
    p_k: float64, in
    layers_0_0: float64[:], in
    layers_0_1: float64, in
    layers_1_0: float64[:], in
    layers_1_1: float64, in
"""


def change_tangent(state_u, state_u_dot, p_k, p_k_dot, dt):
    """Tangent of change: d(state_u) / d(state_u, p_k)."""
    for i in range(state_u.size):
        state_u_here = state_u[i]
        state_u_dot[i] += state_u_here * (dt * p_k_dot) + dt * p_k * state_u_dot[i]
        state_u[i] += dt * p_k * state_u_here


def change_tangent_2(state_u, state_u_dot, p_k, p_k_dot, dt, dt_dot):
    """Tangent of change: d(state_u) / d(state_u, p_k, dt)."""
    for i in range(state_u.size):
        state_u_here = state_u[i]
        state_u_dot[i] += state_u_here * (p_k * dt_dot + dt * p_k_dot) + dt * p_k * state_u_dot[i]
        state_u[i] += dt * p_k * state_u_here


def kernel_tangent(
    state_u, state_u_dot, state_t, state_t_dot, p_k, p_k_dot, layers_0_0, layers_0_0_dot,
    layers_0_1, layers_1_0, layers_1_1, layers_1_1_dot
):
    t = state_t[0]
    t_dot = state_t_dot[0]
    change_tangent(state_u, state_u_dot, p_k, p_k_dot, layers_0_1)
    state_u_here = state_u[0]
    t_1 = t + layers_0_0[1] * state_u_here
    t_1_dot = t_dot + (state_u_here * layers_0_0_dot[1] + layers_0_0[1] * state_u_dot[0])
    change_tangent_2(state_u, state_u_dot, p_k, p_k_dot, layers_1_1, layers_1_1_dot)
    t_2 = t_1 + layers_1_0[1] * state_u[0]
    t_2_dot = t_1_dot + layers_1_0[1] * state_u_dot[0]
    state_t_dot[0] = t_2_dot
    state_t[0] = t_2
