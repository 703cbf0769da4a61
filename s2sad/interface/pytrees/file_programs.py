"""Programs of functions of files, which are read and not run, without structures.

What the parameters are made of is said: by a text (`--types`), or by annotations whose classes the files define. Where
reading does not know what the program is, or where an object has methods, the evaluator computes it.
"""
from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from s2sad import read
from s2sad.diagnostics import Diagnostic, Report, S2sadError
from s2sad.dispatch.deferred import compiler
from s2sad.evaluate.specialize import unread
from s2sad.evaluate.needs_evaluation import needs_evaluation
from s2sad.infer.assumed_types import Assumed, assumed_types
from s2sad.infer.types import NONE, TEXT, UNKNOWN, Type, array
from s2sad.interface.pytrees.annotated_forms import annotated, mapped_types
from s2sad.program import DemandedFacts, Fact, FlatProgram, Kernel, Program
from s2sad.pytree import Form, PyTree, form_of, is_held, leaves, steps
from s2sad.read.file_definitions import parameters_of
from s2sad.tree import AST, Attribute, Constant, Name, Subscript, walk

_OF_ARRAYS = ("shape", "size", "ndim", "dtype", "T", "copy", "fill", "sum", "mean", "min", "max", "dot", "reshape",
              "ravel", "flatten", "transpose", "astype", "prod", "std", "var", "real", "item", "argmax", "argmin",
              "cumsum", "clip", "sort", "any", "all", "nonzero", "squeeze", "swapaxes", "repeat", "take", "tolist")


@dataclass(frozen=True)
class Said:
    """What is said of parameters: what they are made of, and what values or shapes some have, by their paths."""
    forms: Mapping[str, Form] = field(default_factory=dict)
    facts: Mapping[Fact, Any] = field(default_factory=dict)


def file_program(path: str | os.PathLike[str], function: str) -> Program:
    """The program of a function of a file; where reading refuses it, one that waits for what it is given."""
    meaning, files = read.function_in_file(path, function)
    try:
        return replace(read.load_meaning(meaning), files=tuple(files), function=meaning.handle)
    except S2sadError as refused:
        if refused.diagnostics[0].code.startswith("S1"):
            raise
        return replace(unread(meaning.handle, refused), files=tuple(files))


def flat_spelled(program: Program, said: Said) -> tuple[Program, dict[str, Assumed], dict[str, str]]:
    """The program without structures, the types of its parameters, assumed where they are not said, and the paths of
    its parameters in structures; raises S2sadError where a parameter has parts that are unknown."""
    kernel = program.kernels[program.entry]
    forms = _forms(program, kernel, said)
    _known(program, forms)
    plain = program.refused is None and not needs_evaluation(program)
    if plain and not any(isinstance(f, PyTree) for f in forms.values()):
        known = {p: t for p, t in forms.items() if p in said.forms and isinstance(t, Type)}
        return program, _assumed(program, known), {}
    refused = program.refused
    flat, facts = _evaluated(program, forms, said, refused)
    found = _assumed(flat.program, _leaves(flat, forms))
    if any(t == UNKNOWN for p, f in forms.items() for _, t in leaves(f, p)):
        types = {path: found[name].type for name, path in flat.paths.items()}
        forms = {p: mapped_types(f, p, types.get) for p, f in forms.items()}
        flat, facts = _evaluated(program, forms, said, refused)
        again = _assumed(flat.program, _leaves(flat, forms))
        found = {n: replace(a, reason=found[n].reason) if n in found else a for n, a in again.items()}
    made_for = {path: f"made for {path}{'.shape' if what == 'shape' else ''} = {value!r}"
                for (path, what), value in facts.items()}
    found = {n: replace(a, reason=made_for.get(flat.paths[n], a.reason)) for n, a in found.items()}
    return flat.program, found, flat.paths


