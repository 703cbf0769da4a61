"""A function for many inputs: what it gives for each of them, along one more axis, the first.

Inputs are independent of each other, so threads share them, each with tapes of its own; what is computed for one is
what it is alone, whatever the number of threads.
"""
from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import misfit
from s2sad.dispatch.cache import derivatives_of
from s2sad.interface.differentiate import Differentiated
from s2sad.interface.drivers import Gradient, ValueAndGradient
from s2sad.interface.pickling import Decorated
from s2sad.interface.pytrees import flat_call
from s2sad.interface.pytrees.flat_batches import changed_floats
from s2sad.interface.selection import Wrt, names_of
from s2sad.interface.value_calls import selection_of
from s2sad.live_objects.unwrap import apply_functions, python_function
from s2sad.pytree import PyTree, form_of, map_leaves
from s2sad.run.compiled import chosen
from s2sad.run.tracebacks import public


@public
def batched(f: Callable[..., Any], over: Wrt, *, workers: int | None = None) -> Batched:
    """A function of f's arguments that gives what f does for many inputs: those named have one more axis, the first.

    Args: f, a function, or what is made of one: `gradient(f)`, `value_and_gradient(f)`, `jacobian(f)`, `ode(f)`; over,
    names or positions of parameters: arrays of shape (k, ...), of a number one of k of them, in structures all arrays
    of floats; workers, how many threads share the inputs (default: as many as there are processors where derivatives
    are compiled, else one). Results have that axis, too: arrays of shape (k, ...), numbers as an array of k, tuples,
    dicts and structures of such; all others of f's arguments are the same for each input. Arguments are never changed.
    Raises S2sadError: S401 (over names no parameter; f returns nothing), S403 (unequal numbers of inputs, or results of
    unequal shapes; none, where only a run tells their shape), S405 (workers that are none); and what f raises for the
    first input for which it does.

    >>> import numpy as np
    >>> from s2sad import gradient
    >>> def energy(u, k):
    ...     total = 0.0
    ...     for i in range(u.size):
    ...         total += k * u[i] ** 2
    ...     return total
    >>> batched(gradient(energy, "u"), over="u")(np.array([[1.0, 2.0], [3.0, 4.0]]), 0.5)
    array([[1., 2.],
           [3., 4.]])
    >>> batched(energy, over="k")(np.ones(2), np.array([1.0, 2.0, 3.0]))
    array([2., 4., 6.])
    """
    return Batched(f, over, workers)


