"""Finds a glacier's bed and the softness of its ice from its final surface, with gradients made by s2sad.

    python examples/glacier.py [--n 40] [--steps 400] [--quick] [--output glacier.png]

Shallow ice (isothermal in each column, Glen's n = 3) flows over a bed, explicit in time, its thickness written in place
with slices. First the bed, a sum of bumps, and one rate factor are found from the final surface by L-BFGS-B. Then the
rate factor is a function of temperature that nobody tells: a small network of the temperature takes its place in the
same kernel (a universal differential equation), is trained on the final surface, and is compared with Arrhenius' law.
"""
from __future__ import annotations

import argparse
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import s2sad

EXTRAS = {"scipy": "jit", "rich": "progress", "matplotlib": "plot"}
DX, DT = 1000.0, 0.05                        # metres, years
BALANCE = 0.3                                # metres of ice a year
RATE = 2.0e-16                               # Pa^-3 a^-1, the softness of ice at -10 degrees
HIDDEN = 6


# -- the model --------------------------------------------------------------------------------------------------------

def advance(thickness, bed, rate, balance, dx, dt, steps):
    """Ice thickness, in place: (n, n); the rate factor stands between the cells, (n - 1, n - 1)."""
    factor = 2.0 * rate * (917.0 * 9.81) ** 3 / 5.0
    for _ in range(steps):
        surface = bed + thickness
        slope_x = (surface[1:, :] - surface[:-1, :]) / dx
        slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
        steep = (0.5 * (slope_x[:, 1:] + slope_x[:, :-1])) ** 2 + (0.5 * (slope_y[1:, :] + slope_y[:-1, :])) ** 2
        mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
        diffusivity = factor * mean ** 5 * steep
        flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
        flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
        change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
        thickness[1:-1, 1:-1] = np.maximum(thickness[1:-1, 1:-1] + dt * (balance - change), 0.0)


def bed_misfit(heights, log_rate, modes, plain, start, observed, balance, dx, dt, steps):
    """The mean square distance to the observed surface, over a bed of bumps and with one rate factor."""
    bed = plain + np.sum(heights[:, None, None] * modes, axis=0)
    rate = 2.0e-16 * np.exp(log_rate) * np.ones((plain.shape[0] - 1, plain.shape[1] - 1))
    thickness = start.copy()
    advance(thickness, bed, rate, balance, dx, dt, steps)
    return np.mean((bed + thickness - observed) ** 2)


def network(rate, temperature, w1, b1, w2, b2):
    """The rate factor as a small network of the temperature, written to rate."""
    log_rate = b2 * np.ones(temperature.shape)
    for k in range(w1.size):
        log_rate += w2[k] * np.tanh(w1[k] * temperature + b1[k])
    rate[:] = 2.0e-16 * np.exp(log_rate)


def network_misfit(w1, b1, w2, b2, temperature, bed, start, observed, balance, dx, dt, steps):
    """The same, over a known bed, with the network for the rate factor."""
    rate = np.empty_like(temperature)
    network(rate, temperature, w1, b1, w2, b2)
    thickness = start.copy()
    advance(thickness, bed, rate, balance, dx, dt, steps)
    return np.mean((bed + thickness - observed) ** 2)


# -- the scene --------------------------------------------------------------------------------------------------------

def arrhenius(temperature):
    """The rate factor of ice by its temperature, given in units of 9 degrees from -10."""
    kelvin = 263.15 + 9.0 * temperature
    return RATE * np.exp(-6.0e4 / 8.314 * (1.0 / kelvin - 1.0 / 263.15))


