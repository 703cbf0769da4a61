"""Normal form."""


def kernel(x, y):
    total = 0.0
    total_1 = total
    for index in range(min(len(x), len(y))):
        value = x[index]
        other = y[index]
        total_1 += value * other
    for k in range(len(x)):
        value_1 = x[k]
        y[k] = total_1 * value_1
    total_2 = total_1
    for i in range(x.size - 1, 0, -1):
        total_3 = total_2 * x[i]
        total_2 = total_3
    return total_2
