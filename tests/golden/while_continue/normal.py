"""Normal form."""


def kernel(x):
    k = 0
    total = 0.0
    k_1 = k
    total_1 = total
    while k_1 < x.size:
        k_2 = k_1 + 1
        taken = not x[k_2 - 1] < 0.0
        if taken:
            total_1 += x[k_2 - 1] ** 3
        k_1 = k_2
    return total_1
