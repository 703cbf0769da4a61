"""Functions that Numba follows deeper than Python's stack."""
from __future__ import annotations

import pytest

from s2sad.run.compiled import prepare


class Dispatcher:
    """A function that is compiled by recursion, as Numba's is for each block."""
    typeof_pyval = staticmethod(type)

    def __init__(self, depth):
        self.depth, self.compiled = depth, []

    @staticmethod
    def py_func():
        """Nothing."""

    def compile(self, signature):
        def block(n):
            return 1 + block(n - 1) if n else 0
        self.compiled.append((signature, block(self.depth)))


@pytest.mark.parametrize("depth", [3, 5000])
def test_compilation_goes_as_deep_as_the_function(depth):
    dispatcher = Dispatcher(depth)
    prepare(dispatcher, (1.0,), "f")
    assert dispatcher.compiled == [((float,), depth)]
