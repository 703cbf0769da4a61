"""Normal form."""


def kernel(x):
    a = x[0]
    x_here = x[1]
    b = 2.0 * x_here
    a_before = a
    a_1 = b
    b_1 = a_before
    held = x[1]
    x_here_2 = x[2]
    x[1] = x_here_2
    x[2] = held
    x[0] = a_1 * b_1
