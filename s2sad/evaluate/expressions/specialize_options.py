"""specialize_options: a helper that calls give several numbers for an option is one helper for each.

    def slope(u, axis):             def slope(u, axis): ...
        return np.roll(u, -1, axis) - u
    slope(u, 0) * slope(u, 1)       slope(u, 0) * slope_2(u, 1)
    for d in range(2):              d = 0
        e += energy(u, d)           e += energy(u, 0)
                                    d = 1
                                    e += energy_2(u, 1)

Requires resolved names; `settled` then knows the number in each.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from s2sad.evaluate.completion import BREAK, CONTINUE, completion
from s2sad.evaluate.expressions.static_options import UNKNOWN, argument, bound, counted, in_round, options
from s2sad.program import Kernel, Program
from s2sad.tree import (
    AST, Call, For, If, Name, While, assign, at, call_name, const, copy, keyword, name, names,
    rebuild, stored_names, walk,
)

_MOST = 32      # helpers that are made


def specialize_options(program: Program) -> Program:
    """The program with such helpers."""
    asked = _asked(program)
    if asked:
        program = replace(program, kernels={t: _written_out(k, program, asked) for t, k in program.kernels.items()})
    for _ in range(_MOST if asked else 0):
        new = _apart(program, asked)
        if new is None:
            break
        program, asked = new, _asked(new)
    return program


def _asked(program: Program) -> dict[str, list[str]]:
    """The parameters of each helper that are options, in it or in what it calls."""
    found: dict[str, list[str]] = {}
    for title, kernel in program.kernels.items():  # callees first
        used = list(options(kernel.tree.body))
        for node in walk(kernel.tree.body):
            callee = program.kernels.get((call_name(node) or "").partition("user.")[2])
            if isinstance(node, Call) and callee is not None:
                places = [callee.parameters.index(p) for p in found.get(callee.name, [])]
                used += [node.args[k] for k in places if k < len(node.args)]
                used += [k.value for k in node.keywords if k.arg in found.get(callee.name, [])]
        mine = [p for p in kernel.parameters if p in names(used) and p not in stored_names(kernel.tree.body)]
        if mine and title != program.entry and kernel.own is None:
            found[title] = mine
    return found


def _written_out(kernel: Kernel, program: Program, asked: Mapping[str, list[str]]) -> Kernel:
    """The kernel without loops whose counter is an option of what it calls."""
    known = bound(program).known(kernel)

    def given(block: list[AST], counter: str, number: int) -> list[AST]:
        def change(node: AST) -> AST | None:
            parameters = asked.get((call_name(node) or "").partition("user.")[2], [])
            if not parameters:
                return None
            places = program.kernels[(call_name(node) or "").partition("user.")[2]].parameters
            args = [_number(a, counter, number) if p in parameters else rebuild(a, change)
                    for p, a in zip(places, node.args)]
            options = [at(keyword(k.arg, _number(k.value, counter, number) if k.arg in parameters
                                  else rebuild(k.value, change)), k.value) for k in node.keywords]
            return at(Call(node.func, [*args, *node.args[len(args):]], options), node)
        return in_round([rebuild(s, change) for s in block], name(counter), const(number))

    def through(block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for old in block:
            statement = copy(old)
            for field in ("body", "orelse"):
                if isinstance(statement, (For, If, While)):
                    setattr(statement, field, through(getattr(statement, field)))
            numbers = counted(statement.iter, known) if isinstance(statement, For) else None
            if numbers is not None and _picks(statement, program, asked):
                for k in numbers:
                    made += [at(assign(copy(statement.target), const(k)), statement),
                             *given(copy(statement.body), statement.target.id, k)]
            else:
                made.append(statement)
        return made
    tree = copy(kernel.tree)
    tree.body = through(kernel.tree.body)
    return replace(kernel, tree=tree)


def _number(node: AST, counter: str, number: int) -> AST:
    return at(const(number), node) if isinstance(node, Name) and node.id == counter else node


def _picks(loop: For, program: Program, asked: Mapping[str, list[str]]) -> bool:
    """Whether a loop that is not left early gives its counter to a helper for an option."""
    if not isinstance(loop.target, Name) or loop.orelse or {BREAK, CONTINUE} & completion(loop.body) or (
            loop.target.id in stored_names(loop.body)):
        return False
    for node in walk(loop.body):
        callee = (call_name(node) or "").partition("user.")[2]
        if callee in asked and isinstance(node, Call):
            given = [*zip(program.kernels[callee].parameters, node.args), *((k.arg, k.value) for k in node.keywords)]
            if any(p in asked[callee] and isinstance(v, Name) and v.id == loop.target.id for p, v in given):
                return True
    return False


def _apart(program: Program, asked: Mapping[str, list[str]]) -> Program | None:
    """The program with one helper more; None if no helper is given several numbers."""
    for title in reversed(list(asked)):
        kernel, given = program.kernels[title], {}
        for caller in program.kernels.values():
            known = bound(program).known(caller)
            for node in walk(caller.tree.body):
                if call_name(node) == f"user.{title}":
                    given[id(node)] = tuple(repr(argument(node, kernel, p, known)) for p in asked[title])
        several = list(dict.fromkeys(g for g in given.values() if repr(UNKNOWN) not in g))
        if several and len(set(given.values())) > 1:
            return _with(program, kernel, {n for n, g in given.items() if g == several[-1]})
    return None


def _with(program: Program, kernel: Kernel, calls: set[int]) -> Program:
    """The program in which these calls have a copy of the kernel."""
    number, taken = 2, {*program.kernels, *program.constants, *program.arrays, *program.records}
    while f"{kernel.name}_{number}" in taken:
        number += 1
    made = f"{kernel.name}_{number}"

    def change(node: AST) -> AST | None:
        if id(node) not in calls:
            return None
        new = rebuild(Call(node.func, node.args, node.keywords), change)
        new.func = name(f"user.{made}")
        for field in ("lineno", "col_offset", "end_lineno", "end_col_offset"):
            setattr(new, field, getattr(node, field, None))
        return new
    kernels: dict[str, Kernel] = {}
    for title, old in program.kernels.items():
        tree = copy(old.tree)
        tree.body = [rebuild(s, change) for s in old.tree.body]
        kernels[title] = replace(old, tree=tree)
        if old is kernel:
            kernels[made] = replace(old, name=made, tree=copy(tree))
            kernels[made].tree.name = made
    return replace(program, kernels=kernels)
