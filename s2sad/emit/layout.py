"""layout: a tree becomes text: readable Python with minimal parentheses, comments, and no line over 100 columns.

>>> from s2sad import tree
>>> print(text(tree.statements("y[i,(j)] = (-(x**2))*((a+b)-(c-d))")))
y[i, j] = -x ** 2 * (a + b - (c - d))
>>> print(text(tree.comment("forward sweep")))
# forward sweep

What `tree.parse` makes of the text is the tree again, comments and places aside.
"""
from __future__ import annotations

import io
import textwrap
from collections.abc import Mapping
from typing import Any

from s2sad import tree
from s2sad.emit.expressions import ATOM, TEST, Expressions
from s2sad.emit.line_breaking import BREAK, broken, flat
from s2sad.emit.literals import docstring, formatted_string
from s2sad.emit.dotted_names import SPELLING

WIDTH = 100


def text(node: tree.AST | list[tree.AST], names: Mapping[str, str] = SPELLING, width: int | None = WIDTH) -> str:
    """The text of statements, laid out, or of one expression, on one line; no newline at its end.

    `names` says how dotted names print; with `width=None` no line is broken.
    """
    is_expression = not isinstance(node, list) and isinstance(node, tree.expr)
    return Layout(node, names=names, width=None if is_expression else width).text


def is_comment(node: tree.AST) -> bool:
    return isinstance(node, tree.Expr) and isinstance(node.value, tree.Constant) and node.value.kind == "comment"


def _is_breakable(node: tree.AST) -> bool:
    return isinstance(node, tree.expr) and not isinstance(node, tree.Name)


