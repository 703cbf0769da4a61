"""What guards took, as descriptions that mean the same in every process.

    code            what it does, where it stands, the text of its file
    numbers         by value, as strings, tuples, frozensets and members of enumerations
    arrays          by type
    all else        by what it is called; what it holds was taken on its own

Of two things that are called alike a process may read now this one, now that one: what was met before is described as
that (`again`), so that the descriptions tell what is one object and what is two.
"""
from __future__ import annotations

import hashlib
from collections.abc import Sequence
from enum import Enum
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from s2sad.live_objects.code_text import text_of
from s2sad.live_objects.guards import ABSENT, STEPS, Guards, VaryingNumber, layout, reached, recording, taken
from s2sad.live_objects.registry import GIVEN
from s2sad.live_objects.unwrap import fingerprint

Number = Any            # of a value: of the place where it was taken; of an item of a tuple (place, item, ...)
_LONGEST = 4096         # items of a list: more are not written out
_FOLLOWING = frozenset((    # steps that follow from what was taken
    "root", "function", "kernel", "given", "bound", "combined", "part"))
_BUFFERS = (bytes, bytearray, memoryview, range, slice, set, frozenset)


class NotSerializable(Exception):
    """A value that no description identifies in another process."""


class Descriptions:
    """Values in the order in which they were taken, after the roots, whose numbers are negative."""

    def __init__(self, roots: Sequence[Any] = ()) -> None:
        self.roots, self.values = roots, list[Any]()
        self.numbers: dict[int, Number] = {id(root): -2 - k for k, root in enumerate(roots)} | {id(None): -1}

    def add(self, value: Any) -> Any:
        """The description of the next value; raises NotSerializable where none identifies it."""
        self.values.append(value)
        return self._describe(value, len(self.values) - 1)

    def at(self, number: Number) -> Any:
        """The value of a number."""
        if isinstance(number, tuple):
            found = self.values[number[0]]
            for place in number[1:]:
                found = found[place]
            return found
        return None if number == -1 else self.roots[-2 - number] if number < -1 else self.values[number]

    def _describe(self, value: Any, number: Number) -> Any:
        if isinstance(value, tuple):
            self.numbers.setdefault(id(value), number)
            if len(value) > _LONGEST:
                raise NotSerializable
            way = number if isinstance(number, tuple) else (number,)
            return "tuple", *_class(type(value)), *(self._describe(v, (*way, k)) for k, v in enumerate(value))
        known = self.numbers.setdefault(id(value), number)
        plain = plain_description(value)
        if plain is not None:
            return plain
        return _named(value) if known == number else ("again", known)


def describe_guards(guards: Guards, roots: Sequence[Any]) -> tuple[tuple[Any, ...], dict[int, Number]]:
    """What was taken, each as (the number of its holder, step, key, description), and the numbers of the values.
    Raises NotSerializable."""
    made, found = Descriptions(roots), []
    for guard in guards.places.values():
        if guard.step == "root":
            continue
        if id(guard.holder) not in made.numbers:
            raise NotSerializable
        found.append((made.numbers[id(guard.holder)], guard.step, guard.key, made.add(guard.value)))
    return tuple(found), made.numbers


def replay_guards(described: Any, roots: Sequence[Any], guards: Guards) -> Descriptions | None:
    """The values that are taken on the ways that are described; None if one of them is not what is described."""
    made = Descriptions(roots)
    with recording(guards):
        for number, root in enumerate(roots):
            reached(None, "root", number, root)
        for holder, step, key, description in described:
            if step not in STEPS:
                return None
            start = made.at(holder)
            if step in _FOLLOWING:
                value = STEPS[step](start)(key, ABSENT)
                reached(start, step, key, value)
            else:
                value = taken(start, step, key)
            try:
                if made.add(value) != description:
                    return None
            except NotSerializable:
                return None
    return made


def description(value: Any) -> Any:
    """The description of a value alone."""
    return Descriptions().add(value)


def plain_description(value: Any) -> Any:
    """The description of what one value of is as good as another; None of all else.

    >>> plain_description(0.5), plain_description(frozenset((1,))), plain_description([])
    (('value', 'builtins', 'float', '0.5'), ('frozenset', ('value', 'builtins', 'int', '1')), None)
    """
    if value is ABSENT:
        return ("absent",)
    if value is None or isinstance(value, (int, float, complex, str, np.generic)):
        return "value", *_class(type(value)), _content(value)
    if isinstance(value, CodeType):
        return "code", _of_code(value)
    if isinstance(value, ModuleType):
        return "module", value.__name__
    if isinstance(value, Enum):
        return "member", *_class(type(value)), str(value._name_), _of_member(value._value_)
    return ("frozenset", *sorted(map(_fixed, value), key=repr)) if type(value) is frozenset else None


def _fixed(value: Any) -> Any:
    """The description of an item that nothing took on its own; raises NotSerializable of what may change."""
    found = ("tuple", *map(_fixed, value)) if type(value) is tuple else plain_description(value)
    if found is None:
        raise NotSerializable
    return found


def _of_member(value: Any) -> Any:
    """What a member of an enumeration is; what a list or an object there holds was taken on its own."""
    try:
        return _fixed(value)
    except NotSerializable:
        return _class(type(value))


def _named(value: Any) -> Any:
    """What a thing is called that is no plain value."""
    if isinstance(value, FunctionType):
        if GIVEN.by_identity.get(id(value)) is not None:
            raise NotSerializable
        return "function", value.__module__, value.__qualname__, _of_code(value.__code__)
    if isinstance(value, type):
        return "class", *_class(value)
    if isinstance(value, np.ndarray):
        dtype, *ones = layout(value)
        return "array", type(value).__name__, dtype.str, tuple(ones)
    if isinstance(value, (VaryingNumber, *_BUFFERS)):
        raise NotSerializable
    names = [n if isinstance(n := getattr(value, a, None), str) else "" for a in ("__module__", "__name__")]
    return "object", *_class(type(value)), *(names if callable(value) else ())


def _class(made: type) -> tuple[str, str]:
    return made.__module__, made.__qualname__


def _content(value: Any) -> str:
    """The literal of a number or string, whatever a class of the user's makes of `repr`."""
    if isinstance(value, np.generic):
        return f"{value.dtype.str} {value.tobytes().hex()}"
    plain: Any = next((c for c in (bool, int, float, complex, str) if isinstance(value, c)), type(None))
    return plain.__repr__(value)


def _of_code(code: CodeType) -> str:
    """What a code object does, where it stands, and the text around it, which generated files quote."""
    path, text = (code.co_filename, "") if code.co_filename == "<string>" else text_of(code)
    key = repr((fingerprint(code), path, code.co_firstlineno)) + text
    return hashlib.sha256(key.encode()).hexdigest()
