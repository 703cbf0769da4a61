"""Normal form."""


def kernel(a, b, n):
    power = b ** -1.5
    power_2 = b ** a
    power_3 = 2.0 ** a
    power_4 = a ** n
    power_5 = a ** 0.5
    result = a ** 2 + a ** 3 * power + power_2 + power_3 + power_4 + power_5
    return result
