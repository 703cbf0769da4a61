"""What functions that make one array out of several are made of: an allocation, and stores into its parts."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.promotion import common
from s2sad.infer.types import Type
from s2sad.normalize.library.expansions.templates import CallArguments, empty, lines, part, size, sizes
from s2sad.tree import List, Tuple, call

Piece = tuple[str, list[str], Type]     # text, sizes and type of something that is put into a larger array


def _given(asked: CallArguments, before: list[str], parameter: str = "x") -> list[Piece]:
    found: list[Piece] = []
    for item in asked.items(parameter):
        kind = asked.typing.of(item)
        text = asked.let("item", item)
        if isinstance(item, (List, Tuple)):
            asked.arguments[text] = call("numpy.array", item)
            kind = asked.typing.of(asked.arguments[text])
        if kind.is_array:
            before.append(f"part{len(found)} = {text}")
            text = f"part{len(found)}"
        found.append((text, sizes(text, kind.rank), kind))
    return found


def _joined(parts: list[Piece], axis: int, before: list[str]) -> str:
    """The parts one after the other along an axis; numbers are parts of size 1."""
    stores, start = [], ""
    for text, found, _ in parts:
        stop = f"{start} + {found[axis]}" if start else found[axis]
        last = len(stores) == len(parts) - 1
        stores.append(f"{part('result', axis, f'{start}:' + ('' if last else stop))} = {text}")
        start = stop
    whole = [*parts[0][1]]
    whole[axis] = start
    return lines(*before, f"result = {empty(whole, common([kind for _, _, kind in parts]))}", *stores)


def _rows(asked: CallArguments, rank: int) -> str:
    """The rows of one array one after the other, as an array of fewer axes; a copy where it keeps them."""
    own = asked.rank("x")
    if own <= rank:
        return "result = numpy.copy(x)"
    shape = [f"{size('x', 0)} * {size('x', 1)}", *sizes("x", own)[2:]]
    return f"result = numpy.reshape(x, ({', '.join(shape)},))"


def _concatenate(asked: CallArguments) -> str:
    if asked.rank("x"):
        return _rows(asked, asked.rank("x") - 1)
    before: list[str] = []
    parts = _given(asked, before)
    if not asked.given("axis"):
        before += [f"flat{k} = numpy.ravel({text})" for k, (text, _, _) in enumerate(parts)]
        return _joined([(f"flat{k}", sizes(f"flat{k}", 1), kind) for k, (_, _, kind) in enumerate(parts)], 0, before)
    return _joined(parts, asked.axis(parts[0][2].rank), before)


def _append(asked: CallArguments) -> str:
    parts = [(p, sizes(p, 1) if asked.rank(p) else ["1"], asked.type(p)) for p in ("x", "values")]
    return _joined(parts, 0, [])


def _hstack(asked: CallArguments, axis: int = 1) -> str:
    if asked.rank("x"):
        return _rows(asked, 1)
    before: list[str] = []
    parts = [(text, found or ["1"], kind) for text, found, kind in _given(asked, before)]
    return _joined(parts, 0 if len(parts[0][1]) == 1 else axis, before)


def _vstack(asked: CallArguments) -> str:
    if asked.rank("x"):
        return _rows(asked, 2)
    before: list[str] = []
    parts = [(f"{text}[None, :]" if len(found) == 1 else text, ["1", *found][-2:], kind)
             for text, found, kind in _given(asked, before)]
    return _joined(parts, 0, before)


def _column_stack(asked: CallArguments) -> str:
    if asked.rank("x"):
        return "result = numpy.copy(numpy.transpose(x))"
    before: list[str] = []
    parts = [(f"{text}[:, None]" if len(found) == 1 else text, [*found, "1"][:2], kind)
             for text, found, kind in _given(asked, before)]
    return _joined(parts, 1, before)


def _stack(asked: CallArguments) -> str:
    if asked.rank("x"):
        return "result = numpy.copy(x)"
    before: list[str] = []
    parts = _given(asked, before)
    axis = asked.axis(parts[0][2].rank + 1)
    whole = [*parts[0][1]]
    whole.insert(axis, str(len(parts)))
    return lines(*before, f"result = {empty(whole, common([kind for _, _, kind in parts]))}",
                 *(f"{part('result', axis, str(k))} = {text}" for k, (text, _, _) in enumerate(parts)))


def _dstack(asked: CallArguments) -> str:
    before: list[str] = []
    parts: list[Piece] = []
    for text, found, kind in _given(asked, before):
        held = f"deep{len(parts)}"
        before.append(f"{held} = {text}[{'None, :' if len(found) == 1 else ':, :'}, None]")
        parts.append((held, sizes(held, 3), kind))
    return _joined(parts, 2, before)


JOINS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.concatenate": _concatenate, "numpy.append": _append, "numpy.hstack": _hstack,
    "numpy.r_": lambda asked: _hstack(asked, 0), "numpy.vstack": _vstack,
    "numpy.column_stack": _column_stack, "numpy.stack": _stack, "numpy.dstack": _dstack,
}
