"""The normal form: its grammar, and `verify`, which runs after every pass.

    function  = parameters, statements
    statement = name = E | x[E, ...] = E | name += E | x[E, ...] += E              one target
              | names = CALL | CALL                                                a kernel's call stands alone
              | for i in range(E, ...): statements | while E: statements | if E: statements else: statements
              | break                                                              where nothing of the loop follows
              | assert E | raise E | print(E, ...) | return E | return E, ...      the return is last, and only one
              | # comment
    E         = name | constant | x[E, ...] | E op E | op E | function(E, ...) | E and E | E < E < E
              | x.shape | E if E else E                                            no kernel's call inside

What holds from which pass on (each line adds to those before):

    structured   the statements above, with every operator in +=
    views        += and -= only on arrays; an array's name is bound once on each path, by an allocation; no slice but
                 x[...]; no list and no copy of an array
    rename       += and -= only; a number's name is bound once, but for copies where paths meet and sums in loops
    atoms        the test of a branch is a name; a kernel's numbers are names or constants
    derivative   as structured, with choices (E if E else E) and comments
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.infer.shapes import ALLOCATIONS
from s2sad.tree import (
    AST, Add, Assert, Assign, Attribute, AugAssign, BinOp, BoolOp, Break, Call, Compare, Constant, Expr, For,
    FunctionDef, If, IfExp, List, Name, Raise, Return, Slice, Store, Sub, Subscript, Tuple, UnaryOp, While, call_name,
    stored_names, user_call, walk, walk_statements,
)

STAGES = ("structured", "views", "rename", "atoms", "derivative")
_MADE = frozenset({"numpy.copy", "numpy.array", "numpy.asarray", "numpy.ascontiguousarray"})
_EXPRESSIONS = (Attribute, BinOp, BoolOp, Call, Compare, Constant, IfExp, List, Name, Slice, Subscript, Tuple, UnaryOp)


def verify(function: FunctionDef, stage: str, made_by: str) -> FunctionDef:
    """The function itself, if it is in normal form; else an internal error that names the pass and the line."""
    if stage not in STAGES:
        raise ValueError(f"{stage!r} is none of {', '.join(STAGES)}")
    level = STAGES.index(stage)
    for node, what in _faults(function, level, stage == "derivative"):
        line = getattr(node, "lineno", None)
        raise S2sadError(Diagnostic(
            "S901", f"internal error: after the pass '{made_by}', '{function.name}' is not in normal form",
            note=what + (f", made from line {line}" if line else ""),
            help="this is a defect of s2sad: please report it with the kernel"))
    return function


def _faults(function: FunctionDef, level: int, derivative: bool) -> Iterator[tuple[AST, str]]:
    returns = [s for s in walk_statements(function.body) if isinstance(s, Return)]
    if len(returns) > 1 or returns and function.body[-1] is not returns[0]:
        yield returns[0], "a return that is not the last statement"
    yield from _block(function.body, level, derivative, False)
    yield from _unbound(function)
    if not derivative:
        yield from _counters(function)
    if 2 <= level and not derivative:
        yield from _rebound(function)


def _unbound(function: FunctionDef) -> Iterator[tuple[AST, str]]:
    """Names that are read or written into and bound nowhere; a dotted name is of the module or a library."""
    bound, read = {p.id for p in function.args.args}, dict[str, None]()
    for node in walk(function.body):
        if type(node) is Name:
            if type(node.ctx) is Store:
                bound.add(node.id)
            elif "." not in node.id:
                read[node.id] = None
    for name in read:
        if name not in bound:
            yield function, f"'{name}' is bound nowhere"


def _counters(function: FunctionDef) -> Iterator[tuple[AST, str]]:
    """Counters of loops that something else binds: no pass gives these another name."""
    counters = {s.target.id: s for s in walk_statements(function.body) if isinstance(s, For)}
    for statement in walk_statements(function.body):
        if isinstance(statement, Assign):
            for name in stored_names(statement.targets):
                if name in counters:
                    yield counters[name], f"the counter '{name}' is bound outside its loop, too"


def _block(block: list[AST], level: int, derivative: bool, tail: bool) -> Iterator[tuple[AST, str]]:
    for position, statement in enumerate(block):
        last = tail and position == len(block) - 1
        if isinstance(statement, (For, While)):
            yield from _block(statement.body, level, derivative, True)
            yield from _expression(statement.iter if isinstance(statement, For) else statement.test, level,
                                   derivative)
            if isinstance(statement, For) and call_name(statement.iter) != "builtins.range":
                yield statement, "a loop over something that is no range"
            if statement.orelse:
                yield statement, "a loop with an else"
        elif isinstance(statement, If):
            if level == 3 and not isinstance(statement.test, Name):
                yield statement, "a test without a name"
            yield from _expression(statement.test, level, derivative)
            for inner in (statement.body, statement.orelse):
                yield from _block(inner, level, derivative, last)
        elif isinstance(statement, Break):
            if not last:
                yield statement, "a break that something follows"
        else:
            yield from _simple(statement, level, derivative)


def _simple(statement: AST, level: int, derivative: bool) -> Iterator[tuple[AST, str]]:
    if isinstance(statement, (Assign, AugAssign)):
        target = statement.targets[0] if isinstance(statement, Assign) else statement.target
        if isinstance(statement, Assign) and len(statement.targets) != 1:
            yield statement, "an assignment with several targets"
        if isinstance(target, Tuple) and not user_call(statement.value):
            yield statement, "several names bound to something that is no kernel's call"
        if not isinstance(target, (Name, Subscript, Tuple)):
            yield statement, f"a {type(target).__name__} as a target"
        elif not isinstance(target.ctx, Store):
            yield statement, "a target that is read, and not stored to"
        sums = level >= 2 or level == 1 and isinstance(target, Subscript)
        if isinstance(statement, AugAssign) and sums and not isinstance(statement.op, (Add, Sub)):
            yield statement, "an augmented assignment that is no sum"
        yield from _value(statement.value, level, derivative)
    elif isinstance(statement, Expr):
        yield from _value(statement.value, level, derivative)
    elif isinstance(statement, Return):
        if statement.value is not None:
            yield from _expression(statement.value, level, derivative)
    elif not isinstance(statement, (Assert, Raise)):
        yield statement, f"a {type(statement).__name__}"


def _value(value: AST, level: int, derivative: bool) -> Iterator[tuple[AST, str]]:
    if user_call(value):
        for argument in value.args:
            yield from _expression(argument, level, derivative)
    else:
        yield from _expression(value, level, derivative)


def _expression(node: AST, level: int, derivative: bool) -> Iterator[tuple[AST, str]]:
    for part in walk(node):
        if type(part) is Name or type(part) is Constant:
            continue
        if user_call(part):
            yield part, "a kernel's call inside an expression"
        if isinstance(part, Subscript) and level and not isinstance(part.value, (Name, Attribute, Tuple)):
            yield part, "a part of an expression"
        if level and not derivative and (isinstance(part, List) or call_name(part) in _MADE):
            yield part, "an array made inside an expression"
        if isinstance(part, IfExp) and not derivative:
            yield part, "a choice inside an expression"
        if hasattr(part, "lineno") and not isinstance(part, _EXPRESSIONS) and type(part).__name__ != "keyword":
            yield part, f"a {type(part).__name__} inside an expression"


def _rebound(function: FunctionDef) -> Iterator[tuple[AST, str]]:
    """Names bound twice by anything but copies, sums and allocations (of one array, in the branches of an if)."""
    seen: dict[str, AST] = {}
    for statement in walk_statements(function.body):
        if isinstance(statement, Assign) and isinstance(statement.targets[0], Name):
            name = statement.targets[0].id
            copies = isinstance(statement.value, (Name, Constant)) or call_name(statement.value) in ALLOCATIONS
            if name in seen and not (copies or isinstance(seen[name].value, (Name, Constant))):
                yield statement, f"'{name}' bound twice"
            seen[name] = statement
