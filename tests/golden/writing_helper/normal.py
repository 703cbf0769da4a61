"""Normal form."""


def step(u, k):
    for i in range(u.size):
        u_here = u[i]
        u[i] += k * u_here * u_here


def kernel(u, k, steps):
    for _ in range(steps):
        step(u, k)
