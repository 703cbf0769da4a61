"""The chapter on other tools as text, tables and pictures, from what is stored: pure, nothing is measured here."""
from __future__ import annotations

from statistics import geometric_mean
from typing import Any

from benchmarks.peers.measuring import ALLOWED, CALL, PREPARE
from benchmarks.peers.pictures import picture
from benchmarks.peers.results import DOUBLE, LOSES, Kernel, slope
from benchmarks.peers.sections import Chapter, Part
from benchmarks.peers.tools import DIFFERENCES, OURS, PRIMALS, TOOLS
from benchmarks.tables import Table, seconds, shown

MIB = 2.0 ** 20
LEAST = {"time": 0.0, "memory": 0.25 * MIB}
EXPLAINED = f"""Every tool differentiates its own version of each kernel, written as its users write it;
s2sad has the kernel itself. One gradient of all inputs is timed, from arguments that are at hand to arrays that are
there; what s2sad or the adjoint by hand overwrite is restored within the time. Of s2sad that is the adjoint alone,
without what `s2sad.vjp` checks and copies (of the published kernels below there are both); JAX compiles, PyTorch runs
eagerly. Tools run in processes of their own, in turns, on one core; where samples are far apart more are taken, and all
count. Errors are the largest of an element relative to the largest of its input's gradient, against gradients with 113
bits. A version whose gradient is off by more than {ALLOWED:g} is left out as wrong. Left out is also what needs more
than {PREPARE:g} s to its first gradient, compilation included, or {CALL:g} s for a gradient, or clearly would at the
next size. Memory is the growth of resident memory in a call, with the shadows and the tape that were there before."""
LISTED = f"""Where s2sad loses to other tools or to an adjoint by hand, in time by a factor of more than {LOSES:g}, in
error of more than 2:"""


def render(found: dict[str, Any]) -> Chapter:
    """The summary's tables, then for each kernel its table and picture, and what concerns all."""
    kernels = [Kernel(name, stored) for name, stored in found["kernels"].items() if "failed" not in stored]
    body: list[Part] = [EXPLAINED, *([found["missing"]] if found["missing"] else [])]
    body += [f"The kernel {name} failed: {stored['failed']}." for name, stored in found["kernels"].items()
             if "failed" in stored]
    if found["unreached"]:
        body.append(f"No time was left for {', '.join(found['unreached'])}.")
    for kernel in kernels:
        body += [f"### {kernel.name}", _times(kernel), *_left_out(kernel), picture(kernel)]
    body += ["### Growth", _growth(kernels, "time"), _growth(kernels, "memory")]
    if any(found["first"].values()):
        body += ["### First gradient", _first(found["first"])]
    return Chapter([_summary(kernels, -1), LISTED, "\n".join(loss(k) for k in kernels)],
                   [*body, "### Lines", _lines(kernels)])


def _tools(kernels: list[Kernel]) -> dict[str, tuple[str, ...]]:
    """The other tools that were measured, with their variants."""
    tried = {v for k in kernels for v in k.variants}
    return {t.name: t.variants for t in TOOLS if t.adapter not in ("ours", "differences") and tried & {*t.variants}}


def _summary(kernels: list[Kernel], place: int) -> Table:
    tools = _tools(kernels)
    table = Table("Time of a gradient at the largest size over that of s2sad's fastest engine and level, float64",
                  ("kernel", "n", "s2sad", "primal", *tools))
    for kernel in kernels:
        size = kernel.sizes[place]
        ours = kernel.fastest(DOUBLE, size)
        if ours is None:
            table.rows.append((kernel.name, str(size), "does not repeat", *["-"] * (len(tools) + 1)))
            continue
        others = [kernel.fastest(variants, size) for variants in (PRIMALS, *tools.values())]
        table.rows.append((kernel.name, str(size), seconds(ours[1]), *(
            f"{other[1] / ours[1]:.2f}" if other else "-" for other in others)))
    means = [_mean([row[column] for row in table.rows]) for column in range(3, len(table.columns))]
    table.rows.append(("geometric mean", "", "", *means))
    table.notes = ["Above 1 s2sad is faster, below 1 slower. Of each tool the fastest variant counts; - where it was "
                   "left out at this size, has no version, or does not repeat. Each mean is over the kernels that its "
                   "column has."]
    return table


def _mean(cells: list[str]) -> str:
    factors = [float(cell) for cell in cells if cell != "-"]
    return f"{geometric_mean(factors):.2f}" if factors else "-"


