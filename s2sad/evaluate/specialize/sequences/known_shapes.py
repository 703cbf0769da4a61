"""Lengths of axes: what allocations, arithmetic and slices say of the shapes of arrays before the run.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from s2sad.diagnostics import Report, Source
from s2sad.evaluate.specialize.evaluator import is_spelled
from s2sad.evaluate.specialize.values import NONE, Data, SliceValue, TupleValue, Value
from s2sad.infer.inference import Typing
from s2sad.infer.types import FLOAT, INT, Type, array
from s2sad.read.outside_values import library_value
from s2sad.tree import AST, Call, const, keyword, name as name_of, tuple_of

Shape = tuple["int | None", ...]
_LIKE = ("zeros_like", "ones_like", "empty_like", "full_like", "copy", "array", "asarray", "ascontiguousarray",
         "cumsum", "flip", "roll", "clip", "sort", "astype", "conj", "round", "abs", "absolute", "nan_to_num", "square")
_REDUCTIONS = ("sum", "mean", "prod", "max", "min", "amax", "amin", "std", "var", "any", "all", "argmax", "argmin")
_NUMBERS = ("builtins.float", "builtins.int", "builtins.bool", "builtins.len")
_FILLED = ("zeros", "ones", "empty", "full")
_SORTED = ("cumsum", "sort")        # along None as a vector
_NOWHERE = Source("", "")


def shape(value: Value) -> Shape | None:
    """The shape of a value, as far as it is known; () of a number."""
    if not isinstance(value, Data):
        return None
    return () if value.is_known and isinstance(value.known, (bool, int, float, complex)) else value.shape


def origins(*values: Value) -> frozenset[str]:
    """The arguments whose shapes say what the shape of something computed of the values is."""
    found: frozenset[str] = frozenset()
    for v in values:
        if isinstance(v, Data):
            found |= v.origins
        elif isinstance(v, TupleValue):
            found |= origins(*v.items)
    return found


def broadcast(*values: Value) -> Shape | None:
    """The shape of what is computed element by element."""
    shapes = [shape(v) for v in values]
    if any(s is None for s in shapes):
        return None
    known = [s for s in shapes if s is not None]
    rank = max(map(len, known), default=0)
    rows = [(1,) * (rank - len(s)) + s for s in known]
    return tuple(_axis(axis) for axis in zip(*rows))


def _axis(lengths: Sequence[int | None]) -> int | None:
    more = {n for n in lengths if n is not None and n != 1}
    if len(more) == 1:
        return next(iter(more))
    return None if more or None in lengths else 1


def of_call(path: str, args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    """The shape of what a function of NumPy's gives."""
    name = path.rpartition(".")[2]
    if path.startswith("math.") and name not in ("modf", "frexp") or path in _NUMBERS:
        return ()
    if path in ("builtins.min", "builtins.max") and len(args) > 1:
        return broadcast(*args)
    if name in _FILLED and args:
        return lengths(args[0])
    if name in _REDUCTIONS and args:
        return _reduced(shape(args[0]), args[1:], keywords)
    if name == "einsum" and args and isinstance(args[0], Data) and isinstance(args[0].known, str):
        return _contracted(args[0].known, args[1:])
    flattens = name == "cumsum" and len(shape(args[0]) or (0, 0)) != 1 or name in _SORTED and len(args) > 1
    if name in _LIKE and args and not flattens and not keywords.keys() & {"axis", "shape", "ndmin"}:
        return shape(args[0])
    if name == "arange" and not keywords and all(isinstance(a, Data) and type(a.known) is int for a in args):
        return (len(range(*(a.known for a in args))),)  # pyright: ignore
    if name == "linspace" and len(args) == 3 and isinstance(args[2], Data) and type(args[2].known) is int:
        return (args[2].known,)
    if name == "outer" and len(args) == 2 and all(len(shape(a) or ()) == 1 for a in args):
        return (*(shape(args[0]) or ()), *(shape(args[1]) or ()))
    value = library_value(path)
    if getattr(value, "nin", 0) and getattr(value, "nout", 0) == 1 and getattr(value, "signature", None) is None:
        return None if keywords else broadcast(*args)
    return broadcast(*args) if name == "where" and len(args) == 3 else inferred(path, args, keywords)


