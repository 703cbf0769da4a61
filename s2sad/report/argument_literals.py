"""Arguments of a function that is not run: numbers, shapes and NumPy's constructors, evaluated without running code.

    s2sad explain kernel.py:step --arguments "u=np.ones((512, 512)), steps=100"
    s2sad explain kernel.py:step --arguments "u: float64[512, 512], state: {h: float32[64], t: 0.0}, steps: 100"

An array keeps its shape, and its elements where one number fills it or they are spelled; it takes no memory.
"""
from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.infer.types import Type, array, of_value
from s2sad.program import Kernel
from s2sad.pytree import Form, PyTree, steps

_LARGEST = 2 ** 63
_DTYPES = ("float64", "float32", "complex128", "int64", "int32", "int16", "int8", "uint64", "uint32", "uint16", "uint8",
           "bool")
_DTYPE_WORDS = {"float": "float64", "int": "int64", "complex": "complex128", "bool_": "bool", **{d: d for d in _DTYPES}}
_FILLED = {"ones": 1.0, "zeros": 0.0, "empty": None, "full": None}
_RANDOM = ("random.rand", "random.randn", "random.random", "random.standard_normal")
_BINARY: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.Pow: operator.pow}
_HELP = ('write numbers, np.ones((4, 4)), np.zeros, np.full, np.arange, np.linspace, np.eye, np.array([1.0]), or a '
         'shape, as --arguments "u=np.ones((512, 512)), steps=100" or "u: float64[512, 512], steps: 100"')


class Shape:
    """An array of which the shape is known and the content is not."""

    def __init__(self, shape: tuple[int, ...], dtype: Any):
        self.shape, self.dtype, self.ndim, self.size = shape, np.dtype(dtype), len(shape), math.prod(shape)

    def __len__(self) -> int:
        return self.shape[0]


def evaluate_arguments(text: str, parameters: Sequence[str], floats: Collection[str] = ()) -> dict[str, Any]:
    """The values by the names of parameters; those that are not named are missing, an integer for one of `floats` is
    a float. Raises S2sadError (S405).

    >>> found = evaluate_arguments("np.ones((2, 3)), n=2 * 8", ["u", "n"])
    >>> found["u"].shape, found["n"], evaluate_arguments("u: float64[9]", ["u"])["u"].shape
    ((2, 3), 16, (9,))
    """
    try:
        pairs = _pairs(text, parameters)
        found: dict[str, Any] = {}
        for name, node in pairs:
            if name not in parameters or name in found:
                what = "given twice" if name in found else f"no parameter: they are {', '.join(parameters)}"
                raise _refusal(f"'{name}' is {what}")
            value = _value(node)
            found[name] = float(value) if type(value) is int and name in floats else value
    except (SyntaxError, ArithmeticError, TypeError, ValueError, RecursionError, MemoryError) as error:
        raise _refusal(f"{type(error).__name__}: {error}") from None
    return found


def form_of_literal(value: Any) -> Form:
    """The type of a value, or what it is made of."""
    if isinstance(value, dict):
        return PyTree("either", tuple(value), tuple(map(form_of_literal, value.values())))
    if isinstance(value, (tuple, list)):
        return PyTree("tuple", tuple(range(len(value))), tuple(map(form_of_literal, value)))
    if isinstance(value, Shape):
        ones = tuple(k for k, size in enumerate(value.shape) if size == 1)
        return Type("array", value.dtype.name, value.ndim, ones=ones) if ones else array(value.dtype.name, value.ndim)
    return of_value(value)


def flat_values(values: Mapping[str, Any], paths: Mapping[str, str], kernel: Kernel) -> dict[str, Any]:
    """The values by the flat names of parameters, as far as they are known; `paths` has the path of each."""
    found: dict[str, Any] = {}
    for parameter in kernel.parameters:
        title, *keys = steps(paths.get(parameter, parameter)) or (parameter,)
        if title in values:
            found[parameter] = values[str(title)]
            for key in keys:
                found[parameter] = found[parameter][key]
    return found


def _refusal(message: str) -> S2sadError:
    return S2sadError(Diagnostic("S405", f"--arguments: {message}", help=_HELP))


def _pairs(text: str, parameters: Sequence[str]) -> list[tuple[str, ast.expr]]:
    """The parameters with their expressions, of `a, n=b` or of `u: a, n: b`."""
    for spelling in (f"_({text}\n)", f"{{{text}\n}}"):
        try:
            body = ast.parse(spelling, mode="eval").body
        except SyntaxError:
            continue
        if isinstance(body, ast.Call) and isinstance(body.func, ast.Name):
            if len(body.args) > len(parameters):
                raise _refusal(f"{len(body.args)} are given, and there are {len(parameters)} parameters")
            return [*zip(parameters, body.args), *((k.arg or "**", k.value) for k in body.keywords)]
        if isinstance(body, ast.Dict):
            return [(_key(k), v) for k, v in zip(body.keys, body.values)]
    raise _refusal("this is neither NAME=VALUE, ... nor NAME: VALUE, ...")


def _key(node: ast.expr | None) -> str:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    raise _refusal("a name must stand before the colon")


