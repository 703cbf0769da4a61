"""global_arrays: arrays that kernels read from their module or closure become parameters, on every kernel on the way.

    TABLE = np.array(...)           def f(x, TABLE): y = g(x, TABLE=TABLE)
    def f(x): y = g(x)              def g(v, TABLE): return v * TABLE[0]
    def g(v): return v * TABLE[0]

Constants are compiled in and compared at each call; an array's content may change between calls.
"""
from __future__ import annotations

from dataclasses import replace

from s2sad.naming import Names
from s2sad.program import Kernel, Program
from s2sad.tree import Name, call_name, copy, function, keyword, name, rename, user_call, walk


def global_arrays(program: Program) -> Program:
    """The program in which no kernel reads an array from outside."""
    if not program.arrays:
        return program
    needs: dict[str, list[str]] = {}
    kernels: dict[str, Kernel] = {}
    free = Names(set().union(*map(_locals, program.kernels.values())))
    parameter_names = {a: free.fresh(a) for a in program.arrays}
    for title, kernel in program.kernels.items():
        read = {n.id[6:] for n in walk(kernel.tree.body) if isinstance(n, Name) and n.id.startswith("array.")}
        for node in walk(kernel.tree.body):
            if user_call(node):
                read |= set(needs[(call_name(node) or "")[5:]])
        read |= set(needs.get(kernel.residual, ()))
        needs[title] = [a for a in program.arrays if a in read]
        kernels[title] = _extended(kernel, needs, parameter_names)
    return replace(program, kernels=kernels, arrays={a: program.arrays[a] for a in needs[program.entry]})


def _locals(kernel: Kernel) -> set[str]:
    return {n.id for n in walk(kernel.tree) if isinstance(n, Name)}


def _extended(kernel: Kernel, needs: dict[str, list[str]], parameter_names: dict[str, str]) -> Kernel:
    tree = rename(copy(kernel.tree), {f"array.{a}": s for a, s in parameter_names.items()})
    for node in walk(tree.body):
        if user_call(node):
            node.keywords += [keyword(p, name(p)) for p in (
                parameter_names[a] for a in needs[user_call(node) or ""])]
    added = [parameter_names[a] for a in needs[kernel.name]]
    parameters = [p.id for p in tree.args.args]
    tree.args = function("_", [*parameters, *added], []).args
    return replace(kernel, tree=tree, parameters=(*kernel.parameters, *added))


def hidden_arrays(program: Program) -> dict[str, str]:
    """The arrays that the entry of a program without outside arrays takes after its own parameters, by these' names."""
    parameters = program.kernels[program.entry].parameters
    return dict(zip(parameters[len(parameters) - len(program.arrays):], program.arrays))


def hidden_name(parameter: str, program: Program) -> str:
    """The parameter's name as the caller knows it: `array.TABLE` for a hidden one."""
    array = hidden_arrays(program).get(parameter)
    return parameter if array is None else f"array.{array}"
