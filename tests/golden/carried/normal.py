"""Normal form."""


def kernel(u, c):
    left = u[u.size - 1]
    left_1 = left
    for i in range(u.size):
        here = u[i]
        u[i] = here - c * here * (here - left_1)
        left_2 = here
        left_1 = left_2
