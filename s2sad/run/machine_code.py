"""Numba's machine code in our store: what Numba unpickles was put there by this user, and is what was put.

Numba's own cache unpickles files beside the source, or wherever NUMBA_CACHE_DIR says, whoever wrote them; they have no
checksum, and an error while one is written is raised. A dispatcher takes any object with a cache's methods.
"""
from __future__ import annotations

import importlib
import pickle
from typing import Any

from s2sad.run import store

_KIND = "code"


class MachineCode:
    """The cache of one dispatcher: an entry for each signature, under all that its machine code depends on: `module`,
    the name of a generated module, is a digest of its text, the flags and the versions; the processor is added here."""

    cache_path = None

    def __init__(self, module: str, function: str, numba: Any):
        self._owner, self._numba = f"{module}.{function}", numba

    def load_overload(self, signature: Any, target_context: Any) -> Any:
        """The compiled function for a signature, None if there is none."""
        target_context.refresh()
        key = self._key(signature, target_context.codegen())
        data = None if key is None else store.get(key, _KIND)
        if data is None:
            return None
        try:
            return self._numba.compiler.CompileResult._rebuild(target_context, *pickle.loads(data))
        except Exception:  # of another Numba than its version says: compiled anew
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keeps a compiled function, unless it holds addresses of this process."""
        key = self._key(signature, result.codegen)
        if key is None or result.library.has_dynamic_globals or not all(part.can_cache for part in result.lifted):
            return
        try:
            data = self._numba.serialize.dumps(result._reduce())
        except Exception:  # what cannot be pickled is not kept
            return
        store.put(key, data, _KIND)

    def enable(self) -> None:
        """Part of Numba's interface; it is always enabled."""

    disable = flush = enable

    def _key(self, signature: Any, codegen: Any) -> str | None:
        """None for types that have no name which another process gives to nothing else."""
        if not isinstance(signature, tuple) or not all(map(self._is_plain, signature)):
            return None
        return f"{self._owner} {signature!r} {codegen.magic_tuple()!r}"

    def _is_plain(self, kind: Any) -> bool:
        types = self._numba.types
        if isinstance(kind, types.BaseTuple):
            return all(map(self._is_plain, kind))
        return isinstance(kind, (types.Number, types.Boolean, types.NoneType)) or (
            isinstance(kind, types.Array) and self._is_plain(kind.dtype))


def stored(dispatcher: Any, module: str) -> Any:
    """The dispatcher of a function of a generated module, with its machine code in the store; as it is under a Numba
    that does not have what this takes."""
    numba = importlib.import_module("numba.core")
    for name in ("compiler", "serialize", "types"):
        importlib.import_module(f"numba.core.{name}")
    parts = ((dispatcher, "_cache"), (numba.compiler.CompileResult, "_rebuild"),
             (numba.compiler.CompileResult, "_reduce"), (numba.serialize, "dumps"))
    if all(hasattr(place, name) for place, name in parts):
        dispatcher._cache = MachineCode(module, dispatcher.py_func.__qualname__, numba)
    return dispatcher
