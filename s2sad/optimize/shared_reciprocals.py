"""shared_reciprocals: what seeds are divided by several times is divided into 1 once, and multiplied with.

    def f(x: float64[:], y: float64[:], d, z: float64[:]):
        for i in range(x.shape[0]):
            z[i] = x[i] / y[i] / d

in its adjoint:

    def f_adjoint(...):
        ...
        for i in range(x.shape[0]):
            ratio = x[i] / y[i]
            seed = z_bar[i]
            z_bar[i] = 0.0
            ratio_bar = seed / d if seed != 0.0 else 0.0
            d_bar = added(d_bar, -(ratio / d * seed / d if seed != 0.0 else 0.0))
            x_bar[i] += ratio_bar / y[i] if ratio_bar != 0.0 else 0.0
            y_bar[i] -= ratio * ratio_bar / y[i] if ratio_bar != 0.0 else 0.0
        ...

becomes

    def f_adjoint(...):
        ...
        reciprocal = 1.0 / d
        for i in range(x.shape[0]):
            ratio = x[i] / y[i]
            seed = z_bar[i]
            z_bar[i] = 0.0
            ratio_bar = seed * reciprocal if seed != 0.0 else 0.0
            d_bar = added(d_bar, -(ratio * reciprocal * seed * reciprocal if seed != 0.0 else 0.0))
            reciprocal_2 = 1.0 / y[i]
            x_bar[i] += ratio_bar * reciprocal_2 if ratio_bar != 0.0 else 0.0
            y_bar[i] -= ratio * ratio_bar * reciprocal_2 if ratio_bar != 0.0 else 0.0
        ...

*Requires* a finished adjoint. *Establishes* the same values up to the rounding of a reciprocal, with one division in
place of several: of a block, or of the iterations of a loop that does not change the divisor. Only products with what
depends on a seed are divided so: values of the kernel that are computed again keep their digits, for branches and
indices may depend on them.
"""
from __future__ import annotations

from collections.abc import Iterator, Set
from dataclasses import dataclass

from s2sad.blocks import with_blocks
from s2sad.liveness import base_name, read_names, targets, touched
from s2sad.naming import Names
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, Call, Constant, Div, Expr, FunctionDef, If, Mult, Name, Subscript, assign, at,
    call_name, const, copy, dump, name, names, rebuild, walk, walk_statements, with_body,
)

CHANGES_ROUNDING = True


