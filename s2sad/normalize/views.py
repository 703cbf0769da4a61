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
from s2sad.infer.shapes import Shapes, is_whole, scattered, single_values, stand_apart
from s2sad.infer.types import INT, Type, array
from s2sad.naming import Names
from s2sad.normalize.allocations import Allocations
from s2sad.normalize.apart import overlaps
from s2sad.normalize.functions import is_function
from s2sad.normalize.reduced import is_reduction
from s2sad.normalize.regions import composed, is_new
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, BinOp, Call, Constant, Eq, Expr, For, FunctionDef, GtE, If, Name,
    Return, Slice, Store, Subscript, Tuple, While, assign, at, attribute, augment, call, call_name, compare,
    const, copy, dump, index, indices, mult, name, names, rebuild, rename, tuple_of, walk,
)

View = tuple[str, tuple[AST, ...]]
_AMBIGUOUS: View = ("", ())


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


class _Views:
    def __init__(self, types: Mapping[str, Type], typing: Typing, free: Names, report: Report, bound: list[str],
                 shapes: Shapes):
        self.types, self.typing, self.free, self.report, self.shapes = types, typing, free, report, shapes
        self.before: list[AST] = []
        self.loops = False
        self.seen: dict[str, View] = {}
        self.tuples: dict[str, AST] = {}
        self.parameters: set[str] = set()
        self.bound = bound
        self.depth = 0
        self.versions: set[str] = set()
        self.home: dict[str, int] = {}                  # how many loops are around an allocation
        self.allocations = Allocations(typing, report, shapes)

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
        self.seen = {n: _AMBIGUOUS if n in inside else v for n, v in self.seen.items()}
        self.depth += 1
        if isinstance(statement, For):
            bounds = self.resolve(statement.iter)
            counters = dict(self.shapes.counters)
            self.shapes.counters |= least_of(statement)
            new: AST = For(statement.target, bounds, self.block(statement.body), [], None)
            self.shapes.counters = counters
        else:
            new = While(self.resolve(statement.test), self.block(statement.body), [])
        self.depth -= 1
        self.seen = {n: v if n not in inside or n not in before else _AMBIGUOUS for n, v in self.seen.items()}
        return new

    def allocated_on_both(self, before: Mapping[str, View], after: Mapping[str, View]) -> dict[str, str]:
        """The arrays of a second branch that go under the name of the first branch's: both were bound to one name."""
        found: dict[str, str] = {}
        for bound, (second, subscripts) in self.seen.items():
            first = after.get(bound, _AMBIGUOUS)[0]
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
            base, prefix = self.viewed(value) or _AMBIGUOUS
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

    def frozen(self, subscript: AST, wanted: str) -> AST:
        """A subscript as an expression that stays what it is now; what may change gets a name before."""
        if isinstance(subscript, Slice):
            parts = (subscript.lower, subscript.upper, subscript.step)
            return Slice(*(p and self.frozen(p, wanted) for p in parts))
        simple = not any(isinstance(n, (Subscript, Call)) for n in walk(subscript))
        if simple and all(self.bound.count(n) <= 1 for n in names(subscript)) or self.lasts(subscript):
            return subscript
        held = self.free.fresh(wanted)
        self.before.append(assign(held, subscript))
        self.typing.table[held] = INT
        self.shapes.values = {**self.shapes.values, held: None}
        return name(held)

    def lasts(self, node: AST) -> bool:
        """Whether an expression is made of sizes of arrays that are bound once: they stay what they are."""
        if isinstance(node, BinOp):
            return self.lasts(node.left) and self.lasts(node.right)
        asked = isinstance(node, Subscript) and isinstance(node.value, Attribute) and node.value.attr == "shape"
        return isinstance(node, Constant) or asked and self.depth == 0 and all(
            self.bound.count(n) <= 1 for n in names(node))

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

    # -- places and expressions --------------------------------------------------------------------------------------

    def viewed(self, node: AST) -> View | None:
        """The base and the indices that an array expression names, or None if it names no array."""
        if isinstance(node, Name):
            if not self.typing.of(node).is_array:
                return None
            view = self.seen.get(node.id)
            if view is None and node.id.startswith("array."):
                return node.id, ()
            if view is None or view == _AMBIGUOUS:
                self.report.error("S201", f"'{node.id}' may stand for different arrays here", node,
                                  help="copy into one array with x[...] = ..., or use two names")
                return None
            return view
        if isinstance(node, Subscript):
            inner = self.viewed(node.value)
            if inner is None:
                return None
            added = [self.part(s) for s in indices(node)]
            return inner[0], self.composed(inner, added, node)
        return None

    def part(self, subscript: AST) -> AST:
        """A subscript with views resolved; the bounds of a slice stay what they are now."""
        if isinstance(subscript, Name) and self.typing.of(subscript).is_array:
            return self.whole(subscript)
        if not isinstance(subscript, Slice):
            return self.resolve(subscript)
        if self.loops and subscript.step is not None and whole_number(subscript.step) is None:
            self.report.error("S201", "a slice whose step is not a written number", subscript.step,
                              help="write a loop")
        parts = (subscript.lower, subscript.upper, subscript.step)
        return self.frozen(Slice(*(p and self.resolve(p) for p in parts)), "bound")

    def composed(self, view: View, added: list[AST], node: AST) -> tuple[AST, ...]:
        """The subscripts of a view's part, trailing whole axes left out."""
        def refuse(what: str) -> None:
            self.report.error("S201", what, node, help="take the part from the array itself, or write a loop")
        if not view[1] and len(added) == 1 and _is_full(added[0]):
            return ()
        if any(self.typing.of(s).is_array for s in (*view[1], *added) if not isinstance(s, Slice)):
            if any(isinstance(s, Slice) or is_new(s) or self.typing.of(s).is_array for s in view[1]):
                refuse("elements picked from a part of an array")
            elif stand_apart([*view[1], *added], self.typing):
                refuse("subscripts that pick elements on both sides of a slice")
            return (*view[1], *added)
        if all(not isinstance(s, Slice) and not is_new(s) and not _is_full(s) for s in (*view[1], *added)):
            return (*view[1], *added)
        found = composed(self.shapes, name(view[0]), list(view[1]), added, refuse)
        while found and is_whole(found[-1]) and not any(map(is_new, found)) and len(found) > 1 and \
                not isinstance(found[-2], Slice):
            found.pop()
        if all(map(is_whole, found)):
            return ()
        self.shapes.of(index(name(view[0]), *found))  # asks for the guards under which its slices are exact
        return tuple(found)

    def whole(self, array: Name) -> AST:
        """An array of subscripts: a name, or refused."""
        base, subscripts = self.viewed(array) or _AMBIGUOUS
        if subscripts or base == "":
            self.report.error("S201", "a part of an array as a subscript", array,
                              help="copy it before: places = x[...].copy()")
        return name(base or array.id)

    def place(self, target: AST) -> Subscript:
        base, subscripts = self.viewed(target) or ("_", ())
        if base.startswith("array."):
            self.report.error("S201", f"the global array '{base[6:]}' is written", target,
                              help="pass it as an argument")
        new = index(name(base), *(subscripts or (const(...),)))
        return at(new, target) if hasattr(target, "lineno") else new

    def is_region(self, place: Subscript) -> bool:
        return self.typing.of(place).is_array

    def load(self, place: Subscript) -> AST:
        subscripts = indices(place)
        return name(place.value.id) if _is_full(subscripts[0]) and len(subscripts) == 1 else copy(place)

    def resolve(self, node: AST) -> AST:
        def change(n: AST) -> AST | None:
            if isinstance(n, Name) and n.id in self.tuples:
                return copy(self.tuples[n.id])
            if isinstance(n, Subscript) and isinstance(n.value, Name) and n.value.id in self.tuples:
                return _item(self.tuples[n.value.id], self.resolve(n.slice))
            if isinstance(n, Subscript) and isinstance(n.value, Attribute) and self.typing.of(n.value.value).is_array:
                return _item(self.attribute(n.value) or n.value, self.resolve(n.slice))
            if isinstance(n, Attribute) and self.typing.of(n.value).is_array:
                return self.attribute(n)
            if isinstance(n, Call) and isinstance(n.func, Attribute):
                return self.method(n)
            if call_name(n) == "builtins.len" and self.typing.of(n.args[0]).is_array:
                return self.shape_of(n.args[0], 0) if self.prefix(n.args[0]) else None
            if isinstance(n, (Name, Subscript)) and (view := self.viewed(n)) is not None:
                base, subscripts = view
                return at(index(name(base), *map(copy, subscripts)) if subscripts else name(base), n) \
                    if hasattr(n, "lineno") else index(name(base), *subscripts) if subscripts else name(base)
            return None
        made = rebuild(node, change)
        self.before += self.operands_fit(made)
        return made

    def operands_fit(self, node: AST) -> list[AST]:
        """Guards that the arrays in an operand of a function of whole arrays fit each other."""
        operands = [a for n in walk(node) if rules.find_array(call_name(n)) is not None for a in n.args]
        return [guard for o in operands if len({dump(p) for p in array_operands(o, self.typing)}) > 1
                for guard in self.allocations.operands_fit(o, self.shapes.of(o))]

    def prefix(self, node: AST) -> int:
        return len((self.viewed(node) or _AMBIGUOUS)[1])

    def shape_of(self, node: AST, axis: int) -> AST:
        base, subscripts = self.viewed(node) or ("_", ())
        if not any(isinstance(x, Slice) or is_new(x) for x in subscripts):
            return index(attribute(name(base), "shape"), const(axis + len(subscripts)))
        size = self.shapes.of(index(name(base), *subscripts))[axis]
        if size is None:
            self.report.error("S201", "the size of a part of an array whose bounds change", node,
                              help="give the bounds names that are bound once")
            return const(0)
        return self.shapes.expression(size)

    def attribute(self, node: Attribute) -> AST | None:
        skip, rank = self.prefix(node.value), self.typing.of(node.value).rank
        base = name((self.viewed(node.value) or ("_", ()))[0])
        if node.attr == "ndim":
            return const(rank)
        if node.attr == "size" and skip:
            sizes = [self.shape_of(node.value, k) for k in range(rank)]
            product = sizes[0]
            for size in sizes[1:]:
                product = mult(product, size)
            return product
        if node.attr == "shape" and skip:
            return tuple_of(*(self.shape_of(node.value, k) for k in range(rank)))
        if node.attr in ("shape", "size", "dtype"):
            return attribute(base, node.attr)
        self.report.error("S201", f"the attribute '{node.attr}' of an array", node, help="write a loop")
        return base

    def method(self, node: Call) -> AST | None:
        assert isinstance(node.func, Attribute)
        if node.func.attr == "copy":
            return call("numpy.copy", self.resolve(node.func.value))
        self.report.error("S201", f"the method '{node.func.attr}'", node, help="write it as a loop")
        return const(0.0)

    def checks(self, place: Subscript, value: AST) -> list[AST]:
        """Guards that the arrays of a whole-array statement fit what it stores into."""
        whole = self.load(place)
        made: list[AST] = []
        for part in [value] if is_function(value) else array_operands(value, self.typing):
            if self.typing.of(part).rank > self.typing.of(place).rank:
                self.report.error("S203", f"a {self.typing.of(part)} does not fit into a {self.typing.of(place)}",
                                  place, help="the shapes must be equal, or of length 1 where they differ")
                continue
            made += self.allocations.fitting(whole, part)
        return list({dump(m): m for m in made}.values())


