"""Tangent of kernel: d(x) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in-out
    tolerance: float64, in
"""

# ruff: noqa: FURB136, RUF100


def kernel_tangent(x, x_dot, tolerance):
    guess = 1.0
    guess_dot = 0.0
    while abs(guess * guess - x[0]) > tolerance:
        x_here_dot = x_dot[0]
        ratio = x[0] / guess
        ratio_dot = (
            (x_here_dot / guess if x_here_dot != 0.0 else 0.0) -
            (ratio * guess_dot / guess if guess_dot != 0.0 else 0.0)
        )
        guess = 0.5 * (guess + ratio)
        guess_dot = 0.5 * (guess_dot + ratio_dot)
    x_here = x[1]
    x_dot[0] = x_here * guess_dot + guess * x_dot[1]
    x[0] = guess * x_here