class Layout(Expressions):
    """Prints a tree; `text` holds what was printed, `origins` the statement of each of its lines (None between them).
    Each statement is gathered as pieces, then broken into lines."""

    def __init__(self, node: Any, file: Any = None, names: Mapping[str, str] = SPELLING, width: int | None = WIDTH):
        self.names, self.width = names, width
        self.lines: list[str] = []
        self.origins: list[tree.AST | None] = []
        self.items: list = []
        self.line_indent = 0
        self.statement: tree.AST | None = None
        super().__init__(node, io.StringIO())
        self.flush()
        self.text = "\n".join(self.lines)
        if file is not None:
            file.write(self.text + "\n")

    def _JoinedStr(self, node: Any) -> None:
        self.write(formatted_string(node, self.inline))

    def inline(self, node: tree.AST) -> str:
        return type(self)(node, names=self.names, width=None).text

    def begin(self, statement: tree.AST) -> None:
        """What follows is of another statement."""
        self.flush()
        self.statement = statement

    def fill(self, text: str = "") -> None:
        self.flush()
        self.line_indent = 4 * self._indent
        self.items.append(text)

    def flush(self) -> None:
        if self.items:
            if self.width is None:
                made = [" " * self.line_indent + flat(self.items)]
            else:
                made = broken(self.items, self.line_indent, self.width)
            self.lines += made
            self.origins += [self.statement] * sum(1 + line.count("\n") for line in made)
        self.items = []

    def dispatch(self, tree: Any, level: int = TEST) -> None:
        if isinstance(tree, list):
            self.statements(tree)
        elif self.depth == 0 and _is_breakable(tree):
            with self.group("optional"):  # straight in a statement a line may end in parentheses only
                super().dispatch(tree, level)
        else:
            super().dispatch(tree, level)

    # -- statements -------------------------------------------------------------------------------------------------

    def statements(self, body: list[tree.AST]) -> None:
        """Statements in a row; at the top level two blank lines around functions."""
        def defines(position: int) -> bool:
            while position < len(body) - 1 and is_comment(body[position]):
                position += 1
            return isinstance(body[position], tree.FunctionDef)

        for position, node in enumerate(body):
            if position and not self._indent and not is_comment(body[position - 1]):
                if defines(position) or isinstance(body[position - 1], tree.FunctionDef):
                    self.flush()
                    self.lines += ["", ""]
                    self.origins += [None, None]
            self.begin(node)
            self.dispatch(node)

    def block(self, body: list[tree.AST]) -> None:
        self.enter()
        self.statements(body)
        if all(map(is_comment, body)):
            self.fill("pass")
        self.leave()

    def _Module(self, node: tree.Module) -> None:
        self.statements(node.body)

    def _Expr(self, node: tree.Expr) -> None:
        value = node.value
        if is_comment(node):
            self.comment(str(value.value))
        elif isinstance(value, tree.Constant) and isinstance(value.value, str):
            self.fill(docstring(value.value))
        else:
            self.fill()
            self.bare(value)

    def comment(self, words: str) -> None:
        room = None if self.width is None else max(self.width - 4 * self._indent - 2, 20)
        for line in words.replace("\0", "").expandtabs(4).splitlines() or [""]:
            parts = [line] if room is None or len(line) <= room else textwrap.wrap(
                line, room, subsequent_indent="    ", break_on_hyphens=False)
            for part in parts or [""]:
                self.fill(f"# {part}".rstrip())

    def _Assign(self, node: tree.Assign) -> None:
        self.fill()
        for target in node.targets:
            self.target(target)
            self.write(" = ")
        self.bare(node.value)

    def target(self, node: tree.AST) -> None:
        if isinstance(node, tree.Tuple) and len(node.elts) != 1:
            self.bare(node)
        elif isinstance(node, tree.Tuple):
            self.dispatch(node, ATOM)
        else:
            self.dispatch(node)

    def _AugAssign(self, node: tree.AugAssign) -> None:
        self.fill()
        self.dispatch(node.target)
        self.write(f" {self.binop[type(node.op).__name__]}= ")
        self.bare(node.value)

    def _Return(self, node: tree.Return) -> None:
        self.fill("return")
        if node.value is not None:
            self.write(" ")
            if isinstance(node.value, tree.Tuple) and len(node.value.elts) == 1:
                self.dispatch(node.value, ATOM)  # a comma at the end of a line is easily missed
            else:
                self.bare(node.value)

    def _Assert(self, node: tree.Assert) -> None:
        self.fill("assert ")
        self.dispatch(node.test)
        if node.msg is not None:
            self.write(", ")
            self.dispatch(node.msg)

    def _If(self, node: tree.If, word: str = "if ") -> None:
        self.begin(node)
        self.fill(word)
        self.dispatch(node.test)
        self.block(node.body)
        if len(node.orelse) == 1 and isinstance(node.orelse[0], tree.If):
            self._If(node.orelse[0], "elif ")
        else:
            self.otherwise(node)

    def otherwise(self, node: tree.If | tree.For | tree.While) -> None:
        if node.orelse:
            self.begin(node)
            self.fill("else")
            self.block(node.orelse)

    def _For(self, node: tree.For) -> None:
        self.fill("for ")
        self.target(node.target)
        self.write(" in ")
        self.dispatch(node.iter)
        self.block(node.body)
        self.otherwise(node)

    def _While(self, node: tree.While) -> None:
        self.fill("while ")
        self.dispatch(node.test)
        self.block(node.body)
        self.otherwise(node)

    def _FunctionDef(self, node: tree.FunctionDef) -> None:
        for decorator in node.decorator_list:
            self.fill("@")
            self.dispatch(decorator)
        self.fill(f"def {node.name}")
        with self.group("brackets", "(", ")"):
            self._arguments(node.args)
        if node.returns is not None:
            self.write(" -> ")
            self.dispatch(node.returns)
        self.block(node.body)

    def _arguments(self, node: tree.arguments) -> None:
        plain = [*node.posonlyargs, *node.args]
        defaults = [None] * (len(plain) - len(node.defaults)) + list(node.defaults)
        entries: list[tuple[str, tree.Name | None, tree.AST | None]]
        entries = [("", name, default) for name, default in zip(plain, defaults)]
        if node.posonlyargs:
            entries.insert(len(node.posonlyargs), ("/", None, None))
        if node.vararg or node.kwonlyargs:
            entries.append(("*", node.vararg, None))
        entries += [("", name, default) for name, default in zip(node.kwonlyargs, node.kw_defaults)]
        if node.kwarg:
            entries.append(("**", node.kwarg, None))
        for position, entry in enumerate(entries):
            if position:
                self.items += [",", BREAK]
            self.parameter(*entry)

    def parameter(self, stars: str, name: tree.Name | None, default: tree.AST | None) -> None:
        self.write(stars + (name.id if name else ""))
        annotation = name.annotation if name else None
        if annotation is not None:
            self.write(": ")
            self.dispatch(annotation)
        if default is not None:
            self.write("=" if annotation is None else " = ")
            self.operand(default, TEST)
