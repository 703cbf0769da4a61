"""compiled: the Numba engine: every function of a generated module becomes a compiled one, in the module's namespace.

NumPy's error model for floats everywhere (`error_model`), fastmath nowhere, primal and derivatives with the same flags.
What machine code depends on beside the module's text (the runtime's text, flags, versions) is part of the module's
name, under which it is kept on disk.
"""
from __future__ import annotations

import ast
import hashlib
import importlib
import importlib.util
import os
import platform
import threading
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache, lru_cache, partial
from importlib import metadata
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

from s2sad.deep_stack import deep_stack
from s2sad.diagnostics import Diagnostic, S2sadError, warn_once
from s2sad.extras import absent
from s2sad.run.progress import Working
from s2sad.run.internal_functions import DISTINCT, options, without_integer_literals, written_out
from s2sad.run.interrupts import interruptible
from s2sad.run.interpreter import DTYPES, interpreted
from s2sad.run.module_loader import load
from s2sad.run.machine_code import stored
from s2sad.run.special_functions import register, used
from s2sad.run.through_python import through_python
from s2sad.run.unsigned_elements import Known, unsigned_elements

_RUNTIME = "s2sad.runtime"
_UNROLLED = "__unrolled__"
_ANY_ORDER = {"added"}  # sums whose compiled form may be reassociated
_CHECKED: ContextVar[bool] = ContextVar("s2sad_bounds_checked", default=False)


@lru_cache(maxsize=1)
def available() -> bool:
    """Whether Numba can be imported."""
    return importlib.util.find_spec("numba") is not None


def chosen(engine: str) -> str:
    """"numpy" or "numba" for "auto", "numpy" or "numba"; S2sadError if Numba is requested and absent."""
    if engine == "auto":
        return "numba" if available() else "numpy"
    if engine == "numba" and not available():
        raise absent("numba", 'engine="numba"', 'use engine="auto"')
    if engine not in ("numpy", "numba"):
        raise S2sadError(Diagnostic("S405", f"there is no engine {engine!r}", help='use "auto", "numpy" or "numba"'))
    return engine


def always_checked() -> bool:
    """Whether $S2SAD_BOUNDSCHECK or `bounds_checked` requests bounds checks in everything that is compiled."""
    return _CHECKED.get() or os.environ.get("S2SAD_BOUNDSCHECK", "0") not in ("", "0")


@contextmanager
def bounds_checked() -> Iterator[None]:
    """Everything that is compiled inside checks its indices."""
    token = _CHECKED.set(True)
    try:
        yield
    finally:
        _CHECKED.reset(token)


def compiled(text: str, name: str, *, bounds: bool = False, plain: tuple[str, ...] = (),
             user_functions: bool = False, guards: Collection[int] = (), entries: Collection[str] = (),
             unrolled: bool = False, distinct: Collection[str] = (), known: Mapping[str, Known] | None = None
             ) -> ModuleType:
    """The module of `text` with its functions compiled (lazily, when first called); those in `plain` are left. Python
    calls those in `entries` (all of them if it is empty). If it is `unrolled`, LLVM makes vectors of neighbouring
    operations, too: of loops that it has written out. It is told that arrays given to those in `distinct` share no
    memory. Where something is `known` of the parameters of the entries, indices that are never negative are unsigned.

    With `user_functions` it imports functions of the user: these are compiled too, and nothing is kept on disk, for
    the text stays the same when they change. Nor is a module that calls what the interpreter runs, which lives as
    long as the process.
    """
    bounds = bounds or always_checked()
    key = f"{_key(bounds)}{'-unrolled' * unrolled} {sorted(distinct)}{sorted(known.items()) if known else ''}"
    change = partial(unsigned_elements, entries=entries, given=known) if known else None
    module = load(text, name, key, own=user_functions, guards=guards, change=change)
    if not getattr(module, "__compiled__", False):
        space = vars(module)
        register(used(space))
        on_disk = not user_functions and not any(map(_is_interpreted, space.values()))
        inlined = written_out(text)
        for identifier, value in list(space.items()):
            if not isinstance(value, FunctionType) or identifier in plain:
                continue
            if value.__module__ == module.__name__:
                internal = bool(entries) and identifier not in entries and not user_functions
                space[identifier] = _jit(value, bounds, on_disk=on_disk, inline=internal and identifier in inlined,
                                         internal=internal)
            elif (value.__module__ or "").startswith(_RUNTIME):
                space[identifier] = _runtime(value.__module__, bounds)[value.__name__]
            elif user_functions:
                space[identifier] = _jit(value, bounds, on_disk=False)
        space["__compiled__"], space[_UNROLLED], space[DISTINCT] = True, unrolled, frozenset(distinct)
    return module


def quiet(text: str) -> str:
    """A text without its `print` statements, line for line: for a run that only looks whether indices stay in bounds.

    >>> quiet("def f(x):\\n    print(x)\\n    return x")
    'def f(x):\\n    pass\\n    return x'
    """
    if "print(" not in text:
        return text
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        call = node.value if isinstance(node, ast.Expr) else None
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "print":
            last = node.end_lineno or node.lineno       # pyright: ignore[reportAttributeAccessIssue]
            lines[node.lineno - 1:last] = [" " * node.col_offset + "pass", *[""] * (last - node.lineno)]  # pyright: ignore
    return "\n".join(lines)


