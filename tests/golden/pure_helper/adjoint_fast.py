"""Adjoint of kernel: d(y) / d(x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in

It records nothing.
"""

# ruff: noqa: FURB136, PLR1730, RUF100


def bent_adjoint(a, b, result_bar):
    """Adjoint of bent: d(return) / d(a, b)."""
    # forward sweep: only what the reverse sweep reads
    taken = a * b <= 0.0
    if not taken:
        result = a * a / b
    # reverse sweep
    a_bar = 0.0
    b_bar = 0.0
    # return a * a / b
    result_bar_1 = result_bar
    if not taken:
        reciprocal = 1.0 / b
        a_bar += 2.0 * (a * (result_bar_1 * reciprocal if result_bar_1 != 0.0 else 0.0))
        b_bar -= result * result_bar_1 * reciprocal if result_bar_1 != 0.0 else 0.0
    return a_bar, b_bar


def bent_adjoint_2(a, b, result_bar):
    """Adjoint of bent: d(return) / d(a)."""
    # reverse sweep
    a_bar = 0.0
    # return a * a / b
    result_bar_1 = result_bar
    if not a * b <= 0.0:
        a_bar += 2.0 * (a * (result_bar_1 / b if result_bar_1 != 0.0 else 0.0))
    return (a_bar,)


def kernel_adjoint(y, y_bar, x, x_bar):
    # reverse sweep
    if 1 < x.size:
        x_bar_held = x_bar[0]
        for i in range(1, x.size):
            x_bar_held_2 = x_bar[i]
            # y[i] = bent(x[i], x[i - 1]) + 3.0 * bent(x[i - 1], 2.0)
            seed = y_bar[i]
            y_bar[i] = 0.0
            bent_value_bar = seed
            bent_value_2_bar = 3.0 * seed
            (gain,) = bent_adjoint_2(x[i - 1], 2.0, bent_value_2_bar)
            x_bar_held += gain
            gain, gain_2 = bent_adjoint(x[i], x[i - 1], bent_value_bar)
            x_bar_held += gain_2
            x_bar_held_2 += gain
            x_bar[i - 1] = x_bar_held
            x_bar_held = x_bar_held_2
        x_bar[x.size - 1] = x_bar_held
