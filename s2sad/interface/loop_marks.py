"""What a kernel's text says of its loops, which does nothing where the kernel runs."""
from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from s2sad.program import Snapshots

T = TypeVar("T")


def timesteps(steps: Iterable[T], snapshots: int | Snapshots) -> Iterable[T]:
    """The steps themselves: in the text of a kernel it says that the loop over them keeps so many snapshots in a
    derivative, as `checkpoint` does.

    Args: steps, what the loop goes through, as range(n); snapshots, a number in the text, or there
    s2sad.Snapshots(20, on_disk="/scratch"). Literature: Griewank and Walther, Algorithm 799: revolve, ACM TOMS 26,
    2000.

    >>> import numpy as np
    >>> from s2sad import gradient
    >>> def decay(u, n):
    ...     for k in timesteps(range(n), snapshots=3):
    ...         u[0] = 0.5 * u[0]
    ...     return u[0]
    >>> gradient(decay)(np.array([1.0]), 10)
    array([0.00097656])
    """
    return steps
