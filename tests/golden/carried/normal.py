"""Normal form."""


def kernel(u, c):
    left = u[u.size - 1]
    left_1 = left
    for i in range(u.size):
        here = u[i]
        u[i] = here - c * here * (here - left_1)
        left_2 = here
        left_1 = left_2
    total = 0.0
    total_1 = total
    for i in range(u.size):
        u_here = u[i]
        total_1 += u_here * u_here
    return total_1
