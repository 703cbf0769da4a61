"""Normal form."""


def kernel(y, x):
    for i in range(x.size):
        taken = i < x.size - 1
        if taken:
            right = x[i + 1]
            right_2 = right
        else:
            right_1 = 0.5
            right_2 = right_1
        y[i] = right_2 * x[i]