def loss(kernel: Kernel) -> str:
    """Where s2sad loses on a kernel, and by how much, in time at each size and in error."""
    why = kernel.why(DOUBLE[0])
    said = [f"{DOUBLE[0]} is left out ({why})"] if why else []
    for size in kernel.sizes:
        ours, other = kernel.fastest(DOUBLE, size), kernel.fastest(kernel.others, size)
        hand = kernel.fastest(["by hand"], size)
        if ours is None:
            said.append(f"no time of it repeats at n = {size}")
        if ours and other and ours[1] > LOSES * other[1]:
            said.append(f"{ours[1] / other[1]:.1f} times slower than {other[0]} at n = {size} "
                        f"({seconds(ours[1])} against {seconds(other[1])})")
        if ours and hand and ours[1] > LOSES * hand[1]:
            said.append(f"{ours[1] / hand[1]:.1f} times slower than by hand at n = {size}")
    errors = {v: e for v in (*kernel.others, "by hand") if (e := kernel.error(v)) is not None}
    mine = [e for v in DOUBLE if (e := kernel.error(v)) is not None]
    if errors and mine and min(mine) > 2.0 * min(errors.values()):
        best = min(errors, key=lambda v: errors[v])
        said.append(f"its error {min(mine):.1e} where {best} has {errors[best]:.1e}")
    unsteady = [f"{v} at n = {size}" for v in (*kernel.others, "by hand") for size in kernel.sizes
                if kernel.times(v, size) and kernel.median(v, size) is None]
    compared = f" Not compared, for they do not repeat: {', '.join(unsteady)}." if unsteady else ""
    return f"- {kernel.name}: " + ("; ".join(said) if said else "loses nowhere") + "." + compared


def _times(kernel: Kernel) -> Table:
    inputs = ", ".join(f"{kernel.stored['sizes'][str(n)]['inputs']} at n = {n}" for n in kernel.sizes)
    table = Table(f"{kernel.name}: time of a gradient",
                  ("", "error" if kernel.exact is None else f"error, n = {kernel.exact}",
                   *(f"n = {n}" for n in kernel.sizes), f"MiB, n = {kernel.sizes[-1]}"))
    for variant in kernel.variants:
        times = [kernel.times(variant, n) for n in kernel.sizes]
        if not any(times):
            continue
        error, memory = kernel.error(variant), kernel.memory(variant, kernel.sizes[-1])
        table.rows.append((variant, "" if variant in PRIMALS else "-" if error is None else f"{error:.1e}",
                           *(shown(t) if t else "-" for t in times), "-" if memory is None else f"{memory / MIB:.1f}"))
    table.notes = [f"Inputs: {inputs}."]
    for variant, curve in kernel.stored["curves"].items():
        table.notes.append(f"Errors of {variant} by step: " + ", ".join(f"{h:g}: {e:.0e}" for h, e in curve) + ".")
    return table


def _left_out(kernel: Kernel) -> list[str]:
    reasons = [(v, why) for v in kernel.variants if (why := kernel.why(v))]
    return ["Left out: " + "; ".join(f"{variant} ({why})" for variant, why in reasons) + "."] if reasons else []


def _growth(kernels: list[Kernel], what: str) -> Table:
    variants = [v for v in dict.fromkeys(v for k in kernels for v in k.variants)
                if v not in (*PRIMALS[1:], *DIFFERENCES[:2])]
    table = Table(f"Exponents of {what}: it grows as n to this power, from the last size but one to the last",
                  ("", *(k.name for k in kernels)))
    for variant in variants:
        cells = []
        for kernel in kernels:
            value = kernel.median if what == "time" else kernel.memory
            points = [(n, y) for n in kernel.sizes[-2:] if (y := value(variant, n)) and y > LEAST[what]]
            cells.append(f"{slope(*zip(*points)):.2f}" if len(points) == 2 else "-")
        if any(cell != "-" for cell in cells):
            table.rows.append((variant, *cells))
    table.notes = ["- where one of the two was left out" + (
        ", or does not repeat." if what == "time" else f", or needs less than {LEAST[what] / MIB:g} MiB.")]
    return table


def _first(found: dict[str, dict[str, float | None]]) -> Table:
    kernels = list(next(iter(found.values())))
    table = Table("Seconds of the processor from the start of a process to its first gradient, empty caches",
                  ("", *kernels))
    for variant, taken in found.items():
        if any(taken.values()):
            table.rows.append((variant, *("-" if t is None else f"{t:.1f}" for t in taken.values())))
    table.notes = ["One run each: to tell tenths of a second from seconds."]
    return table


def _lines(kernels: list[Kernel]) -> Table:
    tools = _tools(kernels)
    table = Table("Lines of a tool's version that are not the kernel's", ("kernel", "of", "s2sad", *tools))
    for kernel in kernels:
        size = kernel.sizes[0]
        counted = {v: line["lines"] for v in kernel.variants if "lines" in (line := kernel.line(v, size))}
        own = next((counted[v] for v in OURS if v in counted), None)
        cells = [next((str(counted[v][0]) for v in variants if v in counted), "-") for variants in tools.values()]
        table.rows.append((kernel.name, str(own[1]) if own else "-", str(own[0]) if own else "-", *cells))
    table.notes = ["Counted on the texts of both, with the functions they call, without docstrings and comments; "
                   "an adjoint by hand is written beside the kernel."]
    return table
