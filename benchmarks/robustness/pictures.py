"""Pictures of errors: over condition numbers, and over the horizon of a chaotic run."""
from __future__ import annotations

from typing import Any

from benchmarks.peers.sections import Part, Picture
from benchmarks.robustness.cases import EPS


def of_conditions(found: dict[str, Any]) -> list[Part]:
    """The errors of gradients of solutions, with rounding times the condition as a line."""
    rows = found["systems"]

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        condition = [r["condition"] for r in rows]
        axes.loglog(condition, [r["b"] for r in rows], "o-", label="gradient by b")
        axes.loglog(condition, [r["a"] for r in rows], "s-", label="gradient by A")
        axes.loglog(condition, [EPS * c for c in condition], "k--", label="rounding times the condition")
        axes.set(xlabel="condition number of A", ylabel="relative error", title="solve(A, b)")
        axes.legend()
    return [Picture("solve", "Errors of the gradient of a linear system's solution over the condition number; the "
                             "dashed line is rounding times the condition.", draw)]


def of_runs(found: dict[str, Any]) -> list[Part]:
    """Gradient, its error, and how far adjoint and tangent are apart, over the horizon."""
    def draw(figure: Any) -> None:
        for axes, (name, rows) in zip(figure.subplots(1, 2), found["chaotic"].items()):
            time = [r["time"] for r in rows]
            axes.semilogy(time, [r["gradient"] for r in rows], "o-", label="gradient by the adjoint")
            if "true" in rows[0]:
                axes.semilogy(time, [r["true"] for r in rows], "k--", label="gradient of the exact run")
                axes.semilogy(time, [r["error"] for r in rows], "s-", label="relative error against it")
            axes.semilogy(time, [max(r["apart"], 1e-17) for r in rows], "^-", label="adjoint against tangent")
            axes.axhline(1.0, color="grey", linewidth=0.8)
            axes.set(xlabel="time", title=name)
            axes.legend(fontsize=7)
    return [Picture("chaos", "Gradients over the horizon of chaotic runs: where the error against the exact run "
                             "reaches 1 they say nothing of it, though adjoint and tangent still agree to rounding "
                             "times the condition.", draw, (9.0, 4.0))]
