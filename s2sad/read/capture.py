"""A live function becomes its definition's tree, its source and the names around it.

The text is the file's as it is now (or what `linecache` holds, as for a notebook's cell). It is compiled again and
compared with the function's own code, so a text that no longer belongs to the function is never read (S104).
"""
from __future__ import annotations

import copy
import functools
import types
import warnings
from collections.abc import Iterable, Mapping
from typing import Any

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError, Source, Span
from s2sad.live_objects.code_text import FUTURE, codes, text_of
from s2sad.live_objects.guards import taken
from s2sad.read.live_module import LiveScope, defaults_of
from s2sad.read.marked_loops import unmarked
from s2sad.read.outside_values import AST, Captured, kind_of
from s2sad.live_objects.unwrap import fingerprint, partial_application, python_function

# line ends to str.splitlines, but not to Python: replaced by blanks as wide in UTF-8
_ODD_LINE_ENDS = {**dict.fromkeys(map(ord, "\x0b\x0c\x1c\x1d\x1e"), " "), 0x85: "\xa0",
                  **dict.fromkeys((0x2028, 0x2029), "\u2003")}


def source_of(path: str, text: str) -> Source:
    return Source(path, text.translate(_ODD_LINE_ENDS))


def captured_of(handle: Any) -> Captured:
    """The definition of a function, live or of a text that is not run; raises S2sadError."""
    is_live = isinstance(handle, types.FunctionType) or not hasattr(handle, "captured")
    return unmarked(capture(handle) if is_live else handle.captured())


def capture(value: Any) -> Captured:
    """The definition of a live function; raises S2sadError (S101, S104)."""
    function = python_function(value)
    if function is None:
        raise S2sadError(not_a_function(value))
    function, bound = partial_application(function)
    code = taken(function, "code")
    path, text = _text(function, code)
    try:
        module, compiled = _compiled(text, path, code.co_flags & FUTURE)
    except (SyntaxError, ValueError):
        raise S2sadError(_stale(code, None)) from None
    source = source_of(path, text)
    if code.co_name == "<lambda>":
        made = _without(_of_lambda(code, module, compiled, source), bound, source)
        return Captured(name_of(function), made, source, LiveScope(function, bound), defaults_of(function))
    definitions = {_first_line(n): n for n in tree.walk(module) if type(n).__name__.endswith("FunctionDef")}
    namesakes = [c for c in compiled if c.co_name == code.co_name and c.co_firstlineno in definitions]
    namesakes.sort(key=lambda c: c.co_firstlineno != code.co_firstlineno)
    found = next((c for c in namesakes if _same(code, c)), None)
    if found is None:
        place = Span.of(source, _header(definitions[namesakes[0].co_firstlineno])) if namesakes else None
        raise S2sadError(_stale(code, place))
    definition = _without(definitions[found.co_firstlineno], bound, source)
    return Captured(function.__name__, definition, source, LiveScope(function, bound), defaults_of(function))


def _without(definition: Any, bound: Mapping[str, Any], source: Source) -> Any:
    """The definition without the parameters that were given already; raises S2sadError (S101) where it assigns one."""
    if not bound:
        return definition
    place = next((n for n in tree.walk(definition.body) if isinstance(n, tree.Name) and n.id in bound
                  and isinstance(n.ctx, tree.Store)), None)
    if place is not None:
        raise S2sadError(Diagnostic("S101", f"'{place.id}' was given already, and is assigned", Span.of(source, place),
                                    help="assign to another name, or give the argument with each call"))
    new, args = copy.copy(definition), copy.copy(definition.args)
    plain = [*args.posonlyargs, *args.args]
    fallback = dict(zip((a.id for a in reversed(plain)), reversed(args.defaults)))
    args.posonlyargs, args.args = ([a for a in part if a.id not in bound] for part in (args.posonlyargs, args.args))
    args.defaults = [fallback[a.id] for a in (*args.posonlyargs, *args.args) if a.id in fallback]
    named = [(a, d) for a, d in zip(args.kwonlyargs, args.kw_defaults) if a.id not in bound]
    args.kwonlyargs, args.kw_defaults = [a for a, _ in named], [d for _, d in named]
    new.args = args
    return new


