"""Structures of arguments: a frozen description of what they are made of, their leaves by path, and how to build one.

    Params(k=2.0, layers=[(w, b)])      p.k: float64, p.layers[0][0]: float64[:, :], p.layers[0][1]: float64[:]

A structure is a dataclass or another object of a class of the user's, a named tuple, a `types.SimpleNamespace`, a
dict, a tuple, a list, or a sparse matrix of SciPy's in the format csr, csc or coo; a leaf is anything else: an array,
a number, a str, None, or something that a kernel may carry along but not use.
"""
from __future__ import annotations

import copy
import dataclasses
import re
import sys
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cache
from types import FunctionType, SimpleNamespace
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.live_objects.code_text import is_generated
from s2sad.live_objects.guards import ABSENT, class_attribute, reached, taken
from s2sad.live_objects.unwrap import default_values
from s2sad.infer.types import DTYPES, FLOAT, INT, Type, misfit_of, of_value

LARGEST = 512                           # leaves: longer lists of numbers are arrays
_DEEPEST = 16
_HEAP = 1 << 9                          # the flag of a class that is written in Python (or was made at run time)
_LIBRARIES = ("builtins", "numpy", "scipy", "pandas", "numba", "torch", "jax", "s2sad", "threading", "types")
SPARSE = {"csr": ("data", "indices", "indptr", "shape"), "csc": ("data", "indices", "indptr", "shape"),
          "coo": ("data", "row", "col", "shape")}    # the formats of sparse matrices, and what they are made of
_FLOATS = ("float", "np.float64", "numpy.float64", "float64")
_ARRAYS = ("np.ndarray", "numpy.ndarray", "ndarray", "NDArray", "npt.NDArray", "numpy.typing.NDArray")
_STEP = re.compile(r"""\.([^\W\d]\w*)|\[(-?\d+)\]|\['([^']*)'\]|\["([^"]*)"\]""")


@dataclass(frozen=True)
class PyTree:
    """One level of a structure: `kind` is "record" (fields), "named" (a named tuple), "dict", "tuple" or "list";
    "either" was spelled in a text and goes by fields and by keys; "csr", "csc" and "coo" are sparse matrices. Of a
    `fixed` one no item can be assigned. An int in a field that is annotated as float means a float.
    """
    kind: str
    keys: tuple[str | int, ...]
    items: tuple[Form, ...]
    made: Any = None                # a class, live or of a file
    fixed: bool = False

    @property
    def is_sequence(self) -> bool:
        return self.kind in ("tuple", "list", "named")

    def __str__(self) -> str:
        titles = {"dict": "a dict", "tuple": "a tuple", "list": "a list", "named": "a named tuple",
                  "either": "a structure", **{f: f"a sparse matrix ({f})" for f in SPARSE},
                  "dia": "a sparse matrix", "factors": "a factorization of a sparse matrix"}
        if self.kind in titles:
            return titles[self.kind]
        if dataclasses.is_dataclass(self.made) or self.made is None:
            return "a dataclass" if self.made else "a structure"
        return f"an object of class {self.made.__name__}"


Form = Type | PyTree


def is_structure(value: object) -> bool:
    """Whether a value has parts that a kernel can name."""
    return _kind(value) is not None


def form_of(value: object, name: str, largest: int = LARGEST) -> Form:
    """The description of an argument; raises S2sadError (S405) for what is nested without end or far too large."""
    form = _form(value, name, 0)
    count = sum(1 for _ in leaves(form, name))
    if isinstance(form, PyTree) and count > largest:
        raise S2sadError(Diagnostic("S405", f"the argument '{name}' is {form} of {count} values",
                                    help=f"pass numpy.array({name}, dtype=float)"))
    return form


def _form(value: object, name: str, depth: int) -> Form:
    kind = _kind(value)
    if kind is None:
        return _leaf(value)
    if depth > _DEEPEST:
        raise S2sadError(Diagnostic("S405", f"the argument '{name}' is nested more than {_DEEPEST} deep",
                                    help="pass its parts as arguments of their own"))
    keys, made = _keys(kind, value), type(value)
    items = [_form(part_of(kind, value, k), name, depth + 1) for k in keys]
    if kind in ("record", "named"):
        annotated = annotated_as(made)
        items = [FLOAT if i == INT and (annotated.get(str(k)) is float or annotated.get(str(k)) in _FLOATS) else i
                 for k, i in zip(keys, items)]
    return PyTree(kind, keys, tuple(items), made, is_fixed(kind, made))


def annotated_as(made: type) -> dict[str, Any]:
    """The annotations of a class, those of its bases included."""
    return {k: t for c in reversed(made.__mro__) for k, t in vars(c).get("__annotations__", {}).items()}



