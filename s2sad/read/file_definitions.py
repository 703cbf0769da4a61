"""Functions and classes of files that are not run, as their definitions say.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from s2sad import tree
from s2sad.read.constant_folding import folded
from s2sad.read.outside_values import AST, Captured, NotConstant, dotted, is_number, is_numbers

if TYPE_CHECKING:
    from s2sad.read.file_module import FileModule


@dataclass(frozen=True)
class FileClass:
    """A class of a file that is not run: its definition, or the call that makes it."""
    module: FileModule
    name: str
    definition: AST

    @property
    def __name__(self) -> str:
        return self.name

    @property
    def kind(self) -> str:
        """What its objects are to a kernel: "record", "named" or "dict"."""
        bases = {dotted(c.module.path_meaning(b)) for c in self.classes() for b in getattr(c.definition, "bases", ())}
        return "named" if isinstance(self.definition, tree.Call) or "typing.NamedTuple" in bases else \
            "dict" if "typing.TypedDict" in bases else "record"

    def classes(self) -> list[FileClass]:
        """The class and those that it is derived from, as far as files define them."""
        found = [c for b in getattr(self.definition, "bases", ()) if (c := self.module.class_meant(b)) is not None]
        return [self, *(inner for c in found for inner in c.classes())]

    def fields(self) -> dict[str, tuple[FileModule, AST] | None]:
        """The annotations in its body and those of its bases, each with the file that it is in."""
        if isinstance(self.definition, tree.Call):
            said = self.definition.args[1]
            names = said.elts if isinstance(said, (tree.List, tree.Tuple)) else [said]
            text = " ".join(str(getattr(n, "value", "")) for n in names)
            return dict.fromkeys(text.replace(",", " ").split())
        return {s.target.id: (c.module, s.annotation) for c in reversed(self.classes()) for s in getattr(
            c.definition, "body", ()) if isinstance(s, tree.AnnAssign) and isinstance(s.target, tree.Name)
            and "ClassVar" not in str([getattr(n, "id", getattr(n, "attr", "")) for n in tree.walk(s.annotation)])}

    def attributes(self) -> list[str]:
        """The names that its functions assign as attributes of their first parameters."""
        functions = [s for c in self.classes() for s in getattr(c.definition, "body", ()) if isinstance(
            s, tree.FunctionDef) and s.args.args]
        return list(dict.fromkeys(
            n.attr for s in functions for n in tree.walk(s.body) if isinstance(n, tree.Attribute) and isinstance(
                n.ctx, tree.Store) and isinstance(n.value, tree.Name) and n.value.id == s.args.args[0].id))

    def has_functions(self) -> bool:
        """Whether it has functions of its own or from a base, one that no file defines included."""
        known = ("typing.NamedTuple", "typing.TypedDict", "builtins.object")
        return any(isinstance(s, tree.FunctionDef) for c in self.classes() for s in getattr(c.definition, "body", ())) \
            or any(self.module.class_meant(b) is None and dotted(c.module.path_meaning(b)) not in known
                   for c in self.classes() for b in getattr(c.definition, "bases", ()))


class FileFunction:
    """A definition in a file that is not run."""

    def __init__(self, module: FileModule, definition: AST):
        self.module, self.definition, self.__name__ = module, definition, definition.name

    @property
    def decorators(self) -> list[AST]:
        """The decorators that may make another function of it."""
        return [d for d in self.definition.decorator_list
                if makes_derivative(self._path(d)) or not dropped_decorator(self._path(d))]

    def _path(self, decorator: Any) -> str:
        node = decorator.func if isinstance(decorator, tree.Call) else decorator
        return dotted(self.module.path_meaning(node)) or ""

    @property
    def is_derivative(self) -> bool:
        """Whether a decorator makes a derivative of it, which its name means from then on."""
        return any(makes_derivative(self._path(d)) for d in self.definition.decorator_list)

    def itself(self) -> FileFunction:
        """The function that is written there, whatever derivative its name means."""
        definition = tree.head_copy(self.definition)
        definition.decorator_list = [d for d in definition.decorator_list if not makes_derivative(self._path(d))]
        return FileFunction(self.module, definition)

    def captured(self) -> Captured:
        def default(parameter: str, node: AST) -> Any:
            if any(isinstance(n, tree.Name) and n.id in self.module.often for n in tree.walk(node)):
                raise NotConstant       # which of the values it was is known to who runs the file
            value = folded(node, self.module.path_meaning) if isinstance(node, tree.List) else self.module.folded(node)
            if value is None or isinstance(value, str) or is_number(value) or is_numbers(value, tuple):
                return value
            raise NotConstant(self.module.path_meaning(node))
        return Captured(self.definition.name, self.definition, self.module.source, self.module, default)


_AS_IT_IS = ("differentiate", "rule", "nondifferentiable")


def makes_derivative(path: str) -> bool:
    """Whether something of this package, by its dotted path, makes another function of the one that it is given."""
    root, _, rest = path.partition(".")
    return root == "s2sad" and rest.partition(".")[0] not in _AS_IT_IS


def dropped_decorator(path: str) -> bool:
    """Whether a decorator, by its dotted path, leaves the function's meaning alone: Numba's jit, all of s2sad's, and
    those of a class's functions."""
    root, _, rest = path.partition(".")
    of_class = path in ("builtins.classmethod", "builtins.property", "builtins.staticmethod")
    return root == "s2sad" or of_class or (root == "numba" and rest.rpartition(".")[2] in ("jit", "njit"))


def parameters_of(definition: AST) -> list[AST]:
    """A function's parameters that are given one by one."""
    return [*definition.args.posonlyargs, *definition.args.args, *definition.args.kwonlyargs]
