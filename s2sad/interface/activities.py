"""The annotations of arguments of `autodiff`, as Enzyme has them, and the modes."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, eq=False)
class Annotation:
    """A value with what is to be done with it."""
    value: Any


class Const(Annotation):
    """`Const(x)`: no derivative with respect to x or of x, whatever its type.

    >>> Const(3.0)
    Const(value=3.0)
    """


class Active(Annotation):
    """`Active(x)`: a float whose derivative is returned; in reverse modes only.

    >>> Active(3.0)
    Active(value=3.0)
    """


@dataclass(frozen=True, eq=False)
class Duplicated(Annotation):
    """`Duplicated(x, x_bar)`: an array and its shadow of the same shape and dtype (forwards also a float and its
    tangent). In reverse the shadow holds the adjoint of the array's exit value on entry, of its entry value on exit.

    >>> Duplicated(3.0, 1.0)
    Duplicated(value=3.0, shadow=1.0)
    """
    shadow: Any


class DuplicatedNoNeed(Duplicated):
    """`DuplicatedNoNeed(x, x_bar)`: as `Duplicated`, but what x holds after the call is unspecified.

    >>> DuplicatedNoNeed(3.0, 1.0)
    DuplicatedNoNeed(value=3.0, shadow=1.0)
    """


@dataclass(frozen=True, eq=False)
class BatchDuplicated(Annotation):
    """`BatchDuplicated(x, shadows)`: several directions in one pass, with a shadow for each as `Duplicated` has one.

    >>> BatchDuplicated(3.0, (1.0, 0.0))
    BatchDuplicated(value=3.0, shadows=(1.0, 0.0))
    """
    shadows: Any


@dataclass(frozen=True)
class Mode:
    """A mode of `autodiff`."""
    name: str
    reverse: bool
    with_primal: bool

    def __repr__(self) -> str:
        return self.name


Forward = Mode("Forward", reverse=False, with_primal=False)
ForwardWithPrimal = Mode("ForwardWithPrimal", reverse=False, with_primal=True)
Reverse = Mode("Reverse", reverse=True, with_primal=False)
ReverseWithPrimal = Mode("ReverseWithPrimal", reverse=True, with_primal=True)
