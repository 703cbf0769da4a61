"""Kernels, with arguments and what is to be found of them: modules of topics, which hold nothing else.

A module's `cases()` yields a `Case` for each kernel and its arguments; tests/test_corpus.py runs all of them. A case
has right derivatives of `of` with respect to `wrt` under every engine, or is `refused` with exactly that text.
"""
from __future__ import annotations

import copy
import importlib
import inspect
import pkgutil
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Case:
    """A kernel with its arguments. `options` are `check_derivatives`'s, as rtol; a refusal says the code, the part of
    the kernel's text that is marked, and what the error says: "S201 at `del x`: del is not supported: ..."."""
    kernel: Callable[..., Any]
    arguments: tuple[Any, ...]
    wrt: str | tuple[str, ...] | None = None
    of: tuple[str, ...] | None = ("return",)
    refused: str = ""
    options: dict[str, Any] = field(default_factory=dict)


def outputs(kernel: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[str, ...]:
    """The arrays that a call changes, by their names, and `return` if it returns something."""
    given = copy.deepcopy(arguments)
    result = kernel(*given)
    changed = (name for name, before, after in zip(inspect.signature(kernel).parameters, arguments, given)
               if isinstance(before, np.ndarray) and not np.array_equal(before, after))
    return (*changed, *(("return",) if result is not None else ()))


def _modules() -> Iterator[Any]:
    for found in pkgutil.walk_packages(__path__, f"{__name__}."):
        if not found.ispkg:
            yield importlib.import_module(found.name)


def cases() -> Iterator[tuple[str, Case]]:
    """All cases by their names: the topic's and the kernel's, with a number from the second of one name on."""
    for module in _modules():
        topic, seen = module.__name__.removeprefix(f"{__name__}."), Counter()
        for case in module.cases():
            name = f"{topic}.{getattr(case.kernel, '__name__', type(case.kernel).__name__)}"
            seen[name] += 1
            yield name if seen[name] == 1 else f"{name}-{seen[name]}", case
