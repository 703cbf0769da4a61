"""Normal form."""


def kernel(x):
    for i in range(1, x.size):
        taken = x[i] > x[i - 1]
        if taken:
            x_here = x[i]
            x_here_2 = x[i - 1]
            x[i] = x_here * x_here_2
        else:
            x_here_3 = x[i]
            x[i] = 3.0 * x_here_3
