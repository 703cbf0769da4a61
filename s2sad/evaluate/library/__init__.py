"""What functions of libraries do, said in Python: the evaluator reads them as it reads a user's function, and what they
refuse is said of their call.

Parameters are called as the library calls them. `WRITTEN` has the functions by their paths, `WITH_OPTION` those that
are read where an option is given that the function's own rule does not know; `lists.py` has those of a list of which
only the run knows the length, `random_numbers.py` NumPy's generators. What lies in this folder is read so.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from s2sad.evaluate.library import arrays, iterators, polynomials

_FOLDER = str(Path(__file__).parent)


def is_of_library(path: str) -> bool:
    """Whether a file lies in this folder."""
    return path.startswith(_FOLDER)


def _by_path(room: str, *found: Any) -> Iterable[tuple[str, Any]]:
    return ((f"{room}.{f.__name__}", f) for f in found)


_OF_NUMPY = {"phase": "angle", **{f"a{name}": f"arc{name}" for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh")}}
_OF_COMPLEX = ("exp", "log", "log10", "sqrt", "sin", "cos", "tan", "sinh", "cosh", "tanh", *_OF_NUMPY)

WRITTEN: dict[str, Callable[..., Any]] = dict((
    *_by_path("itertools", iterators.count, iterators.cycle, iterators.repeat, iterators.pairwise, iterators.islice,
              iterators.takewhile, iterators.starmap, iterators.groupby, iterators.zip_longest),
    *_by_path("operator", iterators.itemgetter, iterators.attrgetter, iterators.methodcaller),
    *_by_path("itertools.chain", iterators.from_iterable), *_by_path("cmath", arrays.polar, arrays.rect),
    *((f"cmath.{name}", arrays.of_complex(getattr(np, _OF_NUMPY.get(name, name)))) for name in _OF_COMPLEX),
    *_by_path("numpy", arrays.piecewise, arrays.fromfunction, arrays.apply_along_axis, arrays.vectorized,
              arrays.rollaxis, arrays.broadcast_arrays, arrays.unwrap, arrays.tolist, arrays.diag_indices_from,
              arrays.triu_indices_from, arrays.tril_indices_from, polynomials.polyadd, polynomials.polysub,
              polynomials.poly1d),
    *_by_path("numpy.polynomial", polynomials.Polynomial),
    *_by_path("numpy.polynomial.polynomial", polynomials.Polynomial),
    *_by_path("numpy.polynomial.chebyshev", polynomials.chebval),
    *_by_path("numpy.polynomial.legendre", polynomials.legval),
    *_by_path("numpy.polynomial.hermite", polynomials.hermval),
    *_by_path("numpy.polynomial.hermite_e", polynomials.hermeval),
    *_by_path("numpy.polynomial.laguerre", polynomials.lagval)))

_MASKED = ("where", "initial")
WITH_OPTION: dict[str, tuple[Callable[..., Any], tuple[str, ...]]] = {
    "numpy.ediff1d": (arrays.ediff1d, ("to_begin", "to_end")),
    **{f"numpy.{name}": (made, _MASKED) for name, made in (
        ("max", arrays.masked_max), ("min", arrays.masked_min), ("amax", arrays.masked_max),
        ("amin", arrays.masked_min), ("mean", arrays.masked_mean), ("var", arrays.masked_var),
        ("std", arrays.masked_std))}}
