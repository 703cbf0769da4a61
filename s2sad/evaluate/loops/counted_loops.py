"""Every `for` counts: `for name in range(...)`, the name bound nowhere else and not read after the loop.

    def f(u: float64[:], v: float64[:], n: int64):      def f(u, v, n):
        for k, e in enumerate(u):                           for k in range(len(u)):
            v[k] += k * e                                       e = u[k]
        for w in (u, v):                                        v[k] += k * e
            w[0] = 2.0 * w[1]                               w = u
        for i in range(n):                                  w[0] = 2.0 * w[1]
            n = n - 1                                       w = v
            u[i] = v[n]                                     w[0] = 2.0 * w[1]
        return u[i]                                         stop = n
                                                            for i_index in range(stop):
                                                                i = i_index
                                                                n = n - 1
                                                                u[i] = v[n]
                                                            return u[i]

*Requires* what `single_exit` establishes. *Establishes* that every loop has a counter of its own: a sequence that is
spelled out is written out, the loops of `np.ndindex` are nested, bounds that the body changes are held in names before
the loop.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.evaluate.loops.table_columns import Column, bound_columns
from s2sad.evaluate.loops.late_reads import is_read_late, plain_item
from s2sad.evaluate.completion import BREAK, completion
from s2sad.evaluate.loops.ndindex import IndexLoops, is_index_loop
from s2sad.evaluate.live_after_loops import live_after_loops
from s2sad.evaluate.effects import bindings, parameters
from s2sad.evaluate.loops.unrolling import Rounds
from s2sad.evaluate.scope import KernelScope
from s2sad.evaluate.loops.iterators import Hold, literal, sequence
from s2sad.evaluate.expressions.unpack import unpack
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, Break, Call, Constant, Expr, For, FunctionDef, If, Name, Not, Subscript, Tuple,
    UnaryOp, While, assign, at, attribute, call, call_name, const, copy, counted_for, dump, function, index, name,
    names, rebuild, stored_names, tuple_of, walk, walk_statements,
)

LONGEST = 16                            # the longest sequence that is written out
FEWEST = 4                              # items of a loop over numbers that stays one


def counted_loops(tree: FunctionDef, scope: KernelScope) -> FunctionDef:
    tree = rebuild(tree, _over_indices)
    scope.begin(tree)
    made = _Loops(tree, scope)
    body = made.block(tree.body)
    return at(function(tree.name, parameters(tree), [*made.arrays.values(), *body]), tree)


class _Loops:
    """The loops of one function; names in `_copied` cannot be counters."""

    def __init__(self, tree: FunctionDef, scope: KernelScope):
        self._scope, self._tree = scope, tree
        self._bound = list(bindings(tree))
        self._live = live_after_loops(tree.body)
        self.arrays: dict[str, Assign] = {}     # of written numbers, by their text
        self._copied = _copied(tree, self._live, lambda loop: self._spelled_out(loop.iter) is not None)

    def block(self, statements: list[AST]) -> list[AST]:
        new: list[AST] = []
        for node in statements:
            if isinstance(node, If):
                new.append(at(If(node.test, self.block(node.body), self.block(node.orelse)), node))
            elif isinstance(node, While):
                new.append(at(While(node.test, self.block(node.body), []), node))
            elif isinstance(node, For):
                new += [at(s, node) for s in self._for(node)]
            else:
                new.append(node)
        return new

    def _for(self, node: For) -> list[AST]:
        body = self.block(node.body)
        before: list[AST] = []
        if is_index_loop(node):
            unsafe = stored_names(node.target)[0] in self._live[id(node)]
            return IndexLoops(node, self._scope, self._hold(node, before), self._copied).nested(body, before, unsafe)
        items = self._spelled_out(node.iter)
        if items is not None:
            return self._over_columns(node, items, body) or self._written_out(node, items, body)
        found = sequence(node.iter, self._hold(node, before), self._scope)
        if found is None:
            return []
        counter = _counter_of(node)
        if counter is None or counter in self._copied:
            wanted = node.target.id if isinstance(node.target, Name) else counter
            counter = self._scope.fresh(f"{wanted}_index" if wanted else "index")
        bound = _without_counter(node.target, found.item(name(counter)), counter)
        if bound is not None:
            body = [*(at(s, node) for s in unpack([bound[0]], bound[1], self._scope)), *body]
        return [*before, counted_for(counter, found.bounds, body)] if body else before

    def _hold(self, node: For, before: list[AST]):
        """How an expression keeps its value throughout the loop: as it is, or through a name before it."""
        stored = set(stored_names(node.body)) | set(stored_names(node.target))
        written = self._scope.memory.written(node.body)

        def hold(value: AST, wanted: str) -> AST:
            changes = stored & set(names(value)) or self._scope.memory.affected(value, written)
            if changes or (wanted == "items" and not isinstance(value, Name)):
                return self._scope.held(value, wanted, before)
            return value
        return hold

    def _spelled_out(self, iterable: AST) -> list[AST] | None:
        """The items of a tuple written in place, or of constants under a name that is bound once."""
        if isinstance(iterable, Name):
            values = [v for t, v in self._bound if iterable.id in stored_names(t)]
            items = literal(values[0]) if len(values) == 1 else None
            return items if items is not None and all(isinstance(i, Constant) for i in items) else None
        return literal(iterable)

    def _over_columns(self, node: For, items: list[AST], body: list[AST]) -> list[AST]:
        """The loop over arrays of the numbers that it goes through; nothing if it is to be written out."""
        columns = bound_columns(node.target, items, self._scope.program.constants)
        rounds = Rounds(body, {n: c.values for n, c in columns.items() if c.kind == "int"}, self._tree, self._scope)
        if not columns or len(items) <= LONGEST and not self._stays(node, body, len(items), columns, rounds):
            return []
        counter, reads = self._scope.fresh("index"), []
        for target, c in columns.items():
            item: AST = index(name(self._array(target, c.array)), name(counter))
            whole_number = c.kind == "int" and rounds.computed(target)
            reads.append(at(assign(target, call("builtins.int", item) if whole_number else item), node))
        return [counted_for(counter, [const(len(items))], [*reads, *body])]

    def _stays(self, node: For, body: list[AST], count: int, columns: dict[str, Column], rounds: Rounds) -> bool:
        """Whether a short loop is long enough as it would be written out, and need not be."""
        size = sum(isinstance(s, (Assign, AugAssign, Expr, If, For, While)) for s in walk_statements(body))
        outside = {n for t, _ in self._bound if not any(t is s for s in walk(node)) for n in stored_names(t)}
        left = self._live[id(node)] & {*stored_names(body), *columns}
        picked = [s.slice for s in walk(body) if isinstance(s, Subscript)]
        floats = {n for n, c in columns.items() if c.kind == "float"} & set(names(picked))
        sums = [s for s in walk(body) if isinstance(s, (AugAssign, BinOp, Call))]   # NumPy adds bools otherwise
        bools = {n for n, c in columns.items() if c.kind == "bool"} & set(names(sums))
        if count < FEWEST or count * size <= LONGEST or floats or bools or left & set(columns):
            return False
        return left <= {*outside, *parameters(self._tree)} and rounds.stay()

    def _array(self, target: str, array: AST) -> str:
        """The name of an array of written numbers, which is bound where the function begins."""
        text = dump(array)
        if text not in self.arrays:
            self.arrays[text] = assign(self._scope.fresh(f"{target}_items"), array)
        return self.arrays[text].targets[0].id

    def _written_out(self, node: For, items: list[AST], body: list[AST]) -> list[AST]:
        if len(items) > LONGEST:
            self._scope.refuse(node.iter, f"a loop over {len(items)} spelled-out items",
                               help="put them into an array: np.array([...])")
            return []
        before: list[AST] = []
        hold = self._hold(node, before)
        items = [_kept(item, hold) for item in items]
        stopped = self._scope.fresh("stopped") if BREAK in completion(body) else ""
        rest: list[AST] = []
        for item in reversed(items):
            bound = [at(s, node) for s in unpack([copy(node.target)], copy(item), self._scope)]
            again = copy(body)
            this_round = [*bound, *(_flagged(again, stopped) if stopped else again)]
            rest = [*this_round, at(If(UnaryOp(Not(), name(stopped)), rest, []), node)] if stopped and rest \
                else this_round + rest
        return [*before, *([assign(stopped, const(False))] if stopped else []), *rest]


def _kept(item: AST, hold: Hold) -> AST:
    """An item as it is before the loop, or in its round where it is to be read then."""
    if isinstance(item, Tuple):
        return tuple_of(*[_kept(i, hold) for i in item.elts])
    return plain_item(item) if is_read_late(item) else hold(item, "held")


def _over_indices(node: AST) -> AST | None:
    """`for (i, j), v in np.ndenumerate(x)` goes over the indices."""
    if not isinstance(node, For) or call_name(node.iter) != "numpy.ndenumerate":
        return None
    pair = node.target.elts if isinstance(node.target, Tuple) and len(node.target.elts) == 2 else []
    array = node.iter.args[0] if len(node.iter.args) == 1 else None
    if not pair or not isinstance(pair[0], Tuple) or not isinstance(array, Name) or array.id in stored_names(node):
        return None
    places = [name(n) for n in stored_names(pair[0])]
    item = at(assign(pair[1], index(copy(array), *places)), node)
    over = at(call("numpy.ndindex", attribute(copy(array), "shape")), node.iter)
    return at(For(pair[0], over, [item, *(rebuild(s, _over_indices) for s in node.body)], [], None), node)


def _counter_of(node: For) -> str | None:
    """The user's name that counts this loop: i in `for i in range(n)` and `for i, v in enumerate(x)`."""
    called, target = call_name(node.iter), node.target
    reverse = called == "builtins.reversed" and node.iter.args and call_name(node.iter.args[0]) == "builtins.range"
    if isinstance(target, Name):
        return target.id if called == "builtins.range" or reverse else None
    plain = called == "builtins.enumerate" and len(node.iter.args) == 1 and not node.iter.keywords
    first = target.elts[0] if isinstance(target, Tuple) and len(target.elts) == 2 else None
    return first.id if plain and isinstance(first, Name) else None


