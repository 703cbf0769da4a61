"""Normal form."""

import math


def polar(a, b):
    result = math.hypot(a, b)
    result_2 = math.atan2(b, a)
    return result, result_2, 2


def kernel(x):
    argument = x[0]
    argument_2 = x[1]
    radius, angle, count = polar(argument, argument_2)
    power = radius ** count
    result = power * angle
    return result