class Scene:
    """What is known: grids, the ice at the start, the temperature; and what is not: heights of bumps, the rate."""

    def __init__(self, n, steps):
        x = np.linspace(-1.0, 1.0, n)
        self.n, self.steps = n, steps
        self.start = 300.0 * np.maximum(1.1 - x[:, None] ** 2 - x[None, :] ** 2, 0.0)
        self.plain = 1500.0 - 150.0 * x[:, None] + 0.0 * x[None, :]
        centres = [(a, b) for a in (-0.45, 0.0, 0.45) for b in (-0.45, 0.0, 0.45)]
        self.modes = np.array([np.exp(-((x[:, None] - a) ** 2 + (x[None, :] - b) ** 2) / 0.08) for a, b in centres])
        self.heights = 60.0 * np.random.default_rng(3).standard_normal(len(centres))
        self.log_rate = 0.4
        middle = 0.5 * (x[1:] + x[:-1])
        self.temperature = 0.8 * middle[None, :] + 0.2 * middle[:, None]
        self.run = s2sad.differentiate(advance).primal

    def surface(self, bed, rate):
        thickness = self.start.copy()
        self.run(thickness, bed, np.broadcast_to(rate, (self.n - 1,) * 2).copy(), BALANCE, DX, DT, self.steps)
        return bed + thickness

    def bed(self, heights):
        return self.plain + np.sum(heights[:, None, None] * self.modes, axis=0)

    @property
    def numbers(self):
        return BALANCE, DX, DT, self.steps


# -- the work ---------------------------------------------------------------------------------------------------------

def minimised(title, objective, start, iterations, console):
    """What L-BFGS-B finds, with a progress display."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from scipy.optimize import minimize

    columns = (TextColumn(title), BarColumn(), TextColumn("iteration {task.completed}"),
               TextColumn("misfit {task.fields[misfit]} m"), TimeElapsedColumn())
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("", total=iterations, misfit="")

        def after_iteration(intermediate_result):
            progress.update(task, advance=1, misfit=f"{np.sqrt(intermediate_result.fun):.4f}")

        found = minimize(objective, start, jac=True, method="L-BFGS-B", callback=after_iteration,
                         options={"maxiter": iterations, "ftol": 1e-14, "gtol": 1e-10})
        progress.update(task, total=found.nit, completed=found.nit)
    return found


def find_bed(scene, iterations, console):
    """The heights of the bumps and the logarithm of the rate factor."""
    observed = scene.surface(scene.bed(scene.heights), RATE * np.exp(scene.log_rate))
    both = s2sad.value_and_gradient(bed_misfit, wrt=("heights", "log_rate"))

    def objective(unknowns):
        value, gradient = both(50.0 * unknowns[:-1], float(unknowns[-1]), scene.modes, scene.plain, scene.start,
                               observed, *scene.numbers)
        return value, np.append(50.0 * gradient["heights"], gradient["log_rate"])

    found = minimised("bed and rate", objective, np.zeros(scene.heights.size + 1), iterations, console)
    return 50.0 * found.x[:-1], found.x[-1], objective


def train(scene, iterations, console):
    """The weights of the network."""
    bed = scene.bed(scene.heights)
    observed = scene.surface(bed, arrhenius(scene.temperature))
    both = s2sad.value_and_gradient(network_misfit, wrt=("w1", "b1", "w2", "b2"))

    def objective(weights):
        w1, b1, w2 = weights[:-1].reshape(3, HIDDEN).copy()
        value, gradient = both(w1, b1, w2, float(weights[-1]), scene.temperature, bed, scene.start, observed,
                               *scene.numbers)
        return value, np.concatenate([gradient["w1"], gradient["b1"], gradient["w2"], [gradient["b2"]]])

    start = 0.5 * np.random.default_rng(1).standard_normal(3 * HIDDEN + 1)
    return minimised("network", objective, start, iterations, console).x


def rate_of(weights, temperature):
    """What the network says of the rate factor."""
    w1, b1, w2 = weights[:-1].reshape(3, HIDDEN)
    return RATE * np.exp(np.tanh(temperature[..., None] * w1 + b1) @ w2 + weights[-1])


# -- what is shown ----------------------------------------------------------------------------------------------------

def show_bed(scene, heights, log_rate, objective, console):
    from rich.table import Table

    error = scene.bed(heights) - scene.bed(scene.heights)
    table = Table("found from the surface", "truth", "found", "error", title="Bed and rate factor")
    table.add_row("relief of the bed, m", f"{np.ptp(scene.bed(scene.heights) - scene.plain):.1f}",
                  f"{np.ptp(scene.bed(heights) - scene.plain):.1f}", f"{np.sqrt(np.mean(error ** 2)):.3f} m rms")
    table.add_row("rate factor, 1e-16", f"{1e16 * RATE * np.exp(scene.log_rate):.4f}",
                  f"{1e16 * RATE * np.exp(log_rate):.4f}", f"{abs(np.expm1(log_rate - scene.log_rate)):.3%}")
    console.print(table)
    unknowns = np.append(heights / 50.0, log_rate) + 0.1
    step = 1e-5 * np.eye(unknowns.size)
    near = np.array([(objective(unknowns + s)[0] - objective(unknowns - s)[0]) / 2e-5 for s in step])
    exact = objective(unknowns)[1]
    console.print(f"s2sad and central differences agree to {np.abs(exact - near).max() / np.abs(exact).max():.0e}.")


def show_times(scene, objective, unknowns, console):
    begin = time.perf_counter()
    objective(unknowns)
    gradient = time.perf_counter() - begin
    begin = time.perf_counter()
    scene.surface(scene.plain, RATE)
    model = time.perf_counter() - begin
    console.print(f"The model takes {1e3 * model:.1f} ms, misfit and gradient {1e3 * gradient:.1f} ms.")


def show_network(scene, weights, console):
    inside = np.linspace(scene.temperature.min(), scene.temperature.max(), 50)
    error = np.abs(np.log(rate_of(weights, inside) / arrhenius(inside)))
    console.print(f"The network's rate factor is within {np.expm1(error.mean()):.1%} of Arrhenius' law on average, "
                  f"{np.expm1(error.max()):.1%} at most.")


def picture(path, scene, heights, weights):
    """The bed as it is and as found, and the two rate factors over the temperature."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (first, second, third) = pyplot.subplots(1, 3, figsize=(13, 3.8), layout="constrained")
    truth, found = scene.bed(scene.heights) - scene.plain, scene.bed(heights) - scene.plain
    for axes, field, title in ((first, truth, "bumps of the bed, truth (m)"), (second, found, "as found (m)")):
        shown = axes.imshow(field, cmap="RdBu_r", vmin=-np.abs(truth).max(), vmax=np.abs(truth).max())
        axes.set_title(title)
        figure.colorbar(shown, ax=axes)
    scaled = np.linspace(scene.temperature.min(), scene.temperature.max(), 100)
    third.plot(9.0 * scaled - 10.0, arrhenius(scaled), label="Arrhenius' law")
    third.plot(9.0 * scaled - 10.0, rate_of(weights, scaled), "--", label="network, from the surface")
    third.set(xlabel="temperature (Celsius)", ylabel="rate factor (Pa$^{-3}$ a$^{-1}$)", title="softness of ice")
    third.legend()
    figure.savefig(path, dpi=110)


