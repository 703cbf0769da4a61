"""Normal form."""


def kernel(x, tolerance):
    guess = 1.0
    guess_1 = guess
    while abs(guess_1 * guess_1 - x[0]) > tolerance:
        x_here = x[0]
        ratio = x_here / guess_1
        guess_2 = 0.5 * (guess_1 + ratio)
        guess_1 = guess_2
    x_here_2 = x[1]
    x[0] = guess_1 * x_here_2
