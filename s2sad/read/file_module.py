"""What the names of a file mean, without running it: imports, functions and plain constants at module level.

Statements are followed in order, as Python would run them on import. A name that is bound under a condition, in a
loop or by an expression that is not constant arithmetic is known, but unusable, and says so.
"""
from __future__ import annotations

import builtins
import os
from typing import Any

from s2sad import tree
from s2sad.read.capture import source_of
from s2sad.read.constant_folding import folded
from s2sad.read.file_definitions import FileClass, FileFunction, dropped_decorator, makes_derivative
from s2sad.read.module_bindings import bound_names, bound_twice, changed_name, imports_name
from s2sad.read.source_text import parsed, read_text
from s2sad.read.namespaces import NamespaceScope
from s2sad.read.outside_values import (
    AST, UserFunctionValue, Namespace, NumberTable, Library, LibraryScope, Meaning, NotConstant, Number,
    Numbers, ModuleValue, Unusable, dotted, is_numbers, value_meaning,
)

LIBRARIES = ("numpy", "math", "scipy", "numba", "s2sad", "builtins", "itertools", "cmath")


class FileModule:
    """A file's module-level names and what they mean; also the scope of its functions."""

    def __init__(self, path: str, cache: dict[str, FileModule]):
        self.path, self.cache = path, cache
        cache[os.path.realpath(path)] = self
        self.name = os.path.splitext(os.path.basename(path))[0]
        text = read_text(path)
        self.source = source_of(path, text)
        self.meanings: dict[str, Meaning | _Member] = {}
        self.definitions: list[str] = []
        self.origins: dict[str, AST | _Member] = {}
        self.tree = module = parsed(self.source, text)
        self.often = bound_twice(module.body)
        for statement in module.body:
            self._follow(statement)
        for node in tree.walk(module):
            if type(node).__name__ == "Global":
                for name in node.names:
                    self.meanings[name] = Unusable("changed by a function through 'global'", _PASS_IT)
                    self.origins.pop(name, None)
        for name in self._changed(module):
            self.meanings[name] = Unusable("changed after it was made", _PASS_IT)
            self.origins.pop(name, None)
        for name, node in self.origins.items():     # the evaluator sees whether it is changed there
            if isinstance(self.meanings[name], (Namespace, NumberTable, Numbers)) and not isinstance(
                    node, tree.Tuple) and self.uses(name):
                self.meanings[name] = Unusable("given to a function at module level, which may change it", _PASS_IT)

    def _changed(self, module: AST) -> set[str]:
        """The names of what statements change, and of what shares something with it."""
        found = {w for n in tree.walk(module) if (w := changed_name(n)) and (isinstance(
            self.meanings.get(w), (Namespace, NumberTable, Numbers)) or isinstance(self.origins.get(w), AST))}
        made = {n: {m.id for m in tree.walk(node) if isinstance(m, tree.Name)} for n, node in self.origins.items()
                if isinstance(node, AST) and type(node).__name__ not in ("FunctionDef", "ClassDef")
                and isinstance(self.meanings[n], (Namespace, NumberTable, Numbers, Unusable))}
        while True:
            more = {n for n, parts in made.items() if parts & found}
            more |= {m for n in found & made.keys() for m in made[n] & made.keys()}
            if more <= found:
                return found
            found |= more

    def lookup(self, name: str) -> Meaning | None:
        meaning = self.meanings.get(name)
        if isinstance(meaning, _Member):
            meaning = self.meanings[name] = meaning.found()
        if meaning is None and hasattr(builtins, name):
            return Library(f"builtins.{name}")
        return meaning

    def origin(self, name: str) -> tuple[FileModule, str, AST] | None:
        """The file and the class, the function or the expression that a name means; None for anything else."""
        found = self.origins.get(name)
        if isinstance(found, _Member):
            space = found.importer.space(found.module, found.level).scope
            return space.origin(found.name) if found.name is not None and isinstance(space, PackageScope) else None
        return None if found is None else (self, name, found)

    def class_meant(self, node: AST) -> FileClass | None:
        """The class of a file that an annotation or a base names."""
        if isinstance(node, tree.Constant) and isinstance(node.value, str):
            try:
                return self.class_meant(tree.expression(node.value))
            except SyntaxError:
                return None
        base = self.path_meaning(node.value) if isinstance(node, tree.Attribute) else None
        scope = base.scope if isinstance(base, ModuleValue) else None
        found = self.origin(node.id) if isinstance(node, tree.Name) else scope.origin(node.attr) if isinstance(
            scope, PackageScope) else None
        if found is None:
            return None
        module, _, definition = found
        by_call = isinstance(definition, tree.Call) and len(definition.args) > 1 and dotted(
            module.path_meaning(definition.func)) == "collections.namedtuple"
        return FileClass(*found) if by_call or type(definition).__name__ == "ClassDef" else None

    def uses(self, name: str) -> list[AST]:
        """The calls at module level that are given what a name means, and may change it."""
        calls = [n for s in self.tree.body if type(s).__name__ in ("Expr", "Assign", "AnnAssign", "If", "For", "With")
                 and not _is_main(s) for n in tree.walk(s) if isinstance(n, tree.Call)]
        return [n for n in calls if not self._is_harmless(n.func) and any(
            isinstance(a, tree.Name) and a.id == name for p in (*n.args, *(k.value for k in n.keywords))
            for a in tree.walk(p))]

    def _is_harmless(self, function: AST) -> bool:
        """Whether a library's function changes no lists and dicts that it is given."""
        path = dotted(self.path_meaning(function)) or ""
        root, _, name = path.partition(".")
        return root in _HARMLESS and name not in ("setattr", "delattr", "exec", "eval", "random.shuffle")

    def known(self) -> list[str]:
        return list(self.meanings)

    def is_being_imported(self, name: str) -> bool:
        """Whether a name is what an import of this file is looking for just now: imports may go round in circles."""
        meaning = self.meanings.get(name)
        return isinstance(meaning, _Member) and meaning.is_under_way

    def imported(self, module: str, level: int, name: str | None) -> Meaning:
        """What an import in a function of the file binds."""
        return _Member(self, module, level, name).found()

    # -- statements ---------------------------------------------------------------------------------------------------

    def _follow(self, statement: AST) -> None:
        kind = type(statement).__name__
        if kind in ("FunctionDef", "AsyncFunctionDef"):
            self.definitions.append(statement.name)
            self.meanings[statement.name] = UserFunctionValue(statement.name, ("file", self.path, statement.lineno),
                                                              f"{self.name}.{statement.name}", FileFunction(self,
                                                                                                            statement))
            self.origins[statement.name] = statement
            if any(self._gives(d) for d in statement.decorator_list):
                self.meanings[statement.name] = _GIVEN
                del self.origins[statement.name]
        elif kind == "Expr" and isinstance(statement.value, tree.Call) and self._gives(statement.value):
            first = statement.value.args[0] if statement.value.args else None
            text = first.value if isinstance(first, tree.Constant) and isinstance(first.value, str) else ""
            name = first.id if isinstance(first, tree.Name) else text.partition("(")[0].rpartition(".")[2]
            if name in self.meanings:
                self.meanings[name] = _GIVEN
                self.origins.pop(name, None)
        elif kind == "ClassDef":
            self.meanings[statement.name] = Unusable("a class", "pass its fields as arguments, numbers and arrays")
            self.origins[statement.name] = statement
        elif kind == "Import":
            self._import(statement)
        elif kind == "ImportFrom":
            self._import_from(statement)
        elif kind in ("Assign", "AnnAssign") and statement.value is not None:
            targets = statement.targets if kind == "Assign" else [statement.target]
            self._assign(targets, statement.value)
        elif kind in ("Try", "TryStar"):
            self._try(statement)
        else:
            self._unclear(statement, "set under a condition, in a loop or by more than an assignment")

    def _gives(self, node: AST) -> bool:
        """Whether a decorator or a call gives a function a derivative of its own."""
        path = dotted(self.path_meaning(node.func if isinstance(node, tree.Call) else node))
        return path in ("s2sad.rule", "s2sad.nondifferentiable")

    def _try(self, statement: AST) -> None:
        """`try: from numba import prange / except ImportError: ...` means what it imports."""
        before = dict(self.meanings)
        for inner in statement.body:
            self._follow(inner)
        imported = {n for n, m in self.meanings.items() if before.get(n) is not m
                    and any(imports_name(i, n) for i in statement.body if type(i).__name__.startswith("Import"))}
        for part in (*statement.handlers, *statement.orelse, *statement.finalbody):
            self._unclear(part, "set under a condition", imported)

    def _unclear(self, node: AST, why: str, except_for: set[str] | frozenset[str] = frozenset()) -> None:
        for name in bound_names(node):
            if name not in except_for:
                self.meanings[name] = Unusable(why, _PASS_IT)
                self.origins.pop(name, None)

    def _assign(self, targets: list[AST], value: AST) -> None:
        for target in targets:
            if isinstance(target, (tree.Tuple, tree.List)) and isinstance(value, (tree.Tuple, tree.List)) \
                    and len(target.elts) == len(value.elts):
                meanings = [self._value(item, each) for item, each in zip(target.elts, value.elts)]
                pairs = list(zip(target.elts, meanings, value.elts))
            else:
                pairs = [(target, self._value(target, value), value)]
            for item, meaning, node in pairs:
                if isinstance(item, tree.Name):
                    self.meanings[item.id] = meaning
                    self.origins[item.id] = node
                else:
                    self._unclear(item, "not set by a plain assignment")

    def _value(self, target: AST, value: AST) -> Meaning:
        name = target.id if isinstance(target, tree.Name) else ""
        alias = self.path_meaning(value)
        if isinstance(alias, Number):
            return Number(name, alias.value)
        if alias is not None:
            return alias
        if isinstance(value, tree.Call):
            maker = self.path_meaning(value.func) or (self._value(target, value.func)
                                                      if isinstance(value.func, tree.Call) else None)
            if maker is not None and dropped_decorator(dotted(maker) or ""):
                if makes_derivative(dotted(maker) or ""):
                    return maker
                inner = self.path_meaning(value.args[0]) if len(value.args) == 1 else None
                return inner if isinstance(inner, UserFunctionValue) else maker
        try:
            return self._holding(name, self.folded(value))
        except NotConstant:
            return Unusable("not constant arithmetic, and the file is read without being run", _PASS_IT)

    def _holding(self, name: str, value: Any) -> Meaning:
        return Namespace(name, NamespaceScope(name, value, self._holding), "a dict") if isinstance(value, dict) else \
            value_meaning(name, value)

    def folded(self, node: AST) -> Any:
        """The value of a constant expression, or of a tuple or list of such; raises NotConstant for any other."""
        if isinstance(node, (tree.Tuple, tree.List)):
            found = tuple(map(self.folded, node.elts))
            if not is_numbers(found):
                raise NotConstant
            return found
        if isinstance(node, tree.Dict) and node.keys and all(
                isinstance(k, tree.Constant) and isinstance(k.value, str) for k in node.keys):
            return {k.value: self.folded(v) for k, v in zip(node.keys, node.values)}
        return folded(node, self.path_meaning)

    def path_meaning(self, node: AST) -> Meaning | None:
        """The meaning of a name or dotted path, None for anything else."""
        if isinstance(node, tree.Name):
            return self.lookup(node.id)
        if isinstance(node, tree.Attribute):
            base = self.path_meaning(node.value)
            return base.scope.lookup(node.attr) if isinstance(base, ModuleValue) else None
        return None

    # -- imports ------------------------------------------------------------------------------------------------------

    def _import(self, statement: AST) -> None:
        for alias in statement.names:
            if alias.asname:
                self._bind_member(alias.asname, alias.name, 0, None)
            else:
                # `import a.b` binds a, from which b is reached
                self._bind_member(alias.name.partition(".")[0], alias.name.partition(".")[0], 0, None)

    def _bind_member(self, name: str, module: str, level: int, member: str | None) -> None:
        self.meanings[name] = self.origins[name] = _Member(self, module, level, member)

    def _import_from(self, statement: AST) -> None:
        for alias in statement.names:
            if alias.name != "*":
                self._bind_member(alias.asname or alias.name, statement.module or "", statement.level or 0, alias.name)
                continue
            space = self.space(statement.module or "", statement.level or 0)
            for name in space.scope.known():
                if not name.startswith("_"):
                    self._bind_member(name, statement.module or "", statement.level or 0, name)

    def space(self, module: str, level: int) -> ModuleValue:
        """An imported module: a library's, a file beside this one (or in its package), or a foreign one."""
        if not level and module.partition(".")[0] in LIBRARIES:
            return ModuleValue(module, LibraryScope(module))
        path = next((p for folder in self._folders(level) if (p := _file(folder, module))), None)
        if path is None:
            return ModuleValue(module, LibraryScope("." * level + module))
        found = self.cache.get(os.path.realpath(path)) or FileModule(path, self.cache)
        return ModuleValue(module, PackageScope(found))

    def _folders(self, level: int) -> list[str]:
        folder = os.path.dirname(self.path)
        if level:
            return [os.path.join(folder, *[".."] * (level - 1))]
        folders = [folder]
        while os.path.exists(os.path.join(folder, "__init__.py")) and folder != os.path.dirname(folder):
            folder = os.path.dirname(folder)
            folders.append(folder)
        return folders


