"""Recovers the parameters of a reaction-diffusion model from noisy observations, with gradients made by s2sad.

    python examples/brusselator.py [--n 64] [--steps 1200] [--quick] [--output brusselator.png]

The Brusselator stands below as its users write it: loops over a grid, arrays written in place. `misfit` integrates it
and compares one of its two fields with what was observed. L-BFGS-B then finds A, B, alpha and the amplitude of the
initial fields from the gradient of `misfit`.
"""
from __future__ import annotations

import argparse
import statistics
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import s2sad

EXTRAS = {"numba": "jit", "scipy": "jit", "rich": "progress", "matplotlib": "plot"}
NAMES = ("A", "B", "alpha", "amplitude")
TRUTH = np.array([3.4, 1.0, 0.002, 1.0])
GUESS = np.array([2.8, 1.3, 0.004, 0.7])
BOUNDS = [(0.4, 2.0)] * 4  # as multiples of the guess
END, FRAMES, NOISE = 6.0, 8, 0.1


# -- the model --------------------------------------------------------------------------------------------------------

def limit(a, n):
    if a == n:
        return 0
    if a == -1:
        return n - 1
    return a


def forcing(x, y, t):
    inside = (x - 0.3) ** 2 + (y - 0.6) ** 2 <= 0.01
    return 5.0 if inside and t >= 1.1 else 0.0


def brusselator(du, u, p, t):
    """du, u: (n, n, 2); p = (A, B, alpha, dx)."""
    a, b, alpha, dx = p
    alpha = alpha / dx ** 2
    n = u.shape[0]
    for i in range(n):
        for j in range(n):
            x, y = i * dx, j * dx
            ip1, im1, jp1, jm1 = limit(i + 1, n), limit(i - 1, n), limit(j + 1, n), limit(j - 1, n)
            du[i, j, 0] = (alpha * (u[im1, j, 0] + u[ip1, j, 0] + u[i, jp1, 0] + u[i, jm1, 0] - 4.0 * u[i, j, 0])
                           + b + u[i, j, 0] ** 2 * u[i, j, 1] - (a + 1.0) * u[i, j, 0] + forcing(x, y, t))
            du[i, j, 1] = (alpha * (u[im1, j, 1] + u[ip1, j, 1] + u[i, jp1, 1] + u[i, jm1, 1] - 4.0 * u[i, j, 1])
                           + a * u[i, j, 0] - u[i, j, 0] ** 2 * u[i, j, 1])


def start(u, amplitude):
    """The initial fields, written to u."""
    n = u.shape[0]
    for i in range(n):
        for j in range(n):
            x, y = i / n, j / n
            u[i, j, 0] = amplitude * 22.0 * (y * (1.0 - y)) ** 1.5
            u[i, j, 1] = amplitude * 27.0 * (x * (1.0 - x)) ** 1.5


def advance(u, p, t, dt, steps):
    """Explicit Euler steps, in place."""
    du = np.empty_like(u)
    for s in range(steps):
        brusselator(du, u, p, t + s * dt)
        u += dt * du


def misfit(amplitude, p, observed, dt, steps):
    """The mean square of (first field - observed), over the frames in `observed`, `steps` time steps apart."""
    frames, n, _ = observed.shape
    u = np.empty((n, n, 2))
    start(u, amplitude)
    total = 0.0
    for frame in range(frames):
        advance(u, p, frame * steps * dt, dt, steps)
        for i in range(n):
            for j in range(n):
                total += (u[i, j, 0] - observed[frame, i, j]) ** 2
    return total / observed.size


# -- the work ---------------------------------------------------------------------------------------------------------

def simulate(parameters, n, dt, steps):
    """The first field at every frame, by the compiled model."""
    begin, run = s2sad.differentiate(start).primal, s2sad.differentiate(advance).primal
    u, frames = np.empty((n, n, 2)), []
    begin(u, parameters[3])
    for frame in range(FRAMES):
        run(u, np.array([*parameters[:3], 1.0 / n]), frame * steps * dt, dt, steps)
        frames.append(u[:, :, 0].copy())
    return np.array(frames)


class Objective:
    """The misfit and its gradient as functions of the four unknowns, each divided by its guess."""

    def __init__(self, observed, dt, steps):
        self.observed, self.dt, self.steps = observed, dt, steps
        self.dx = 1.0 / observed.shape[1]
        self.both = s2sad.value_and_gradient(misfit, wrt=("amplitude", "p"))
        self.primal = s2sad.differentiate(misfit).primal

    def arguments(self, unknowns):
        a, b, alpha, amplitude = (float(v) for v in unknowns * GUESS)
        return amplitude, np.array([a, b, alpha, self.dx]), self.observed, self.dt, self.steps

    def value(self, unknowns):
        return self.primal(*self.arguments(unknowns))

    def __call__(self, unknowns):
        value, gradient = self.both(*self.arguments(unknowns))
        return value, np.array([*gradient["p"][:3], gradient["amplitude"]]) * GUESS

    def differences(self, unknowns, h=1e-6):
        """The gradient by central differences: two runs of the model for each unknown."""
        steps = h * np.eye(len(unknowns))
        return np.array([(self.value(unknowns + s) - self.value(unknowns - s)) / (2.0 * h) for s in steps])


def recover(objective, console, limit_of_iterations):
    """The unknowns by L-BFGS-B, and the errors of all iterates, with a progress display."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from scipy.optimize import minimize

    history = [np.ones(4)]
    columns = (TextColumn("L-BFGS-B"), BarColumn(), TextColumn("iteration {task.completed}"),
               TextColumn("misfit {task.fields[misfit]}"), TimeElapsedColumn())
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("", total=limit_of_iterations, misfit="")

        def after_iteration(intermediate_result):
            history.append(intermediate_result.x.copy())
            progress.update(task, advance=1, misfit=f"{intermediate_result.fun:.6f}")

        found = minimize(objective, history[0], jac=True, method="L-BFGS-B", bounds=BOUNDS, callback=after_iteration,
                         options={"maxiter": limit_of_iterations, "ftol": 1e-12, "gtol": 1e-8})
        progress.update(task, total=found.nit, completed=found.nit)
    return found, np.abs(np.array(history) * GUESS / TRUTH - 1.0)


def interleaved(calls, rounds):
    """The median seconds of each call, measured in turns."""
    times = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            begin = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - begin)
    return {name: statistics.median(found) for name, found in times.items()}


# -- what is shown ----------------------------------------------------------------------------------------------------

def show_head(objective, console, lines=30):
    """The generated file's opening, and the opening of the function that it was made for."""
    from rich.syntax import Syntax

    source = s2sad.differentiate(misfit, wrt=("amplitude", "p")).adjoint_source(*objective.arguments(np.ones(4)))
    opening = source[:source.index('"""', 3) + 3]
    adjoint = source[source.index("def misfit_adjoint("):].splitlines()
    console.print(f"From the generated file ({len(source.splitlines())} lines):\n")
    shown = "\n".join([opening, "...", "", *adjoint[:lines], "    ..."])
    console.print(Syntax("", "python", background_color="default").highlight(shown), soft_wrap=True)


def show_recovered(found, console):
    from rich.table import Table

    table = Table("unknown", "guess", "recovered", "truth", "error",
                  title=f"After {found.nit} iterations, {found.nfev} gradients")
    for name, guess, value, truth in zip(NAMES, GUESS, found.x * GUESS, TRUTH):
        table.add_row(name, f"{guess:g}", f"{value:.6g}", f"{truth:g}", f"{abs(value / truth - 1.0):.2%}")
    console.print(table)


def show_times(objective, unknowns, console, rounds):
    """What a gradient costs, against the model alone and against differences, and how far these are apart."""
    from rich.table import Table

    times = interleaved({"the model (misfit alone)": lambda: objective.value(unknowns),
                         "s2sad: misfit and gradient": lambda: objective(unknowns),
                         "central differences": lambda: objective.differences(unknowns)}, rounds)
    model = times["the model (misfit alone)"]
    table = Table("one evaluation", "milliseconds", "over the model", title="Time for the gradient")
    for name, seconds in times.items():
        table.add_row(name, f"{1e3 * seconds:.1f}", f"{seconds / model:.1f}")
    console.print(table)
    exact, near = objective(unknowns)[1], objective.differences(unknowns)
    console.print(f"s2sad and central differences agree to {np.abs(exact - near).max() / np.abs(exact).max():.0e}.")


def picture(path, observed, recovered, truth, errors):
    """Four frames as observed, as recovered, and their distance to the truth; below, how the unknowns got there."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    shown = [0, 2, 4, 7]
    figure = pyplot.figure(figsize=(10.5, 9.6), layout="constrained")
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=[3.4, 1.0])[:, 0]
    grid = above.subplots(3, 4, sharex=True, sharey=True)
    top = max(observed[shown].max(), recovered[shown].max())
    far = max(np.abs((recovered - truth)[shown]).max(), 1e-12)
    rows = [("observed", observed, "viridis", 0.0, top), ("recovered", recovered, "viridis", 0.0, top),
            ("recovered - truth", recovered - truth, "RdBu_r", -far, far)]
    for axes, (label, fields, colours, low, high) in zip(grid, rows):
        for axis, frame in zip(axes, shown):
            image = axis.imshow(fields[frame].T, origin="lower", extent=(0, 1, 0, 1), cmap=colours, vmin=low, vmax=high)
            axis.set(xticks=[], yticks=[])
        axes[0].set_ylabel(label)
        above.colorbar(image, ax=axes, shrink=0.85)
    for axis, frame in zip(grid[0], shown):
        axis.set_title(f"t = {(frame + 1) * END / FRAMES:g}")
    axis = below.subplots()
    for name, marker, error in zip(NAMES, "os^d", errors.T):
        axis.semilogy(error, marker=marker, markersize=3.5, linewidth=1.2, label=name)
    axis.set(xlabel="iteration of L-BFGS-B", ylabel="relative error")
    axis.xaxis.get_major_locator().set_params(integer=True)
    axis.grid(alpha=0.3)
    axis.legend(ncols=4)
    figure.savefig(path, dpi=110)
    pyplot.close(figure)


def options(given):
    parser = argparse.ArgumentParser(description="Recover a model's parameters by s2sad's gradients.")
    parser.add_argument("--n", type=int, help="cells along each side (default 64)")
    parser.add_argument("--steps", type=int, help="time steps up to t = 6 (default 1200)")
    parser.add_argument("--quick", action="store_true", help="a small problem: n = 16, 400 steps, few repetitions")
    parser.add_argument("--output", type=Path, default=Path("brusselator.png"), help="the picture's file")
    chosen = parser.parse_args(given)
    chosen.n = chosen.n or (16 if chosen.quick else 64)
    chosen.steps = chosen.steps or (400 if chosen.quick else 1200)
    if chosen.n < 4 or chosen.steps < FRAMES:
        parser.error(f"--n is at least 4, --steps at least {FRAMES}")
    # explicit Euler: diffusion at the largest alpha that the search may try, and the reaction
    needed = int(np.ceil(END * max(4.0 * BOUNDS[2][1] * GUESS[2] * chosen.n ** 2, 50.0)))
    if chosen.steps < needed:
        parser.error(f"with --n {chosen.n} explicit Euler needs at least --steps {needed}")
    if not chosen.output.resolve().parent.is_dir():
        parser.error(f"--output: there is no folder {chosen.output.resolve().parent}")
    return chosen


def main(given=None):
    chosen = options(given)
    missing = [module for module in EXTRAS if find_spec(module) is None]
    if missing:
        extras = ",".join(dict.fromkeys(EXTRAS[module] for module in missing))
        print(f"this example needs {', '.join(missing)}: pip install \"s2sad[{extras}]\"", file=sys.stderr)
        return 1
    from rich.console import Console

    console = Console()
    steps = chosen.steps // FRAMES
    dt = END / (steps * FRAMES)
    with console.status("compiling and running the model"):
        truth = simulate(TRUTH, chosen.n, dt, steps)
        observed = truth + NOISE * np.random.default_rng(1).standard_normal(truth.shape)
        objective = Objective(observed, dt, steps)
    show_head(objective, console)
    console.print(f"\n{FRAMES} frames of {chosen.n} x {chosen.n} observations with noise of {NOISE}, "
                  f"{steps * FRAMES} time steps.")
    with console.status("compiling the adjoint"):
        begin = time.perf_counter()
        objective(np.ones(4))
        console.print(f"First gradient after {time.perf_counter() - begin:.1f} s.")
    found, errors = recover(objective, console, 30 if chosen.quick else 80)
    show_recovered(found, console)
    show_times(objective, np.ones(4), console, 3 if chosen.quick else 5)
    picture(chosen.output, observed, simulate(found.x * GUESS, chosen.n, dt, steps), truth, errors)
    console.print(f"Fields drawn in {chosen.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