def inferred(path: str, args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    """A shape of as many axes as the type of what a function gives has, whatever numbers it is given; the lengths of
    1 that np.squeeze leaves out are not known here."""
    if path == "numpy.squeeze" and len(args) == 1 and not keywords:
        return None
    ranks = set[int]()
    for number in (FLOAT, INT):
        table: dict[str, Type] = {}
        given = [_operand(a, number, table) for a in args]
        options = {k: _operand(v, number, table) for k, v in keywords.items()}
        if None in given or None in options.values():
            return None
        made = Call(name_of(path), given, [keyword(k, v) for k, v in options.items()])
        found = Typing(table, lambda *_: (), Report(_NOWHERE), {}).of(made)
        ranks |= {found.rank or 0} if found.is_array or found.is_number else set()
    return (None,) * ranks.pop() if len(ranks) == 1 else None


def _operand(value: Value, number: Type, table: dict[str, Type]) -> AST | None:
    """An operand of a known number of axes under a name in the table of types; what is known as it is."""
    if isinstance(value, TupleValue):
        items = [_operand(v, number, table) for v in value.items]
        return None if None in items else tuple_of(*items)  # pyright: ignore[reportArgumentType]
    if isinstance(value, Data) and value.is_known and is_spelled(value.known):
        return const(value.known)
    if not isinstance(value, Data) or value.shape is None:
        return None
    table[found := f"x{len(table)}"] = array("float64", len(value.shape)) if value.shape else number
    return name_of(found)


def _reduced(whole: Shape | None, args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    """The shape of what a reduction along one axis gives, or along all."""
    axis = args[0] if args else keywords.get("axis", NONE)
    if whole is None or args[1:] or keywords.keys() - {"axis"} or not isinstance(axis, Data) or not axis.is_known:
        return None
    if axis.known is None:
        return ()
    if type(axis.known) is not int or not -len(whole) <= axis.known < len(whole):
        return None
    at = axis.known % len(whole)
    return (*whole[:at], *whole[at + 1:])


def _contracted(subscripts: str, operands: Sequence[Value]) -> Shape | None:
    """The shape of what np.einsum gives that names its axes."""
    terms, arrow, result = subscripts.replace(" ", "").partition("->")
    if not arrow or "." in subscripts:
        return None
    known: dict[str, int | None] = {}
    for letters, operand in zip(terms.split(","), operands):
        known.update({k: n for k, n in zip(letters, shape(operand) or ()) if n is not None and n != 1})
    return tuple(known.get(k) for k in result)


def lengths(value: Value) -> Shape | None:
    """A shape that is given to an allocation."""
    if isinstance(value, Data) and type(value.known) is int:
        return (value.known,)
    if isinstance(value, Data) and isinstance(value.known, tuple):
        return value.known
    if isinstance(value, TupleValue):
        return tuple(i.known if isinstance(i, Data) and type(i.known) is int else None for i in value.items)
    return None


def of_part(base: Data, place: Value) -> Shape | None:
    """The shape of `base[place]`, of slices and numbers, or of slices and an array with one axis."""
    whole = shape(base)
    places = place.items if isinstance(place, TupleValue) else (place,)
    taken = [p for p in places if not _is_new(p)]
    if whole is None or len(taken) > len(whole):
        return None
    if any(map(_picks, taken)) and sum(isinstance(p, SliceValue) for p in taken) < len(taken) - 1:
        return None
    found: list[int | None] = []
    axes = iter(whole)
    for p in places:
        if _is_new(p):
            found.append(1)
            continue
        n = next(axes)
        if isinstance(p, SliceValue):
            found.append(_length(n, p))
        elif _picks(p):
            found.append(None)
        elif not (isinstance(p, Data) and (type(p.known) is int or p.shape == ())):
            return None
    return (*found, *axes)


def _picks(place: Value) -> bool:
    return isinstance(place, Data) and place.shape is not None and len(place.shape) == 1


def _is_new(place: Value) -> bool:
    """Whether a subscript is np.newaxis."""
    return isinstance(place, Data) and place.is_known and place.known is None


def _length(n: int | None, part: SliceValue) -> int | None:
    ends: list[Any] = [p.known if isinstance(p, Data) and p.is_known else ... for p in part.parts]
    if n is None or any(e is ... or e is not None and type(e) is not int for e in ends) or ends[2] == 0:
        return None
    return len(range(*slice(*ends).indices(n)))


def of_method(base: Data, name: str, args: Sequence[Value], keywords: Mapping[str, Value]) -> Shape | None:
    """The shape of what a method of an array gives."""
    if name in ("copy", "astype", "conj", "clip", "round"):
        return shape(base)
    if name in _REDUCTIONS:
        return _reduced(shape(base), args, keywords)
    if name == "reshape" and args:
        found = lengths(args[0] if len(args) == 1 else TupleValue(tuple(args)))
        return found if found is not None and all(n is not None and n >= 0 for n in found) else None
    return None
