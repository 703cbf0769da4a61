"""Normal form."""


def kernel(y, x):
    n = x.size
    for i in range(n):
        y[i] = x[i - 1] * x[(i + 2) % n]
    y_here = y[-1]
    y[-1] = y_here * x[-2]
