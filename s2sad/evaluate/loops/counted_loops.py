"""Every `for` counts: `for name in range(...)`, the name bound nowhere else and not read after the loop.

    def f(u: float64[:], v: float64[:], n: int64):      def f(u, v, n):
        for w in (u, v):                                    w = u
            w[0] = 2.0 * w[1]                               w[0] = 2.0 * w[1]
        for i in range(n):                                  w = v
            n = n - 1                                       w[0] = 2.0 * w[1]
            u[i] = v[n]                                     stop = n
        return u[i]                                         for i_index in range(stop):
                                                                i = i_index
                                                                n = n - 1
                                                                u[i] = v[n]
                                                            return u[i]

*Requires* what `single_exit` establishes, and loops over ranges or what is spelled out. *Establishes* that every loop
has a counter of its own: a sequence that is spelled out is written out, bounds that the body changes are held in names
before the loop.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.evaluate.loops.table_columns import Column, bound_columns
from s2sad.evaluate.loops.late_reads import is_read_late, plain_item
from s2sad.evaluate.completion import BREAK, completion
from s2sad.evaluate.live_after_loops import live_after_loops
from s2sad.evaluate.effects import bindings, parameters
from s2sad.evaluate.loops.unrolling import Rounds
from s2sad.evaluate.scope import KernelScope
from s2sad.evaluate.loops.literal_sequences import literal
from s2sad.evaluate.expressions.unpack import unpack
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, Break, Call, Constant, Expr, For, FunctionDef, If, Name, Not, Subscript, Tuple,
    UnaryOp, While, assign, at, call, const, copy, counted_for, dump, function, index, name, names, stored_names,
    tuple_of, walk, walk_statements,
)

Hold = Callable[[AST, str], AST]        # an expression that keeps its value throughout the loop, with a wanted name
LONGEST = 16                            # the longest sequence that is written out
FEWEST = 4                              # items of a loop over numbers that stays one


def counted_loops(tree: FunctionDef, scope: KernelScope) -> FunctionDef:
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
        items = self._spelled_out(node.iter)
        if items is not None:
            return self._over_columns(node, items, body) or self._written_out(node, items, body)
        hold, roles = self._hold(node, before), ["stop"] if len(node.iter.args) == 1 else ["start", "stop", "step"]
        bounds = [hold(b, wanted) for b, wanted in zip(node.iter.args, roles)]
        counter = node.target.id
        if counter in self._copied:
            counter = self._scope.fresh(f"{counter}_index")
            body = [at(assign(node.target.id, name(counter)), node), *body]
        return [*before, counted_for(counter, bounds, body)] if body else before

    def _hold(self, node: For, before: list[AST]):
        """How an expression keeps its value throughout the loop: as it is, or through a name before it."""
        stored = set(stored_names(node.body)) | set(stored_names(node.target))
        written = self._scope.memory.written(node.body)

        def hold(value: AST, wanted: str) -> AST:
            changes = stored & set(names(value)) or self._scope.memory.affected(value, written)
            return self._scope.held(value, wanted, before) if changes else value
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


def _copied(tree: FunctionDef, live: dict[int, set[str]], written_out: Callable[[For], bool]) -> set[str]:
    """The names that something other than a loop's count binds, or that are read after their loop."""
    found = set(parameters(tree))
    for node in walk_statements(tree.body):
        if isinstance(node, (Assign, AugAssign)):
            found |= set(stored_names(node))
        elif isinstance(node, For):
            if written_out(node):
                found |= set(stored_names(node.target))
            elif node.target.id in live[id(node)] | set(stored_names(node.body)):
                found.add(node.target.id)
    return found


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
