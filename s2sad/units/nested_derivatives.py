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
from functools import cached_property

from s2sad.diagnostics import Diagnostic, S2sadError, Span
from s2sad.infer.promotion import promote
from s2sad.infer.types import Type
from s2sad.live_objects.guards import same
from s2sad.naming import Names
from s2sad.normalize.buffers.allocations import dtype_of
from s2sad.program import EntrySummary, Generated, Kernel, Program, Request
from s2sad.tree import (
    AST, Expr, FunctionDef, Name, Return, Slice, Tuple, assign, at, attribute, call, const, copy, counted_for, function,
    index, name, rename, tuple_of, user_call, walk,
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
    def mode(self) -> str:
        assert self.kernel.nested is not None
        return self.kernel.nested.mode

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
    assert outer.nested is not None
    outer = replace(outer, tree=outer.nested.standing or outer.tree)
    called = next(n for n in walk(outer.tree.body) if user_call(n))
    inner = program.kernels[user_call(called) or ""]
    arguments = [*zip(inner.parameters, called.args), *((k.arg, k.value) for k in called.keywords)]
    passed = {p: a.id for p, a in arguments if isinstance(a, Name)}
    return NestedCall(outer, inner, passed, tuple(p.id for p in outer.tree.args.args if p.id not in passed.values()))


def settled(nested: NestedCall, types: Sequence[Type], about: EntrySummary) -> NestedCall:
    """The derivative with a mode: a matrix is made of what takes fewer products, as far as its types tell."""
    if nested.mode != "auto":
        return nested
    assert nested.kernel.nested is not None
    kinds = dict(zip(nested.inner.parameters, types_of_inner(nested, types))) | dict(zip((_RESULT,), about.results))
    by_rows = kinds[nested.of[0]].is_number and kinds[nested.wrt[0]].is_array
    made = replace(nested.kernel.nested, mode="adjoint" if by_rows else "tangent")
    return replace(nested, kernel=replace(nested.kernel, nested=made))


def differentiated_program(program: Program, nested: NestedCall) -> Program:
    """The program of the function that is differentiated."""
    reached = {nested.inner.name}
    for title, kernel in reversed(program.kernels.items()):
        if title in reached:
            reached |= {user_call(n) or "" for n in walk(kernel.tree.body)} | {kernel.residual}
    kernels = {t: k for t, k in program.kernels.items() if t in reached}
    return Program(nested.inner.name, kernels, program.constants, records=program.records)


def types_of_inner(nested: NestedCall, types: Sequence[Type]) -> tuple[Type, ...]:
    """The types of what the function that is differentiated is given."""
    by_name = dict(zip((p.id for p in nested.kernel.tree.args.args), types))
    return tuple(by_name[nested.passed[p]] for p in nested.inner.parameters)


def nested_request(nested: NestedCall, types: Sequence[Type], engine: str) -> Request:
    """The request for the derivative, for arguments of these types."""
    assert nested.kernel.nested is not None
    return Request(nested.mode, types_of_inner(nested, types), nested.wrt, nested.of, engine=engine,
                   with_primal=nested.kernel.nested.with_value)


def with_derivative(program: Program, nested: NestedCall, types: tuple[Type, ...], generated: Generated, text: Program,
                    summary: EntrySummary) -> Program:
    """The program with the functions of the derivative's `text`, and the kernel that calls them; `summary` is that of
    the function that is differentiated."""
    free = Names({*program.kernels, *program.constants})
    mapping = {f"user.{k}": f"user.{free.numbered(k)}" for k in text.kernels}
    mapping |= {f"const.{c}": f"const.{c if same(v, program.constants.get(c)) else free.fresh(c)}"
                for c, v in text.constants.items()}
    made = {t.partition(".")[2]: _renamed(text.kernels[k.partition(".")[2]], t.partition(".")[2], mapping)
            for k, t in mapping.items() if k.startswith("user.")}
    assert nested.kernel.nested is not None
    make = _Matrix if nested.kernel.nested.matrix else _Wrapper
    wrapper = at(make(nested, types, generated, mapping[f"user.{text.entry}"], summary).function(), nested.kernel.tree)
    kernels: dict[str, Kernel] = {}
    for title, kernel in program.kernels.items():
        kernels |= {**made, **_for_types(nested.kernel, kernel, types, wrapper, free)} if (
            title == nested.kernel.name) else {title: kernel}
    constants = {mapping[f"const.{c}"].partition(".")[2]: v for c, v in text.constants.items()}
    return replace(program, kernels=kernels, constants={**program.constants, **constants})


def _for_types(standing: Kernel, kernel: Kernel, types: tuple[Type, ...], wrapper: FunctionDef, free: Names
               ) -> dict[str, Kernel]:
    """The kernel that stands for a derivative, which is the first that is made, and the one for these types."""
    nested = kernel.nested
    assert nested is not None
    title = free.numbered(kernel.name) if nested.made else kernel.name
    known = replace(nested, made=(*nested.made, (types, title)), standing=standing.tree)
    if not nested.made:
        return {title: replace(kernel, tree=wrapper, nested=known)}
    wrapper.name = title
    return {title: replace(kernel, name=title, tree=wrapper, nested=None), kernel.name: replace(kernel, nested=known)}


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
        self.seeds: dict[str, AST] = dict(zip(self.asked, map(name, nested.seeds)))
        self.shadows: dict[str, str] = {}
        self.body: list[AST] = []

    @property
    def asked(self) -> tuple[str, ...]:
        """What seeds or directions belong to."""
        return self.nested.of if self.nested.mode == "adjoint" else self.nested.wrt

    @property
    def found(self) -> tuple[str, ...]:
        """What there are gradients or tangents of."""
        return self.nested.wrt if self.nested.mode == "adjoint" else self.nested.of

    def function(self) -> FunctionDef:
        results = self.called()
        self.body.append(Return(results[0] if len(results) == 1 else tuple_of(*results)))
        return function(self.nested.kernel.name, self.parameters, self.body)

    def called(self) -> list[AST]:
        """The call of the derivative, and what it gives."""
        arguments = [self.argument(p.name, p.role, p.primal) for p in self.generated.parameters]
        words = [self.free.fresh(f"{r.replace(' ', '_')}_value") for r in self.generated.returns]
        called = call(self.title, *arguments)
        self.body.append(Expr(called) if not words else assign(
            name(words[0]) if len(words) == 1 else tuple_of(*map(name, words)), called))
        return self.results(words)

    def argument(self, own: str, role: str, primal: str) -> AST:
        """What a parameter of the derivative is given."""
        if role == "seed":
            return self.seeds.get(_RESULT, const(1.0))
        given = self.nested.passed[primal]
        if role == "primal":
            return self.held(own, call("numpy.copy", name(given))) if primal in self.summary.written else name(given)
        seed = self.seeds.get(primal)
        stays = self.nested.mode == "tangent" and primal not in (*self.summary.written, *self.found)
        if seed is not None and (stays or not self.types[given].is_array):
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
        return [name(w) for w in (*value, *(by_name[w] for w in self.found))]


class _Matrix(_Wrapper):
    """The kernel that fills a matrix by products with all unit directions, or seeds:

        jacobian = np.zeros((y.shape[0], x.shape[0]))
        unit = np.zeros_like(x)
        for i in range(x.shape[0]):
            unit[i] = 1.0
            jacobian[:, i] = f_tangent(x, unit)
            unit[i] = 0.0

    One array is all of them in turn, of which single elements are recorded.
    """

    def called(self) -> list[AST]:
        """The matrix, the axes of the output first; a product alone where what is asked for is a number."""
        [of], [wrt] = self.nested.of, self.nested.wrt
        for n in (of, wrt):
            self.refuse_complex(n)
        axes = {n: self.axes(n) for n in (of, wrt)}
        [asked], [found] = self.asked, self.found
        self.seeds[asked] = const(1.0)
        if not axes[asked]:
            return super().called()
        dtype = dtype_of(promote(self.kind(of), self.kind(wrt)))
        whole, unit = self.free.fresh("jacobian"), self.free.fresh("unit")
        before = [*self.body, assign(whole, call("numpy.zeros", tuple_of(*axes[of], *axes[wrt]), *dtype)),
                  assign(unit, call("numpy.zeros_like", name(self.like[asked])))]
        counters = [self.free.fresh(hint) for hint in "ijklmnpq"[:len(axes[asked])]]
        own = list(map(name, counters))
        self.body = [assign(index(name(unit), *own), const(1.0))]
        self.seeds[asked] = name(unit)
        [product] = super().called()
        rest = [Slice(None, None, None) for _ in axes[found]]
        places = [*own, *rest] if self.nested.mode == "adjoint" else [*rest, *own]
        self.body += [assign(index(name(whole), *places), product),
                      assign(index(name(unit), *own), const(0.0))]
        for counter, size in reversed([*zip(counters, axes[asked])]):
            self.body = [counted_for(counter, [copy(size)], self.body)]
        self.body = [*before, *self.body]
        return [name(whole)]

    @cached_property
    def like(self) -> dict[str, str]:
        """Names of arrays of the same shapes; that of what is returned is computed for it."""
        names = {n: self.nested.passed[n] for n in (*self.nested.of, *self.nested.wrt) if n != _RESULT}
        if _RESULT in self.nested.of and self.kind(_RESULT).is_array:
            given = [(p, name(self.nested.passed[p])) for p in self.nested.inner.parameters]
            arguments = [call("numpy.copy", a) if p in self.summary.written else a for p, a in given]
            names[_RESULT] = self.free.fresh("value")
            self.body.append(assign(names[_RESULT], call(f"user.{self.nested.inner.name}", *arguments)))
        return names

    def refuse_complex(self, of: str) -> None:
        if self.kind(of).is_complex:
            kernel, title = self.nested.kernel, self.nested.inner.name
            raise S2sadError(Diagnostic(
                "S201", f"a Jacobian of complex numbers: '{of}' of '{title}', which has two directions",
                Span.of(kernel.source, kernel.tree), help="write a function of real and imaginary parts"))

    def kind(self, of: str) -> Type:
        return self.summary.results[0] if of == _RESULT else self.types[self.nested.passed[of]]

    def axes(self, of: str) -> list[AST]:
        """The lengths of an array's axes."""
        return [index(attribute(name(self.like[of]), "shape"), const(k)) for k in range(self.kind(of).rank)]