def prepare(dispatcher: Any, args: Sequence[Any], what: str) -> None:
    """Compiles a function for the types of `args`, or takes its machine code from the store; runs nothing. Numba
    follows a function's blocks by recursion."""
    if not hasattr(dispatcher, "typeof_pyval"):
        return
    numba_errors = importlib.import_module("numba.core.errors")
    signature = tuple(map(dispatcher.typeof_pyval, args))
    try:
        with _reported(dispatcher, what), interruptible(), _vectors_of_neighbours(
                dispatcher.py_func.__globals__.get(_UNROLLED, False)):
            deep_stack(dispatcher.compile)(signature)
    except numba_errors.NumbaError as error:
        reason = str(error).strip()
        raise S2sadError(Diagnostic("S901", f"internal error: Numba cannot compile {what}", note=reason,
                                    help='engine="numpy" runs the same text without Numba')) from error


@contextmanager
def _vectors_of_neighbours(wanted: bool) -> Iterator[None]:
    """Whether LLVM makes vectors of operations beside each other in what is compiled inside."""
    config: Any = importlib.import_module("numba.core.config")
    before = config.SLP_VECTORIZE
    config.SLP_VECTORIZE = int(wanted or before)
    try:
        yield
    finally:
        config.SLP_VECTORIZE = before


@contextmanager
def _reported(dispatcher: Any, what: str) -> Iterator[None]:
    """Reports each function that is compiled on the way to one."""
    event = importlib.import_module("numba.core.event")
    functions = {f for f in dispatcher.py_func.__globals__.values() if hasattr(f, "typeof_pyval")}
    with Working(f"compiling {what}", of=len(functions)) as work:
        left, thread = set(functions), threading.get_ident()

        class Each(event.Listener):
            def on_start(self, event: Any) -> None:
                begun = event.data["dispatcher"]
                if begun in left and threading.get_ident() == thread:
                    left.remove(begun)
                    work.step(begun.py_func.__name__)

            def on_end(self, event: Any) -> None:
                pass

        with event.install_listener("numba:compile", Each()):
            yield


_INTERPRETS = ('Numba is not installed, so engine="auto" runs derivatives in the interpreter, where loops over '
               'elements are some hundred times slower: pip install "s2sad[jit]", or say engine="numpy"')


def interpreting() -> None:
    """Warns, once, that Numba is absent and the interpreter runs derivatives."""
    if not available():
        warn_once(_INTERPRETS)


def _jit(function: FunctionType, bounds: bool, on_disk: bool, fastmath: bool | set[str] = False,
         inline: bool = False, internal: bool = False) -> Any:
    if _is_interpreted(function):
        return interpreted(function)
    numba = importlib.import_module("numba")
    flags = {"error_model": error_model(), "boundscheck": bounds, "nogil": True, "fastmath": fastmath,
             "forceinline": inline, **options()[internal]}
    dispatcher = numba.njit(**flags)(function)
    if internal:
        return without_integer_literals(dispatcher)
    return stored(dispatcher, function.__module__) if on_disk else dispatcher


@cache
def error_model() -> str:
    """Numba's name for what divisions by zero give: of floats what NumPy gives; of integers they raise, as Python's do
    (Numba's own for NumPy gives 0, without a word)."""
    models = importlib.import_module("numba.core.callconv")

    class IntegerErrorModel(models.NumpyErrorModel):
        def fp_zero_division(self, builder: Any, exc_args: Any = None, loc: Any = None) -> bool:
            if not exc_args or not str(exc_args[0]).startswith("integer"):
                return False
            self.call_conv.return_user_exc(builder, ZeroDivisionError, exc_args, loc)
            return True

    models.error_models["s2sad"] = IntegerErrorModel
    return "s2sad"


def _is_interpreted(value: Any) -> bool:
    """Whether a name of a module means a function of the runtime that Numba cannot compile."""
    return isinstance(value, FunctionType) and value.__name__ in DTYPES and value.__module__.startswith(_RUNTIME)


@cache
def _runtime(module_name: str, bounds: bool) -> dict[str, Any]:
    """A compiled copy of a runtime module's names; not cached on disk, for it is inlined into what is."""
    source = vars(importlib.import_module(module_name))
    space = dict(source)
    inline = module_name == f"{_RUNTIME}.exponentials"      # a call keeps a loop from vectors
    for identifier, value in source.items():
        if not isinstance(value, FunctionType):
            continue
        if value.__module__ == module_name:
            copy = FunctionType(value.__code__, space, value.__name__, value.__defaults__, value.__closure__)
            copy.__qualname__, copy.__module__ = value.__qualname__, value.__module__
            fastmath = {"reassoc"} if identifier in _ANY_ORDER else False
            run = value if _is_interpreted(value) else copy     # the interpreter calls nothing that is compiled
            space[identifier] = through_python(value) or _jit(run, bounds, False, fastmath, inline, internal=True)
        elif (value.__module__ or "").startswith(_RUNTIME):
            space[identifier] = _runtime(value.__module__, bounds)[value.__name__]
    return space


@cache
def _key(bounds: bool) -> str:
    """A digest of all that machine code depends on beside its own text."""
    numba, numpy = importlib.import_module("numba"), importlib.import_module("numpy")
    digest = hashlib.sha256()
    found = importlib.util.find_spec(_RUNTIME)
    if found is not None and found.origin:
        origin = Path(found.origin)
        for path in sorted(origin.parent.rglob("*.py")) if origin.name == "__init__.py" else [origin]:
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
    for path in sorted(Path(__file__).parent.glob("*.py")):     # the flags, and what is registered with Numba
        digest.update(path.read_bytes())
    config = tuple(getattr(numba.config, n, None) for n in ("BOUNDSCHECK", "OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE"))
    llvm = importlib.import_module("llvmlite").__version__
    with suppress(metadata.PackageNotFoundError):
        digest.update(metadata.version("scipy").encode())       # its C functions are called
    versions = (numba.__version__, llvm, numpy.__version__, platform.python_version(), config)
    digest.update(repr(versions).encode())
    return f"numba-{digest.hexdigest()[:12]}{'-bounds' if bounds else ''}"
