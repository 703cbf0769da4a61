"""inverse_views: a view that a function makes as slices or elements of its operand, and its operand made of it.

    t = np.transpose(u)             u[...] = np.transpose(t)        t[i, j]     u[j, i]         t[1:, 0]    u[0, 1:]
    f = np.ravel(u)                 u[...] = np.reshape(f, u.shape) f[k]        u[k // u.shape[1], k % u.shape[1]]
    w = np.flip(u, axis=0)          u[...] = np.flip(w, axis=0)

What `np.split` and `np.vsplit` give are slices, and stand so:

    a = np.split(x, 2, part=0)      assert x.shape[0] % 2 == 0
                                    a = x[:1 * (x.shape[0] // 2)]
"""
from __future__ import annotations

from dataclasses import dataclass

from s2sad import rules
from s2sad.blocks import with_blocks
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import whole_number
from s2sad.normalize.library.expansions.templates import SECTIONS
from s2sad.tree import (
    AST, Assert, Assign, Attribute, BinOp, Call, Eq, FloorDiv, FunctionDef, List, Mod, Name, Slice, Subscript, Tuple,
    assign, at, attribute, call, call_name, compare, const, copy, index, indices, mult, name, rebuild, tuple_of, walk,
    with_body,
)

_RESHAPED = ("numpy.reshape", "numpy.ravel")


@dataclass(frozen=True)
class InverseView:
    """The view of an operand, the operand made of the view, and the view's elements made again."""
    view: AST
    operand: AST
    refreshed: AST


def inverse_views(binding: Assign, part: AST, typing: Typing) -> InverseView | None:
    """How a view and its operand are made of each other; None for functions without an inverse."""
    called, value, view = call_name(binding.value) or "", binding.value, name(binding.targets[0].id)
    view_rank, part_rank = typing.of(value).rank, typing.of(part).rank
    if called in _RESHAPED:
        shape = attribute(copy(part), "shape")
        back = name(view.id) if view_rank == part_rank == 1 else call("numpy.ravel", view) if part_rank == 1 else call(
            "numpy.reshape", view, shape)
        again = copy(part) if view_rank == part_rank == 1 else call(
            "numpy.ravel", copy(part)) if view_rank == 1 else call(
            "numpy.reshape", copy(part), attribute(name(view.id), "shape"))
        return InverseView(_applied_to(value, part), back, again)
    if called in ("numpy.transpose", "numpy.flip"):
        made = _applied_to(value, part)
        return InverseView(made, _applied_to(value, view), copy(made))
    moved = _moved_axes(value, part_rank)
    if moved is None:
        return None
    source, destination = (tuple_of(*map(const, axes)) for axes in moved)
    made = call("numpy.moveaxis", copy(part), source, destination)
    return InverseView(made, call("numpy.moveaxis", view, copy(destination), copy(source)), copy(made))


def _applied_to(value: Call, operand: AST) -> Call:
    made = copy(value)
    made.args[0] = copy(operand)
    return made


def _moved_axes(value: Call, rank: int) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
    """The axes that a function moves, and where to."""
    rule = rules.find_array(call_name(value))
    if rule is None or call_name(value) not in ("numpy.moveaxis", "numpy.swapaxes"):
        return None
    arguments = rule.arguments(value)
    if call_name(value) == "numpy.swapaxes":
        pair = [whole_number(arguments[a]) for a in ("axis1", "axis2")]
        if None in pair or not all(-rank <= a < rank for a in pair if a is not None):
            return None
        a, b = (axis % rank for axis in pair if axis is not None)
        return ((a, b), (b, a)) if a != b else ((), ())
    source, destination = (_axes(arguments[a], rank) for a in ("source", "destination"))
    return None if source is None or destination is None else (source, destination)


def _axes(node: AST, rank: int) -> tuple[int, ...] | None:
    """The axes that an argument names, in its order; None if they are not constants."""
    axes = [whole_number(n) for n in (node.elts if isinstance(node, (Tuple, List)) else [node])]
    return tuple(a % rank for a in axes if a is not None) if None not in axes else None


