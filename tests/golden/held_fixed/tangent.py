"""Tangent of kernel: d(du) / d(u).

Engine: NumPy. Level: plain. Arguments:
    du: float64[:], out
    u: float64[:], in
    p: float64[:], in
"""


def kernel_tangent(du, du_dot, u, u_dot, p):
    rate = p[0] / p[1]
    for i in range(u.size):
        du_dot[i] = u[i] * (rate * u_dot[i]) + rate * u[i] * u_dot[i]
        du[i] = rate * u[i] * u[i] + p[1] * rate