_GIVEN = Unusable("given a derivative of its own, in a file that is read without being run",
                  "ask for the derivative in Python, where the file is imported")
_HARMLESS = ("builtins", "numpy", "math", "scipy", "matplotlib")
_PASS_IT = "pass it to the kernel as an argument, or write it at module level as a plain number"


class PackageScope:
    """The names of an imported file, not those of builtins; a package's files are reached as attributes, too: by the
    package itself, which imports them with `from . import helpers`."""

    def __init__(self, module: FileModule):
        self.module = module

    def lookup(self, name: str) -> Meaning | None:
        if name in self.module.meanings and not self.module.is_being_imported(name):
            return self.module.lookup(name)
        if os.path.basename(self.module.path) == "__init__.py":
            path = _file(os.path.dirname(self.module.path), name)
            if path:
                cache = self.module.cache
                return ModuleValue(name, PackageScope(cache.get(os.path.realpath(path)) or FileModule(path, cache)))
        return None

    def origin(self, name: str) -> tuple[FileModule, str, AST] | None:
        """What `FileModule.origin` gives."""
        return self.module.origin(name) if self.lookup(name) is not None else None

    def known(self) -> list[str]:
        return self.module.known()


class _Member:
    """An imported name, looked up when it is first used: imports may go round in circles."""

    def __init__(self, importer: FileModule, module: str, level: int, name: str | None):
        self.importer, self.module, self.level, self.name = importer, module, level, name
        self.is_under_way = False

    def found(self) -> Meaning:
        self.is_under_way = True
        try:
            space = self.importer.space(self.module, self.level)
            if self.name is None:
                return space
            if not isinstance(space.scope, PackageScope) and (self.level or self.module):
                inner = self.importer.space(f"{self.module}.{self.name}".lstrip("."), self.level)   # without __init__
                if isinstance(inner.scope, PackageScope):
                    return inner
            return space.scope.lookup(self.name) or Unusable(f"not in the module '{space.name}'", "correct the import")
        finally:
            self.is_under_way = False


def _file(folder: str, module: str) -> str | None:
    base = os.path.join(folder, *module.split(".")) if module else folder
    paths = (base + ".py", os.path.join(base, "__init__.py"))
    return next((p for p in paths[not module:] if os.path.isfile(p)), None)


def _is_main(statement: AST) -> bool:
    """Whether a statement is for the file as a program: `if __name__ == "__main__": ...`."""
    test = getattr(statement, "test", None)
    return isinstance(test, tree.Compare) and isinstance(test.left, tree.Name) and test.left.id == "__name__"
