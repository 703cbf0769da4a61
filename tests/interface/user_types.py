# pyright: strict, reportUnnecessaryTypeIgnoreComment=true
"""What a user writes, under strict types: a call of what s2sad gives has the signature of the user's function.

Pyright reads this file, nothing runs it. Where it says that an error is ignored, there must be one.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import s2sad

if TYPE_CHECKING:
    from collections.abc import Callable

    from typing_extensions import assert_type

Array = NDArray[np.float64]


def energy(u: Array, k: float, steps: int = 3) -> float:
    return k * float(np.sum(u * u)) * steps


@s2sad.differentiate
def plain(u: Array, k: float) -> float:
    return k * float(np.sum(u))


@s2sad.differentiate(wrt="u", engine="numpy")
def chosen(u: Array, k: float) -> float:
    return k * float(np.sum(u))


class Spring:
    @s2sad.differentiate
    def pull(self, x: float) -> float:
        return x * x


@s2sad.nondifferentiable
def looked_up(x: float) -> float:
    return x


@s2sad.rule(x="2 * x")
def squared(x: float) -> float:
    return x * x


def keeps_signatures(u: Array) -> None:
    slope = s2sad.gradient(energy, "u")
    both = s2sad.value_and_gradient(energy, wrt=("u", "k"))
    assert_type(both(u, 0.5), tuple[float, Any])
    assert_type(plain(u, 0.5), float)
    assert_type(chosen(u, k=0.5), float)
    assert_type(s2sad.value_and_gradient(plain, 0)(u, 0.5), tuple[float, Any])
    assert_type(Spring().pull(2.0), float)
    assert_type(looked_up(2.0), float)
    assert_type(squared(2.0), float)
    assert_type(plain.engine, str)
    slope(u, 0.5, steps=4)
    taken: Callable[[Array, float], float] = plain
    del taken


def finds_mistakes(u: Array) -> None:
    slope = s2sad.gradient(energy, "u")
    slope(u)                                    # pyright: ignore[reportCallIssue]
    slope(u, "0.5")                             # pyright: ignore[reportArgumentType]
    slope(u, 0.5, stages=4)                     # pyright: ignore[reportCallIssue]
    plain(u)                                    # pyright: ignore[reportCallIssue]
    Spring().pull("2.0")                        # pyright: ignore[reportArgumentType]
    s2sad.gradient(energy, argnums=0)           # pyright: ignore[reportArgumentType]
    s2sad.grad(energy, wrt="u")                 # pyright: ignore[reportCallIssue]
    s2sad.gradient(3.0)                         # pyright: ignore[reportArgumentType]


def other_calls(u: Array) -> None:
    u_bar: Array = s2sad.make_zero(u)
    by_name = s2sad.vjp(energy, (u, 0.5), {"return": 1.0}, wrt="u")
    assert_type(by_name, dict[str, Any])
    s2sad.jvp(energy, (u, 0.5), {"u": u_bar})
    s2sad.autodiff(s2sad.Reverse, energy, s2sad.Duplicated(u, u_bar), s2sad.Active(0.5), 3)
    plain.adjoint(u, u_bar, 0.5, 1.0)
    print(plain.adjoint_source(u, 0.5))
    assert s2sad.check(energy, u, 0.5)
    print(s2sad.explain(energy, u, 0.5))
    try:
        s2sad.gradient(energy)(u, 0.5)
    except s2sad.S2sadError as error:
        for diagnostic in error.diagnostics:
            print(diagnostic.code, diagnostic.message)
