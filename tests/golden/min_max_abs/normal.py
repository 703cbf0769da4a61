"""Normal form."""


def kernel(y, x, top):
    for i in range(x.size):
        y[i] = min(max(x[i], 0.1), top) * abs(x[i])
