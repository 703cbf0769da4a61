"""The tools that are compared, how they are found, and what is said of those that are not."""
from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Tool:
    """A tool: its name in tables, the file that has its kernels, the module by which it is found, its distribution."""
    name: str
    adapter: str
    module: str
    distribution: str

    @property
    def installed(self) -> bool:
        """Whether its module can be imported."""
        return importlib.util.find_spec(self.module) is not None


TOOLS = {tool.adapter: tool for tool in (
    Tool("JAX", "jax", "jax", "jax"),
    Tool("PyTorch", "pytorch", "torch", "torch"),
    Tool("HIPS autograd", "autograd", "autograd", "autograd"),
    Tool("CasADi", "casadi", "casadi", "casadi"),
    Tool("tangent", "tangent", "tangent", "tangent-ad"),
    Tool("MyGrad", "mygrad", "mygrad", "mygrad"),
    Tool("numba-enzyme", "enzyme", "numba_enzyme", "numba-enzyme"),
)}
DISTRIBUTIONS = ("s2sad", "numpy", "numba", "scipy", "numpy-quaddtype", *(tool.distribution for tool in TOOLS.values()))


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
    return said([tool.name for tool in TOOLS.values() if not tool.installed])
