"""Derivatives on disk, for later processes: what a function reads, what it writes, and the generated text.

    readings of a function     the guards of a reading, in order, each as a description of what was taken there
    its summaries, texts       under the reading's address: a digest of these descriptions

A later process takes the same values on the same ways and compares them with the descriptions
(`guard_descriptions.py`). What holds is this process's reading,
and its guards are compared at each call as those of any other. What no description identifies is
not kept: a process without it derives anew. Entries are texts of a few kinds of literals; nothing in one is executed
or imported but the generated text itself, which the store vouches for.
"""
from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import platform
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from functools import cache, wraps
from types import FunctionType
from typing import Any, TypeVar

import numpy as np

from s2sad.diagnostics import HOME, warn_once
from s2sad.dispatch.guard_descriptions import NotSerializable, describe_guards, description, replay_guards
from s2sad.live_objects.guards import Guards, recording
from s2sad.infer.types import Type
from s2sad.program import (
    EntrySummary, Generated, IndexLimit, Kernel, Parameter, RecordedArray, Recording, Request, Schedule, SnapshotLoop,
    Snapshots, SourcePlace, TextGuard,
)
from s2sad.live_objects.registry import GIVEN, is_of_package
from s2sad.run import store
from s2sad.pytree import PyTree
from s2sad.live_objects.unwrap import default_values, partial_application

T = TypeVar("T")
ENABLED = True
_KIND = "derived"
_READINGS = 8           # of one function: for so many sets of constants
_WRITTEN: dict[str, type] = {c.__name__: c for c in (
    Type, PyTree, Parameter, EntrySummary, Recording, Request, Schedule, Snapshots, TextGuard, SourcePlace,
    IndexLimit, RecordedArray, SnapshotLoop)}
_FACTS = ("wrappers", "stacks", "arena", "taped", "independent", "guards", "places", "folders", "recorded", "loops",
          "forward", "taken", "tape", "index_limits", "decided_by_integers", "unwritten")


@dataclass(frozen=True)
class ReadRecord:
    """What of a program that was read its derivatives need: the entry without its text, whether calls ask what
    arguments are made of, the arrays from outside and the classes of structures that it makes by name, what was taken,
    where what is derived is kept, and what was warned of."""
    kernel: Kernel
    depends_on_structure: bool
    arrays: dict[str, Any]
    records: dict[str, type]
    guards: Guards
    address: str | None
    warned: tuple[str, ...] = ()


@dataclass(frozen=True)
class KeptResidual:
    """A residual program for arguments of some forms, without its text."""
    reading: ReadRecord
    paths: dict[str, str]
    cells: frozenset[str]
    result: Any
    changed: frozenset[str]
    mutated: frozenset[str]


def _miss_unless_complete(find: Callable[..., T]) -> Callable[..., T | None]:
    """An entry that does not hold what it should is a miss, as one that is not there."""
    @wraps(find)
    def found(*arguments: Any) -> T | None:
        try:
            return find(*arguments)
        except (ValueError, LookupError, TypeError, AttributeError):
            return None
    return found


# -- readings -------------------------------------------------------------------------------------------------------

@_miss_unless_complete
def load_reading(function: FunctionType) -> ReadRecord | None:
    """The reading of a function that holds now."""
    for described, kernel, asks, warned, *held in _readings(_place(function)):
        guards = Guards()
        found = replay_guards(described, (function,), guards)
        if found is not None:
            arrays, records = ({n: found.at(number) for n, number in part} for part in held)
            for message in warned:
                warn_once(message)
            with recording(guards):
                defaults = default_values(partial_application(function)[0])
            return ReadRecord(_kernel(kernel, defaults), asks, arrays, records, guards, _address(described, function),
                              warned)
    return None


def store_reading(reading: ReadRecord, function: FunctionType) -> None:
    """Stores a reading, before the others of its function."""
    place = _place(function)
    if place is None or reading.address is None:
        return
    described, numbers = describe_guards(reading.guards, (function,))
    held = (tuple((n, numbers[id(v)]) for n, v in part.items()) for part in (reading.arrays, reading.records))
    entry = (described, _of_kernel(reading.kernel), reading.depends_on_structure, reading.warned, *held)
    others = [e for e in _readings(place) if e[0] != described]
    _put((entry, *others[:_READINGS - 1]), place)


