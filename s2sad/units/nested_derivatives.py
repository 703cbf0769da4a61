"""nested_derivatives: a derivative that a kernel calls becomes a kernel, made for the types of its arguments.

    def loss(x, k):                                     def force(x, k):
        f = force(x, k)     # s2sad.gradient(energy)        x_bar = np.zeros_like(x)
        return np.sum(f * f)                                energy_adjoint(x, x_bar, k, 1.0)
                                                            return x_bar

Requires a program in which a kernel stands for the derivative, calling the function that is differentiated, the types
of a call of it, and the generated derivative, read as any text is. Establishes a program with the functions of that
text. So derivatives nest as deep as they are called: the text of an inner one is differentiated as what it is.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from s2sad.infer.types import Type
from s2sad.live_objects.guards import same
from s2sad.naming import Names
from s2sad.program import EntrySummary, Generated, Kernel, Program, Request
from s2sad.tree import (
    AST, Expr, FunctionDef, Name, Return, Tuple, assign, at, call, const, function, name, rename, tuple_of,
    user_call, walk,
)

_RESULT = "return"


@dataclass(frozen=True)
class NestedCall:
    """What a kernel stands for: the function that it differentiates, and its own parameter for each of that one's; the
    parameters that follow are the seeds."""
    kernel: Kernel
    inner: Kernel
    passed: dict[str, str]
    seeds: tuple[str, ...]

    @property
    def wrt(self) -> tuple[str, ...]:
        assert self.kernel.nested is not None
        return tuple(self.inner.parameters[k] for k in self.kernel.nested.wrt)

    @property
    def of(self) -> tuple[str, ...]:
        assert self.kernel.nested is not None
        return tuple(_RESULT if k < 0 else self.inner.parameters[k] for k in self.kernel.nested.of)


def nested_call(program: Program, kernel: str) -> NestedCall:
    """The derivative that a kernel stands for."""
    outer = program.kernels[kernel]
    called = next(n for n in walk(outer.tree.body) if user_call(n))
    inner = program.kernels[user_call(called) or ""]
    arguments = [*zip(inner.parameters, called.args), *((k.arg, k.value) for k in called.keywords)]
    passed = {p: a.id for p, a in arguments if isinstance(a, Name)}
    return NestedCall(outer, inner, passed, tuple(p.id for p in outer.tree.args.args if p.id not in passed.values()))


def differentiated_program(program: Program, nested: NestedCall) -> Program:
    """The program of the function that is differentiated."""
    reached = {nested.inner.name}
    for title, kernel in reversed(program.kernels.items()):
        if title in reached:
            reached |= {user_call(n) or "" for n in walk(kernel.tree.body)} | {kernel.residual}
    kernels = {t: k for t, k in program.kernels.items() if t in reached}
    return Program(nested.inner.name, kernels, program.constants, records=program.records)


def nested_request(nested: NestedCall, types: Sequence[Type], engine: str) -> Request:
    """The request for the derivative, for arguments of these types."""
    by_name = dict(zip((p.id for p in nested.kernel.tree.args.args), types))
    assert nested.kernel.nested is not None
    return Request(nested.kernel.nested.mode, tuple(by_name[nested.passed[p]] for p in nested.inner.parameters),
                   nested.wrt, nested.of, engine=engine, with_primal=nested.kernel.nested.with_value)


def with_derivative(program: Program, nested: NestedCall, types: tuple[Type, ...], generated: Generated, text: Program,
                    summary: EntrySummary) -> Program:
    """The program with the functions of the derivative's `text`, and the kernel that calls them; `summary` is that of
    the function that is differentiated."""
    free = Names({*program.kernels, *program.constants})
    mapping = {f"user.{k}": f"user.{free.fresh(k)}" for k in text.kernels}
    mapping |= {f"const.{c}": f"const.{c if same(v, program.constants.get(c)) else free.fresh(c)}"
                for c, v in text.constants.items()}
    made = {t.partition(".")[2]: _renamed(text.kernels[k.partition(".")[2]], t.partition(".")[2], mapping)
            for k, t in mapping.items() if k.startswith("user.")}
    wrapper = _Wrapper(nested, types, generated, mapping[f"user.{text.entry}"], summary).function()
    assert nested.kernel.nested is not None
    outer = replace(nested.kernel, tree=at(wrapper, nested.kernel.tree),
                    nested=replace(nested.kernel.nested, types=types))
    kernels: dict[str, Kernel] = {}
    for title, kernel in program.kernels.items():
        kernels |= {**made, title: outer} if kernel is nested.kernel else {title: kernel}
    constants = {mapping[f"const.{c}"].partition(".")[2]: v for c, v in text.constants.items()}
    return replace(program, kernels=kernels, constants={**program.constants, **constants})


def _renamed(kernel: Kernel, title: str, mapping: dict[str, str]) -> Kernel:
    """A kernel of the text under its name in the program; it returns a value where the text returns a tuple of one."""
    tree = rename(kernel.tree, mapping)
    tree.name = title
    for node in walk(tree.body):
        if isinstance(node, Return) and isinstance(node.value, Tuple) and len(node.value.elts) == 1:
            [node.value] = node.value.elts
    return replace(kernel, name=title, tree=tree)


class _Wrapper:
    """The kernel that calls a derivative; what that overwrites is copied before."""

    def __init__(self, nested: NestedCall, types: tuple[Type, ...], generated: Generated, title: str,
                 summary: EntrySummary):
        self.nested, self.generated, self.title, self.summary = nested, generated, title, summary
        self.parameters = [p.id for p in nested.kernel.tree.args.args]
        self.types = dict(zip(self.parameters, types))
        self.free = Names(self.parameters)
        self.seeds = dict(zip(nested.of if self.is_adjoint else nested.wrt, map(name, nested.seeds)))
        self.shadows: dict[str, str] = {}
        self.body: list[AST] = []

    @property
    def is_adjoint(self) -> bool:
        assert self.nested.kernel.nested is not None
        return self.nested.kernel.nested.mode == "adjoint"

    def function(self) -> FunctionDef:
        arguments = [self.argument(p.name, p.role, p.primal) for p in self.generated.parameters]
        words = [self.free.fresh(f"{r.replace(' ', '_')}_value") for r in self.generated.returns]
        called = call(self.title, *arguments)
        self.body.append(Expr(called) if not words else assign(
            name(words[0]) if len(words) == 1 else tuple_of(*map(name, words)), called))
        results = self.results(words)
        self.body.append(Return(results[0] if len(results) == 1 else tuple_of(*results)))
        return function(self.nested.kernel.name, self.parameters, self.body)

    def argument(self, own: str, role: str, primal: str) -> AST:
        """What a parameter of the derivative is given."""
        if role == "seed":
            return self.seeds.get(_RESULT, const(1.0))
        given = self.nested.passed[primal]
        if role == "primal":
            return self.held(own, call("numpy.copy", name(given))) if primal in self.summary.written else name(given)
        seed = self.seeds.get(primal)
        if seed is not None and not self.types[given].is_array:
            return seed
        self.shadows[primal] = self.free.fresh(own)
        made = call("numpy.zeros_like", name(given)) if seed is None else call("numpy.copy", seed)
        return self.held(self.shadows[primal], made)

    def held(self, wanted: str, value: AST) -> Name:
        word = wanted if wanted in self.shadows.values() else self.free.fresh(wanted)
        self.body.append(assign(word, value))
        return name(word)

    def results(self, words: list[str]) -> list[AST]:
        """What the kernel returns, in its order: the value is what a derivative returns first."""
        nested = self.nested.kernel.nested
        assert nested is not None
        value, found = words[:nested.with_value], dict(zip(self.generated.returns[nested.with_value:],
                                                           words[nested.with_value:]))
        by_name = {_RESULT if k.startswith(f"{_RESULT} ") else k: v for k, v in found.items()} | self.shadows
        return [name(w) for w in (*value, *(by_name[w] for w in (
            self.nested.wrt if self.is_adjoint else self.nested.of)))]
