"""The caller's arguments as values of the kernel's types, or a refusal that names the argument."""
from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.infer.types import Type, misfit_of, of_value
from s2sad.program import Kernel
from s2sad.run.overlap import Slot, folded, self_overlap, shape_mismatch
from s2sad.pytree import PyTree, form_of, map_leaves

FLOATS = ("float64", "float32")
INEXACT = (*FLOATS, "complex128")   # the dtypes of what has shadows
_LEAST, _BEYOND = -2 ** 63, 2 ** 63
_PLAIN = frozenset((float, bool, str, complex, type(None), np.float64, np.float32, np.bool_))   # known by their class
_SINGLE: type[np.floating] = np.float32  # to pyright np.float32 itself is an alias, which isinstance does not take
_NUMBERS = (int, float, complex, np.integer, np.floating)
_FLOAT_ANNOTATIONS = ("float", "np.float64", "numpy.float64", "float64", "np.float32", "numpy.float32", "float32")


def float_parameters(kernel: Kernel) -> frozenset[str]:
    """The parameters that are floats by their annotation or their default; an int argument is converted."""
    annotated = {p for p, text in kernel.annotations.items() if str(text).strip("\"'") in _FLOAT_ANNOTATIONS}
    return frozenset(annotated | {p for p, value in kernel.defaults.items() if isinstance(value, float)})


def bind(kernel: Kernel, args: Sequence[Any], keywords: Mapping[str, Any] | None = None) -> list[Any]:
    """One value per parameter, in order, defaults filled in; TypeError as Python words it, S2sadError of further
    arguments that the kernel takes."""
    names, keywords = kernel.parameters, dict(keywords or {})
    if kernel.rest and (len(args) > len(names) or keywords.keys() - {*names}):
        raise _unnamed(kernel, keywords)
    if len(args) > len(names):
        raise TypeError(f"{kernel.name}() takes {len(names)} arguments but {len(args)} were given")
    bound = dict(zip(names, args))
    for name, value in keywords.items():
        if name not in names:
            raise TypeError(f"{kernel.name}() got an unexpected keyword argument '{name}'")
        if name in bound:
            raise TypeError(f"{kernel.name}() got multiple values for argument '{name}'")
        bound[name] = value
    missing = [n for n in names if n not in bound and n not in kernel.defaults]
    if missing:
        raise TypeError(f"{kernel.name}() missing {len(missing)} required argument"
                        f"{'s' if len(missing) > 1 else ''}: {', '.join(map(repr, missing))}")
    return [bound[n] if n in bound else kernel.defaults[n] for n in names]


def _unnamed(kernel: Kernel, keywords: Mapping[str, Any]) -> S2sadError:
    named = [k for k in keywords if k not in kernel.parameters][:1]
    head = ", ".join((*kernel.parameters, *(named or "a")))
    call = ", ".join((*kernel.parameters, *(f"{k}={k}" for k in named))) if named else head
    return S2sadError(Diagnostic(
        "S405", f"'{kernel.name}' is given more than its parameters have names for, which {' and '.join(kernel.rest)} "
        "would take", help=f"call it in a function that names them: def f({head}): return {kernel.name}({call})"))


def kernel_value(name: str, value: Any, is_float: bool = False) -> Any:
    """The value as generated code takes it: an ndarray, float, complex number, int, bool, str or None; else S2sadError.

    >>> kernel_value("x", 3, is_float=True), kernel_value("n", 3)
    (3.0, 3)
    """
    kind = type(value)
    if kind is float or value is None or kind is str:
        return value
    if kind is np.ndarray or isinstance(value, np.ndarray):
        return _array(name, value)
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        if not _LEAST <= value < _BEYOND:
            raise _argument_error(name, f"is {value}, which does not fit 64 bits", "give a float")
        return float(value) if is_float else int(value)
    if isinstance(value, _SINGLE):
        return value
    if isinstance(value, (np.float64, float)):
        return float(value)
    if isinstance(value, complex):
        return np.complex128(value)     # NumPy's, which divides by zero without an error
    raise _argument_error(name, *_unsupported(name, value))


def coercion(name: str, value: Any, is_float: bool) -> Any:
    """The function that turns later values of the same type into what `kernel_value` gave, or None if it keeps them."""
    kind, passed = type(kernel_value(name, value, is_float)), type(value)
    if kind is np.ndarray:
        return None if passed is np.ndarray else np.asarray
    return None if kind is passed else kind


def types(values: Sequence[Any]) -> tuple[Type, ...]:
    return tuple(map(of_value, values))


def describe(args: Sequence[Any]) -> tuple[Any, ...]:
    """A key that is equal only for arguments that may take the same compiled function: of each all that `kernel_value`
    and the types depend on, and the layout of arrays."""
    array = np.ndarray
    return tuple([(a.dtype, a.ndim if 1 not in a.shape else tuple([n == 1 for n in a.shape]), a.flags.num)
                  if (kind := type(a)) is array
                  else kind if kind in _PLAIN or kind is int and _LEAST <= a < _BEYOND else _described(a)
                  for a in args])


