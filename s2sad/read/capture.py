"""A live function becomes its definition's tree, its source and the names around it.

The text is the file's as it is now (or what `linecache` holds, as for a notebook's cell). It is compiled again and
compared with the function's own code, so a text that no longer belongs to the function is never read (S104).
"""
from __future__ import annotations

import __future__

import builtins
import functools
import linecache
import types
import warnings
from collections.abc import Iterator
from typing import Any

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError, Source, Span
from s2sad.read.meaning import (
    AST, Captured, Function, Library, LibraryScope, Meaning, NotConstant, Number, Space, Text, Unusable,
    is_numbers, library_path, value_meaning,
)
from s2sad.rules.given import GIVEN, ROOM

_FUTURE = functools.reduce(int.__or__, (getattr(__future__, n).compiler_flag for n in __future__.all_feature_names))
# line ends to str.splitlines, but not to Python: replaced by blanks as wide in UTF-8
_ODD_LINE_ENDS = {**dict.fromkeys(map(ord, "\x0b\x0c\x1c\x1d\x1e"), " "), 0x85: "\xa0",
                  **dict.fromkeys((0x2028, 0x2029), "\u2003")}


def source_of(path: str, text: str) -> Source:
    return Source(path, text.translate(_ODD_LINE_ENDS))


def python_function(value: Any) -> types.FunctionType | None:
    """The plain function behind a differentiated one or a Numba dispatcher; None for anything else."""
    for _ in range(8):
        if isinstance(value, types.FunctionType):
            inner = getattr(value, "__wrapped_kernel__", None)
            return value if inner is None else python_function(inner)
        names = ("__wrapped_kernel__", "py_func")
        value = next((getattr(value, n) for n in names if not isinstance(value, type) and hasattr(value, n)), None)
    return None


def capture(value: Any) -> Captured:
    """The definition of a live function; raises S2sadError (S101, S104)."""
    function = python_function(value)
    if function is None:
        raise S2sadError(not_a_function(value))
    if hasattr(function, "__wrapped__"):
        raise S2sadError(Diagnostic("S101", f"'{function.__name__}' is wrapped by a decorator that s2sad does not know",
                                    help=f"give the function inside: {function.__name__}.__wrapped__"))
    code = function.__code__
    text = _text(function)
    if code.co_name == "<lambda>":
        raise S2sadError(_lambda(code, text))
    try:
        module, compiled = _compiled(text, code.co_filename, code.co_flags & _FUTURE)
    except (SyntaxError, ValueError):
        raise S2sadError(_stale(code, None)) from None
    source = source_of(code.co_filename, text)
    definitions = {_first_line(n): n for n in tree.walk(module) if type(n).__name__.endswith("FunctionDef")}
    namesakes = [c for c in compiled if c.co_name == code.co_name and c.co_firstlineno in definitions]
    namesakes.sort(key=lambda c: c.co_firstlineno != code.co_firstlineno)
    found = next((c for c in namesakes if _same(code, c)), None)
    if found is None:
        place = Span.of(source, _header(definitions[namesakes[0].co_firstlineno])) if namesakes else None
        raise S2sadError(_stale(code, place))
    definition = definitions[found.co_firstlineno]
    return Captured(function.__name__, definition, source, LiveScope(function), _defaults(function))


# -- the text -------------------------------------------------------------------------------------------------------

def _text(function: types.FunctionType) -> str:
    path = function.__code__.co_filename
    linecache.checkcache(path)
    text = "".join(linecache.getlines(path, function.__globals__))
    if text:
        return text
    if path.startswith("<"):
        raise S2sadError(_fileless(function.__code__))
    name = function.__name__
    raise S2sadError(Diagnostic("S101", f"the source of '{name}' cannot be had: {path} cannot be read",
                                help="restore the file that the function was imported from"))


def _fileless(code: types.CodeType) -> Diagnostic:
    return Diagnostic("S101", f"the source of '{code.co_name}' cannot be had: it was defined in {code.co_filename}, "
                      "not in a file", help="write the function to a .py file and import it from there")


def not_a_function(value: Any) -> Diagnostic:
    name = getattr(value, "__name__", None) or repr(value)
    if isinstance(value, types.MethodType):
        return Diagnostic("S101", f"'{name}' is a method", help="write it as a function at module level; pass what it "
                          "reads of self as arguments")
    if isinstance(value, type):
        return Diagnostic("S101", f"'{name}' is a class, not a function", help="give a function defined with def")
    if callable(value):
        return Diagnostic("S101", f"'{name}' has no Python source: it is {_article(type(value).__name__)}",
                          help="give a function defined with def in a .py file, which may call it")
    return Diagnostic("S101", f"a function is needed, not {_article(type(value).__name__)}",
                      help="give a function defined with def in a .py file")


def _article(word: str) -> str:
    return f"{'an' if word[0].lower() in 'aeiou' else 'a'} {word}"


def _lambda(code: types.CodeType, text: str) -> Diagnostic:
    source = source_of(code.co_filename, text)
    line = source.line(code.co_firstlineno)
    column = max(0, line.find("lambda"))
    span = Span(source, code.co_firstlineno, column, code.co_firstlineno, column + 6)
    return Diagnostic("S101", "a lambda cannot be read", span, help="write it as a function at module level, with def")


def _stale(code: types.CodeType, place: Span | None) -> Diagnostic:
    if code.co_filename == "<string>":
        # since Python 3.13 the text of `python -c` goes by this name, as what `exec` compiles does
        return _fileless(code)
    where = "" if place else f"{code.co_filename}: "
    message = f"{where}the source of '{code.co_name}' has changed since the function was defined"
    return Diagnostic("S104", message, place, help="import the module again (importlib.reload, or a new process) and "
                      "use the function from there")


