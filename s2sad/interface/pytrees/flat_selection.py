"""What wrt, of and outputs mean where arguments are structures: the flat names of the floats in them.

    wrt=("state.inner", "p")     ->   ("state_inner_u", "state_inner_v", "p_k")
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.infer.types import FLOAT, NONE, TEXT, Type, array
from s2sad.interface.value_calls import selection_of
from s2sad.interface.selection import RETURN, Selection
from s2sad.program import Recording
from s2sad.pytree import Form, PyTree, is_held, leaves, subtree, steps
from s2sad.dispatch.cache import ProgramVersion

Path = tuple[str, Form, str]            # what the caller asked for, what it is, its path in one spelling


class Carrier:
    """What a differentiated function carries."""

    def __init__(self, selection: Selection):
        self.__s2sad_selection__ = selection

    @classmethod
    def with_overrides(cls, f: Any, wrt: Any, of: Any, engine: str | None,
                       recording: Recording | None = None) -> Carrier:
        """What f carries, with other arguments in its place."""
        carried = selection_of(f)
        return cls(Selection(wrt if wrt is not None else carried.wrt, of if of is not None else carried.of,
                             engine if engine is not None else carried.engine,
                             recording if recording is not None else carried.recording))


class FlatSelection:
    """The inputs and outputs of one function for arguments of one make; `names` are its flat names by path, `cells`
    those of arrays of one element, `changed` the paths of objects that hold something else in the end."""
    forms: dict[str, Form]
    names: dict[str, str]
    paths: dict[str, str]
    cells: frozenset[str]
    changed: frozenset[str]
    plain: tuple[str, ...]          # the parameters that the kernel's text takes for floats
    state: ProgramVersion
    title: str

    def selected_paths(self, names: Sequence[str] | None, what: str) -> list[Path]:
        """What names mean: a parameter, or a part of one; by default every parameter that holds a float."""
        if names is None:
            return [(p, f, p) for p, f in self.forms.items() if self.floats(f, p)]
        return [self._selected_path(n, what) for n in names]

    def independents(self) -> list[str]:
        """The parameters that a gradient is with respect to by default: structures that hold a float, and
        others by the kernel's text."""
        return [p for p, form in self.forms.items() if (
            self.floats(form, p) if isinstance(form, PyTree) else
            p in self.plain and form not in (NONE, TEXT) and p in self.names)]

    def _selected_path(self, name: str, what: str) -> Path:
        keys = steps(name)
        root = str(keys[0]) if keys else name
        if keys is None or root not in self.forms:
            raise _refused(f"{what} names '{name}', which is no parameter of '{self.title}'",
                           f"its parameters are {', '.join(self.forms)}")
        found = subtree(self.forms[root], root, keys[1:])
        if found is None:
            parts = [path for path, _ in leaves(self.forms[root], root)]
            raise _refused(f"{what} names '{name}', and '{root}' has no such part",
                           f"its parts are {', '.join(parts[:12])}{', ...' if len(parts) > 12 else ''}")
        return name, *found

    def floats(self, form: Form, path: str) -> list[str]:
        """The flat names of the floats in something."""
        return [self.names[p] for p, t in leaves(form, path) if is_held(t) and (
            t.is_inexact or t.is_number and self.names[p] in self.state.floats)]

    def flat_names(self, paths: Sequence[Path], what: str) -> tuple[str, ...]:
        """The flat names of paths."""
        found: list[str] = []
        for name, form, path in paths:
            own = self.floats(form, path)
            if isinstance(form, PyTree) and not own:
                raise _refused(f"{what} names '{name}', which holds no float")
            found += own or [self.names.get(path, path)]
        return tuple(dict.fromkeys(found))

    def carrier(self, f: Any) -> tuple[list[Path] | None, Carrier]:
        """What a differentiated function carries: its wrt, and all of it in flat names."""
        carried = selection_of(f)
        inputs = None if carried.wrt is None else self.selected_paths(carried.wrt, "wrt")
        wrt = None if inputs is None else self.flat_names(inputs, "wrt")
        return inputs, Carrier(carried._replace(wrt=wrt, of=self.outputs(carried.of)))

    def outputs(self, of: Sequence[str] | None) -> tuple[str, ...] | None:
        """The flat names of outputs: of a structure the floats that the kernel writes."""
        if of is None:
            return None
        found: list[str] = [RETURN] if RETURN in of else []
        for path in self.selected_paths([n for n in of if n != RETURN], "of"):
            found += self.written(path)
        return tuple(dict.fromkeys(found))

    def written(self, path: Path) -> list[str]:
        """The floats in something that the kernel writes; a leaf is itself."""
        name, form, spelling = path
        if isinstance(form, Type):
            return [self.names.get(spelling, spelling)]
        if self.leaves_another(spelling):
            raise _refused(f"'{self.title}' leaves something else in '{name}' than was there, which is no output",
                           "return it, or write it into an array in place")
        found = [n for n in self.floats(form, spelling) if n in self._summary.written]
        if not found:
            raise _refused(f"'{name}' is no output of '{self.title}', which writes no float in it")
        return found

    def leaves_another(self, spelling: str) -> bool:
        """Whether an object at a path, or one in it, holds something else in the end."""
        return any(p == spelling or p.startswith((f"{spelling}.", f"{spelling}[")) for p in self.changed)

    @cached_property
    def _summary(self) -> Any:
        """What the kernel writes."""
        kinds = [t for p, f in self.forms.items() for _, t in leaves(f, p) if is_held(t)]
        types = [array(t.dtype, 1) if n in self.cells else FLOAT if n in self.state.floats and t.is_number else t
                 for n, t in zip(self.paths, kinds)]
        return self.state.summary(tuple(types))


def _refused(message: str, remedy: str = "") -> S2sadError:
    return S2sadError(Diagnostic("S401", message, help=remedy))
