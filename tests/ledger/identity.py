"""What identifies a kernel wherever its test is: the sources of its functions, what they read, and its arguments."""
from __future__ import annotations

import hashlib
import inspect
import linecache
from collections.abc import Iterable, Mapping
from functools import partial
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from s2sad.infer.types import Type
from s2sad.pytree import PyTree

DEEPEST = 6


def digest(text: str) -> str:
    """The first 12 digits of a hash."""
    return hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()[:12]


def described(value: Any, seen: dict[int, tuple[int, Any]] | None = None, depth: int = 0) -> str:
    """A text that two values share if kernels that read them are the same; of arrays only their type counts."""
    seen = {} if seen is None else seen
    value = getattr(value, "__wrapped_kernel__", getattr(value, "py_func", value))
    if isinstance(value, (bool, int, float, complex, str, bytes, type(None), np.generic)):
        return f"{type(value).__name__} {value!r}"
    if isinstance(value, np.ndarray):
        return f"{value.dtype}[{', '.join('1' if n == 1 else ':' for n in value.shape)}]"
    if isinstance(value, (ModuleType, Type)):
        return getattr(value, "__name__", str(value))
    if id(value) in seen or depth > DEEPEST:
        return f"<{seen[id(value)][0] if id(value) in seen else type(value).__name__}>"
    seen[id(value)] = len(seen), value      # held, so that no other value gets its identity
    if isinstance(value, PyTree):
        return f"{value.kind} {value.keys} {value.fixed} {_each((value.made, *value.items), seen, depth)}"
    if isinstance(value, (set, frozenset)):
        return f"{type(value).__name__}({', '.join(sorted(described(v, seen, depth + 1) for v in value))})"
    if isinstance(value, (tuple, list)):
        return f"{type(value).__name__}({_each(value, seen, depth)})"
    if isinstance(value, Mapping):
        return f"{{{_each((part for item in value.items() for part in item), seen, depth)}}}"
    if isinstance(value, (partial, MethodType)):
        return f"{type(value).__name__} {_each(value.__reduce__()[1:], seen, depth)}"
    if isinstance(value, FunctionType):
        return _function(value, seen, depth)
    if isinstance(value, type):
        own = value.__module__.partition(".")[0] not in ("builtins", "numpy", "scipy", "s2sad")
        inside = [v for v in vars(value).values() if isinstance(v, FunctionType)] if own else []
        return f"class {value.__name__}({_each(inside, seen, depth)})"
    home = type(value).__module__.partition(".")[0]
    fields = getattr(value, "__dict__", {}) if home not in ("numpy", "s2sad") else {}
    return f"{type(value).__name__} {_each((part for item in fields.items() for part in item), seen, depth)}"


def _each(values: Iterable[Any], seen: dict[int, tuple[int, Any]], depth: int) -> str:
    return ", ".join(described(v, seen, depth + 1) for v in values)


def _function(function: FunctionType, seen: dict[int, tuple[int, Any]], depth: int) -> str:
    """A function by its text, its defaults, and what its names mean, as far as it is code that was read."""
    if function.__module__ and function.__module__.partition(".")[0] in ("numpy", "scipy", "numba", "s2sad"):
        return f"{function.__module__}.{function.__qualname__}"
    read = {n: function.__globals__[n] for n in sorted(_names(function.__code__)) if n in function.__globals__}
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or ()):
        try:
            read[name] = cell.cell_contents
        except ValueError:      # not bound yet
            continue
    held = {n: v for n, v in vars(function).items() if not n.startswith("__s2sad")}
    outside = (function.__defaults__, function.__kwdefaults__, read, held)
    return f"{source_of(function)} {_each(outside, seen, depth)}"


def _names(code: CodeType) -> set[str]:
    inner = (_names(c) for c in code.co_consts if isinstance(c, CodeType))
    return set(code.co_names).union(*inner)


def source_of(function: FunctionType) -> str:
    """The text of a function's definition without its indentation; its name and code where there is no text."""
    code = function.__code__
    lines = linecache.getlines(code.co_filename, function.__globals__)[code.co_firstlineno - 1:]
    try:
        return inspect.cleandoc("\n" + "".join(inspect.getblock(lines)))
    except (SyntaxError, IndexError, inspect.EndOfBlock):
        return f"{function.__name__} {code.co_code.hex()} {code.co_names}"