def is_fixed(kind: str, made: type) -> bool:
    """Whether nothing can be assigned to the items: of a frozen dataclass, or one that does more when it is."""
    assigned = made.__setattr__ not in (object.__setattr__, SimpleNamespace.__setattr__)
    return kind in ("named", "tuple", *SPARSE) or kind == "record" and assigned


def _kind(value: object) -> str | None:
    kind = type(value)
    if kind.__module__.startswith("scipy.sparse."):
        return sparse_format(value)
    if kind in (dict, OrderedDict):
        return "dict" if all(map(_is_key, value)) else None  # pyright: ignore
    if kind in (tuple, list):
        return kind.__name__
    if isinstance(value, tuple) and hasattr(kind, "_fields"):
        return "named"
    return "record" if kind is SimpleNamespace or _holds_fields(kind) else None


def _is_key(key: object) -> bool:
    """Whether a key of a dict is one that a kernel can name."""
    plain = type(key) in (str, int, float, bool) or isinstance(key, Enum)
    return plain or type(key) is tuple and all(map(_is_key, key))


def sparse_format(value: Any) -> str | None:
    """The format of a sparse matrix that can be taken apart; None for anything else."""
    sparse = sys.modules.get("scipy.sparse")
    usable = sparse is not None and sparse.issparse(value) and value.format in SPARSE and len(value.shape) == 2
    return value.format if usable else None


@cache
def _holds_fields(kind: type) -> bool:
    """Whether the objects of a class are what is stored in their attributes: a class written in Python that does not
    compute them."""
    written = all(c.__flags__ & _HEAP and c.__module__.partition(".")[0] not in _LIBRARIES for c in kind.__mro__[:-1])
    plain = kind.__getattribute__ is object.__getattribute__ and not hasattr(kind, "__getattr__")
    holds = dataclasses.is_dataclass(kind) or kind.__dictoffset__ != 0
    return written and plain and holds and not issubclass(kind, (type, BaseException, Enum))




def record_fields(made: type) -> tuple[str, dict[str, Any]] | None:
    """The kind of a class whose constructor only fills its fields, and these with their defaults (`...` without one);
    None for any other class."""
    if issubclass(made, tuple) and made.__bases__ == (tuple,) and hasattr(made, "_fields"):
        defaults = named_defaults(made)
        return "named", {name: defaults.get(name, ...) for name in taken(made, "attribute", "_fields")}
    if taken(made, "own", "__dataclass_params__") is ABSENT or class_attribute(made, "__post_init__") is not ABSENT:
        return None
    constructor = taken(made, "own", "__init__")
    if not isinstance(constructor, FunctionType) or not is_generated(taken(constructor, "code")):
        return None     # one of the user's own
    taken(constructor, "attribute", "__defaults__")
    given = dataclasses.fields(made)  # pyright: ignore[reportArgumentType]
    plain = made.__dataclass_params__.init and all(  # pyright: ignore[reportAttributeAccessIssue]
        f.init and not f.kw_only and f.default_factory is dataclasses.MISSING for f in given)
    defaults = {f.name: ... if f.default is dataclasses.MISSING else f.default for f in given}
    return ("record", defaults) if plain else None


def named_defaults(made: type) -> dict[str, Any]:
    """The defaults of a named tuple's fields: those of what makes one, which `_field_defaults` need not know of."""
    found = class_attribute(made, "__new__")
    maker = reached(found, "part", "__func__", found.__func__) if isinstance(found, staticmethod) else found
    return default_values(maker) if isinstance(maker, FunctionType) else {}


def _keys(kind: str, value: Any) -> tuple[str | int, ...]:
    if kind in SPARSE:
        return SPARSE[kind]
    if kind == "dict":
        return tuple(value)
    if kind == "named":
        return tuple(value._fields)
    if kind in ("tuple", "list"):
        return tuple(range(len(value)))
    declared = [f.name for f in dataclasses.fields(value)] if dataclasses.is_dataclass(value) else []
    return tuple(dict.fromkeys(k for k in (*declared, *getattr(value, "__dict__", ())) if hasattr(value, k)))


def part_of(kind: str, value: Any, key: str | int) -> Any:
    """One item of a structure."""
    return getattr(value, str(key)) if kind in ("record", "named", *SPARSE) else value[key]


def assign_part(kind: str, value: Any, key: str | int, new: Any) -> None:
    """Assigns one item of a structure."""
    if kind in ("dict", "list"):
        value[key] = new
    else:
        setattr(value, str(key), new)


def _leaf(value: object) -> Type:
    """The type of a leaf; of kind "other" where a kernel cannot use it."""
    found = of_value(value)
    if found.kind in ("none", "text"):
        return found
    if isinstance(value, np.ndarray) and type(value) in (np.ndarray, np.memmap):
        usable = misfit_of(value, "") is None
        return found if usable else Type("other", f"an array of {found.dtype} of rank {found.rank}")
    if found.is_number and found.dtype in DTYPES:
        return found
    word = type(value).__name__
    return Type("other", f"{'an' if word[0].lower() in 'aeiou' else 'a'} {word}")