def _forms(program: Program, kernel: Kernel, said: Said) -> dict[str, Form]:
    """What the parameters are made of, as far as it is known."""
    defaults = {p: NONE if d is None else TEXT if isinstance(d, str) else form_of(d, p)
                for p, d in kernel.defaults.items() if d is None or isinstance(d, (tuple, str))}
    forms = {p: said.forms.get(p, defaults.get(p, UNKNOWN)) for p in kernel.parameters}
    return annotated(program.function, forms)


_NOTHING = S2sadError(Diagnostic("S201", "an object has methods"))


def _evaluated(program: Program, forms: Mapping[str, Form], said: Said, refused: S2sadError | None
               ) -> tuple[FlatProgram, dict[Fact, Any]]:
    """The residual program, and the facts about arguments that it is made for; raises S2sadError, also where more must
    be said of these."""
    facts: dict[Fact, Any] = {}
    while True:
        try:
            return compiler().evaluated(program, tuple(forms.values()), (), facts, refused or _NOTHING), facts
        except DemandedFacts as demanded:
            missing = sorted(demanded.facts - said.facts.keys())
            if missing or demanded.facts <= facts.keys():
                help = _said(*(missing or sorted(demanded.facts))[0], forms)
                raise S2sadError(*(replace(d, help=help) for d in demanded.error.diagnostics)) from None
            facts |= {fact: said.facts[fact] for fact in demanded.facts}


def _said(path: str, what: str, forms: Mapping[str, Form]) -> str:
    """How one says a fact about an argument."""
    name, *keys = steps(path) or ("",)
    if what.startswith("is ") or not all(isinstance(k, str) for k in keys):
        return "call it in Python, where the arguments are at hand"
    types = dict(leaf for p, form in forms.items() for leaf in leaves(form, p))
    spelled = "float64[4]" if what == "shape" else "'...'" if types.get(path) == TEXT else "3"
    for key in reversed(keys):
        spelled = f"{{{key}: {spelled}}}"
    return f"say {'what shape' if what == 'shape' else 'which'} '{path}' {'has' if what == 'shape' else 'is'}, as " \
        f'--types "{name}: {spelled}"'


def _leaves(flat: FlatProgram, forms: Mapping[str, Form]) -> dict[str, Type]:
    """The types of the flat parameters that are known."""
    kinds = {path: kind for p, form in forms.items() for path, kind in leaves(form, p) if is_held(kind)}
    return {name: array(kinds[path].dtype, 1) if name in flat.cells else kinds[path]
            for name, path in flat.paths.items() if kinds[path] != UNKNOWN}


def _assumed(program: Program, known: Mapping[str, Type]) -> dict[str, Assumed]:
    kernel = program.kernels[program.entry]
    report = Report(kernel.source)
    found = assumed_types(program.entry, {n: k.tree for n, k in program.kernels.items()}, kernel.parameters,
                          kernel.annotations, kernel.defaults, known, report)
    report.finish()
    return found


def _known(program: Program, forms: Mapping[str, Form]) -> None:
    """Refuses a parameter that is read by field or key and has no type."""
    function = program.function
    report, parts = Report(function.module.source), {}
    for node in walk(function.definition.body):
        if isinstance(node, (Attribute, Subscript)) and isinstance(node.value, Name) and forms.get(
                node.value.id) == UNKNOWN and _part(node):
            parts.setdefault(node.value.id, []).append(node)
    classes = {a.id: function.module.class_meant(a.annotation) for a in parameters_of(function.definition)
               if a.annotation is not None}
    for name, nodes in parts.items():
        made = classes.get(name)
        words = dict.fromkeys(map(_part, nodes)) if made is None else made.attributes()
        found = ", ".join(f"{k}: float64" for k in words)
        report.error("S203", f"'{name}' has parts, whose types are not known", nodes[0],
                     help=f'say what it is made of, as --types "{name}: {{{found}}}"')
    report.finish()


def _part(node: AST) -> str:
    """The field or key that a part is read by; empty if it is an attribute or an element of an array."""
    if isinstance(node, Attribute):
        return "" if node.attr in _OF_ARRAYS else node.attr
    key = node.slice.value if isinstance(node.slice, Constant) else None
    return key if isinstance(key, str) else ""