def _readings(place: str | None) -> list[Any]:
    found = _get(place)
    return [e for e in found if isinstance(e, tuple) and len(e) == 6] if isinstance(found, tuple) else []


def address(guards: Guards, function: FunctionType, held: Iterable[Any], kernel: Kernel) -> str | None:
    """The address under which the derivatives of a reading are kept; None where no description identifies a value."""
    if not ENABLED or guards.varying:
        return None
    try:
        described, numbers = describe_guards(guards, (function,))
        _literal(_of_kernel(kernel))
        return _address(described, function) if all(id(v) in numbers for v in held) else None
    except NotSerializable:
        return None


def _address(described: Any, function: FunctionType) -> str:
    key = f"{_surroundings()} {_text(description(function))} {_text(described)}"
    return hashlib.sha256(key.encode()).hexdigest()


def _place(function: FunctionType) -> str | None:
    try:
        return f"readings {_surroundings()} {_text(description(function))}"
    except NotSerializable:
        return None


def _of_kernel(kernel: Kernel) -> Any:
    """A kernel without its text; its defaults are those that the function has where it is loaded."""
    return (kernel.name, kernel.parameters, tuple(kernel.defaults), kernel.annotations, kernel.results, kernel.floats,
            kernel.independents, kernel.rest)


def _kernel(kept: Any, values: Mapping[str, Any]) -> Kernel:
    name, parameters, said, annotations, results, floats, independents, rest = kept
    defaults = {n: values[n] for n in said}
    return Kernel(name, None, None, parameters, defaults, annotations, results=results,  # pyright: ignore
                  floats=floats, independents=independents, rest=rest)


# -- what was derived -------------------------------------------------------------------------------------------------

def load_summary(place: str | None, types: tuple[Type, ...]) -> EntrySummary | None:
    """The summary of a kernel for arguments of these types, None if none is stored."""
    found = None if place is None else _get(f"summary {place} {_text(types)}")
    return found if isinstance(found, EntrySummary) else None


def store_summary(place: str | None, types: tuple[Type, ...], found: EntrySummary) -> None:
    if place is not None:
        _put(found, f"summary {place} {_text(types)}")


@_miss_unless_complete
def load_generated(place: str | None, request: Request) -> Generated | None:
    """The generated module that was made for a request."""
    kept = None if place is None else _get(f"text {place} {_text(request)}")
    return None if kept is None else Generated(*kept)


def store_generated(place: str | None, request: Request, found: Generated) -> None:
    """Stores a generated module, but none with facts that have no place here."""
    facts = found.facts
    if place is None or facts.get("moving") or facts.get("unshadowed"):
        return
    kept = {name: facts[name] for name in _FACTS if name in facts}
    _put((found.text, found.entry, found.parameters, found.returns, kept), f"text {place} {_text(request)}")


@_miss_unless_complete
def load_residual(reading: ReadRecord, function: FunctionType, forms: tuple[Any, ...], facts: Any
                  ) -> KeptResidual | None:
    """The residual program that was kept for arguments of these forms, of which `facts` hold."""
    place = _residual_place(reading, forms, facts)
    kept = _get(place)
    if kept is None:
        return None
    described, kernel, warned, held, paths, cells, result, changed, mutated = kept
    guards = Guards()
    found = replay_guards(described, (function, *_classes(forms, reading)), guards)
    if found is None:
        return None
    arrays = {n: found.at(number) for n, number in held}
    made = ReadRecord(_kernel(kernel, {}), False, arrays, {}, guards, _address((place, described), function), warned)
    return KeptResidual(made, paths, frozenset(cells), result, frozenset(changed), frozenset(mutated))


def store_residual(reading: ReadRecord, function: FunctionType, forms: tuple[Any, ...], facts: Any, made: KeptResidual
                   ) -> str | None:
    """Keeps a residual program; the address of what is derived of it, None where nothing identifies it elsewhere."""
    ours = made.reading
    try:
        place = _residual_place(reading, forms, facts)
        described, numbers = describe_guards(ours.guards, (function, *_classes(forms, reading)))
        if place is None or ours.guards.varying or any(id(a) not in numbers for a in ours.arrays.values()):
            return None
        held = tuple((n, numbers[id(a)]) for n, a in ours.arrays.items())
        _put((described, _of_kernel(ours.kernel), ours.warned, held, made.paths, tuple(sorted(made.cells)), made.result,
              tuple(sorted(made.changed)), tuple(sorted(made.mutated))), place)
        return _address((place, described), function)
    except NotSerializable:
        return None