def is_whole_place(place: Subscript) -> bool:
    """Whether a place is all of its array."""
    return all(map(is_whole, indices(place)))


def array_operands(node: AST, typing: Typing) -> list[AST]:
    """The array references (whole or partly indexed) that an elementwise expression reads, outermost only."""
    if isinstance(node, (Name, Subscript)) and typing.of(node).is_array:
        return [node]
    if isinstance(node, (Attribute, Name, Constant, Subscript)) or call_name(node) in ("numpy.sum", "builtins.len"):
        return []
    children = [c for f in node._fields for c in _children(getattr(node, f, None))]
    return [part for c in children for part in array_operands(c, typing)]


def least_of(loop: For) -> dict[str, int]:
    """The least value of a loop's counter, if it is written."""
    args = loop.iter.args
    low = 0 if len(args) == 1 else whole_number(args[0])
    step = 1 if len(args) < 3 else whole_number(args[2])
    if step is not None and step < 0:
        stop = whole_number(args[1])
        low = None if stop is None else stop + 1
    return {} if low is None or not step else {loop.target.id: low}


def _children(value: object) -> list[AST]:
    if isinstance(value, list):
        return [v for v in value if isinstance(v, AST)]
    return [value] if isinstance(value, AST) else []


def _is_full(node: AST) -> bool:
    if isinstance(node, Slice):
        return node.lower is None and node.upper is None and node.step is None
    return isinstance(node, Constant) and node.value is Ellipsis


def _item(value: AST, position: AST) -> AST:
    if isinstance(value, Tuple) and isinstance(position, Constant):
        return copy(value.elts[position.value])
    return index(copy(value), position)


def _merged(a: dict[str, View], b: dict[str, View], looping: bool) -> dict[str, View]:
    """What names stand for where two branches meet; in a loop a name bound on one side may be an iteration old."""
    made: dict[str, View] = {}
    for bound in {**a, **b}:
        if bound in a and bound in b:
            made[bound] = a[bound] if repr(a[bound]) == repr(b[bound]) else _AMBIGUOUS
        else:
            made[bound] = _AMBIGUOUS if looping else a.get(bound) or b[bound]
    return made
