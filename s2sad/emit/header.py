"""The docstring of a generated file: what it differentiates with respect to what, roles, and what it records."""
from __future__ import annotations

from s2sad.program import Request
from s2sad.report.facts import recorded_lines
from s2sad.units import Derived


def header(derived: Derived, request: Request) -> list[str]:
    """The lines of the docstring."""
    unit = derived.unit
    of = ", ".join(o.split()[0] for o in dict.fromkeys(o.split()[0] for o in derived_of(derived))) or "nothing"
    lines = [f"{request.mode.capitalize()} of {unit.kernel.name}: d({of}) / d({', '.join(request.wrt) or 'nothing'}).",
             ""]
    lines.append(f"Engine {request.engine}, level {request.level}.")
    written = {k for k in unit.summary.written}
    for position, (parameter, kind) in enumerate(zip((p.id for p in unit.function.args.args), unit.types)):
        role = role_of(parameter, position in written, derived)
        lines.append(f"    {parameter}: {kind}, {role}")
    if request.mode == "adjoint":
        lines += ["", *recorded_lines(derived)]
    return lines


def derived_of(derived: Derived) -> list[str]:
    seeds = [p for _, role, p in derived.made.parameters if role == "seed"]
    shadows = [p for _, role, p in derived.made.parameters if role == "shadow"]
    written = {p.id for k, p in enumerate(derived.unit.function.args.args) if k in derived.unit.summary.written}
    return [p for p in shadows if p in written] + seeds


def role_of(parameter: str, written: bool, derived: Derived) -> str:
    """Whether a parameter goes in, comes out, or both."""
    if not written:
        return "in"
    first = derived.unit.first_use(parameter)
    return "in-out" if first else "out"
