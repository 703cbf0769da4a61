"""views: every array reference names its base array and all of its subscripts.

Requires structured form and types; establishes that an array name is bound once on each path, by an allocation, and
that no name stands for a part of another array. What a view's index was when it was bound is frozen. Names of tuples go
too.

    row = x[i]                      x[i, j] = 2.0 * x[i, 0]
    row[j] = 2.0 * row[0]
    y[:] = 0.0                      y[...] = 0.0
    u += v                          assert u.shape == v.shape
                                    u[...] += v
    w = u.copy()                    w = np.empty_like(u)
                                    w[...] = u
    inner = u[1:-1]                 v[...] = u[1:-3]
    v = inner[:-2]
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad import rules
from s2sad.analyze.liveness import base_name
from s2sad.diagnostics import Report
from s2sad.infer.infer import Typing
from s2sad.infer.laws import ONE, whole_number
from s2sad.infer.shapes import Shapes, single_values
from s2sad.infer.slices import scattered
from s2sad.infer.types import Type, array
from s2sad.naming import Names
from s2sad.normalize.apart import overlaps
from s2sad.normalize.reduced import is_reduction
from s2sad.normalize.places import AMBIGUOUS, Places, View, is_whole_place
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, BinOp, Call, Eq, Expr, For, FunctionDef, GtE, If, Name, Return, Slice,
    Store, Subscript, Tuple, While, assign, at, attribute, augment, call_name, compare, const, copy, dump, index,
    indices, name, names, rename, tuple_of, walk,
)


def views(function: FunctionDef, types: Mapping[str, Type], typing: Typing, free: Names,
          report: Report, loops: bool = False) -> FunctionDef:
    """The function with views resolved; what cannot be resolved goes into the report. `loops` if whole-array statements
    are to become loops."""
    bound = [p.id for p in function.args.args]
    bound += [n.id for n in walk(function.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]
    shapes = Shapes(typing, single_values(function))
    pass_ = _Views(types, typing, free, report, bound, shapes)
    pass_.seen = {p.id: (p.id, ()) for p in function.args.args if types[p.id].is_array}
    pass_.parameters = set(pass_.seen)
    pass_.loops = loops
    new = copy(function)
    lengths = [Assert(compare(index(attribute(name(p.id), "shape"), const(k)), Eq(), const(1)), None)
               for p in function.args.args for k in typing.ones.get(p.id, ())]
    new.body = [*(at(test, function) for test in lengths), *pass_.block(function.body)]
    return new


class _Views(Places):
    """Rewrites the statements of one function."""

    # -- statements --------------------------------------------------------------------------------------------------

    def block(self, block: list[AST]) -> list[AST]:
        new: list[AST] = []
        known = dict(self.shapes.equal)
        for statement in block:
            outer, self.before = self.before, []
            self.shapes.serial += 1
            made = self.statement(statement)
            new += [at(s, statement) for s in [*self.before, *self.required(), *made]]
            self.before = outer
        self.shapes.equal = known
        return new

    def required(self) -> list[AST]:
        """Guards that slices which start from the end start inside."""
        needed, self.shapes.required = self.shapes.required, []
        tests = [compare(self.shapes.expression(form), GtE(), const(0)) for form in needed]
        return [Assert(test, None) for test in {dump(t): t for t in tests}.values()]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, Assign):
            return self.assignment(statement)
        if isinstance(statement, AugAssign):
            return self.augmented(statement)
        if isinstance(statement, (If, For, While)):
            return [self.compound(statement)]
        if isinstance(statement, Expr):
            return self.effect(statement)
        if isinstance(statement, Return) and statement.value is not None:
            return [Return(self.returned(statement.value))]
        return [self.resolve(statement)]

    def compound(self, statement: AST) -> AST:
        if isinstance(statement, If):
            test, before = self.resolve(statement.test), dict(self.seen)
            body, after = self.block(statement.body), self.seen
            self.seen = dict(before)
            orelse = self.block(statement.orelse)
            one = self.allocated_on_both(before, after)
            self.seen = {n: (one.get(base, base), subscripts) for n, (base, subscripts) in self.seen.items()}
            self.tuples = {n: rename(t, one) for n, t in self.tuples.items()}
            self.seen = _merged(after, self.seen, self.depth > 0)
            return If(test, body, [rename(s, one) for s in orelse])
        inside = {t.id for s in walk(statement.body) if isinstance(s, Assign) for t in s.targets
                  if isinstance(t, Name) and t.id in self.types and self.types[t.id].is_array}
        before = dict(self.seen)
        self.seen = {n: AMBIGUOUS if n in inside else v for n, v in self.seen.items()}
        self.depth += 1
        if isinstance(statement, For):
            bounds = self.resolve(statement.iter)
            counters = dict(self.shapes.counters)
            self.shapes.counters |= least_of(statement)
            new: AST = For(statement.target, bounds, self.block(statement.body), [], None)
            self.shapes.counters = counters
        else:
            self.testing = True
            test = self.resolve(statement.test)
            self.testing = False
            new = While(test, self.block(statement.body), [])
        self.depth -= 1
        self.seen = {n: v if n not in inside or n not in before else AMBIGUOUS for n, v in self.seen.items()}
        return new

    def allocated_on_both(self, before: Mapping[str, View], after: Mapping[str, View]) -> dict[str, str]:
        """The arrays of a second branch that go under the name of the first branch's: both were bound to one name."""
        found: dict[str, str] = {}
        for bound, (second, subscripts) in self.seen.items():
            first = after.get(bound, AMBIGUOUS)[0]
            if first != second and not subscripts and bound in self.types and all(
                    self.home.get(v) == self.depth and (v, ()) not in before.values() for v in (first, second)) \
                    and after[bound] == (first, ()) and second not in found and first not in found.values():
                found[second] = first
                self.allocations.forget(first, second)
        return found

    def assignment(self, statement: Assign) -> list[AST]:
        target, value = statement.targets[0], statement.value
        if isinstance(target, Subscript):
            return self.store(target, value)
        if isinstance(target, Tuple) or self.types.get(target.id, None) is None:
            self.refuse_array_results(statement)
            return [assign(target, self.resolve(value))]
        kind = self.types[target.id]
        if kind.kind == "tuple" and call_name(value) is None:
            self.tuples[target.id] = self.resolve(value)
            return []
        if not kind.is_array:
            return [assign(target, self.resolve(value))]
        return self.bind_array(target.id, value, statement)

    def refuse_array_results(self, statement: Assign) -> None:
        for target in getattr(statement.targets[0], "elts", []):
            kind = self.types.get(target.id)
            if kind is not None and kind.is_array:
                self.report.error("S201", "a kernel that returns an array", statement,
                                  help="pass the array as an argument and write into it")

    def bind_array(self, target: str, value: AST, statement: AST) -> list[AST]:
        if isinstance(value, (Name, Subscript)) and not self.picks(value) and self.viewed(value):
            base, prefix = self.viewed(value) or AMBIGUOUS
            self.seen[target] = (base, tuple(self.frozen(s, f"{target}_at") for s in prefix))
            return []
        if (call_name(value) or "").startswith("user."):
            self.report.error("S201", "a kernel that returns an array", statement,
                              help="pass the array as an argument and write into it")
            return []
        if isinstance(value, Attribute) or isinstance(value, Name):
            self.report.error("S201", f"'{target}' would be a view that is not supported", statement,
                              help="copy it with np.empty and a loop")
            return []
        new = self.version(target)
        made = self.allocations.allocate(new, self.types[target], self.resolve(value), statement)
        self.seen[target] = (new, ())
        self.home[new] = self.depth
        self.typing.table[new] = self.types[target]
        return made

    def picks(self, value: AST) -> bool:
        """Whether an expression is a copy of elements that an array picks."""
        return isinstance(value, Subscript) and (self.picks(value.value) or any(
            self.typing.of(s).is_array for s in indices(value) if not isinstance(s, Slice)))

    def version(self, target: str) -> str:
        if target in self.versions or target in self.parameters:
            return self.free.fresh(f"{target}_{sum(v.startswith(target) for v in self.versions) + 1}")
        self.versions.add(target)
        return target

    def augmented(self, statement: AugAssign) -> list[AST]:
        target = statement.target
        if isinstance(target, Name) and not self.typing.of(target).is_array:
            return [augment(target, statement.op, self.resolve(statement.value))]
        place = self.place(target)
        value = self.resolve(statement.value)
        checks = self.checks(place, value) if self.is_region(place) else []
        value = self.apart(place, value, checks, statement)
        if type(statement.op).__name__ in ("Add", "Sub"):
            return [*checks, augment(place, statement.op, value)]
        return [*checks, assign(place, BinOp(self.load(place), statement.op, value))]

    def store(self, target: Subscript, value: AST) -> list[AST]:
        place, new = self.place(target), self.resolve(value)
        checks = self.checks(place, new) if self.is_region(place) else []
        new = self.apart(place, new, checks, target)
        return [*checks, assign(place, new)]

    def apart(self, place: Subscript, value: AST, before: list[AST], origin: AST) -> AST:
        """The value, under a name of its own where the place cannot hold it while it is made: a loop would read what
        it has filled, or a function's derivative or loop needs its result as it is."""
        if not self.made_first(place, value):
            return value
        kind = self.typing.of(value)
        held = self.free.fresh(f"{base_name(place)}_next")
        self.typing.table[held] = kind
        if not kind.is_array:
            self.shapes.values = {**self.shapes.values, held: None}
            before.append(assign(held, value))
            return name(held)
        before += self.allocations.allocate(held, array(kind.dtype, kind.rank), value, origin)
        return name(held)

    def made_first(self, place: Subscript, value: AST) -> bool:
        """Whether a value must be there before the place is filled with it."""
        if not self.is_region(place):
            return rules.find_array(call_name(value)) is not None and base_name(place) in names(value)
        looped = self.loops or scattered(place, self.typing)
        if self.typing.of(value).is_array and looped and overlaps(place, value, self.typing):
            return True
        if rules.find_array(call_name(value)) is None:
            return False
        filled, made = self.shapes.of(self.load(place)), self.shapes.of(value)
        spread = len(filled) != len(made) or any(m == ONE != f for f, m in zip(filled, made))
        part = self.loops and is_reduction(value) and not is_whole_place(place)
        return spread or part or base_name(place) in names(value)

    def effect(self, statement: Expr) -> list[AST]:
        value = statement.value
        if isinstance(value, Call) and isinstance(value.func, Attribute):
            if value.func.attr == "fill":
                return self.store(index(value.func.value, const(...)), value.args[0])
            self.report.error("S201", f"the method '{value.func.attr}'", statement, help="write it as a loop")
            return []
        return [Expr(self.resolve(value))]

    def returned(self, value: AST) -> AST:
        parts = value.elts if isinstance(value, Tuple) else [value]
        for part in parts:
            if self.typing.of(part).is_array and self.viewed(part) not in [(p, ()) for p in self.parameters]:
                self.report.error("S201", "a kernel that returns an array", part if hasattr(part, "lineno") else value,
                                  help="pass the array as an argument and write into it")
        new = [self.resolve(part) for part in parts]
        return tuple_of(*new) if isinstance(value, Tuple) else new[0]


def least_of(loop: For) -> dict[str, int]:
    """The least value of a loop's counter, if it is written."""
    args = loop.iter.args
    low = 0 if len(args) == 1 else whole_number(args[0])
    step = 1 if len(args) < 3 else whole_number(args[2])
    if step is not None and step < 0:
        stop = whole_number(args[1])
        low = None if stop is None else stop + 1
    return {} if low is None or not step else {loop.target.id: low}


def _merged(a: dict[str, View], b: dict[str, View], looping: bool) -> dict[str, View]:
    """What names stand for where two branches meet; in a loop a name bound on one side may be an iteration old."""
    made: dict[str, View] = {}
    for bound in {**a, **b}:
        if bound in a and bound in b:
            made[bound] = a[bound] if repr(a[bound]) == repr(b[bound]) else AMBIGUOUS
        else:
            made[bound] = AMBIGUOUS if looping else a.get(bound) or b[bound]
    return made
