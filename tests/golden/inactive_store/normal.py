"""Normal form."""


def kernel(y, x):
    for i in range(y.size):
        y[i] = x[i] * x[i]
    for i in range(y.size):
        y[i] = 0.5
    y[0] = x[0] * x[1]
