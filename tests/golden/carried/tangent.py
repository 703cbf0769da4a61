"""Tangent of kernel: d(u, return) / d(u, c).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    c: float64, in
"""


def kernel_tangent(u, u_dot, c, c_dot):
    left = u[u.size - 1]
    left_dot = u_dot[u.size - 1]
    for i in range(u.size):
        here = u[i]
        here_dot = u_dot[i]
        u_dot[i] = (
            here_dot -
            ((here - left) * (here * c_dot + c * here_dot) + c * here * (here_dot - left_dot))
        )
        u[i] = here - c * here * (here - left)
        left = here
        left_dot = here_dot
    total_dot = 0.0
    for i in range(u.size):
        u_here = u[i]
        u_here_dot = u_dot[i]
        total_dot += u_here * u_here_dot + u_here * u_here_dot
    return (total_dot,)
