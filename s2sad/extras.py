"""What other packages bring: a module of one, or an error that names the extra with which it is installed."""
from __future__ import annotations

from importlib import import_module
from typing import Any

from s2sad.diagnostics import Diagnostic, S2sadError

_PACKAGES = {"numba": ("Numba", "jit"), "scipy": ("SciPy", "jit"), "matplotlib": ("matplotlib", "plot"),
             "jax": ("JAX", "jax"), "torch": ("PyTorch", "torch"), "casadi": ("CasADi", "casadi")}


def needed(module: str, what: str, otherwise: str = "") -> Any:
    """A module of another package, which `what` needs; raises S2sadError (S405) where that is not installed, with what
    to do `otherwise`.

    >>> needed("math", "a root").sqrt(4.0)
    2.0
    """
    try:
        return import_module(module)
    except ImportError:
        raise absent(module.partition(".")[0], what, otherwise) from None


def absent(package: str, what: str, otherwise: str = "") -> S2sadError:
    """The error where a package is not installed."""
    title, extra = _PACKAGES[package]
    remedy = f'pip install "s2sad[{extra}]"'
    return S2sadError(Diagnostic("S405", f"{what} needs {title}, which is not installed",
                                 help=f"{remedy}, or {otherwise}" if otherwise else remedy))