def parsed(arguments):
    parser = argparse.ArgumentParser(description="Find a glacier's bed and softness by s2sad's gradients.")
    parser.add_argument("--n", type=int, default=40, help="cells along a side (default: 40)")
    parser.add_argument("--steps", type=int, default=400, help="time steps (default: 400)")
    parser.add_argument("--quick", action="store_true", help="a small grid and few steps")
    parser.add_argument("--output", type=Path, default=Path("glacier.png"), help="the picture (default: glacier.png)")
    options = parser.parse_args(arguments)
    if options.quick:
        options.n, options.steps = 20, 120
    if options.n < 8 or options.steps < 10:
        parser.error("--n is at least 8, --steps at least 10")
    if not options.output.absolute().parent.is_dir():
        parser.error(f"--output: there is no folder {options.output.parent}")
    return options


def main(arguments=None):
    options = parsed(arguments)
    missing = [module for module in EXTRAS if find_spec(module) is None]
    if missing:
        extras = ",".join(dict.fromkeys(EXTRAS[module] for module in missing))
        print(f'this example needs {", ".join(missing)}: pip install "s2sad[{extras}]"', file=sys.stderr)
        return 1
    from rich.console import Console

    console, scene = Console(), Scene(options.n, options.steps)
    iterations = 60 if options.quick else 150
    heights, log_rate, objective = find_bed(scene, iterations, console)
    show_bed(scene, heights, log_rate, objective, console)
    show_times(scene, objective, np.append(heights / 50.0, log_rate), console)
    weights = train(scene, iterations, console)
    show_network(scene, weights, console)
    picture(options.output, scene, heights, weights)
    console.print(f"The picture is {options.output}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
