"""The determinant by expansion by minors."""
import numpy as np


def minor(a, row, c0, c1, c2):
    """The determinant of three rows from `row` on and three columns."""
    return (a[row, c0] * (a[row + 1, c1] * a[row + 2, c2] - a[row + 1, c2] * a[row + 2, c1])
            - a[row, c1] * (a[row + 1, c0] * a[row + 2, c2] - a[row + 1, c2] * a[row + 2, c0])
            + a[row, c2] * (a[row + 1, c0] * a[row + 2, c1] - a[row + 1, c1] * a[row + 2, c0]))


def primal(a):
    """Expands the rows above the last three, one column after another: ell! / 6 minors of 3 rows, for ell >= 3."""
    top = a.shape[0] - 3
    choices = 1
    for left in range(4, a.shape[0] + 1):
        choices *= left
    columns = np.empty(a.shape[0], dtype=np.int64)
    total = 0.0
    for choice in range(choices):
        for j in range(columns.size):
            columns[j] = j
        factor, rest = 1.0, choice
        for i in range(top):
            place = i + rest % (columns.size - i)
            rest //= columns.size - i
            chosen = columns[place]
            for j in range(place, i, -1):
                columns[j] = columns[j - 1]
            columns[i] = chosen
            factor *= a[i, chosen] if (place - i) % 2 == 0 else -a[i, chosen]
        total += factor * minor(a, top, columns[top], columns[top + 1], columns[top + 2])
    return total
