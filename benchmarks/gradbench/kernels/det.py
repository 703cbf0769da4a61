"""The determinant by expansion by minors."""
import numpy as np


def minor_of_two(a, row, c, d):
    """The determinant of two rows from `row` on and two columns."""
    return a[row, c] * a[row + 1, d] - a[row, d] * a[row + 1, c]


def minor_of_three(a, row, b, c, d):
    """The determinant of three rows from `row` on and three columns."""
    return (a[row, b] * minor_of_two(a, row + 1, c, d) - a[row, c] * minor_of_two(a, row + 1, b, d)
            + a[row, d] * minor_of_two(a, row + 1, b, c))


def minor_of_four(a, row, p, q, r, s):
    """The determinant of four rows from `row` on and four columns."""
    return (a[row, p] * minor_of_three(a, row + 1, q, r, s) - a[row, q] * minor_of_three(a, row + 1, p, r, s)
            + a[row, r] * minor_of_three(a, row + 1, p, q, s) - a[row, s] * minor_of_three(a, row + 1, p, q, r))


def primal(a):
    """Expands the rows above the last four: one of ell! / 24 choices of their columns after another, for ell >= 4."""
    ell, choices = a.shape[0], 1
    for left in range(5, ell + 1):
        choices *= left
    columns = np.empty(ell, dtype=np.int64)
    total = 0.0
    for choice in range(choices):
        for j in range(ell):
            columns[j] = j
        factor, rest = 1.0, choice
        for i in range(ell - 4):
            place = i + rest % (ell - i)
            rest //= ell - i
            chosen = columns[place]
            for j in range(place, i, -1):
                columns[j] = columns[j - 1]
            columns[i] = chosen
            factor *= a[i, chosen] if (place - i) % 2 == 0 else -a[i, chosen]
        p, q, r, s = columns[ell - 4:]
        total += factor * minor_of_four(a, ell - 4, p, q, r, s)
    return total
