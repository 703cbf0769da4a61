"""What a name from outside a kernel becomes: a dotted name of a library, the id of a function, number, array or class.

    np.exp, math.pi, G     ->   numpy.exp, math.pi, const.G
"""
from __future__ import annotations

import builtins
from collections.abc import Callable

from s2sad import rules, tree
from s2sad.diagnostics import Report
from s2sad.read.outside_values import (
    AST, BUILTIN_CALLS, Array, UserFunctionValue, Namespace, NumberTable, Library, Matrix, Meaning, Number, Numbers,
    Record, ModuleValue, StringValue, Unusable, dotted, library_value,
)
from s2sad.live_objects.registry import GIVEN, ROOM
from s2sad.rules.array import find_array
from s2sad.rules.spellings import is_scipy

Identify = Callable[["UserFunctionValue | Number | Array | Record"], str]


# what `evaluate/specialize/sequences` writes out
COMBINING = ("itertools.product", "itertools.combinations", "itertools.combinations_with_replacement")
ALL = -1                                # of a tuple or list: NumPy or a loop goes through it as through an array
ITERATORS = ("enumerate", "zip", "reversed")


class OutsideNames:
    """What one kernel refers to; what cannot be used in it is shown in the report."""
    report: Report
    identify: Identify
    calls: list[tuple[UserFunctionValue, AST]]
    references: set[str]
    called: set[int]
    raised: set[int]
    said: set[str]
    picked: dict[int, int]
    looped: set[int]
    stored: set[int]
    exponents: set[int]
    rows: set[int]

    def _pick(self, node: AST) -> None:
        """Takes down what is picked of the values in a subscript, a loop or a call: by how many subscripts, or ALL."""
        if isinstance(node, tree.For):
            self.picked[id(node.iter)] = 2 if isinstance(node.target, tree.Tuple) else 1
            self.looped.add(id(node.iter))
            self.rows |= {id(node.iter)} if isinstance(node.target, tree.Tuple) else set()
        elif isinstance(node, (tree.ListComp, tree.GeneratorExp)):
            self.rows |= {id(g.iter) for g in node.generators if isinstance(g.target, tree.Tuple)}
        elif isinstance(node, tree.BinOp):
            self.exponents |= {id(n) for n in tree.walk(node.right)}
        elif isinstance(node, tree.Assign):
            several = isinstance(node.targets[0], tree.Tuple) and isinstance(node.value, tree.Subscript)
            self.rows |= {id(node.value.value)} if several else set()
        elif isinstance(node, tree.Call):
            word = node.func.id if isinstance(node.func, tree.Name) else ""
            count = 1 if word in ITERATORS else ALL
            for argument in node.args:
                given = argument
                while word == "len" and isinstance(given, tree.Subscript):
                    self.picked[id(given)] = 0
                    given = given.value
                self.picked[id(given)] = count
                self.looped |= {id(given)} if count == 1 else set()
                self.rows |= {id(given)} if count == 1 else set()
        elif isinstance(node, tree.Subscript) and id(node) not in self.picked:
            stored = not isinstance(node.ctx, tree.Load)
            count, varies = 0, False
            while isinstance(node, tree.Subscript) and not isinstance(node.slice, (tree.Slice, tree.Tuple)):
                self.picked[id(node)] = 0
                count, varies, node = count + 1, varies or bool(tree.names(node.slice)), node.value
            self.picked[id(node)] = count if varies else 0
            self.rows |= {id(node)} if count == 2 else set()
            self.stored |= {id(node)} if stored else set()

    def _as_array(self, node: AST, meaning: NumberTable) -> bool:
        """Whether what is picked of a tuple or list is picked as of an array; a loop goes through a short one as it is
        written."""
        picked, looped = self.picked.get(id(node), 0), id(node) in self.looped
        exact = picked == ALL or not meaning.mixed and not (
            id(node) in self.exponents and meaning.value.dtype.kind == "i" and meaning.value.min() < 0)
        return picked in (meaning.value.ndim, ALL) and not (looped and meaning.numbers) and (
            exact or not meaning.mixed and meaning.numbers is None)

    def _columns(self, node: AST, meaning: NumberTable) -> AST:
        """Rows that are too many to be written out, as what goes through their columns."""
        paths = [self.identify(c) for c in meaning.columns]
        self.references |= set(paths)
        return tree.at(tree.call("builtins.zip", *map(tree.name, paths)), node)

    def _refuse(self, message: str, node: AST, help: str) -> None:
        self.report.error("S201", message, node, help=help)

    def _reference(self, node: AST, meaning: Meaning, text: str) -> AST:
        if isinstance(meaning, StringValue):
            return tree.at(tree.Constant(meaning.value, None), node)
        called = id(node) in self.called
        if id(node) in self.stored and isinstance(meaning, (NumberTable, Numbers)):
            meaning = Unusable("a list or tuple of the module, and written", "pass it as an argument, an array")
        if isinstance(meaning, NumberTable) and not self._as_array(node, meaning):
            if meaning.numbers is None and id(node) in self.rows and meaning.columns and not called:
                return self._columns(node, meaning)
            meaning = meaning.numbers or Unusable(meaning.what, "pick its numbers one by one, or make it a NumPy array")
        if isinstance(meaning, Numbers) and not called:
            return tree.at(tree.tuple_of(*(self._reference(node, item, text) for item in meaning.items)), node)
        if isinstance(meaning, Namespace) and called:
            meaning = meaning.scope.lookup("__call__") or meaning
        if isinstance(meaning, Namespace):
            meaning = Unusable(meaning.what, _held(meaning, text))
        path = self._given(node, dotted(meaning), text)
        if isinstance(meaning, UserFunctionValue):
            path = self._function(node, meaning, text, called)
        elif isinstance(meaning, Record):
            path = self.identify(meaning)
            self.references.add(path)
            if not called:
                self._refuse(f"the class '{text}' as a value is not supported in a kernel", node,
                             f"make one: {text}(...)")
        elif isinstance(meaning, Matrix):
            self._refuse(f"'{text}' is a sparse matrix", node, "make what is computed with it a function of its own")
        elif isinstance(meaning, (Number, Array)):
            path = self.identify(meaning)
            self.references.add(path)
            if called:
                word = "a number" if isinstance(meaning, Number) else "an array"
                self._refuse(f"'{text}' is {word}, not a function", node, "correct the name, or subscript with []")
        elif isinstance(meaning, Numbers):
            self._refuse(f"'{text}' holds numbers, and is no function", node, "correct the name, or subscript with []")
        elif isinstance(meaning, Unusable):
            if text not in self.said:
                self._refuse(f"'{text}' cannot be used in a kernel: it is {meaning.what}", node, meaning.help)
            self.said.add(text)
        elif path is not None and rules.result_kind(path) is None:
            self._library(node, meaning, path, text, called)
        elif path is not None and not called and not isinstance(library_value(path), type):
            self._as_value(node, text)
        return tree.copy(node) if path is None else tree.at(tree.name(path), node)

    def _given(self, node: AST, path: str | None, text: str) -> str | None:
        """The path of what a library has, `given.` before it if the user gave it a derivative."""
        given = None if path is None else GIVEN.named(path) or GIVEN.of(library_value(path))
        if given is not None:
            path = ROOM + given.path
        if path is None or not path.startswith(ROOM):
            return path
        lost = [g for g in GIVEN.closure([path[len(ROOM):]]) if not g.reachable()]
        for given in lost:
            module, _, last = given.path.rpartition(".")
            self._refuse(f"'{text}' has a derivative of its own, but 'from {module} import {last}' does not give "
                         f"{'it' if given.path == path[len(ROOM):] else repr(last) + ', which its derivative calls'}",
                         node, "define it at module level, and register it again when it was defined anew")
        return path

    def _as_value(self, node: AST, text: str) -> None:
        self._refuse(f"the function '{text}' as a value is not supported in a kernel", node,
                     "call it where it is needed")

    def _function(self, node: AST, meaning: UserFunctionValue, text: str, called: bool) -> str:
        if rules.result_kind(meaning.path) is not None:
            return meaning.path
        path = self.identify(meaning)
        self.references.add(path)
        if not called:
            self._as_value(node, text)
        elif all(meaning.key != known.key for known, _ in self.calls):
            self.calls.append((meaning, node))
        return path

    def _library(self, node: AST, meaning: Meaning, path: str, text: str, called: bool) -> None:
        root, _, rest = path.partition(".")
        if root == "builtins":
            self._builtin(node, rest, called)
        elif path.startswith("scipy.sparse.") and find_array(path) is None:
            self._refuse(f"'{text}' is of sparse matrices", node, "make what is computed with it a function of its own")
        elif root == "scipy" and is_scipy(path) or path in COMBINING:
            if not called:
                self._as_value(node, text)
        elif called and path.startswith(("numpy.random.", "random.")):
            self._refuse(f"'{text}' draws random numbers, or begins a sequence of them", node,
                         "begin it in the kernel, rng = np.random.default_rng(1), or draw them before and give them "
                         "to the kernel as an argument: both sweeps read the same ones")
        elif root not in ("numpy", "math", "runtime") and (called or rest):
            self._refuse(f"'{text}' is not a function that s2sad can read", node, "write it with numpy and math, or "
                         f"give its derivative: s2sad.rule(\"{path}(x)\", x=...)")
        elif isinstance(meaning, ModuleValue):
            self._refuse(f"the module '{text}' as a value is not supported in a kernel", node, "name what is in it")
        elif root in ("numpy", "math"):
            value = library_value(path)
            if called and not callable(value):
                self._refuse(f"'{text}' is a number, not a function", node, "correct the name")
            elif not called and callable(value) and not isinstance(value, type):
                self._as_value(node, text)

    def _builtin(self, node: AST, word: str, called: bool) -> None:
        value = getattr(builtins, word, None)
        if id(node) in self.raised and isinstance(value, type) and issubclass(value, Exception):
            return
        if word in BUILTIN_CALLS:
            if not called and word not in ("int", "float", "bool", "complex"):
                self._as_value(node, word)
            return
        self._refuse(f"the built-in '{word}' is not supported in a kernel", node, _BUILTIN_HELP.get(
            word, f"these are: {', '.join(BUILTIN_CALLS)}"))


_BUILTIN_HELP = {
    "sorted": "sort before the kernel is called, and pass the sorted array or the order",
    "list": "allocate an array with np.empty or np.zeros",
    "tuple": "write the elements out: (a, b)",
    "map": "write a for loop",
    "filter": "write a for loop with an if",
}


def _held(holder: Namespace, text: str) -> str:
    """What to write to have what is in a dictionary or an object."""
    known = holder.scope.known()
    if known and all(k.startswith("[") and isinstance(holder.scope.lookup(k), (UserFunctionValue, Library))
                     for k in known):
        return (f"bind the function to a name of its own, which is only called: f = {text}[key], where the key is a "
                "parameter, or a name that is bound once")
    return "name the number or array that is in it, or pass it as an argument"