def _value(node: ast.expr) -> Any:
    if isinstance(node, ast.Constant) and (node.value is None or type(node.value) in (bool, int, float, complex)):
        return _bounded(node.value)
    if isinstance(node, (ast.Tuple, ast.List)):
        return tuple(map(_value, node.elts))
    if isinstance(node, ast.Dict):
        return {_key(k): _value(v) for k, v in zip(node.keys, node.values)}
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        value = _number(node.operand)
        return -value if isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        left, right = _number(node.left), _number(node.right)
        if isinstance(node.op, ast.Pow) and abs(left) > 1 and abs(right) * math.log2(abs(left)) > 1000:
            raise _refusal(f"{ast.unparse(node)} is too large")
        return _bounded(_BINARY[type(node.op)](left, right))
    if isinstance(node, ast.Subscript):
        return _typed(node)
    if isinstance(node, ast.Call):
        return _constructed(node)
    raise _refusal(f"{ast.unparse(node)} would have to be run")


def _bounded(value: Any) -> Any:
    if isinstance(value, int) and not -_LARGEST <= value < _LARGEST:
        raise _refusal("an integer does not fit 64 bits")
    return value


def _number(node: ast.expr) -> Any:
    value = _value(node)
    if type(value) not in (int, float, complex):
        raise _refusal(f"{ast.unparse(node)} is no number")
    return value


def _typed(node: ast.Subscript) -> Shape:
    """The array of `float64[512, 512]`."""
    sizes = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    if any(isinstance(size, ast.Slice) for size in sizes):
        raise _refusal(f"{ast.unparse(node)} has no sizes")
    return _shape(tuple(map(_value, sizes)), _dtype(node.value))


def _shape(shape: Any, dtype: str) -> Shape:
    axes = shape if isinstance(shape, tuple) else (shape,)
    if not all(type(size) is int and size >= 0 for size in axes) or len(axes) > 32:
        raise _refusal(f"{shape} is no shape")
    if math.prod(axes) * np.dtype(dtype).itemsize >= _LARGEST:
        raise _refusal(f"an array of the shape {shape} is too large")
    return Shape(axes, dtype)


def _dtype(node: ast.expr) -> str:
    word = node.value if isinstance(node, ast.Constant) else ast.unparse(node)
    found = _DTYPE_WORDS.get(str(word).removeprefix("np.").removeprefix("numpy."))
    if found is None:
        raise _refusal(f"'{word}' is no dtype; use {', '.join(_DTYPES)}")
    return found


def _constructed(node: ast.Call) -> Any:
    """The array or number that a constructor of NumPy's makes."""
    title = ast.unparse(node.func)
    called = title.removeprefix("np.").removeprefix("numpy.")
    options = {k.arg: k.value for k in node.keywords}
    dtype = _dtype(options.pop("dtype")) if "dtype" in options else ""
    if title == called and called not in ("float", "int", "bool", "complex") or options or any(
            isinstance(a, ast.Starred) for a in node.args):
        raise _refusal(f"{ast.unparse(node)} would have to be run")
    values = [_value(a) for a in node.args]
    if called in _DTYPE_WORDS and len(values) == 1 and not isinstance(values[0], tuple):
        return np.dtype(_DTYPE_WORDS[called]).type(values[0])[()] if title != called else _number_of(called, values[0])
    if called in _FILLED and len(values) == 1 + (called == "full"):
        return _filled(values[0], _FILLED[called] if len(values) == 1 else values[1], dtype)
    if called in _RANDOM:
        return _shape(values[0] if called in _RANDOM[2:] and values else tuple(values), "float64")
    if called == "array" and len(values) == 1:
        made = np.array(values[0], dtype=dtype or None)
        if made.dtype.name not in _DTYPES:
            raise _refusal(f"{ast.unparse(node)} holds what is no number")
        return made
    if called in ("arange", "linspace", "eye") and 1 <= len(values) <= 3:
        return _counted(called, values, dtype)
    raise _refusal(f"{ast.unparse(node)} would have to be run")


def _number_of(word: str, value: Any) -> Any:
    return {"float": float, "int": int, "bool": bool, "complex": complex}[word](value)


def _filled(shape: Any, value: Any, dtype: str) -> Any:
    """An array that one number fills, or of which only the shape is known; it lies in no memory of its own."""
    kind = dtype or (np.asarray(value).dtype.name if value is not None else "float64")
    made = _shape(shape, kind)
    return made if value is None else np.broadcast_to(np.asarray(value, dtype=kind), made.shape)


def _counted(called: str, values: list[Any], dtype: str) -> Shape:
    if called == "linspace":
        return _shape(values[2] if len(values) == 3 else 50, dtype or "float64")
    if called == "eye":
        return _shape((values[0], values[1] if len(values) > 1 else values[0]), dtype or "float64")
    start, stop, step = (0, values[0], 1) if len(values) == 1 else (*values, 1)[:3]
    whole = all(type(v) is int for v in values)
    return _shape(max(0, math.ceil((stop - start) / step)), dtype or ("int64" if whole else "float64"))
