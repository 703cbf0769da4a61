"""An adjoint in two functions that is loaded: the augmented primal, which gives the tape, and the reverse sweep."""
from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from types import FunctionType
from typing import Any

import numpy as np

from s2sad.dispatch.executable import Executable, as_it_is, kind_of, without_warnings
from s2sad.infer.types import Type
from s2sad.live_objects.registry import RegisteredRule
from s2sad.program import Generated
from s2sad.run.exceptions import CAUGHT
from s2sad.run.typed_lists import with_typed_lists
from s2sad.runtime import on_disk

_SAME = ("float64", "int64", "bool", "complex128")      # what Numba gives back as it took it
_LISTS = ("list", "tuple", "List", "ReflectedList")


class SplitExecutable(Executable):
    """The two functions; as an `Executable` it is the reverse sweep, which takes the tape first."""

    def __init__(self, generated: Generated, engine: str, summary: Any, kernel: str,
                 registered: tuple[RegisteredRule, ...] = (), function: FunctionType | None = None,
                 forwards: Collection[str] = ()):
        super().__init__(generated, engine, summary, kernel, registered, function, forwards)
        title = generated.facts["forward"]
        self._first_half = getattr(self.module, title)
        self._augmented: Callable[..., Any] = self.in_folders(
            without_warnings(self._first_half) if engine == "numpy" else self._first_half)
        self._folder = next(iter(generated.facts.get("folders", ())), None)
        self.taken = tuple([p.name for p in generated.facts["taken"]])      # its parameters
        self._results = [kind_of(t) if t.is_inexact else as_it_is for t in summary.results]
        self.tape: tuple[tuple[Type, bool], ...] = generated.facts["tape"]
        self._entries = [_number_of(t.dtype) if engine == "numba" and t.is_number and t.dtype not in _SAME else as_it_is
                         for t, _ in self.tape]

    def prepare_call(self, arguments: Sequence[Any]) -> None:
        """Compiles the augmented primal for the types of these arguments."""
        self.prepare_function(self._first_half, arguments, self._first_half.__name__)

    def augmented(self, arguments: Sequence[Any]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """Runs the primal: its results, and the tape."""
        try:
            results, tape = self._augmented(*arguments)
        except CAUGHT as error:
            raise self.failures.meaning(error) from None
        found = () if not self._results else (results,) if len(self._results) == 1 else results
        return (tuple([kind(v) for kind, v in zip(self._results, found)]),
                tuple([kind(v) for kind, v in zip(self._entries, self._typed(arguments, tape))]))

    def _typed(self, arguments: Sequence[Any], tape: tuple[Any, ...]) -> tuple[Any, ...]:
        return with_typed_lists(self._first_half, arguments, tape) if self.engine == "numba" else tape

    def intact(self, tape: Sequence[Any]) -> tuple[Any, ...]:
        """The tape with copies of what the reverse sweep writes."""
        return tuple([copied(v, None if kind.is_array else self._folder) if written else v
                      for v, (kind, written) in zip(tape, self.tape)])


def _number_of(dtype: str) -> Callable[[Any], Any]:
    return np.dtype(dtype).type


def copied(value: Any, folder: str | None = None) -> Any:
    """A copy of the arrays in a value, in files of a folder if there is one, and of the lists, tuples and dicts that
    hold them; everything else as it is."""
    if isinstance(value, np.ndarray):
        if folder is None or not value.size:
            return np.copy(value)
        made = on_disk(value, 1, folder)[0]
        made[...] = value
        return made
    if type(value).__name__ in _LISTS:
        return type(value)([copied(v, folder) for v in value])
    return {k: copied(v, folder) for k, v in value.items()} if type(value) is dict else value


def arrays_in(value: Any) -> list[np.ndarray]:
    """The arrays in a value, and in the lists, tuples and dicts that it holds."""
    if isinstance(value, np.ndarray):
        return [value]
    items = value.values() if type(value) is dict else value if type(value).__name__ in _LISTS else ()
    return [a for v in items for a in arrays_in(v)]
