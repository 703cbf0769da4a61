"""direction_loops: a function for many directions at once: what depends on them runs in loops over them.

    def f_tangent(y, y_dot, x, x_dot):          def f_tangent(y, y_dot, x, x_dot):
                                                    lane = lanes(8)
        for i in range(y.size):                     for i in range(y.size):
                                                        factor = 2.0 * x[i]
                                                        for b in range(8):
                                                            lane[b] = factor * x_dot[i, b]
            y_dot[i] = 2.0 * x[i] * x_dot[i]            for b in range(8):
                                                            y_dot[i, b] = lane[b]
            y[i] = x[i] ** 2                            y[i] = x[i] ** 2

Loops and branches of the kernel stay around; what no direction changes is computed once, before. The text for Numba
(above) has one short loop for each statement, which loads all that it reads before it stores: LLVM writes such loops
out and makes vectors of them, whatever may lie where. That for NumPy has neighbours in one loop.
"""
from __future__ import annotations

from collections.abc import Sequence

from s2sad.optimize.directions.dependent_names import Dependence, OneByOne, mentioned, reads, returned, touches
from s2sad.optimize.directions.direction_expressions import Expressions
from s2sad.optimize.directions.layouts import Apart, Interleaved, is_ellipsis
from s2sad.optimize.directions.number_types import has_arrays, number_types
from s2sad.infer.types import FLOAT, Type
from s2sad.liveness import base_name, targets
from s2sad.naming import Names
from s2sad.tree import (
    AST, Add, Assign, AugAssign, Call, Constant, Expr, For, FunctionDef, If, List, Mult, Name, Return, Subscript, Tuple,
    While, assign, at, attribute, augment, binary, call, call_name, const, copy, counted_for, function, head_copy,
    index, indices, is_comment, name, rebuild, tuple_of, user_call, walk, walk_statements,
)

_COPIES = ("numpy.copy", "numpy.zeros_like", "numpy.empty_like")


