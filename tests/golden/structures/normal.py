"""Normal form."""


def change(state_u, p_k, dt):
    for i in range(state_u.size):
        state_u_here = state_u[i]
        state_u[i] += dt * p_k * state_u_here


def kernel(state_u, state_t, p_k, layers_0_0, layers_0_1, layers_1_0, layers_1_1):
    t = state_t[0]
    change(state_u, p_k, layers_0_1)
    state_u_here = state_u[0]
    t_1 = t + layers_0_0[1] * state_u_here
    change(state_u, p_k, layers_1_1)
    state_u_here_2 = state_u[0]
    t_2 = t_1 + layers_1_0[1] * state_u_here_2
    state_t[0] = t_2