class Batched(Decorated):
    """f for many inputs; see `batched`."""

    def __init__(self, f: Any, over: Wrt, workers: int | None = None):
        self.__wrapped__, self._workers = f, workers
        self._kernel = f.__wrapped__ if isinstance(f, Decorated) and not isinstance(f, Differentiated) else f
        function = python_function(self._kernel)
        if function is None:
            raise S2sadError(Diagnostic("S401", f"{f!r} is no function of Python's", help="give the kernel itself"))
        self._signature, self._title = inspect.signature(function), function.__name__
        self.over: tuple[str, ...] = names_of(over, self._kernel, "over") or ()
        known = list(self._signature.parameters)
        for name in self.over:
            if name not in known:
                raise S2sadError(Diagnostic("S401", f"over names '{name}', which is no parameter of '{self._title}'",
                                            help=f"its parameters are {', '.join(known)}"))
        if not self.over:
            raise S2sadError(Diagnostic("S401", "over names no parameter", help=f'over="{known[0]}"' if known else ""))
        if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 1):
            raise S2sadError(Diagnostic("S405", f"there are no {workers!r} workers", help="give how many threads: 2"))
        self.__name__ = self.__qualname__ = f"batched_{self._title}"
        self.__module__, self.__doc__ = getattr(f, "__module__", __name__), f"'{self._title}' for many inputs."

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self.__wrapped__, self.over, self._workers

    def __repr__(self) -> str:
        return f"<{self._title} over {', '.join(self.over)}>"

    @public
    def __call__(self, *args: Any, **keywords: Any) -> Any:
        bound = self._signature.bind(*args, **keywords)
        bound.apply_defaults()
        values = dict(bound.arguments)
        count = self._count(values)
        if count == 0:
            return self._of_none(values)
        copied, apart = self._written(values)
        first = self._run(values, 0, copied)        # what must be derived is, once
        rest, threads = range(1, count), min(self._threads, count - 1) if apart else 1
        if threads <= 1:
            return _joined([first, *(self._run(values, k, copied) for k in rest)], self._title)
        with ThreadPoolExecutor(threads) as pool:
            parts = [rest[k * len(rest) // threads:(k + 1) * len(rest) // threads] for k in range(threads)]
            found = list(pool.map(lambda part: [self._run(values, k, copied) for k in part], parts))
        return _joined([first, *(f for part in found for f in part)], self._title)

    @property
    def _threads(self) -> int:
        if self._workers is not None:
            return self._workers
        if chosen(selection_of(self._kernel).engine) == "numpy":
            return 1
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

    def _count(self, values: dict[str, Any]) -> int:
        """How many inputs there are, of each name as many."""
        counts: dict[str, int] = {}
        for name in self.over:
            def counted(leaf: np.ndarray, name: str = name) -> np.ndarray:
                if counts.setdefault(name, len(leaf)) != len(leaf):
                    raise misfit(f"parts of '{name}' have {counts[name]} inputs and {len(leaf)}",
                                 "give all of them as many")
                return leaf
            _with_axis(values[name], counted)
            if name not in counts:
                raise misfit(f"'{name}' has no axis of inputs: it is {_described(values[name])}",
                             "give an array of shape (k, ...), k inputs")
        first = self.over[0]
        for name, count in counts.items():
            if count != counts[first]:
                raise misfit(f"'{first}' has {counts[first]} inputs, '{name}' has {count}", "give all of them as many")
        return counts[first]

    def _given(self, values: dict[str, Any], k: int) -> dict[str, Any]:
        """The arguments for one input."""
        return {n: _with_axis(v, lambda leaf: _one(leaf, k)) if n in self.over else v for n, v in values.items()}

    def _run(self, values: dict[str, Any], k: int, copied: Collection[str]) -> Any:
        """What f gives for one input, with copies of some arguments."""
        given = self._given(values, k)
        if self._primal is None:
            return self.__wrapped__(*given.values())
        found = self._primal.primal(*(_copy(v) if n in copied else v for n, v in given.items()))
        if found is None:
            raise S2sadError(Diagnostic("S401", f"'{self._title}' returns nothing",
                                        help="write a function that returns what it computes"))
        return found

    @cached_property
    def _primal(self) -> Differentiated[..., Any] | None:
        f = self.__wrapped__
        if isinstance(f, Decorated) and not isinstance(f, Differentiated):
            return None
        return f if isinstance(f, Differentiated) else Differentiated(f)

    def _written(self, values: dict[str, Any]) -> tuple[Collection[str], bool]:
        """The arguments of the caller's that f writes, and whether calls of it write nothing else that they share."""
        if self._primal is None:
            return (), True
        given = self._given(values, 0)
        f, args, _ = apply_functions(self._primal, tuple(given.values()), {})
        state, flat, _ = flat_call(derivatives_of(f).state(), f, args)
        written = state.summary(state.types(flat)).written
        owned = [n for n, v in given.items() if n in self.over and isinstance(v, np.ndarray)]
        named = written if {*state.parameters} <= {*given} else given       # else they are parts of structures
        return [n for n in given if n in named and n not in owned], {*written} <= {*state.parameters}

    def _of_none(self, values: dict[str, Any]) -> Any:
        """What comes of no input: gradients have the shape of what they are with respect to."""
        f = self.__wrapped__
        if not isinstance(f, (Gradient, ValueAndGradient)):
            raise misfit(f"there is no input of '{self._title}', and only a run tells the shape of what it returns",
                         "give one, or take its gradient")
        given = {n: _with_axis(v, lambda leaf: _one(np.zeros((1, *leaf.shape[1:]), leaf.dtype), 0))
                 if n in self.over else v for n, v in values.items()}
        zeros: Callable[..., Any] = f.zeros
        return _with_axis(_joined([zeros(*given.values())], self._title), lambda leaf: leaf[:0], tuples=True)


def _described(value: Any) -> str:
    return f"an array of shape {value.shape}" if isinstance(value, np.ndarray) else f"of type {type(value).__name__}"


def _with_axis(value: Any, change: Callable[[np.ndarray], Any], tuples: bool = False) -> Any:
    """What is given, with something in place of an array, or of the arrays of floats of a structure."""
    if tuples and isinstance(value, tuple):
        return tuple(_with_axis(v, change, tuples) for v in value)
    return change(value) if isinstance(value, np.ndarray) and value.ndim else changed_floats(value, change)


def _one(leaf: np.ndarray, k: int) -> Any:
    """One input, in memory of its own."""
    found = np.array(leaf[k], order="C")
    return found if found.ndim else found.item()


def _copy(value: Any) -> Any:
    """A structure with arrays of its own."""
    if isinstance(value, np.ndarray):
        return np.array(value, order="C")
    form = form_of(value, "")
    return map_leaves(form, value, "", lambda _, kind, leaf: _copy(leaf) if isinstance(leaf, np.ndarray) else leaf
                      ) if isinstance(form, PyTree) else value


def _joined(values: Sequence[Any], title: str, inside: bool = False) -> Any:
    """The results for all inputs as one with one more axis; what is `inside` a structure and no float is as it was."""
    first = values[0]
    if type(first) is dict:
        return {n: _joined([v[n] for v in values], title, inside) for n in first}
    if type(first) in (tuple, list):
        return type(first)(_joined(items, title, inside) for items in zip(*values))
    numbers = (float, complex, np.inexact) if inside else (int, float, complex, np.generic)
    if isinstance(first, (np.ndarray, *numbers)):
        shapes = sorted({np.shape(v) for v in values})
        if len(shapes) > 1:
            raise misfit(f"'{title}' gives arrays of shapes {shapes[0]} and {shapes[1]}", "call it for each input")
        return np.array(values)
    form = form_of(first, "") if first is not None and not hasattr(first, "tocsr") else None
    if not isinstance(form, PyTree):
        if first is None or inside:
            return first
        raise misfit(f"'{title}' gives what has no axis of inputs, of type {type(first).__name__}",
                     "call it for each input")
    leaves: list[list[Any]] = [[] for _ in values]
    for mine, value in zip(leaves, values):
        map_leaves(form, value, "", lambda _, kind, leaf, mine=mine: mine.append(leaf))
    joined = iter([_joined(of_all, title, True) for of_all in zip(*leaves)])
    return map_leaves(form, first, "", lambda *_: next(joined))
