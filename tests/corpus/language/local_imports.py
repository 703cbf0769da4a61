"""Functions that import what they use."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.62])


def of_modules(x):
    import math
    import numpy.linalg as la
    from numpy import cos as c
    from numpy import sin
    from scipy.linalg import solve_triangular
    a = np.eye(4) + np.tril(np.outer(x, x))
    return math.exp(x[0]) * c(x[1]) + sin(x[2]) + la.det(a) + np.sum(solve_triangular(a, x, lower=True))


def of_an_outer_function(x):
    import numpy
    from math import e as base
    from numpy import tanh as squashed

    def g(v):
        from math import pi
        return squashed(v) * pi
    return g(x[0]) + g(x[1]) * numpy.sum(x) * base


def of_what_is_python_itself(x):
    from collections import namedtuple
    from functools import reduce
    pair = namedtuple("pair", ["a", "b", "c"], defaults=(2.0,))
    p = pair(x[0], x[1])
    return reduce(lambda s, v: s * v + 1.0, p)


def missing(x):
    import no_such_module
    return no_such_module.f(x)


def cases():
    for kernel in (of_modules, of_an_outer_function, of_what_is_python_itself):
        yield Case(kernel, (X,), ("x",))
    yield Case(missing, (X,), refused=(
            "S201 at `import no_such_module`: 'no_such_module' is imported, which fails: No module named "
            "'no_such_module': correct the import"))