def _residual_place(reading: ReadRecord, forms: tuple[Any, ...], facts: Any) -> str | None:
    try:
        return None if reading.address is None else f"residual {reading.address} {_text(forms)} {_text(facts)}"
    except NotSerializable:
        return None


def _classes(forms: Iterable[Any], reading: ReadRecord) -> tuple[type, ...]:
    """The classes of structures, those of arguments and those that the kernel makes, each once, in order."""
    found: dict[type, None] = {}
    waiting = list(forms)
    while waiting:
        form = waiting.pop()
        if isinstance(form, PyTree):
            found |= {} if form.made is None else {form.made: None}
            waiting += form.items
    return tuple(found | dict.fromkeys(reading.records.values()))


# -- what a text depends on beside what was taken ----------------------------------------------------------------------

@cache
def _package() -> str:
    """What this package is: its files, and the versions of what they use."""
    key = repr((_package_files(), platform.python_version(), np.__version__))
    return hashlib.sha256(key.encode()).hexdigest()


def _package_files() -> list[tuple[str, int, int]]:
    """The paths, times and sizes of this package's modules."""
    files, waiting = [], [HOME]
    while waiting:
        with os.scandir(waiting.pop()) as entries:
            for entry in entries:
                if entry.is_dir() and entry.name != "__pycache__":
                    waiting.append(entry.path)
                elif entry.name.endswith(".py"):
                    files.append((entry.path, entry.stat().st_mtime_ns, entry.stat().st_size))
    return sorted(files)


def _surroundings() -> str:
    """All that a text depends on beside what the function reads: versions, and functions that have a derivative of the
    user's own."""
    own = sorted(p for p in GIVEN.by_path if not is_of_package(p))
    return f"{_package()} {_installed('numba')} {_installed('scipy')} {own}"


@cache
def _installed(package: str) -> tuple[Any, ...]:
    """Which installation of a package there is, which need not be imported."""
    found = importlib.util.find_spec(package)
    if found is None or found.origin is None:
        return ()
    status = os.stat(found.origin)
    return found.origin, status.st_mtime_ns, status.st_size


# -- literals ---------------------------------------------------------------------------------------------------------

def _get(place: str | None) -> Any:
    found = None if place is None or not ENABLED else store.get(place, _KIND)
    return None if found is None else _loaded(found)


def _loaded(data: bytes) -> Any:
    try:
        return _value(json.loads(data))
    except (ValueError, LookupError, TypeError, AttributeError):
        return None


def _put(value: Any, place: str) -> None:
    try:
        store.put(place, _text(value).encode(), _KIND)
    except NotSerializable:
        return


def _text(value: Any) -> str:
    return json.dumps(_literal(value), separators=(",", ":"))


def _literal(value: Any) -> Any:
    """A value as JSON: [kind, content] for all but None, bools, whole numbers and strings. Raises NotSerializable."""
    if value is None or type(value) in (bool, int, str):
        return value
    if type(value) in (float, complex):
        return [type(value).__name__, repr(value)]
    if value is Ellipsis:
        return ["..."]
    if type(value) in (tuple, list):
        return [type(value).__name__, *map(_literal, value)]
    if type(value) is dict:
        return ["dict", *([_literal(k), _literal(v)] for k, v in value.items())]
    if isinstance(value, type):
        return ["class", value.__module__, value.__qualname__]
    if type(value).__name__ in _WRITTEN and type(value) is _WRITTEN[type(value).__name__]:
        return [type(value).__name__, *(_literal(getattr(value, f.name)) for f in fields(value))]
    raise NotSerializable


def _value(found: Any) -> Any:
    """The value of a JSON entry; raises LookupError for a class that is not there."""
    if not isinstance(found, list):
        return found
    kind, *rest = found
    if kind in ("float", "complex"):
        return {"float": float, "complex": complex}[kind](rest[0])
    if kind in ("tuple", "list"):
        items = map(_value, rest)
        return tuple(items) if kind == "tuple" else list(items)
    if kind == "dict":
        return {_value(k): _value(v) for k, v in rest}
    if kind == "...":
        return Ellipsis
    if kind == "class":
        made: Any = sys.modules[rest[0]]
        for name in rest[1].split("."):
            made = getattr(made, name)
        return made
    return _WRITTEN[kind](*map(_value, rest))
