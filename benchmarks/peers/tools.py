"""The tools that are compared, how they are found, and what is said of those that are not."""
from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Tool:
    """A tool: its name, the adapter that has its kernels, its variants, and how it is found and installed."""
    name: str
    adapter: str
    variants: tuple[str, ...]
    module: str = "numba"
    distribution: str = ""

    @property
    def installed(self) -> bool:
        """Whether its module can be imported."""
        return importlib.util.find_spec(self.module) is not None


OURS = ("s2sad, Numba", "s2sad, Numba, plain", "s2sad, NumPy", "s2sad, NumPy, plain", "s2sad, Numba, float32")
PRIMALS = ("primal, Numba", "primal, NumPy")
DIFFERENCES = ("forward differences", "central differences", "complex step")
TOOLS = (
    Tool("s2sad", "ours", PRIMALS + OURS),
    Tool("by hand", "by_hand", ("by hand",)),
    Tool("JAX", "with_jax", ("JAX", "JAX, checkpoint"), "jax", "jax"),
    Tool("PyTorch", "with_pytorch", ("PyTorch",), "torch", "torch"),
    Tool("HIPS autograd", "with_autograd", ("HIPS autograd",), "autograd", "autograd"),
    Tool("CasADi", "with_casadi", ("CasADi, MX", "CasADi, SX"), "casadi", "casadi"),
    Tool("tangent", "with_tangent", ("tangent",), "tangent", "tangent-ad"),
    Tool("MyGrad", "with_mygrad", ("MyGrad",), "mygrad", "mygrad"),
    Tool("numba-enzyme", "with_enzyme", ("numba-enzyme",), "numba_enzyme", "numba-enzyme"),
    Tool("differences", "differences", DIFFERENCES),
)
DISTRIBUTIONS = ("s2sad", "numpy", "numba", "scipy", "numpy-quaddtype",
                 *(tool.distribution for tool in TOOLS if tool.distribution))


def said(names: Sequence[str]) -> str:
    """The sentence for tools that are not installed.

    >>> said(["MyGrad", "numba-enzyme"])
    'Not installed and left out: MyGrad, numba-enzyme (pip install "s2sad[peers]" installs those that an index has).'
    """
    if not names:
        return ""
    listed = ", ".join(names)
    return f'Not installed and left out: {listed} (pip install "s2sad[peers]" installs those that an index has).'


def missing() -> str:
    """What is said of the tools that are not installed; empty where all are."""
    return said([tool.name for tool in TOOLS if not tool.installed])
