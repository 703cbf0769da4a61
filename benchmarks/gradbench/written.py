"""Derivatives as functions that a kernel may call: s2sad writes them as Python, so that it can read them again."""
from __future__ import annotations

import linecache
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import s2sad


def written(kernel: Callable[..., Any], mode: str, wrt: str | Sequence[str], arguments: Sequence[Any]
            ) -> Callable[..., Any]:
    """The adjoint or the tangent that s2sad writes for a kernel, as a function whose text can be read again.

    Args: mode, "adjoint" or "tangent"; wrt, as for `s2sad.differentiate`; arguments, examples that give the types.
    Raises S2sadError as the derivative does.

    >>> def half(x: float):
    ...     return 0.5 * x
    >>> written(half, "tangent", "x", (1.0,))(3.0, 1.0)
    (0.5,)
    """
    differentiated = s2sad.differentiate(kernel, wrt=wrt, engine="numpy")
    text = getattr(differentiated, f"{mode}_source")(*arguments)
    name = f"{kernel.__module__}_{kernel.__name__}_{mode}".replace(".", "_")
    file = f"<{name}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    module = ModuleType(name)
    module.__file__ = file
    exec(compile(text, file, "exec"), vars(module))
    return vars(module)[f"{kernel.__name__}_{mode}"]
