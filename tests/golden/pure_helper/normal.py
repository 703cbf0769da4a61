"""Normal form."""


def bent(a, b):
    taken = a * b <= 0.0
    if taken:
        result = 0.0
        result_2 = result
    else:
        result_1 = a * a / b
        result_2 = result_1
    return result_2


def kernel(y, x):
    for i in range(1, x.size):
        argument = x[i]
        argument_2 = x[i - 1]
        bent_value = bent(argument, argument_2)
        argument_3 = x[i - 1]
        bent_value_2 = bent(argument_3, 2.0)
        y[i] = bent_value + 3.0 * bent_value_2
