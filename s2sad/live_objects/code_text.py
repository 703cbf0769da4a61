"""The text that a code object was compiled from, and the path that it goes by.

    a file's function               the file's text as it is now, or what `linecache` holds, as for a notebook's cell
    one that was pickled by its     a text that came along (`carry`), in which there is the same code in the same line:
    content                         such a function has lost the path of its text
"""
from __future__ import annotations

import __future__

import linecache
import warnings
from collections.abc import Iterator, Mapping
from functools import lru_cache, reduce
from types import CodeType
from typing import Any

from s2sad.live_objects.unwrap import fingerprint

FUTURE = reduce(int.__or__, (getattr(__future__, n).compiler_flag for n in __future__.all_feature_names))
_carried: dict[str, str] = {}


def carry(texts: Mapping[str, str]) -> None:
    """Takes texts, by path, that came from another process."""
    for path, text in texts.items():
        _carried[path] = text
        if not linecache.getlines(path):
            linecache.cache[path] = len(text), None, text.splitlines(keepends=True), path


def text_of(code: CodeType, module: dict[str, Any] | None = None) -> tuple[str, str]:
    """The path and the text of a code object, "" if it cannot be had; `module` are the names of its module."""
    path = code.co_filename
    linecache.checkcache(path)
    text = "".join(linecache.getlines(path, module))
    if text or not path.startswith("<"):
        return path, text
    same = (place for place, known in _carried.items() if _holds(known, code.co_flags & FUTURE, code))
    place = next(same, path)
    return place, _carried.get(place, "")


def is_generated(code: CodeType) -> bool:
    """Whether a dataclass has made a function, wherever it was pickled (before Python 3.11 in this process only)."""
    return code.co_filename == "<string>" or code.co_filename.startswith("<") and getattr(
        code, "co_qualname", "").startswith("__create_fn__.")


def codes(code: CodeType) -> Iterator[CodeType]:
    """A code object and those inside it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from codes(constant)


def _holds(text: str, flags: int, code: CodeType) -> bool:
    """Whether a text has the code in the line where it was."""
    return any(c.co_name == code.co_name and c.co_firstlineno == code.co_firstlineno
               and fingerprint(c) == fingerprint(code) for c in _compiled(text, flags))


@lru_cache(maxsize=16)
def _compiled(text: str, flags: int) -> tuple[CodeType, ...]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return tuple(codes(compile(text, "<carried>", "exec", flags, dont_inherit=True)))