# -- the text -------------------------------------------------------------------------------------------------------

def _text(function: types.FunctionType, code: types.CodeType) -> tuple[str, str]:
    """The path of a function's text, and the text; raises S2sadError (S101)."""
    path, text = text_of(code, function.__globals__)
    if text:
        return path, text
    if path.startswith("<"):
        raise S2sadError(_fileless(code))
    name = function.__name__
    raise S2sadError(Diagnostic("S101", f"the source of '{name}' cannot be had: {path} cannot be read",
                                help="restore the file that the function was imported from"))


def _fileless(code: types.CodeType) -> Diagnostic:
    return Diagnostic("S101", f"the source of '{code.co_name}' cannot be had: it was defined in {code.co_filename}, "
                      "not in a file", help="write the function to a .py file and import it from there")


def not_a_function(value: Any) -> Diagnostic:
    name = getattr(value, "__name__", None) or repr(value)
    if isinstance(value, types.MethodType):
        return Diagnostic("S101", f"'{name}' is a method of a class, or of what has no Python source",
                          help="write it as a function at module level; pass what it reads as arguments")
    if isinstance(value, type):
        return Diagnostic("S101", f"'{name}' is a class, not a function", help="give a function defined with def")
    if callable(value):
        return Diagnostic("S101", f"'{name}' has no Python source: it is {kind_of(value)}",
                          help="give a function defined with def in a .py file, which may call it")
    return Diagnostic("S101", f"a function is needed, not {kind_of(value)}",
                      help="give a function defined with def in a .py file")


def name_of(function: types.FunctionType) -> str:
    """A function's name, by which its derivative is named; a lambda has none."""
    return "function" if function.__name__ == "<lambda>" else function.__name__


def _named(parameters: AST) -> list[str]:
    return [a.id for a in (*parameters.posonlyargs, *parameters.args, *parameters.kwonlyargs)]


def _of_lambda(code: types.CodeType, module: AST, compiled: Iterable[types.CodeType],
               source: Source) -> tree.FunctionDef:
    """The lambda as a definition; raises S2sadError (S101) where its line has another that it may be, and S104."""
    found = [n for n in tree.walk(module) if type(n).__name__ == "Lambda" and n.lineno == code.co_firstlineno
             and _named(n.args) == list(code.co_varnames[:code.co_argcount + code.co_kwonlyargcount])]
    if not found or not any(_same(code, c) for c in compiled if c.co_name == "<lambda>"):
        raise S2sadError(_stale(code, None))
    line = found
    if len(found) > 1 and hasattr(code, "co_positions"):
        found = [n for n in found if _stands_in(code, n.body)]
    if len(found) != 1:
        raise S2sadError(Diagnostic("S101", "two lambdas with the same parameters begin in this line", Span.of(
            source, line[0]), help="write it in a line of its own, or with def"))
    body = [tree.at(tree.Return(found[0].body), found[0].body)]
    return tree.at(tree.FunctionDef("function", found[0].args, body, [], None, None, []), found[0])


def _stands_in(code: types.CodeType, body: AST) -> bool:
    """Whether the instructions of a lambda have the places of an expression."""
    places = {(line, column) for line, _, column, _ in getattr(code, "co_positions", tuple)()}
    return (body.lineno, body.col_offset) in places and all(
        (body.lineno, body.col_offset) <= place <= (body.end_lineno, body.end_col_offset)
        for place in places if None not in place and place != (code.co_firstlineno, 0))


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
        _, *inner = codes(compile(text, path, "exec", flags, dont_inherit=True))
        return tree.parse(text), tuple(inner)


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
                and set(map(fingerprint, other.co_consts)) <= set(map(fingerprint, code.co_consts)))
    return fingerprint(code) == fingerprint(other)
