"""Adjoint of kernel: d(y) / d(x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in

It records nothing.
"""

# ruff: noqa: PLR1730, RUF100


def kernel_adjoint(y, y_bar, x, x_bar):
    # reverse sweep
    if 0 < x.size - 1:
        x_bar_held = x_bar[0]
        for i in range(x.size - 1):
            x_bar_held_2 = x_bar[i + 1]
            # right = x[i + 1] if i < x.size - 1 else 0.5
            right = x[i + 1]
            # y[i] = right * x[i]
            seed = y_bar[i]
            y_bar[i] = 0.0
            right_bar = x[i] * seed
            x_bar_held += right * seed
            # right = x[i + 1] if i < x.size - 1 else 0.5
            x_bar_held_2 += right_bar
            x_bar[i] = x_bar_held
            x_bar_held = x_bar_held_2
        x_bar[x.size - 1] = x_bar_held
    for i in range(max(0, x.size - 1), x.size):
        # right = x[i + 1] if i < x.size - 1 else 0.5
        taken = i < x.size - 1
        if taken:
            right = x[i + 1]
        else:
            right = 0.5
        # y[i] = right * x[i]
        seed = y_bar[i]
        y_bar[i] = 0.0
        right_bar = x[i] * seed
        x_bar[i] += right * seed
        if taken:
            # right = x[i + 1] if i < x.size - 1 else 0.5
            x_bar[i + 1] += right_bar
