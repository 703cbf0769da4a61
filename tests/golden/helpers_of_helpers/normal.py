"""Normal form."""


def square(a):
    result = a * a
    return result


def energy(row):
    total = 0.0
    total_1 = total
    for i in range(row.size):
        argument = row[i]
        square_value = square(argument)
        total_1 += square_value
    return total_1


def kernel(y, x):
    for i in range(x.shape[0]):
        energy_value = energy(x[i])
        y_here = y[i]
        y[i] = y_here * energy_value
