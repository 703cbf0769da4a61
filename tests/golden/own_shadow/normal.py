"""Normal form."""


def kernel(y, x):
    for i in range(x.size):
        x_here = x[i]
        x[i] = x_here * x_here
        x_here_2 = x[i]
        y[i] = 3.0 * x_here_2
