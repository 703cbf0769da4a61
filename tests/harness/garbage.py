"""Garbage is sought seldom in long runs: a compiler's trees are many objects that live."""
from __future__ import annotations

import gc


def collect_rarely() -> None:
    """Python looks through all objects after 200,000 new ones, not after 700, which took a fifth of the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(200_000, 20, 50)
