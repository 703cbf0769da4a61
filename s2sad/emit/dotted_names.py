"""dotted_names: how dotted names print: in general, and in one module, where no two things may share a name."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from s2sad import tree
from s2sad.emit.literals import needs_numpy
from s2sad.emit.paste import RuntimeFunction
from s2sad.emit.outside_uses import OutsideUses
from s2sad.naming import Names

# A whole id, or the part before its first dot -> its spelling.
SPELLING: Mapping[str, str] = {
    "numpy": "np", "math": "math", "builtins": "", "user": "", "const": "", "array": "", "runtime": "",
}
# Where a module's spelling holds the name under which it imports `builtins`, if it must.
BUILTINS = "import builtins"
# The same for the one module of SciPy's that generated text calls.
SPECIAL = "from scipy import special"


def spell(identifier: str, spelling: Mapping[str, str] = SPELLING) -> str:
    """The spelling of a name's id.

    >>> spell("numpy.linalg.det"), spell("builtins.range"), spell("u"), spell("const.G", {"const.G": "G_"})
    ('np.linalg.det', 'range', 'u', 'G_')
    """
    if "." not in identifier:
        return identifier
    if identifier in spelling:
        return spelling[identifier]
    room, rest = identifier.split(".", 1)
    alias = spelling.get(room, SPELLING.get(room, room))
    return f"{alias}.{rest}" if alias else rest


def literal(value: Any) -> tree.AST:
    """The tree of a constant's value; a table is an array."""
    if isinstance(value, np.ndarray):
        return tree.call("numpy.array", literal(value.tolist()))
    if isinstance(value, list):
        return tree.List(list(map(literal, value)), tree.Load())
    return tree.tuple_of(*map(literal, value)) if isinstance(value, tuple) else tree.const(value)


def module_spelling(uses: OutsideUses, constants: Mapping[str, tree.AST], pieces: list[RuntimeFunction]) -> dict[str,
                                                                                                                 str]:
    """The spelling for a module: libraries that it imports, and every id that does not print as it would alone.

    The user's names come first, then constants, then what s2sad adds.
    """
    names, spelling = Names(uses.local_names), {}
    for key in uses.room("user"):
        if uses.hidden(f"user.{key}"):
            spelling[f"user.{key}"] = names.fresh(key)
    for key in constants:
        spelling[f"const.{key}"] = names.fresh(key)
    for key in dict.fromkeys([*(piece.name for piece in pieces), *uses.room("runtime")]):
        spelling[f"runtime.{key}"] = names.fresh(key)
    if special := uses.room("scipy"):
        spelling[SPECIAL] = names.fresh("special")
        spelling.update({f"scipy.{key}": f"{spelling[SPECIAL]}.{key.rpartition('.')[2]}" for key in special})
    for key in uses.room("given"):
        spelling[f"given.{key}"] = names.fresh(key.rpartition(".")[2])
    libraries = {library for library in ("math", "numpy") if uses.room(library)}
    libraries = libraries.union(*(piece.libraries for piece in pieces))
    if any(needs_numpy(node.value) if isinstance(node, tree.Constant) else isinstance(node, tree.Call)
           for value in constants.values() for node in tree.walk(value)):
        libraries.add("numpy")
    for library in sorted(libraries):
        spelling[library] = names.fresh({"numpy": "np"}.get(library, library))
    _spell_builtins(uses, pieces, names, spelling)
    return spelling


def _spell_builtins(uses: OutsideUses, pieces: list[RuntimeFunction], names: Names, spelling: dict[str, str]) -> None:
    """A builtin that a function of the module or a local variable hides is read from the module `builtins`."""
    read = set(uses.room("builtins")).union(*(piece.builtins for piece in pieces))
    hidden = sorted(key for key in read if key in uses.local or uses.hidden(f"builtins.{key}"))
    if hidden:
        spelling[BUILTINS] = alias = names.fresh("builtins")
        spelling.update({f"builtins.{key}": f"{alias}.{key}" for key in hidden})