def shared_reciprocals(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with reciprocals of what seeds are divided by more than once."""
    types = context.types
    if any(n in types and (types[n].is_complex or types[n].dtype == "float32") for n in names(function)):
        return function
    sharing = _Sharing(context, seeded_names(function, context), Names(names(function)))
    return with_body(function, sharing.block(function.body, {p.id for p in function.args.args}))


def seeded_names(function: FunctionDef, context: DerivativeContext) -> set[str]:
    """The numbers and arrays that are bound to what depends on seeds, and to constants."""
    bound: dict[str, list[AST]] = {}
    for statement in walk_statements(function.body):
        if isinstance(statement, (Assign, AugAssign)):
            for target in targets(statement):
                bound.setdefault(base_name(target), []).append(statement.value)
    given = {*context.gaining, *context.seeds}
    found = given | {n for n in bound if n in context.numbers or n not in context.types}

    def is_seeded(identifier: str) -> bool:
        values = [v for v in bound[identifier] if not isinstance(v, Constant)]
        sources = found if len(values) == len(bound[identifier]) else found - {identifier}     # 0.0, then a sum
        return not any(sources.isdisjoint(read_names(v)) for v in values)
    while less := {n for n in found - given if not is_seeded(n)}:
        found -= less
    return found


@dataclass
class _Group:
    """The quotients of one divisor in a block, by the positions of their statements, and what they would cost."""
    divisor: AST
    positions: list[int]
    weight: int


@dataclass
class _Sharing:
    """The pass over one function: the names `seeded`, and new names."""
    context: DerivativeContext
    seeded: Set[str]
    free: Names

    def block(self, block: list[AST], sure: Set[str]) -> list[AST]:
        """A block with its reciprocals; the names `sure` are bound before it in any case."""
        shared = self.groups(block, sure)
        made, bound = list[AST](), {*sure}
        for position, statement in enumerate(block):
            for divisor, reciprocal in [(g.divisor, r) for g, r in shared if g.positions[0] == position]:
                made.append(at(assign(reciprocal, BinOp(const(1.0), Div(), copy(divisor))), statement))
            here = {dump(g.divisor): r for g, r in shared if position in g.positions}
            inner = bound | {base_name(t) for t in targets(statement)}
            new = self.multiplied(statement, here)
            made.append(with_blocks(new, lambda body, inner=inner: self.block(body, inner)))
            bound |= _bound_in_any_case(statement)
        return made

    def groups(self, block: list[AST], sure: Set[str]) -> list[tuple[_Group, str]]:
        """The quotients of a block that share a divisor, with the name of its reciprocal."""
        found: list[_Group] = []
        current: dict[str, _Group] = {}
        bound = {*sure}
        for position, statement in enumerate(block):
            changed = _changed(statement)
            for quotient in self.quotients(statement):
                divisor, key = quotient.right, dump(quotient.right)
                simple = isinstance(statement, (Assign, AugAssign))
                fixed = changed.isdisjoint(names(divisor)) and not any(isinstance(n, Subscript) for n in walk(divisor))
                if not self.is_known(divisor, bound) or not simple and not (
                        fixed and (key in current or not isinstance(statement, If))):
                    continue
                if key not in current:
                    found.append(_Group(divisor, [], 0))
                group = current.setdefault(key, found[-1])
                group.positions.append(position)
                group.weight += 1 if simple else 0 if isinstance(statement, If) else 2
            current = {key: g for key, g in current.items() if changed.isdisjoint(names(g.divisor))}
            bound |= _bound_in_any_case(statement)
        return [(g, self.free.numbered("reciprocal")) for g in found if g.weight > 1]

    def quotients(self, statement: AST) -> list[BinOp]:
        """The quotients that are factors of products with what depends on a seed, or are such products."""
        products = [n for n in walk(statement) if isinstance(n, BinOp) and isinstance(n.op, (Mult, Div))
                    and not self.seeded.isdisjoint(read_names(n))]
        return list({id(q): q for n in products for q in _divided(n)}.values())

    def is_known(self, divisor: AST, bound: Set[str]) -> bool:
        """Whether a divisor is a float64 number of names that are bound."""
        read = {n.lstrip("=") for n in read_names(divisor)}
        kinds = [self.context.types.get(n) for n in read]
        calls = [call_name(n) or "" for n in walk(divisor) if isinstance(n, Call)]
        return read <= bound and any(k is not None and k.dtype == "float64" for k in kinds) and all(
            c.startswith("numpy.") for c in calls)

    def multiplied(self, statement: AST, reciprocals: dict[str, str]) -> AST:
        """A statement with products in place of quotients."""
        quotients = {id(n) for n in self.quotients(statement)} if reciprocals else set[int]()

        def change(node: AST) -> AST | None:
            if isinstance(node, BinOp) and id(node) in quotients and (reciprocal := reciprocals.get(dump(node.right))):
                return at(BinOp(rebuild(node.left, change), Mult(), name(reciprocal)), node)
            return None
        return rebuild(statement, change)


def _divided(product: AST) -> Iterator[BinOp]:
    """The quotients among the factors of a product."""
    if isinstance(product, BinOp) and isinstance(product.op, (Mult, Div)):
        if isinstance(product.op, Div):
            yield product
        else:
            yield from _divided(product.right)
        yield from _divided(product.left)


def _changed(statement: AST) -> set[str]:
    """The names that a statement may change."""
    return touched(statement) | ({*names(statement)} if isinstance(statement, Expr) else set())


def _bound_in_any_case(statement: AST) -> set[str]:
    """The names that a statement binds, whatever its tests and trip counts are."""
    if not isinstance(statement, (Assign, AugAssign)):
        return set()
    return {t.id for t in targets(statement) if isinstance(t, Name)}


__all__ = ["shared_reciprocals"]