def _described(value: Any) -> Any:
    """The key of an array of a class of its own, an integer that may be too wide, or anything else."""
    if isinstance(value, np.ndarray):
        return type(value), value.dtype, of_value(value), value.flags.num
    if isinstance(value, (int, np.integer)):
        return type(value), _LEAST <= value < _BEYOND
    return type(value)


def check_writable(name: str, value: Any) -> None:
    """Refuses a read-only array where the kernel writes."""
    if isinstance(value, np.ndarray) and not value.flags.writeable:
        raise _argument_error(name, "is read-only, and the function writes it", "pass a copy of it")


def shadow(name: str, value: Any, primal: str, of: Any) -> Any:
    """The shadow or tangent of an argument, checked for type, dtype, shape and writability: S403 if it does not fit."""
    if isinstance(of, np.ndarray):
        return _shadow_array(name, value, primal, of)
    if isinstance(of, complex) and not isinstance(value, (bool, np.bool_)) and isinstance(value, _NUMBERS):
        return np.complex128(value)
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise misfit(f"'{name}' is {_a(value)}, its primal '{primal}' is a float", "give a float")
    return np.float32(value) if isinstance(of, _SINGLE) else float(value)


def _shadow_array(name: str, value: Any, primal: str, of: np.ndarray) -> np.ndarray:
    remedy = f"make one with s2sad.make_zero({primal})"
    if not isinstance(value, np.ndarray):
        raise misfit(f"the shadow '{name}' is {_a(value)}, its primal '{primal}' is an array", remedy)
    if value.dtype != of.dtype:
        raise misfit(f"the shadow '{name}' has dtype {value.dtype}, its primal '{primal}' has {of.dtype}", remedy)
    if value.shape != of.shape:
        raise S2sadError(shape_mismatch(name, value.shape, primal, of.shape))
    if (found := misfit_of(value, name)) is not None:
        raise misfit(f"the shadow '{name}' {found[0]}", remedy)
    if not value.flags.writeable:
        raise misfit(f"the shadow '{name}' is read-only", remedy)
    if folded(value):
        raise S2sadError(self_overlap(Slot(name, "shadow", primal, True)))
    return value if type(value) is np.ndarray else np.asarray(value)


def misfit(message: str, remedy: str = "") -> S2sadError:
    return S2sadError(Diagnostic("S403", message, help=remedy))


def _array(name: str, value: np.ndarray) -> np.ndarray:
    found = misfit_of(value, name)
    if found is not None:
        raise _argument_error(name, *found)
    return value if type(value) is np.ndarray else np.asarray(value)


def _unsupported(name: str, value: Any) -> tuple[str, str]:
    if isinstance(value, (list, tuple)):
        return f"is {_a(value)}", f"pass numpy.array({name}, dtype=float)"
    if isinstance(value, np.number):
        wanted = "complex number" if value.dtype.kind == "c" else "float"
        return f"is a number of type {value.dtype}", f"give a {wanted}"
    if type(value).__module__.startswith("scipy.sparse."):
        return f"is {_a(value)}", "give it in another format: A.tocsr()"
    if hasattr(value, "__array__") and not isinstance(value, (type, np.generic)):
        return f"is {_a(value)}", f"pass numpy.asarray({name})"
    if hasattr(value, "__float__") and not isinstance(value, (type, np.generic)):
        return f"is {_a(value)}", f"pass float({name})"
    return f"is {_a(value)}", "give an array, a float, an int, a bool, a str or None"


def _a(value: Any) -> str:
    word = "None" if value is None else type(value).__name__
    return word if value is None else f"{'an' if word[0].lower() in 'aeio' else 'a'} {word}"


def _argument_error(name: str, what: str, remedy: str) -> S2sadError:
    return S2sadError(Diagnostic("S405", f"the argument '{name}' {what}", help=remedy))


def make_zero(x: Any) -> Any:
    """A zero shadow of the same structure as x: arrays and floats zero, everything else as it is.

    Args: x, a float, an array of float64 or float32 of any shape, an integer, bool, str or None, or a dataclass, named
    tuple, tuple, list or dict of such; what else a structure holds stays. Raises S2sadError (S405) for other types. The
    shadows are those of Enzyme (Moses and Churavy, NeurIPS 2020).

    >>> import numpy as np
    >>> make_zero((np.ones(2), 3.0, 4))
    (array([0., 0.]), 0.0, 4)
    """
    form = form_of(x, "x", sys.maxsize)
    if isinstance(form, PyTree):
        return map_leaves(form, x, "x", lambda path, kind, leaf: leaf if kind.kind == "other" else make_zero(leaf))
    value = kernel_value("x", x)
    if isinstance(value, np.ndarray):
        return np.zeros_like(value) if value.dtype.name in INEXACT else value
    if isinstance(value, complex):
        return 0j
    if isinstance(value, (float, _SINGLE)):
        return type(value)(0.0)
    return x
