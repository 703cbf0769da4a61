"""What parameters of a file's function are made of, by annotations whose classes the file defines or imports.

    class State(NamedTuple):            def step(state: State): ...      state: {u: float64[:], t: float64}
        u: "float64[:]"
        t: float
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.infer.assumed_types import parsed_type
from s2sad.infer.types import NONE, TEXT, UNKNOWN, Type
from s2sad.pytree import Form, PyTree, step
from s2sad.read.file_definitions import FileClass, parameters_of
from s2sad.read.file_module import FileModule
from s2sad.read.linker import annotation_text
from s2sad.tree import AST


def annotated(function: Any, forms: Mapping[str, Form]) -> dict[str, Form]:
    """The forms of parameters with the classes of their annotations, and with the fields that these say."""
    found = {p: _named(function.module, form) for p, form in forms.items()}
    for a in parameters_of(function.definition):
        if a.annotation is not None and a.id in found:
            found[a.id] = _refined(function.module, a.annotation, found[a.id], ())
    return found


def _named(module: FileModule, form: Form) -> Form:
    """A form with the classes that a text names."""
    if isinstance(form, Type):
        return form
    form = replace(form, items=tuple(_named(module, i) for i in form.items))
    if not isinstance(form.made, str):
        return form
    made = module.class_meant(tree.name(form.made))
    if made is None:
        raise S2sadError(Diagnostic("S405", f"--types names the class '{form.made}', which '{module.path}' does not "
                                    "define or import", help="say what the object is made of alone, in braces"))
    return _of_class(made, form, ())


def _refined(module: FileModule, node: AST, form: Form, around: tuple[FileClass, ...], is_part: bool = False) -> Form:
    """A form with what an annotation says of it; `around` are the classes of the objects that it is a part of."""
    if isinstance(form, Type) and form != UNKNOWN:
        return form
    made = module.class_meant(node)
    if made is not None and made in around and form == UNKNOWN:
        return Type("other", made.name)
    if made is not None:
        return _of_class(made, form, around)
    text = annotation_text(node, module.source)
    if form == UNKNOWN and text == "None":
        return NONE
    items = node.slice.elts if isinstance(node, tree.Subscript) and isinstance(node.slice, tree.Tuple) else []
    if form == UNKNOWN and text.startswith(("tuple[", "Tuple[")) and items and "..." not in text:
        inner = tuple(_refined(module, i, UNKNOWN, around, True) for i in items)
        return PyTree("tuple", tuple(range(len(items))), inner, fixed=True)
    if is_part and form == UNKNOWN:
        word = text.partition("[")[0].rpartition(".")[2]
        return parsed_type(text) or (TEXT if word == "str" else Type("other", word) if word in _NO_DATA else form)
    return form


_NO_DATA = ("list", "dict", "set", "List", "Dict", "Set", "Callable")


def _of_class(made: FileClass, form: Form, around: tuple[FileClass, ...]) -> Form:
    """An object of a class, with the parts that a text spells or the class's body annotates."""
    said = made.fields()
    spelled = dict(zip(form.keys, form.items)) if isinstance(form, PyTree) else {}
    keys = [*said, *(k for k in spelled if k not in said)]
    if not keys or isinstance(form, PyTree) and form.is_sequence and made.kind != "named":
        return form
    if isinstance(form, PyTree) and form.is_sequence:
        spelled = dict(zip(keys, form.items))
    items = [UNKNOWN if said.get(k) is None and k not in spelled else spelled[k] if said.get(k) is None else _refined(
        said[k][0], said[k][1], spelled.get(k, UNKNOWN), (*around, made), True) for k in keys]  # pyright: ignore
    return PyTree(made.kind, tuple(keys), tuple(items), None if made.kind == "dict" else made, made.kind == "named")


def has_methods(form: Form) -> bool:
    """Whether an object in a form is of a class that has functions."""
    return isinstance(form, PyTree) and (
        isinstance(form.made, FileClass) and form.made.has_functions() or any(map(has_methods, form.items)))


def unnamed(form: Form) -> Form:
    """A form by its parts alone."""
    if isinstance(form, Type):
        return form
    return replace(form, kind="either" if form.kind == "record" else form.kind, made=None,
                   items=tuple(map(unnamed, form.items)))


def mapped_types(form: Form, path: str, change: Callable[[str, Type], Type]) -> Form:
    """A form with other types of its leaves, which go by their paths."""
    if isinstance(form, Type):
        return change(path, form)
    return replace(form, items=tuple(mapped_types(i, step(form, path, k), change) for k, i in zip(
        form.keys, form.items)))
