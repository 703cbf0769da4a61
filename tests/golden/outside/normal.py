"""Normal form."""

G = 9.81


def kernel(x, TABLE):
    total = 0.0
    total_1 = total
    for i in range(x.size):
        total_1 += TABLE[i] * x[i] ** 2
    result = G * total_1
    return result
