"""stages: a program as it is after each pass, printed as Python.

The stages are the passes of the rooms' lists, in the order in which they run: those of `units` for the kernels on their
way to normal form, those of `analyze`, which look at them, and of `differentiate`; those of `simplify` and, for the
level "fast", of `optimize` for the derivatives, and `final`, the file.
"""
from __future__ import annotations

from s2sad import normalize, optimize, pipeline, simplify
from s2sad.analyze import PASSES as ANALYSES
from s2sad.blocks import with_blocks
from s2sad.differentiate import PASSES as DIFFERENTIATION
from s2sad.emit.module import module_text
from s2sad.emit.primal import kernels_called, primal_functions
from s2sad.passes import Passes, each
from s2sad.program import Program, Request
from s2sad.tree import AST, FunctionDef, Pass, copy, forgotten
from s2sad.units import KERNELS, Units

SHORTENED: Passes = (*simplify.LOWERED, *simplify.PASSES, *optimize.PASSES)
KERNEL_STAGES = tuple(step.title for step in each((*KERNELS, *ANALYSES)))
STAGES = (*KERNEL_STAGES, *(step.title for step in each((*DIFFERENTIATION, *SHORTENED))), "final")
PHASES = {"structure": normalize.STRUCTURE, "calls": normalize.CALLS, "types": normalize.TYPES,
          "arrays": normalize.ARRAYS, "loops": normalize.LOOPS, "normalize": normalize.NUMBERS,
          "analyze": ANALYSES, "differentiate": DIFFERENTIATION, "simplify": simplify.PASSES}
ROOMS = {**{phase: [*each(passes)][-1].title for phase, passes in PHASES.items()}, "optimize": "final"}


def stages(program: Program, request: Request) -> dict[str, str]:
    """The text of a module for every stage, in order; a stage that changed nothing has the text of the one before."""
    seen: dict[str, dict[str, FunctionDef]] = {stage: {} for stage in STAGES}

    def watch(stage: str, function: FunctionDef) -> None:
        shown: FunctionDef = copy(function)
        shown.body = _readable(shown.body)
        seen[stage][function.name] = shown

    made = pipeline.derive(program, request, watch)
    units: Units = made.facts["units"]
    texts: dict[str, str] = {}
    last: dict[str, FunctionDef] = {}
    for stage in STAGES[:-1]:
        last = {**last, **seen[stage]}      # a pass that a function has no need of shows nothing of it
        derived = [f for n, f in last.items() if n not in units.titled]
        functions = primal_functions(units, kernels_called(derived, units)) + derived if derived else [*last.values()]
        texts[stage] = module_text(functions, header=[f"{program.entry} after {stage}."], constants=program.constants,
                                   standalone=request.standalone)
    return {**texts, "final": made.text}


def _readable(block: list[AST]) -> list[AST]:
    """The block without the marks that one pass leaves for the next."""
    return [with_blocks(s, _readable) for s in block if not forgotten(s)] or [Pass()]
