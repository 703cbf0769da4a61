"""Generated text becomes a module: a real file, named by its content, in the user's cache directory.

A real file is what tracebacks, pdb and Numba's on-disk cache want. Numba's cache depends on the file's time and
size, so an intact file is never touched; a damaged one is written again, beside and renamed.
"""
from __future__ import annotations

import atexit
import hashlib
import importlib.machinery
import importlib.util
import itertools
import os
import shutil
import stat
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from types import CodeType, ModuleType

from s2sad.compiler_lock import COMPILER_LOCK

_OWN = itertools.count(1)


class _Loader(importlib.machinery.SourceFileLoader):
    """Compiles the text that was verified, and leaves no bytecode whose age could be mistaken."""

    def __init__(self, name: str, path: str, text: str):
        super().__init__(name, path)
        self._text = text

    def get_code(self, fullname: str) -> CodeType:
        # the guards are assertions: they stay under python -O
        return compile(self._text, self.path, "exec", dont_inherit=True, optimize=0)


def load(text: str, name: str, key: str = "", own: bool = False) -> ModuleType:
    """The module of a generated text; the same text, name and key give the same module.

    `key` stands for what else the compiled form depends on (engine, flags, versions): another key is another file
    in another folder, so that Numba's cache never mixes them. With `own` the module is a new one each time: it imports
    functions that may have changed.
    """
    digest = hashlib.sha256(f"{key}\0{name}\0{text}".encode()).hexdigest()[:20]
    identifier = f"s2sad_{name}_{digest}"
    with COMPILER_LOCK:
        if own:
            identifier += f"_{next(_OWN)}"
        module = sys.modules.get(identifier)
        if module is not None:
            return module
        path = _stored(text, f"{name}_{digest}.py", key)
        loader = _Loader(identifier, str(path), text)
        spec = importlib.util.spec_from_file_location(identifier, path, loader=loader)
        assert spec is not None  # a loader was given
        module = importlib.util.module_from_spec(spec)
        sys.modules[identifier] = module
        try:
            loader.exec_module(module)
        except BaseException:
            del sys.modules[identifier]
            raise
        return module


def cache_directory() -> Path:
    """The per-user folder of generated modules: $S2SAD_CACHE_DIR, else the platform's place for caches."""
    chosen = os.environ.get("S2SAD_CACHE_DIR")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "s2sad" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "s2sad"
    xdg = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(xdg) if os.path.isabs(xdg) else Path.home() / ".cache") / "s2sad"


def _stored(text: str, filename: str, key: str) -> Path:
    """The path of a file that holds exactly `text`, in the cache or, where that cannot be, in a private folder."""
    folder = f"v1-{key or 'plain'}"
    try:
        return _written(text, _private(cache_directory() / folder) / filename)
    except (OSError, RuntimeError):  # no home directory is a RuntimeError
        return _written(text, _private(Path(_temporary()) / folder) / filename)


def _private(folder: Path) -> Path:
    """The folder, made if need be; PermissionError unless it is ours and only we can write there."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if hasattr(os, "getuid"):
        found = os.lstat(folder)
        if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o022:
            raise PermissionError(f"{folder} can be written by others")
    return folder


def _written(text: str, path: Path) -> Path:
    content = text.encode()
    try:
        if path.read_bytes() == content and not path.is_symlink():
            return path
    except OSError:
        pass  # not there yet, or not readable: written below
    handle, beside = tempfile.mkstemp(prefix=path.stem, suffix=".part", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(beside, path)
    except OSError:
        Path(beside).unlink(missing_ok=True)
        # Windows cannot rename over a file that another process has just written and holds open
        if not path.is_file() or path.read_bytes() != content:
            raise
    return path


@lru_cache(maxsize=1)
def _temporary() -> str:
    folder = tempfile.mkdtemp(prefix="s2sad-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder
