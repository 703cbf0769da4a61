"""Run time against error, drawn: how long each way to the whole gradient takes, and how wrong what it gives is."""
from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.extras import needed

_LEAST = np.finfo(float).eps / 4    # an error of zero is drawn here
_MARKS = {"adjoint, bare": "o", "vjp": "s", "gradient": "s", "tangent": "D", "complex step": "^"}


def figure_class() -> Any:
    """Matplotlib's `Figure`; raises S2sadError (S405) where it is not installed."""
    return needed("matplotlib.figure", "a picture", "leave the picture out").Figure


def drawn(title: str, runs: Sequence[Any], primal: float, floor: float, kind: str = "png") -> bytes:
    """The picture of runs, each with a `name`, a `whole` time in seconds and an `error`, as a file of a kind that
    matplotlib writes: "png", "svg", "pdf"."""
    figure = figure_class()(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.add_subplot()
    shown = [r for r in runs if r.error is not None and np.isfinite(r.error)]
    for family in ("central difference", "forward difference"):
        line = [r for r in shown if r.name.startswith(family)]
        if line:
            axes.plot([max(r.error, _LEAST) for r in line], [r.whole for r in line], "x-", label=f"{family}s", lw=0.8)
            for r in line:
                axes.annotate(r.name.rpartition(" ")[2], (max(r.error, _LEAST), r.whole), fontsize=7,
                              xytext=(0, 5), textcoords="offset points", ha="center")
    for r in shown:
        if r.name in _MARKS:
            axes.plot([max(r.error, _LEAST)], [r.whole], _MARKS[r.name], label=r.name, ls="none")
    axes.axhline(primal, color="0.5", lw=0.8, ls="--", label="primal")
    axes.axvline(np.finfo(float).eps, color="0.5", lw=0.8, ls=":", label="rounding of float64")
    if floor > 0.0:
        axes.axvspan(_LEAST / 2, floor, color="0.93", label="below the reference's own error")
    axes.set(xscale="log", yscale="log", title=title, xlabel="error of the derivatives, as a fraction of the largest",
             ylabel="time of the whole gradient in seconds")
    axes.legend(fontsize=7)
    out = io.BytesIO()
    figure.savefig(out, format=kind, dpi=150)
    return out.getvalue()


def kind_of(path: str) -> str:
    """The kind of picture that a file's name asks for; raises S2sadError (S407)."""
    kind, kinds = Path(path).suffix[1:].lower(), figure_class()().canvas.get_supported_filetypes()
    if kind not in kinds:
        raise S2sadError(Diagnostic("S407", f"{path}: matplotlib writes no such picture",
                                    help="give a file that ends in .png, .svg or .pdf"))
    return kind
