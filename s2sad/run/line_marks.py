"""line_marks: a generated text that says which of its lines it is in, for compiled code that raises cannot.

    def f(x, k):                        def f(x, k, line_):
        for i in range(k.shape[0]):         line_[0] = 2
            x[k[i]] = g(x)                  for i in range(k.shape[0]):
                                                line_[0] = 3
                                                x[k[i]] = g(x, line_)

Every function takes an array of one integer behind its own arguments, and stores in it the line, in the text that was
given, of the statement that runs.
"""
from __future__ import annotations

import ast

_LINE = "line_"


def with_line_marks(text: str) -> str:
    """The text with such functions.

    >>> print(with_line_marks("def f(x):\\n    return x[9]"))
    def f(x, line_):
        line_[0] = 2
        return x[9]
    """
    tree = ast.parse(text)
    functions = {f.name for f in tree.body if isinstance(f, ast.FunctionDef)}
    return ast.unparse(ast.fix_missing_locations(_Marks(functions).visit(tree)))


class _Marks(ast.NodeTransformer):
    """Marks the functions of a module, of which `functions` are the names."""

    def __init__(self, functions: set[str]):
        self._functions = functions

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.args.args.append(ast.arg(_LINE))
        node.body = self._block(node.body)
        return node

    def visit_For(self, node: ast.For) -> ast.AST:
        return self._with_blocks(node)

    def visit_While(self, node: ast.While) -> ast.AST:
        return self._with_blocks(node)

    def visit_If(self, node: ast.If) -> ast.AST:
        return self._with_blocks(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if isinstance(node.func, ast.Name) and node.func.id in self._functions:
            node.args.append(ast.Name(_LINE, ast.Load()))
        return node

    def _with_blocks(self, node: ast.For | ast.While | ast.If) -> ast.AST:
        body, orelse = self._block(node.body), self._block(node.orelse)
        node.body = node.orelse = []
        self.generic_visit(node)
        node.body, node.orelse = body, orelse
        return node

    def _block(self, block: list[ast.stmt]) -> list[ast.stmt]:
        made: list[ast.stmt] = []
        for statement in block:
            place = ast.Subscript(ast.Name(_LINE, ast.Load()), ast.Constant(0), ast.Store())
            made += [ast.Assign([place], ast.Constant(statement.lineno)), self.visit(statement)]
        return made


__all__ = ["with_line_marks"]
