"""What is remembered of a function, in a table that hangs on it.

It hangs on the function itself because what is remembered refers to the function: only so does the garbage collector
see the cycle, and a dead function frees what was derived of it (a global table with weak keys would keep both for
ever). It is no part of the function's value: pickle, cloudpickle and copy find an empty dictionary in its place.
"""
from __future__ import annotations

from types import FunctionType
from typing import Any

_NAME = "__s2sad__"


class _SideTable(dict[str, Any]):
    def __init__(self, owner: FunctionType):
        super().__init__()
        self.owner = owner

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, ()


def side_table(function: FunctionType) -> dict[str, Any]:
    """The table of a function, empty at first; a function that took over another's attributes has one of its own.

    >>> import pickle
    >>> def f(x):
    ...     return x
    >>> side_table(f)["derivatives"] = lambda: "cannot be pickled"
    >>> pickle.loads(pickle.dumps(vars(f)))
    {'__s2sad__': {}}
    """
    kept = vars(function).get(_NAME)
    if not isinstance(kept, _SideTable) or kept.owner is not function:  # functools.wraps and unpickling copy attributes
        kept = vars(function)[_NAME] = _SideTable(function)
    return kept


def looked_up(function: FunctionType, name: str) -> Any:
    """What the table of a function has under a name; None if it has nothing."""
    return side_table(function).get(name) if _NAME in vars(function) else None


def forget(function: FunctionType) -> None:
    """Drops all that is remembered of a function."""
    vars(function).pop(_NAME, None)
