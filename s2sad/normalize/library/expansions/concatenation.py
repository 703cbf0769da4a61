"""Expansions of functions that concatenate: an allocation, and a store of each operand into a slice."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.promotion import common
from s2sad.infer.types import Type
from s2sad.normalize.library.expansions.templates import CallArguments, empty, lines, part, size, sizes
from s2sad.tree import List, Tuple, call

Operand = tuple[str, list[str], Type]     # text, sizes and type


def _operands(args: CallArguments, before: list[str], parameter: str = "x") -> list[Operand]:
    found: list[Operand] = []
    for item in args.items(parameter):
        kind = args.typing.of(item)
        text = args.let("item", item)
        if isinstance(item, (List, Tuple)):
            args.arguments[text] = call("numpy.array", item)
            kind = args.typing.of(args.arguments[text])
        if kind.is_array:
            before.append(f"part{len(found)} = {text}")
            text = f"part{len(found)}"
        found.append((text, sizes(text, kind.rank), kind))
    return found


def _filled_along(parts: list[Operand], axis: int, before: list[str]) -> str:
    """The operands one after the other along an axis; numbers have size 1."""
    stores, start = [], ""
    for text, found, _ in parts:
        stop = f"{start} + {found[axis]}" if start else found[axis]
        last = len(stores) == len(parts) - 1
        stores.append(f"{part('result', axis, f'{start}:' + ('' if last else stop))} = {text}")
        start = stop
    whole = [*parts[0][1]]
    whole[axis] = start
    return lines(*before, f"result = {empty(whole, common([kind for _, _, kind in parts]))}", *stores)


def _rows(args: CallArguments, rank: int) -> str:
    """The rows of one array one after the other, as an array of fewer axes; a copy where it keeps them."""
    own = args.rank("x")
    if own <= rank:
        return "result = numpy.copy(x)"
    shape = [f"{size('x', 0)} * {size('x', 1)}", *sizes("x", own)[2:]]
    return f"result = numpy.reshape(x, ({', '.join(shape)},))"


def _concatenate(args: CallArguments) -> str:
    if args.rank("x"):
        return _rows(args, args.rank("x") - 1)
    before: list[str] = []
    parts = _operands(args, before)
    if not args.has("axis"):
        before += [f"flat{k} = numpy.ravel({text})" for k, (text, _, _) in enumerate(parts)]
        flat = [(f"flat{k}", sizes(f"flat{k}", 1), kind) for k, (_, _, kind) in enumerate(parts)]
        return _filled_along(flat, 0, before)
    return _filled_along(parts, args.axis(parts[0][2].rank), before)


def _append(args: CallArguments) -> str:
    parts = [(p, sizes(p, 1) if args.rank(p) else ["1"], args.type(p)) for p in ("x", "values")]
    return _filled_along(parts, 0, [])


def _hstack(args: CallArguments, axis: int = 1) -> str:
    if args.rank("x"):
        return _rows(args, 1)
    before: list[str] = []
    parts = [(text, found or ["1"], kind) for text, found, kind in _operands(args, before)]
    return _filled_along(parts, 0 if len(parts[0][1]) == 1 else axis, before)


def _vstack(args: CallArguments) -> str:
    if args.rank("x"):
        return _rows(args, 2)
    before: list[str] = []
    parts = [(f"{text}[None, :]" if len(found) == 1 else text, ["1", *found][-2:], kind)
             for text, found, kind in _operands(args, before)]
    return _filled_along(parts, 0, before)


def _column_stack(args: CallArguments) -> str:
    if args.rank("x"):
        return "result = numpy.copy(numpy.transpose(x))"
    before: list[str] = []
    parts = [(f"{text}[:, None]" if len(found) == 1 else text, [*found, "1"][:2], kind)
             for text, found, kind in _operands(args, before)]
    return _filled_along(parts, 1, before)


def _stack(args: CallArguments) -> str:
    if args.rank("x"):
        return "result = numpy.copy(x)"
    before: list[str] = []
    parts = _operands(args, before)
    axis = args.axis(parts[0][2].rank + 1)
    whole = [*parts[0][1]]
    whole.insert(axis, str(len(parts)))
    return lines(*before, f"result = {empty(whole, common([kind for _, _, kind in parts]))}",
                 *(f"{part('result', axis, str(k))} = {text}" for k, (text, _, _) in enumerate(parts)))


def _dstack(args: CallArguments) -> str:
    before: list[str] = []
    parts: list[Operand] = []
    for text, found, kind in _operands(args, before):
        held = f"deep{len(parts)}"
        before.append(f"{held} = {text}[{'None, :' if len(found) == 1 else ':, :'}, None]")
        parts.append((held, sizes(held, 3), kind))
    return _filled_along(parts, 2, before)


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.concatenate": _concatenate, "numpy.append": _append, "numpy.hstack": _hstack,
    "numpy.r_": lambda args: _hstack(args, 0), "numpy.vstack": _vstack,
    "numpy.column_stack": _column_stack, "numpy.stack": _stack, "numpy.dstack": _dstack,
}
