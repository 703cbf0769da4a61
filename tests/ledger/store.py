"""The store: kernels as they were when the compiler was asked for them, independent of tests and of the package.

A function is pickled by its content, as are the classes and objects of tests that it reads, with the texts of the
files that they were read from. Types and structures of arguments are written by their fields.
"""
from __future__ import annotations

import dataclasses
import gzip
import importlib
import io
import linecache
import pickle
import pkgutil
import re
import sys
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import cloudpickle

import s2sad
from s2sad.infer.types import Type
from s2sad.live_objects.code_text import carry
from s2sad.pytree import PyTree
from tests.ledger.identity import source_of

Asked = tuple[str, tuple[str, ...], tuple[str, ...], bool]     # mode, wrt, of, with the primal's result
ANYTHING: Asked = ("", (), (), False)     # of a kernel that was refused before all of it was known
_INSTALLED = ("site-packages", "dist-packages")
_LIBRARY = str(Path(pickle.__file__).parent)
_WORD = re.compile(r"\w+")
_by_content: set[str] = set()


@dataclass
class Kernel:
    """A kernel for arguments of some types. `pickled` is written by `pickled`; `texts` has the digest of each file's
    text by path; `file` is the path where it is read from a file that is not run; one that `registers` derivatives of
    the user's is replayed in a process of its own."""
    identity: str
    name: str
    pickled: bytes
    texts: dict[str, str]
    file: str = ""
    registers: bool = False
    places: set[str] = field(default_factory=set)
    asked: set[Asked] = field(default_factory=set)


@dataclass
class Store:
    """All kernels by their identity, and the texts of files by their digests."""
    kernels: dict[str, Kernel] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)

    def write(self, path: str) -> None:
        rows = [(k.identity, k.name, k.pickled, k.texts, k.file, k.registers, sorted(k.places), sorted(k.asked))
                for _, k in sorted(self.kernels.items())]
        with gzip.open(path, "wb", compresslevel=6) as file:
            pickle.dump((rows, self.texts), file)

    @classmethod
    def read(cls, path: str) -> Store:
        with gzip.open(path, "rb") as file:
            rows, texts = pickle.load(file)
        found = [Kernel(*row[:6], set(row[6]), set(row[7])) for row in rows]
        return cls({k.identity: k for k in found}, texts)

    def add(self, other: Store) -> None:
        """Takes over what another process has collected."""
        self.texts.update(other.texts)
        for identity, kernel in other.kernels.items():
            known = self.kernels.setdefault(identity, kernel)
            known.places |= kernel.places
            known.asked |= kernel.asked


# -- to bytes -------------------------------------------------------------------------------------------------------

def type_of(*fields: Any) -> Type:
    return Type(*fields)


def structure_of(*fields: Any) -> PyTree:
    return PyTree(*fields)


def missing() -> Any:
    return dataclasses.MISSING


def compiled_of(function: FunctionType) -> Any:
    import numba
    return numba.njit(function)


class _Pickler(cloudpickle.CloudPickler):
    """Notes the functions that it writes."""

    def __init__(self, file: io.BytesIO):
        super().__init__(file)
        self.functions: list[FunctionType] = []

    def reducer_override(self, obj: Any) -> Any:    # the name is pickle's
        if type(obj) is Type:
            return type_of, (obj.kind, obj.dtype, obj.rank, obj.items, obj.ones)
        if type(obj) is PyTree:
            return structure_of, (obj.kind, obj.keys, obj.items, obj.made, obj.fixed)
        if isinstance(obj, FunctionType) and obj.__module__ == __name__:
            return obj.__name__     # by name, although what is written of tests is written by its content
        if isinstance(obj, FunctionType):
            self.functions.append(obj)
        if isinstance(obj, ModuleType) and not is_foreign(obj.__name__):
            return importlib.import_module, (obj.__name__,)
        if obj is dataclasses.MISSING:
            return missing, ()
        if type(obj).__name__ == "CPUDispatcher":
            return compiled_of, (obj.py_func,)
        return super().reducer_override(obj)


def pickled(value: Any) -> tuple[bytes, list[FunctionType]]:
    """A value in bytes, and the functions in it."""
    for name in [n for n in list(sys.modules) if n not in _by_content]:
        _by_content.add(name)
        if is_foreign(name):
            cloudpickle.register_pickle_by_value(sys.modules[name])
    target = io.BytesIO()
    pickler = _Pickler(target)
    pickler.dump(value)
    return target.getvalue(), pickler.functions


def decorating(functions: list[FunctionType]) -> list[tuple[FunctionType, dict[str, Any]]]:
    """What the names in the decorators of functions mean: nothing in their code mentions these, but they are read."""
    found = []
    for function in functions:
        head = source_of(function).partition("def ")[0]
        names = set(_WORD.findall(head)) & set(function.__globals__)
        if names:
            found.append((function, {n: function.__globals__[n] for n in sorted(names)}))
    return found


def texts_of(functions: list[FunctionType]) -> dict[str, str]:
    """The texts of the files of functions, by path."""
    files = dict.fromkeys(f.__code__.co_filename for f in functions)
    texts = {path: "".join(linecache.getlines(path)) for path in files if not _is_installed(path)}
    return {path: text for path, text in texts.items() if text}


def is_foreign(name: str) -> bool:
    """Whether a module is neither installed nor the package's nor this folder's."""
    file = getattr(sys.modules.get(name), "__file__", None) or ""
    return file.endswith(".py") and not _is_installed(file) and name.partition(".")[0] != "s2sad" and not (
        name.startswith(__name__.rpartition(".")[0]))


def _is_installed(path: str) -> bool:
    return path.startswith(_LIBRARY) or any(part in path for part in _INSTALLED)


# -- and back -------------------------------------------------------------------------------------------------------

class _Unpickler(pickle.Unpickler):
    """Finds what the package has moved to another module under its name there."""

    def find_class(self, module: str, name: str) -> Any:
        if name in ("type_of", "structure_of", "compiled_of", "missing"):
            return globals()[name]
        if module.partition(".")[0] != "s2sad":
            return super().find_class(module, name)
        there = next((m for m in _modules() if m.__name__ == module), None)
        return getattr(there, name) if hasattr(there, name) else _moved(name)


def _moved(name: str) -> Any:
    found = {id(v): v for v in (vars(m).get(name) for m in _modules())
             if getattr(v, "__module__", "").startswith("s2sad")}
    if len(found) != 1:
        raise AttributeError(f"the package has {len(found)} of '{name}', and none where it was")
    return next(iter(found.values()))


@cache
def _modules() -> list[Any]:
    """All modules of the package that is on the path; what is installed beside it may have others."""
    names = [m.name for m in pkgutil.walk_packages(s2sad.__path__, "s2sad.") if not m.name.endswith("__main__")]
    return [s2sad, *map(importlib.import_module, names)]


def unpickled(kernel: Kernel, texts: dict[str, str]) -> Any:
    """What is asked of a kernel; the texts of its functions are where `linecache` looks for them."""
    for path, known in kernel.texts.items():
        text = texts[known]
        linecache.cache[path] = len(text), None, text.splitlines(keepends=True), path
        carry({path: text})
    *asking, decorators = _Unpickler(io.BytesIO(kernel.pickled)).load()
    for function, names in decorators:
        function.__globals__.update(names)
    return asking
