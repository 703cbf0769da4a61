"""Powers: whole, negative, halves, and of two variables."""


def kernel(a, b, n):
    return a ** 2 + a ** 3 * b ** -1.5 + b ** a + 2.0 ** a + a ** n + a ** 0.5


ARGUMENTS = (0.7, 1.3, 4)
WRT, OF = ("a", "b"), ("return",)