class DirectionLoops(Expressions):
    """One function of a module; `results` are the types of what an entry returns, None for any other function."""

    def __init__(self, tree: FunctionDef, module: Dependence, engine: str, width: int,
                 results: Sequence[Type] | None = None):
        self.tree, self.module, self.width, self.results = tree, module, width, results
        free = Names({n.id for n in walk(tree) if isinstance(n, Name)})
        kinds = dict(module.types.get(tree.name, {}))
        super().__init__(module.names[tree.name], Interleaved(kinds, width) if engine == "numba" else Apart(kinds),
                         free, free.fresh("b"))
        self.kinds = kinds
        if isinstance(self.layout, Interleaved):
            kinds.update(number_types(tree, self.dependent, self.layout))
        self.temporaries: dict[str, str] = {}
        self.added: list[str] = []
        self.allocations: list[AST] = []
        self.count = name(self.free.fresh("width")) if engine != "numba" else const(width)

    # -- the function -------------------------------------------------------------------------------------------------

    def build(self) -> FunctionDef:
        """The function for many directions."""
        parameters = [p.id for p in self.tree.args.args]
        for identifier in sorted(self.dependent - {*parameters}):
            kind = self.kinds.get(identifier)
            if isinstance(self.layout, Interleaved) and (kind is None or kind.kind not in ("number", "array")):
                raise OneByOne(f"'{identifier}' is neither a number nor an array")
        body = self.block(self.tree.body)
        said = int(bool(body) and isinstance(body[0], Expr) and isinstance(body[0].value, Constant)
                   and not is_comment(body[0]))
        made = [*body[:said], *self.prologue(parameters), *body[said:]]
        new = function(self.tree.name, [*parameters, *self.added], made)
        return at(new, self.tree) if getattr(self.tree, "lineno", None) else new

    def prologue(self, parameters: list[str]) -> list[AST]:
        """Memory for what the function binds, and copies of parameters that it binds anew."""
        bound = {t.id for s in walk_statements(self.tree.body) for t in targets(s) if isinstance(t, Name)}
        own = sorted((bound & self.module.names[self.tree.name]) - {*parameters})
        again = [p for p in parameters if p in self.dependent & bound]
        if isinstance(self.layout, Apart):
            first = next((p for p in parameters if p in self.dependent), None)
            if first is None:
                raise OneByOne(f"'{self.tree.name}' is given nothing that depends on the direction")
            return [assign(copy(self.count), call("builtins.len", name(first))),
                    *(assign(p, call("builtins.list", name(p))) for p in again),
                    *(assign(n, self.empty_list()) for n in own)]
        made: list[AST] = []
        for p in filter(self.layout.is_number, again):
            kept, b = self.free.fresh(p), name(self.b)
            made += [assign(kept, self.layout.room(self.kinds[p].dtype)),
                     self.loop([assign(index(name(kept), b), index(name(p), b))]), assign(p, name(kept))]
        made += [assign(n, self.layout.room(self.kinds[n].dtype)) for n in own if self.layout.is_number(n)]
        return made + [assign(n, self.layout.room(dtype)) for dtype, n in self.temporaries.items()] + self.allocations

    def empty_list(self) -> AST:
        return binary(List([const(None)], name("x").ctx), Mult(), copy(self.count))

    def loop(self, body: list[AST]) -> For:
        return counted_for(self.b, [copy(self.count)], body)

    # -- statements ---------------------------------------------------------------------------------------------------

    def block(self, block: list[AST]) -> list[AST]:
        """The statements of a block; under NumPy neighbours share a loop."""
        made: list[AST] = []
        last: For | None = None
        for statement in block:
            found = [at(s, statement) for s in self.statement(statement)]
            alone = (isinstance(self.layout, Apart) and found and self.is_own(found[-1])     # behind what may go first
                     and not any(mentioned(s, self.dependent) for s in found[:-1]))
            if last is not None and alone:
                place = made.index(last)
                made[place:place] = found[:-1]
                last.body += found[-1].body
                continue
            made += found
            last = found[-1] if alone else None
        return made

    def is_own(self, statement: AST) -> bool:
        """Whether it is a loop over directions."""
        return isinstance(statement, For) and isinstance(statement.target, Name) and statement.target.id == self.b

    def statement(self, statement: AST) -> list[AST]:
        if is_comment(statement):
            return [copy(statement)]
        if isinstance(statement, (If, For, While)):
            if id(statement) in self.module.whole:
                return [self.loop([self.for_one(statement)])]
            made = head_copy(statement)
            if isinstance(made, For):
                made.iter = self.sizes(made.iter)
            else:
                made.test = self.sizes(made.test)
            made.body, made.orelse = self.block(statement.body), self.block(statement.orelse)
            return [made]
        if isinstance(statement, Return):
            return self.returned(statement)
        title = user_call(getattr(statement, "value", None))
        if title is not None and title in self.module.functions and (
                self.module.is_batched(title) or touches(statement, self.dependent)):
            return self.called(statement, title)
        if not touches(statement, self.dependent):
            return [self.sizes(statement)]
        return self.over_directions(statement)

    def over_directions(self, statement: AST) -> list[AST]:
        """A statement in a loop over directions, behind what is the same for all of them."""
        target = targets(statement)[0] if isinstance(statement, (Assign, AugAssign)) else None
        if isinstance(self.layout, Interleaved):
            if isinstance(target, Name) and not self.layout.is_number(target.id):
                return self.array(self.layout, statement, target.id)
            if isinstance(target, Subscript) and isinstance(target.value, Name) and self.loads(statement.value) and (
                    self.layout.is_element(target.value.id, indices(target))):
                return self.loaded_and_stored(statement, target)
        if isinstance(target, Name) and not mentioned(statement.value, self.dependent):
            return [self.loop([self.each(statement, name(self.b))])]        # an array of its own for each
        before, made = self.in_loop(statement)
        return [*before, self.loop([made])]

    def loads(self, value: AST) -> bool:
        """Whether an expression reads arrays that depend on the direction."""
        return any(isinstance(n, Name) and n.id in self.dependent and not self.layout.is_number(n.id)
                   for n in walk(value))

    def loaded_and_stored(self, statement: AST, target: Subscript) -> list[AST]:
        """A store of an element in two loops: all is read, then all is stored."""
        kind = self.kinds[base_name(target)].dtype.replace("float32", "float64")
        if kind not in self.temporaries:
            self.temporaries[kind] = self.free.fresh("lane")
        lane = index(name(self.temporaries[kind]), name(self.b))
        before, value = self.in_loop(statement.value)
        place = self.each(target, name(self.b))
        store = assign(place, copy(lane)) if isinstance(statement, Assign) else augment(
            place, statement.op, copy(lane))
        return [*before, self.loop([assign(lane, value)]), self.loop([store])]

    def array(self, layout: Interleaved, statement: AST, target: str) -> list[AST]:
        """An array of all directions is bound: allocated, copied, or made of what is computed for each."""
        value = statement.value
        if isinstance(statement, AugAssign):
            before, made = self.in_loop(value)
            return [*before, self.loop([augment(layout.named(target, name(self.b)), statement.op, made)])]
        copied = value.args[0] if isinstance(value, Call) and call_name(value) in _COPIES and (
            len(value.args) == 1 and not value.keywords) else value
        if isinstance(copied, Name) and copied.id in self.dependent:
            return [copy(statement)]
        if not mentioned(value, self.dependent) and (made := layout.allocated(value)) is not None:
            return [assign(target, made)]
        return self.computed(value, target)

    def computed(self, value: AST, target: str) -> list[AST]:
        """An array of all directions, of the shape and dtype that the first has."""
        before, each = self.in_loop(value)
        first, whole = self.free.fresh("first"), self.free.fresh("every")
        zero = rebuild(each, lambda n: const(0) if isinstance(n, Name) and n.id == self.b else None)
        shape = binary(attribute(name(first), "shape"), Add(), tuple_of(const(self.width)))
        room = call("numpy.empty", shape, attribute(name(first), "dtype"))
        rest = counted_for(self.b, [const(1), const(self.width)], [
            assign(index(name(whole), const(...), name(self.b)), each)])
        return [*before, assign(first, zero), assign(whole, room),
                assign(index(name(whole), const(...), const(0)), name(first)), rest, assign(target, name(whole))]

    def for_one(self, statement: AST) -> AST:
        """A branch or a loop that runs for one direction."""
        for part in walk(statement):
            title = user_call(part)
            if title is not None and title in self.module.functions and self.module.is_batched(title):
                raise OneByOne(f"'{title}' is called where directions part")
        for part in walk_statements(statement):
            for target in targets(part):
                if isinstance(self.layout, Interleaved) and isinstance(target, Name) and (
                        target.id in self.dependent and not self.layout.is_number(target.id)):
                    raise OneByOne(f"'{target.id}' is bound where directions part")
        return self.each(statement, name(self.b))

    # -- calls and results --------------------------------------------------------------------------------------------

    def called(self, statement: AST, title: str) -> list[AST]:
        """A call of a function for many directions: under Numba it fills arrays that it is given with its numbers."""
        called, made, arguments = statement.value, [], []
        theirs, kinds = self.module.names[title], self.module.types.get(title, {})
        for parameter, argument in zip(self.module.parameters(title), called.args):
            if parameter in theirs:
                before, given = self.argument(argument, kinds.get(parameter))
                made += before
                arguments.append(given)
            elif reads(argument, self.dependent):
                raise OneByOne(f"'{title}' is called with what depends on the direction")
            else:
                arguments.append(self.sizes(argument))
        bound, behind = [], []
        for k, target in enumerate(targets(statement)):
            if k in self.module.results[title]:
                filled = isinstance(self.layout, Interleaved) and self.layout.is_number(base_name(target))
                (arguments if filled else bound).append(name(base_name(target)))
            elif base_name(target) in self.dependent:
                held = self.free.fresh("result")
                bound.append(name(held))
                behind += self.over_directions(assign(target, name(held)))
            else:
                bound.append(target)
        new = call(f"user.{title}", *arguments)
        if not bound:
            return [*made, Expr(new), *behind]
        several = isinstance(statement.targets[0], Tuple)
        return [*made, assign(tuple_of(*bound) if several else bound[0], new), *behind]

    def argument(self, argument: AST, kind: Type | None) -> tuple[list[AST], AST]:
        """What is to be done before a call for an argument that depends on the direction, and what is given."""
        if isinstance(argument, Name) and argument.id in self.dependent:
            return [], copy(argument)
        if isinstance(self.layout, Interleaved) and not (kind is not None and kind.is_number) and isinstance(
                argument, Subscript) and isinstance(argument.value, Name) and argument.value.id in self.dependent:
            whole = name(argument.value.id)
            if len(indices(argument)) == 1 and is_ellipsis(argument.slice):
                return [], whole
            if not any(map(is_ellipsis, indices(argument))):
                return [], Subscript(whole, self.sizes(argument.slice), argument.ctx)
        made = self.free.fresh("given")
        self.dependent = self.dependent | {made}
        self.kinds[made] = kind or FLOAT
        first: list[AST] = []
        if isinstance(self.layout, Apart):
            first = [assign(made, self.empty_list())]
        elif self.layout.is_number(made):
            self.allocations.append(assign(made, self.layout.room(self.kinds[made].dtype)))
        return [*first, *self.over_directions(assign(made, copy(argument)))], name(made)

    def returned(self, statement: Return) -> list[AST]:
        """What is returned: under Numba numbers go into arrays, which the caller gives; an entry has its own."""
        made: list[AST] = []
        kept: list[AST] = []
        numbers: list[AST] = []
        stores: list[AST] = []
        for k, part in enumerate(returned(statement)):
            if k not in self.module.results[self.tree.name]:
                kept.append(self.sizes(part))
            elif not self.is_numeric(part, k):
                before, given = self.argument(part, self.results[k] if self.results else None)
                made += before
                kept.append(given)
            else:
                held, out = self.free.fresh("value"), self.free.fresh("result")
                before, value = self.in_loop(part)
                made += before
                numbers.append(assign(held, value))
                stores.append(assign(index(name(out), name(self.b)), name(held)))
                if self.results is None:
                    self.added.append(out)
                else:
                    kept.append(name(out))
                    self.allocations.append(assign(out, call("numpy.empty", const(self.width), name(
                        f"numpy.{self.results[k].dtype}"))))
        if numbers:
            made.append(self.loop([*numbers, *stores]))
        if not kept:
            return made if numbers else [*made, copy(statement)]
        return [*made, Return(tuple_of(*kept) if isinstance(statement.value, Tuple) else kept[0])]

    def is_numeric(self, part: AST, k: int) -> bool:
        """Whether a result is a number that goes into an array."""
        if not isinstance(self.layout, Interleaved):
            return False
        return self.results[k].is_number if self.results is not None else not has_arrays(part, self.layout)


def direction_loops(functions: Sequence[FunctionDef], module: Dependence, entry: str, engine: str, width: int,
                    results: Sequence[Type]) -> list[FunctionDef]:
    """The functions of a module for many directions."""
    return [DirectionLoops(f, module, engine, width, results if f.name == entry else None).build()
            if module.is_batched(f.name) else f for f in functions]
