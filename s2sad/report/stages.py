"""stages: a program as it is after each pass, printed as Python.

    structured  views  workspace  scalarize  handed  rename  atoms       the kernels on their way to normal form
    differentiate  merge  dead  undone  coalesce  branches  fold  algebra  select  gains  uncopied  repeated  final
                                                                        the derivatives
"""
from __future__ import annotations

from s2sad import pipeline
from s2sad.emit.module import module_text
from s2sad.emit.primal import kernels_called, primal_functions
from s2sad.program import Program, Request
from s2sad.blocks import with_blocks
from s2sad.tree import AST, FunctionDef, Pass, copy, forgotten
from s2sad.units import Units

NORMALIZE = ("structured", "views", "workspace", "scalarize", "handed", "rename", "atoms")
DERIVE = ("differentiate", "merge", "dead", "undone", "coalesce", "branches", "fold", "algebra", "select", "gains",
          "uncopied", "repeated", "final")
STAGES = (*NORMALIZE, *DERIVE)
ROOMS = {"normalize": "atoms", "simplify": "final"}


def stages(program: Program, request: Request) -> dict[str, str]:
    """The text of a module for every stage, in order; a stage that changed nothing has the text of the one before."""
    seen: dict[str, dict[str, FunctionDef]] = {stage: {} for stage in STAGES}

    def watch(stage: str, function: FunctionDef) -> None:
        assert stage in seen, f"the stage '{stage}' has no place in STAGES"
        shown: FunctionDef = copy(function)
        shown.body = _readable(shown.body)
        seen[stage].setdefault(function.name, shown)

    made = pipeline.derive(program, request, watch)
    units: Units = made.facts["units"]
    texts: dict[str, str] = {}
    last: dict[str, FunctionDef] = {}
    for stage in STAGES[:-1]:
        last = seen[stage] or last  # a pass that is not asked for shows nothing
        functions = list(last.values())
        if stage in DERIVE:
            functions = primal_functions(units, kernels_called(functions, units)) + functions
        texts[stage] = module_text(functions, header=[f"{program.entry} after {stage}."], constants=program.constants,
                                   standalone=request.standalone)
    return {**texts, "final": made.text}


def _readable(block: list[AST]) -> list[AST]:
    """The block without the marks that one pass leaves for the next."""
    return [with_blocks(s, _readable) for s in block if not forgotten(s)] or [Pass()]
