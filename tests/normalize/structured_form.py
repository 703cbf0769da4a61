"""For the tests of structured form: kernels from text, the grammar of the form, and the form as a Python function."""
from __future__ import annotations

import ast
import builtins
import copy
import math
import os
import re
import tempfile
from functools import lru_cache
from pathlib import Path

import gast
import numpy as np

from s2sad import read
from s2sad import tree as t
from s2sad.evaluate.needs_evaluation import needs_evaluation
from s2sad.evaluate.specialize import specialize
from s2sad.infer.types import UNKNOWN, Type, of_value
from s2sad.interface.pytrees.file_programs import file_program
from s2sad.naming import Names
from s2sad.normalize import structured_form
from s2sad.program import DemandedFacts, Program

Given = tuple[tuple[Type, tuple[int, ...]], ...]


def program_of(text: str, name: str | None = None, given: Given = ()) -> Program:
    """The program of a function of the text, the last one unless named."""
    there = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)                # so that diagnostics say kernel.py, whatever the folder
        try:
            Path("kernel.py").write_text(text + "\nimport math\nimport numpy as np\n")
            program = file_program("kernel.py", name or re.findall(r"^def (\w+)", text, re.M)[-1])
            if program.refused is not None:
                raise program.refused
            return residual(program, given) if needs_evaluation(program) else program
        finally:
            os.chdir(there)


def residual(program: Program, given: Given = ()) -> Program:
    """What the evaluator leaves of a program for arguments of these types and shapes, of which nothing may be known."""
    function, parameters = program.function, program.kernels[program.entry].parameters
    kinds = dict(zip(parameters, [t for t, _ in given] or [UNKNOWN] * len(parameters)))
    shapes, facts = {(p, "shape"): shape for p, (_, shape) in zip(parameters, given)}, {}
    while True:
        try:
            return read.of_captured(specialize(function, kinds, facts), function)
        except DemandedFacts as demanded:
            if not {*demanded.facts} <= shapes.keys() - facts.keys():
                raise demanded.error from None
            facts |= {fact: shapes[fact] for fact in demanded.facts}


def form(text: str, name: str | None = None):
    return forms(text, name)[-1]


def forms(text: str, name: str | None = None, given: Given = ()):
    """The forms of a function and of those that it calls, its own last."""
    program = program_of(text, name, given)
    others = [k for n, k in program.kernels.items() if n != program.entry]
    found = [structured_form(k, Names(), program) for k in (*others, program.kernels[program.entry])]
    check_grammar(found[-1])
    return found


def printed(tree) -> str:
    """The form as Python text; what is outside has its name with `__` for the dot."""
    plain = t.rebuild(tree, lambda n: t.name(n.id.replace(".", "__")) if "." in getattr(n, "id", "") else None)
    return ast.unparse(ast.fix_missing_locations(gast.gast_to_ast(plain)))


def shown(text: str, name: str | None = None) -> str:
    """The body as a reader would like it."""
    body = printed(form(text, name)).split("\n", 1)[1]
    body = re.sub(r"\b(builtins|user)__", "", body).replace("numpy__", "np.").replace("math__", "math.")
    return "\n".join(line[4:] for line in body.splitlines())


def run_both(text: str, *arguments, name: str | None = None):
    """Outcome of the function and of its form: result or exception, and the arguments afterwards."""
    given = tuple((of_value(a), np.shape(a)) for a in arguments)
    return [_outcome(f, copy.deepcopy(arguments)) for f in _both(text, name, given)]


@lru_cache(maxsize=1)
def _both(text: str, name: str | None, given: Given):
    """The function and its form, for all the arguments that follow each other."""
    original: dict = {"np": np, "math": math}
    exec(text, original)
    *others, tree = forms(text, name, given)
    scope: dict = {"builtins__" + n: getattr(builtins, n) for n in dir(builtins)}
    scope.update({"math__" + n: getattr(math, n) for n in dir(math)})
    for node in t.walk([*others, tree]):
        if isinstance(node, t.Name) and node.id.startswith("numpy."):
            found = np
            for part in node.id.split(".")[1:]:
                found = getattr(found, part)
            scope[node.id.replace(".", "__")] = found
    for function in (*others, tree):
        exec(printed(function), scope)
        scope["user__" + function.name] = scope[function.name]
    return original[tree.name], scope[tree.name]


def _outcome(f, arguments):
    try:
        result = f(*arguments)
    except Exception as error:
        return type(error).__name__, None
    return repr(result), repr(arguments)


# -- the grammar ------------------------------------------------------------------------------------------------------

def check_grammar(tree) -> None:
    assert isinstance(tree, t.FunctionDef) and not tree.decorator_list and not tree.args.defaults
    assert isinstance(tree.body[-1], t.Return)
    assert sum(isinstance(n, t.Return) for n in t.walk(tree)) == 1
    _check_block(tree.body, in_loop=False, tail=False, last=True)
    loop_names = [n.target.id for n in t.walk(tree) if isinstance(n, t.For)]
    bound = {a.id for a in tree.args.args}
    for node in t.walk(tree.body):
        if isinstance(node, (t.Assign, t.AugAssign)):
            bound |= set(t.stored_names(node))
        if isinstance(node, t.For):
            assert node.target.id not in t.stored_names(node.body)
    assert not bound & set(loop_names), bound & set(loop_names)


def _check_block(statements, in_loop, tail, last=False):
    assert statements
    for position, node in enumerate(statements):
        at_end = position == len(statements) - 1
        assert node.lineno is not None and node.col_offset is not None
        if isinstance(node, t.If):
            _pure(node.test)
            _check_block(node.body, in_loop, tail and at_end)
            if node.orelse:
                _check_block(node.orelse, in_loop, tail and at_end)
        elif isinstance(node, (t.For, t.While)):
            assert not node.orelse
            if isinstance(node, t.For):
                assert isinstance(node.target, t.Name) and t.call_name(node.iter) == "builtins.range"
            _pure(node.iter if isinstance(node, t.For) else node.test)
            _check_block(node.body, True, True)
        elif isinstance(node, t.Break):
            assert in_loop and tail and at_end
        elif isinstance(node, t.Return):
            assert last and at_end
            _pure(node)
        else:
            _check_simple(node)


def _check_simple(node):
    assert isinstance(node, (t.Assign, t.AugAssign, t.Assert, t.Raise, t.Expr)), node
    if isinstance(node, t.Assign):
        [target] = node.targets
        if isinstance(target, t.Tuple):
            assert all(isinstance(e, t.Name) for e in target.elts) and _is_user(node.value)
        else:
            assert isinstance(target, (t.Name, t.Subscript))
            _pure(target)
        if _is_user(node.value):
            assert isinstance(target, (t.Name, t.Tuple)) and not node.value.keywords
            for a in node.value.args:
                _pure(a)
        else:
            _pure(node.value)
    elif isinstance(node, t.Expr):
        assert _is_user(node.value) or t.call_name(node.value) == "builtins.print"
        for a in node.value.args:
            _pure(a)
    else:
        _pure(node)


def _is_user(node) -> bool:
    return (t.call_name(node) or "").startswith("user.")


def _pure(node):
    assert not any(_is_user(n) or isinstance(n, (t.IfExp, gast.NamedExpr)) for n in t.walk(node))
    assert not any(isinstance(n, t.Name) and n.id.startswith("jump.") for n in t.walk(node))