# -- is it still the same? ------------------------------------------------------------------------------------------

@functools.lru_cache(maxsize=16)
def _compiled(text: str, path: str, flags: int) -> tuple[tree.Module, tuple[types.CodeType, ...]]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return tree.parse(text), tuple(_codes(compile(text, path, "exec", flags, dont_inherit=True)))


def _codes(code: types.CodeType) -> Iterator[types.CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield constant
            yield from _codes(constant)


def _first_line(node: AST) -> int:
    """The line where a definition's code object starts: its first decorator's."""
    return min([node.lineno, *(d.lineno for d in node.decorator_list)])


def _header(node: AST) -> AST:
    """A definition's place cut down to its name, for the caret."""
    head = tree.name(node.name)
    word = 4 if type(node).__name__ == "FunctionDef" else 10
    head.lineno = head.end_lineno = node.lineno
    head.col_offset = node.col_offset + word
    head.end_col_offset = head.col_offset + len(node.name.encode())
    return head


def _same(code: types.CodeType, other: types.CodeType) -> bool:
    if any(name.startswith("@py") for name in code.co_varnames):
        # pytest rewrote the asserts: what the text names and computes with must at least be there
        return (set(other.co_names) <= set(code.co_names) and set(other.co_varnames) <= set(code.co_varnames)
                and set(map(_fingerprint, other.co_consts)) <= set(map(_fingerprint, code.co_consts)))
    return _fingerprint(code) == _fingerprint(other)


def _fingerprint(value: Any) -> Any:
    """What two equal codes or constants share; places are left out, 1, 1.0 and True are three things."""
    if isinstance(value, types.CodeType):
        return (value.co_code, value.co_names, value.co_varnames, value.co_freevars, value.co_cellvars, value.co_flags,
                value.co_argcount, value.co_posonlyargcount, value.co_kwonlyargcount,
                tuple(map(_fingerprint, value.co_consts)))
    if isinstance(value, tuple):
        return ("tuple", *map(_fingerprint, value))
    if isinstance(value, frozenset):
        return ("frozenset", *sorted(map(repr, value)))
    return type(value).__name__, repr(value)


# -- the names around it --------------------------------------------------------------------------------------------

class LiveScope:
    """A function's closure, module and builtins, in this order."""

    def __init__(self, function: types.FunctionType):
        self.function = function
        self.cells = dict(zip(function.__code__.co_freevars, function.__closure__ or ()))

    def value(self, name: str) -> Any:
        """The value now; raises KeyError if there is none."""
        if name in self.cells:
            try:
                return self.cells[name].cell_contents
            except ValueError:
                raise KeyError(name) from None
        if name in self.function.__globals__:
            return self.function.__globals__[name]
        return vars(builtins)[name]

    def lookup(self, name: str) -> Meaning | None:
        try:
            return live_meaning(name, self.value(name), lambda: self.value(name))
        except KeyError:
            return None

    def known(self) -> list[str]:
        return [*self.cells, *self.function.__globals__]


class ModuleScope:
    """The names of a user's module that is loaded."""

    def __init__(self, module: types.ModuleType):
        self.module = module

    def lookup(self, name: str) -> Meaning | None:
        if not hasattr(self.module, name):
            return None
        value = getattr(self.module, name)
        meaning = live_meaning(name, value, lambda: getattr(self.module, name))
        if isinstance(meaning, Unusable) and callable(value):
            return Library(f"{self.module.__name__}.{name}")
        return meaning

    def known(self) -> list[str]:
        return [n for n in dir(self.module) if not n.startswith("_")]


def live_meaning(name: str, value: Any, current: Any = None) -> Meaning:
    """What a live value means to a kernel that names it."""
    given = GIVEN.of(value) or GIVEN.of(python_function(value))
    if given is not None:
        return Library(ROOM + given.path)
    if isinstance(value, types.ModuleType):
        library = value.__name__.partition(".")[0] in ("numpy", "math", "numba", "s2sad")
        return Space(value.__name__, LibraryScope(value.__name__) if library else ModuleScope(value))
    path = library_path(name, value)
    if path is not None:
        return Library(path)
    if isinstance(value, functools.partial) and _home(value.func) in ("numba", "s2sad"):
        value = value.func
    if _home(value) in ("numba", "s2sad") and python_function(value) in (None, value):
        word = getattr(value, "__name__", name)
        if value.__module__.startswith("s2sad.runtime"):
            return Library(f"runtime.{word}")
        if getattr(value, "__module__", "") == "numba.core.decorators":
            word = "jit"  # also what `njit(...)` gives back, called `wrapper`
        return Library("builtins.range") if word == "prange" else Library(f"{_home(value)}.{word}")
    function = python_function(value)
    if function is not None:
        path = f"{function.__module__}.{function.__qualname__}"
        return Function(function.__name__, ("live", id(function)), path, function)
    return value_meaning(name, value, current)


def _home(value: Any) -> str:
    module = getattr(value, "__module__", None) if callable(value) else None
    return module.partition(".")[0] if isinstance(module, str) else ""


def _defaults(function: types.FunctionType) -> Any:
    """Looks up a parameter's default value as the live function has it."""
    code = function.__code__
    positional = code.co_varnames[:code.co_argcount]
    values = dict(zip(reversed(positional), reversed(function.__defaults__ or ()))) | (function.__kwdefaults__ or {})

    def default(parameter: str, node: AST) -> Any:
        value = values.get(parameter)
        if value is None or isinstance(live_meaning(parameter, value), (Number, Text)) or isinstance(value, float):
            return value
        if is_numbers(value, tuple):
            return value
        raise NotConstant
    return default
