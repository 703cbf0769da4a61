"""What an expression with a domain is, and how one is listed."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

FREE = (None, None)     # both signs, any size
ABOVE = (0.0, None)


@dataclass(frozen=True)
class Expression:
    """A function of floats, its arguments' ranges, and what must hold of them beside."""
    function: Callable[..., float]
    ranges: tuple[tuple[float | None, float | None], ...]
    holds: Callable[..., Any] = lambda *_: True


LISTED: list[Expression] = []


def within(*ranges: tuple[float | None, float | None], holds: Callable[..., Any] = lambda *_: True
           ) -> Callable[[Callable[..., float]], Callable[..., float]]:
    """Lists a function with its domain."""
    def enter(function: Callable[..., float]) -> Callable[..., float]:
        LISTED.append(Expression(function, ranges, holds))
        return function
    return enter