def _copied(tree: FunctionDef, live: dict[int, set[str]], written_out: Callable[[For], bool]) -> set[str]:
    """The names that something other than a loop's count binds, or that are read after their loop."""
    found = set(parameters(tree))
    for node in walk_statements(tree.body):
        if isinstance(node, (Assign, AugAssign)):
            found |= set(stored_names(node))
        elif isinstance(node, For):
            targets = stored_names(node.target)
            counter = None if written_out(node) else _counter_of(node)
            counting = targets if is_index_loop(node) else [] if counter is None else [counter]
            found |= {n for n in targets if n not in counting or targets.count(n) > 1}
            found |= set(counting) & (live[id(node)] | set(stored_names(node.body)))
    return found


def _without_counter(target: AST, value: AST, counter: str) -> tuple[AST, AST] | None:
    """What is left to bind where the counter is a target itself."""
    if isinstance(target, Name) and isinstance(value, Name) and target.id == value.id:
        return None
    if isinstance(target, Tuple) and isinstance(target.elts[0], Name) and target.elts[0].id == counter \
            and isinstance(value, Tuple) and len(value.elts) == 2:
        return target.elts[1], value.elts[1]
    return target, value


def _flagged(statements: list[AST], flag: str) -> list[AST]:
    """The breaks of a loop that is no longer one set a flag."""
    new: list[AST] = []
    for node in statements:
        if isinstance(node, Break):
            new.append(at(assign(flag, const(True)), node))
        elif isinstance(node, If):
            new.append(at(If(node.test, _flagged(node.body, flag), _flagged(node.orelse, flag)), node))
        else:
            new.append(node)
    return new
