"""The rules of the functions that work number by number.

Where an identity offers several forms of a partial, the one is written that neither overflows nor cancels: for
`tanh` the square of 1 / cosh (1 - y * y has no correct digit left at x = 20), for `arcsin` (1 - x) * (1 + x)
(1 - x * x has lost half of them near 1), for `log(exp(a) + exp(b))` a difference of a and b. `singular` marks
partials that are infinite or nan somewhere: a zero seed has to contribute an exact zero there. Where a function is nan
its partials are: `log` at -1 has no derivative, whatever 1 / x is. Of complex numbers a partial that is a root is
written by the result: on a branch cut a root of the operand has lost the side, which is the sign of a zero.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.rules.rule import elementwise, number
from s2sad.tree import AST

# -- arithmetic -----------------------------------------------------------------------------------------------------
elementwise("a + b", a="1.0", b="1.0", also=("numpy.add",), result="same", plane="holomorphic")
elementwise("a - b", a="1.0", b="-1.0", also=("numpy.subtract",), result="same", plane="holomorphic")
elementwise("a * b", a="b", b="a", also=("numpy.multiply",), result="same", plane="holomorphic")
elementwise("a / b", a="1.0 / b", b="-y / b", also=("numpy.divide", "numpy.true_divide"), singular=("a", "b"),
            domain={"b": (0.3, 3.0)}, plane="holomorphic")


def _by_a_number(parameter: str, arguments: Mapping[str, AST]) -> str | None:
    """The partial of a remainder where the divisor is a number, which is not 0."""
    return "1.0" if parameter == "a" and "b" in arguments and number(arguments["b"]) else None


# the quotient a // b is computed as the remainder is, so that it jumps where the remainder does; at b == 0 all are nan
_ONE = "numpy.where(numpy.abs(b) > 0, 1.0, numpy.nan)"
elementwise("a % b", a=_ONE, b="numpy.where(b == 0, numpy.nan, -(a // b))", also=("numpy.mod", "numpy.remainder"),
            singular=("a", "b"), refine=_by_a_number, result="same", domain={"a": (1.1, 1.9), "b": (0.61, 0.94)},
            kink="a % b jumps where a is a multiple of b")
elementwise("numpy.fmod(a, b)", a=_ONE, b="numpy.rint((y - a) / b)", also=("math.fmod",), singular=("a", "b"),
            refine=_by_a_number, result="same", domain={"a": (1.1, 1.2), "b": (0.61, 0.94)},
            kink="fmod(a, b) jumps where a is a multiple of b")
elementwise("math.remainder(a, b)", a=_ONE, b="numpy.rint((y - a) / b)", also=("runtime.remainder",),
            singular=("a", "b"), refine=_by_a_number, domain={"a": (1.1, 1.2), "b": (0.9, 1.05)},
            kink="remainder(a, b) jumps halfway between multiples of b")
elementwise("-a", a="-1.0", also=("numpy.negative",), result="same", plane="holomorphic")
elementwise("+a", a="1.0", also=("numpy.positive",), result="same", plane="holomorphic")
elementwise("numpy.square(x)", x="2.0 * x", result="same", plane="holomorphic")
elementwise("numpy.reciprocal(x)", x="-y * y", singular=("x",), domain={"x": (0.3, 3.0)}, result="same",
            plane="holomorphic")
elementwise("builtins.float(x)", x="1.0", also=("numpy.float64", "numpy.float32"))

# -- complex numbers -------------------------------------------------------------------------------------------------
elementwise("numpy.conjugate(x)", x="1.0", also=("numpy.conj",), result="same", plane="conjugate")
elementwise("numpy.real(x)", x="1.0", result="same", plane=("gradient", {"x": "1.0"}))
elementwise("numpy.imag(x)", x="0.0", result="same", plane=("gradient", {"x": "1j"}))
elementwise("numpy.angle(x)", x="0.0", singular=("x",), plane=("gradient", {"x": "1j * x / numpy.abs(x) ** 2"}),
            kink="the angle jumps where a number crosses the negative real axis")

# -- choices: at a tie the first argument is the one that is followed ------------------------------------------------
_ABS = "the derivative of abs at 0 is taken as 0"
elementwise("numpy.absolute(x)", x="numpy.sign(x)", also=("numpy.abs", "builtins.abs"), result="same", kink=_ABS,
            plane=("gradient", {"x": "x / numpy.where(y == 0, 1.0, y)"}))
elementwise("numpy.heaviside(x, h)", x="0.0", h="numpy.where(x != x, x, numpy.where(x == 0.0, 1.0, 0.0))",
            also=("runtime.heaviside",),
            kink="heaviside(x, h) jumps where x is 0")
elementwise("numpy.fabs(x)", x="numpy.sign(x)", also=("math.fabs",), kink=_ABS)
elementwise("numpy.copysign(a, b)", a="numpy.sign(a) * numpy.copysign(1.0, b)", b="0.0", also=("math.copysign",),
            domain={"a": (0.2, 2.0), "b": (0.2, 2.0)}, kink="the derivative of copysign(0, b) is taken as 0")
elementwise("numpy.maximum(a, b)", a="numpy.where(b > a, 0.0, 1.0)", b="numpy.where(b > a, 1.0, 0.0)",
            also=("builtins.max",), result="same", kink="at a tie max(a, b) is a")
elementwise("numpy.minimum(a, b)", a="numpy.where(b < a, 0.0, 1.0)", b="numpy.where(b < a, 1.0, 0.0)",
            also=("builtins.min",), result="same", kink="at a tie min(a, b) is a")
# fmax and fmin pass over a nan in their first argument
elementwise("numpy.fmax(a, b)", a="numpy.where((b > a) | (a != a), 0.0, 1.0)", result="same",
            b="numpy.where((b > a) | (a != a), 1.0, 0.0)", kink="at a tie fmax(a, b) is a")
elementwise("numpy.fmin(a, b)", a="numpy.where((b < a) | (a != a), 0.0, 1.0)", result="same",
            b="numpy.where((b < a) | (a != a), 1.0, 0.0)", kink="at a tie fmin(a, b) is a")
elementwise("numpy.clip(x, low, high)", x="numpy.where((x < low) | (x > high), 0.0, 1.0)",
            low="numpy.where((x < low) & (low <= high), 1.0, 0.0)",
            high="numpy.where(numpy.maximum(x, low) > high, 1.0, 0.0)", result="same",
            domain={"x": (-2.0, 2.0), "low": (-1.3, -0.7), "high": (0.7, 1.3)}, kink="at its bounds clip(x) is x")

elementwise("numpy.where(c, a, b)", c="0.0", a="numpy.where(c, 1.0, 0.0)", b="numpy.where(c, 0.0, 1.0)",
            result="same", plane="holomorphic")
elementwise("runtime.strong_zero(factor, product, steep)", factor="0.0", steep="0.0", result="same",
            product="numpy.where((factor == 0.0) & (steep != 0), 0.0, 1.0)", plane="holomorphic")

# -- exponentials and logarithms ------------------------------------------------------------------------------------
# exp is marked singular for 1 / (1 + exp(-x)): where exp overflows the seed is 0 and the product must be, too
elementwise("numpy.exp(x)", x="y", also=("math.exp",), singular=("x",), plane="holomorphic")
elementwise("numpy.exp2(x)", x="0.6931471805599453 * y", also=("math.exp2",), singular=("x",))
elementwise("numpy.expm1(x)", x="numpy.exp(x)", also=("math.expm1",), singular=("x",), plane="holomorphic")
_POSITIVE = {"x": (0.05, 4.0)}
elementwise("numpy.log(x)", x="1.0 / numpy.where(x < 0, numpy.nan, x)", also=("math.log",), singular=("x",),
            domain=_POSITIVE, plane=("holomorphic", {"x": "1.0 / x"}))
elementwise("numpy.log2(x)", x="1.4426950408889634 / numpy.where(x < 0, numpy.nan, x)", also=("math.log2",),
            singular=("x",), domain=_POSITIVE, plane=("holomorphic", {"x": "1.4426950408889634 / x"}))
elementwise("numpy.log10(x)", x="0.4342944819032518 / numpy.where(x < 0, numpy.nan, x)", also=("math.log10",),
            singular=("x",), domain=_POSITIVE, plane=("holomorphic", {"x": "0.4342944819032518 / x"}))
elementwise("numpy.log1p(x)", x="1.0 / (1.0 + numpy.where(x < -1, numpy.nan, x))", also=("math.log1p",),
            singular=("x",), domain={"x": (-0.9, 3.0)}, plane=("holomorphic", {"x": "1.0 / (1.0 + x)"}))
elementwise("numpy.logaddexp(a, b)", a="1.0 / (1.0 + numpy.exp(b - a))", b="1.0 / (1.0 + numpy.exp(a - b))",
            singular=("a", "b"))
elementwise("numpy.logaddexp2(a, b)", a="1.0 / (1.0 + numpy.exp2(b - a))", b="1.0 / (1.0 + numpy.exp2(a - b))",
            singular=("a", "b"))

# -- roots ----------------------------------------------------------------------------------------------------------
elementwise("numpy.sqrt(x)", x="0.5 / y", also=("math.sqrt",), singular=("x",), domain=_POSITIVE,
            kink="the derivative of sqrt at 0 is infinite", plane="holomorphic")
elementwise("numpy.cbrt(x)", x="numpy.where(x == y, 1.0 / (y * y), y / x) / 3.0", also=("math.cbrt",), singular=("x",),
            domain=_POSITIVE, kink="the derivative of cbrt at 0 is infinite")
elementwise("numpy.hypot(a, b)", a="a / numpy.where(y == 0, 1.0, y)", b="b / numpy.where(y == 0, 1.0, y)",
            also=("math.hypot",), kink="the derivatives of hypot at (0, 0) are taken as 0")

# -- angles ---------------------------------------------------------------------------------------------------------
_UNIT = {"x": (-0.95, 0.95)}
elementwise("numpy.sin(x)", x="numpy.cos(x)", also=("math.sin",), plane="holomorphic")
elementwise("numpy.cos(x)", x="-numpy.sin(x)", also=("math.cos",), plane="holomorphic")
elementwise("numpy.tan(x)", x="1.0 + y * y", also=("math.tan",), domain={"x": (-1.3, 1.3)}, plane="holomorphic")
elementwise("numpy.arcsin(x)", x="1.0 / numpy.sqrt((1.0 - x) * (1.0 + x))", also=("numpy.asin", "math.asin"),
            singular=("x",), domain=_UNIT, plane=("holomorphic", {"x": "1.0 / numpy.cos(y)"}))
elementwise("numpy.arccos(x)", x="-1.0 / numpy.sqrt((1.0 - x) * (1.0 + x))", also=("numpy.acos", "math.acos"),
            singular=("x",), domain=_UNIT, plane=("holomorphic", {"x": "-1.0 / numpy.sin(y)"}))
elementwise("numpy.arctan(x)", x="1.0 / (1.0 + x * x)", also=("numpy.atan", "math.atan"), plane="holomorphic")
elementwise("numpy.arctan2(a, b)", a="b / numpy.hypot(a, b) / numpy.hypot(a, b)", singular=("a", "b"),
            b="-a / numpy.hypot(a, b) / numpy.hypot(a, b)", also=("numpy.atan2", "math.atan2"),
            domain={"a": (-2.0, 2.0), "b": (0.3, 2.0)}, kink="arctan2 jumps across b < 0, a = 0")
elementwise("numpy.deg2rad(x)", x="0.017453292519943295", also=("numpy.radians", "math.radians"))
elementwise("numpy.rad2deg(x)", x="57.29577951308232", also=("numpy.degrees", "math.degrees"))
# near 0 the closed form is a difference of nearly equal numbers: there Chebyshev's economised series in x * x
elementwise("numpy.sinc(x)", x="""numpy.where(
    numpy.abs(x) < 0.5,
    x * (-3.289868133696453 + x * x * (3.2469697011333745 + x * x * (-1.1445109447292616 + x * x * (0.20918278244137992
        + x * x * (-0.023460808844373647 + x * x * (0.001781133106998384 + x * x * (-9.760567966482778e-05
        + x * x * 3.915385873512628e-06))))))),
    (numpy.cos(numpy.pi * x) - y) / numpy.where(x == 0, 1.0, x))""")

# -- hyperbolic functions -------------------------------------------------------------------------------------------
elementwise("numpy.sinh(x)", x="numpy.cosh(x)", also=("math.sinh",), plane="holomorphic")
elementwise("numpy.cosh(x)", x="numpy.sinh(x)", also=("math.cosh",), plane="holomorphic")
elementwise("numpy.tanh(x)", x="(1.0 / numpy.cosh(x)) ** 2", also=("math.tanh",), plane="holomorphic")
elementwise("numpy.arcsinh(x)", x="1.0 / numpy.hypot(1.0, x)", also=("numpy.asinh", "math.asinh"),
            plane=("holomorphic", {"x": "1.0 / numpy.cosh(y)"}))
elementwise("numpy.arccosh(x)", x="1.0 / (numpy.sqrt(x - 1.0) * numpy.sqrt(x + 1.0))", singular=("x",),
            also=("numpy.acosh", "math.acosh"), domain={"x": (1.05, 4.0)},
            plane=("holomorphic", {"x": "1.0 / numpy.sinh(y)"}))
elementwise("numpy.arctanh(x)", x="1.0 / numpy.where(numpy.abs(x) > 1, numpy.nan, (1.0 - x) * (1.0 + x))",
            also=("numpy.atanh", "math.atanh"), singular=("x",), domain=_UNIT,
            plane=("holomorphic", {"x": "1.0 / ((1.0 - x) * (1.0 + x))"}))

# -- error functions ------------------------------------------------------------------------------------------------
elementwise("math.erf(x)", x="1.1283791670955126 * numpy.exp(-x * x)", also=("scipy.special.erf",))
elementwise("math.erfc(x)", x="-1.1283791670955126 * numpy.exp(-x * x)", also=("scipy.special.erfc",))

# -- the gamma function ---------------------------------------------------------------------------------------------
elementwise("math.gamma(x)", x="y * runtime.digamma(x)", domain={"x": (0.3, 4.0)})
elementwise("math.lgamma(x)", x="runtime.digamma(x)", domain={"x": (0.3, 4.0)})
elementwise("scipy.special.gammaln(x)", x="scipy.special.digamma(x)", domain={"x": (0.3, 4.0)}, singular=("x",))

# -- logistic functions and entropies: 0 * log(0) is 0 ---------------------------------------------------------------
elementwise("scipy.special.expit(x)", x="0.25 * (1.0 / numpy.cosh(0.5 * x)) ** 2")
elementwise("scipy.special.logit(x)", x="1.0 / (numpy.where((x < 0) | (x > 1), numpy.nan, x) * (1.0 - x))",
            singular=("x",), domain={"x": (0.05, 0.95)})
elementwise("scipy.special.xlogy(a, b)", a="numpy.log(b)", singular=("a", "b"), domain={"b": (0.3, 3.0)},
            b="numpy.where((a == 0) & (b == b), 0.0, a / numpy.where(b < 0, numpy.nan, b))")
elementwise("scipy.special.xlog1py(a, b)", a="numpy.log1p(b)", singular=("a", "b"), domain={"b": (-0.7, 3.0)},
            b="numpy.where((a == 0) & (b == b), 0.0, a / (1.0 + numpy.where(b < -1, numpy.nan, b)))")
elementwise("scipy.special.entr(x)", x="-numpy.log(x) - 1.0", singular=("x",), domain=_POSITIVE)
_SIDES = {"a": (0.2, 2.0), "b": (0.3, 3.0)}
elementwise("scipy.special.rel_entr(a, b)", a="numpy.log(a / numpy.where(b < 0, numpy.nan, b)) + 1.0",
            singular=("a", "b"), domain=_SIDES,
            b="numpy.where((a == 0) & (b >= 0), 0.0, -a / numpy.where(b < 0, numpy.nan, b))")
elementwise("scipy.special.kl_div(a, b)", a="numpy.log(a / numpy.where(b < 0, numpy.nan, b))",
            singular=("a", "b"), domain=_SIDES,
            b="1.0 - numpy.where((a == 0) & (b >= 0), 0.0, a / numpy.where(b < 0, numpy.nan, b))")
