"""Where the random inputs of tests come from: numbers that stay the same, unless pytest's `--seed` asks for others."""
from __future__ import annotations

import os

import numpy as np

SEED = int(os.environ.get("S2SAD_TEST_SEED", "0"))


def generator(number: int) -> np.random.Generator:
    """The generator with this number, of those of the seed."""
    return np.random.default_rng((number, SEED) if SEED else number)


def seeded(program: int) -> int:
    """The number that the seed gives to a generated program."""
    return program + 1000 * SEED