def through_operand(binding: Assign, part: AST, rest: list[AST], typing: Typing) -> list[AST] | None:
    """What follows a view's binding with elements of its operand in place of the view's, and rows or columns where the
    view has the same axes in another order; None if it reads more."""
    target, value = binding.targets[0].id, binding.value
    rank, part_rank = typing.of(value).rank, typing.of(part).rank
    order = _order(value, part_rank)
    if not isinstance(part, Name) or order is None and (rank != 1 or call_name(value) not in _RESHAPED):
        return None
    most = 0 if order is None else 1

    def is_access(n: AST) -> bool:
        return isinstance(n, Subscript) and isinstance(n.value, Name) and n.value.id == target and typing.of(
            n).rank <= most and all(isinstance(s, Slice) or typing.of(s).is_integer for s in indices(n))
    inside = {id(n.value) for n in walk(rest) if is_access(n) or _is_size(n, target)}
    if any(isinstance(n, Name) and n.id == target and id(n) not in inside for n in walk(rest)):
        return None

    def change(n: AST) -> AST | None:
        if is_access(n):
            places = [rebuild(s, change) for s in indices(n)]
            places += [Slice(None, None, None) for _ in range(rank - len(places))]
            found = _unravelled(places[0], part, part_rank) if order is None else [
                places[order.index(k)] for k in range(part_rank)]
            return at(Subscript(name(part.id), index(name(part.id), *found).slice, n.ctx), n)
        if isinstance(n, Subscript) and isinstance(n.value, Attribute) and _is_size(n.value, target):
            axis = whole_number(n.slice) or 0
            return attribute(name(part.id), "size") if order is None else index(
                attribute(name(part.id), "shape"), const(order[axis]))
        return attribute(name(part.id), "size") if _is_size(n, target) and n.attr == "size" else None
    asked = [n for n in walk(rest) if isinstance(n, Attribute) and _is_size(n, target) and n.attr == "shape"]
    known = {id(n.value) for n in walk(rest) if isinstance(n, Subscript) and whole_number(n.slice) is not None}
    return None if any(id(n) not in known for n in asked) else [rebuild(s, change) for s in rest]


def _is_size(node: AST, target: str) -> bool:
    return isinstance(node, Attribute) and isinstance(node.value, Name) and node.value.id == target and node.attr in (
        "shape", "size")


def _order(value: Call, rank: int) -> list[int] | None:
    """The operand's axis for each axis of the view, where it has the same axes in another order."""
    if call_name(value) == "numpy.transpose":
        return list(range(rank))[::-1]
    moved = _moved_axes(value, rank)
    if moved is None:
        return None
    order = [k for k in range(rank) if k not in moved[0]]
    for place, axis in sorted(zip(moved[1], moved[0])):
        order.insert(place, axis)
    return order


def _unravelled(place: AST, part: Name, rank: int) -> list[AST]:
    """The subscripts of an operand for an element of it by its number."""
    found: list[AST] = []
    for axis in range(rank):
        below = [index(attribute(name(part.id), "shape"), const(k)) for k in range(axis + 1, rank)]
        product = below[0] if below else None
        for size in below[1:]:
            product = mult(product, size)
        whole = copy(place) if product is None else BinOp(copy(place), FloorDiv(), product)
        found.append(whole if axis == 0 else BinOp(whole, Mod(), index(
            attribute(name(part.id), "shape"), const(axis))))
    return found


_SPLIT = {"numpy.split": None, "numpy.vsplit": 0}


def splits(function: FunctionDef) -> FunctionDef:
    """The function with such slices."""
    def block(body: list[AST]) -> list[AST]:
        return [at(made, s) for s in body for made in _statement(with_blocks(s, block))]
    return with_body(function, block(function.body))


def _statement(statement: AST) -> list[AST]:
    called = call_name(statement.value) if isinstance(statement, Assign) else None
    if called not in _SPLIT or not isinstance(statement.value.args[0], (Name, Subscript)) or not isinstance(
            statement.targets[0], Name):
        return [statement]
    rule = rules.find_array(called)
    assert rule is not None
    arguments = rule.arguments(statement.value)
    axis = _SPLIT[called] if _SPLIT[called] is not None else whole_number(arguments["axis"])
    number, asked, array = whole_number(arguments["part"]), arguments["sections"], arguments["x"]
    if axis is None or axis < 0 or number is None:
        return [statement]
    size = index(attribute(copy(array), "shape"), const(axis))
    if isinstance(asked, (Tuple, List)):
        bounds = [None, *asked.elts, None]
        low, high, before = bounds[number], bounds[number + 1], []
    else:
        before = [Assert(compare(BinOp(size, Mod(), copy(asked)), Eq(), const(0)), const(SECTIONS))]
        low, high = (mult(const(k), BinOp(copy(size), FloorDiv(), copy(asked))) if k else None
                     for k in (number, number + 1))
    whole = [Slice(None, None, None) for _ in range(axis)]
    part = index(copy(array), *whole, Slice(low and copy(low), high and copy(high), None))
    return [*before, assign(statement.targets[0], part)]