# -- paths ----------------------------------------------------------------------------------------------------------

def step(form: PyTree, path: str, key: str | int) -> str:
    """The path of an item, as one writes it: `state.u`, `p['k']`, `layers[0]`."""
    dotted = ("record", "named", "either", "dia", "factors", *SPARSE)
    return f"{path}.{key}" if form.kind in dotted else f"{path}[{key!r}]"


def leaves(form: Form, path: str) -> Iterator[tuple[str, Type]]:
    """Every leaf with its path, in order."""
    if isinstance(form, Type):
        yield path, form
    else:
        for key, item in zip(form.keys, form.items):
            yield from leaves(item, step(form, path, key))


def places_of(form: Form, path: str) -> Iterator[str]:
    """The paths of the indices of sparse matrices."""
    if isinstance(form, PyTree):
        for key, item in zip(form.keys, form.items):
            inner = step(form, path, key)
            if form.kind in SPARSE and key != "data":
                yield from (p for p, _ in leaves(item, inner))
            else:
                yield from places_of(item, inner)


def steps(text: str) -> tuple[str | int, ...] | None:
    """The name and the keys of a path as a user writes it; None if it is none.

    >>> steps('p["k"]'), steps("layers[0].w"), steps("1u")
    (('p', 'k'), ('layers', 0, 'w'), None)
    """
    name = re.match(r"[^\W\d]\w*", text)
    found: list[str | int] = []
    at = name.end() if name else -1
    while name and at < len(text):
        part = _STEP.match(text, at)
        if part is None:
            return None
        found.append(int(part[2]) if part[2] else next(p for p in (part[1], part[3], part[4]) if p is not None))
        at = part.end()
    return (name[0], *found) if name else None


def subtree(form: Form, path: str, keys: tuple[str | int, ...]) -> tuple[Form, str] | None:
    """What a path of keys leads to in a structure, with its path in one spelling; None if it leads nowhere."""
    for key in keys:
        if isinstance(form, Type) or key not in form.keys:
            return None
        form, path = form.items[form.keys.index(key)], step(form, path, key)
    return form, path


# -- values ---------------------------------------------------------------------------------------------------------

def map_leaves(form: Form, value: Any, path: str, change: Callable[[str, Type, Any], Any]) -> Any:
    """A structure like `value` in which every leaf is what `change(path, type, leaf)` gives."""
    if isinstance(form, Type):
        return change(path, form, value)
    items = [map_leaves(item, part_of(form.kind, value, key), step(form, path, key), change)
             for key, item in zip(form.keys, form.items)]
    return rebuilt(form, value, items)


def structures(form: Form, value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Every structure in a value that can be changed, with its path."""
    if isinstance(form, PyTree):
        if form.kind in ("list", "dict", "record"):
            yield path, value
        for key, item in zip(form.keys, form.items):
            yield from structures(item, part_of(form.kind, value, key), step(form, path, key))


def rebuilt(form: PyTree, like: Any, items: list[Any]) -> Any:
    """A structure of the same kind with other items; no code of its class runs."""
    if form.kind in SPARSE:
        return _with_entries(like, items[0])
    if form.kind in ("tuple", "list"):
        return tuple(items) if form.kind == "tuple" else items
    if form.kind == "named":
        return tuple.__new__(type(like), items)
    if form.kind == "dict":
        return type(like)(zip(form.keys, items))
    copied = dataclasses.is_dataclass(like) or type(like) is SimpleNamespace
    new = copy.copy(like) if copied else object.__new__(type(like))
    for key, item in zip(form.keys, items):
        object.__setattr__(new, str(key), item)
    return new


def _with_entries(like: Any, data: Any) -> Any:
    """A sparse matrix with other entries at the same places, which it holds in arrays of its own; the matrix itself if
    there are none."""
    if not isinstance(data, np.ndarray):
        return like
    new = like.copy()
    new.data = data
    return new


def matches_form(form: Form, value: Any) -> bool:
    """Whether a value is made as the description says, whatever its leaves are."""
    if isinstance(form, Type):
        return not is_structure(value)
    kind = _kind(value)
    if kind is None or kind != form.kind:
        return False
    keys = _keys(kind, value)
    if len(keys) != len(form.keys) or set(keys) != set(form.keys):
        return False
    return all(matches_form(item, part_of(kind, value, key)) for key, item in zip(form.keys, form.items))


def without_lengths(form: Form) -> Form:
    """The description without what is known of lengths of axes."""
    if isinstance(form, Type):
        return form.plain
    return dataclasses.replace(form, items=tuple(map(without_lengths, form.items)))


def is_held(kind: Form) -> bool:
    """Whether a leaf takes part in a generated function: arrays, numbers and strings do."""
    return isinstance(kind, Type) and kind.kind not in ("none", "other")

