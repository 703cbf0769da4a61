"""Normal form."""


def kernel(y, x):
    for i in range(x.size):
        taken = x[i] > 0.5
        if taken:
            y[i] = x[i] * x[i]
        else:
            y[i] = 3.0 * x[i]
