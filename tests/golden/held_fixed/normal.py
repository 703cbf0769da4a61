"""Normal form."""


def kernel(du, u, p):
    rate = p[0] / p[1]
    for i in range(u.size):
        du[i] = rate * u[i] * u[i] + p[1] * rate
