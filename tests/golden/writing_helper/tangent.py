"""Tangent of kernel: d(u) / d(u, k).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    k: float64, in
    steps: int64, in
"""


def step_tangent(u, u_dot, k, k_dot):
    """Tangent of step: d(u) / d(u, k)."""
    for i in range(u.size):
        u_here = u[i]
        u_here_dot = u_dot[i]
        u_dot[i] += u_here * (u_here * k_dot + k * u_here_dot) + k * u_here * u_here_dot
        u[i] += k * u_here * u_here


def kernel_tangent(u, u_dot, k, k_dot, steps):
    for _ in range(steps):
        step_tangent(u, u_dot, k, k_dot)
