"""Finds the first wave and the roughness of a channel from noisy gauges, with gradients made by s2sad.

    python examples/channel.py [--n 80] [--time 4] [--quick] [--output channel.png]

The solver is written as its author would have published it: a grid, boundary conditions by their names, a limiter
chosen by a string, a class of solvers and one derived from it that keeps its state, its time and its records in
attributes. Nothing in it knows of derivatives. The wave at the beginning, an array, and the roughness, a number in an
object, are then found from what five gauges have recorded, with noise, by L-BFGS-B.
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
GRAVITY = 9.81                               # metres per second squared
NOISE = 0.002                                # metres


# -- the solver -------------------------------------------------------------------------------------------------------

def minmod(a, b):
    return np.where(a * b > 0.0, np.where(np.abs(a) < np.abs(b), a, b), 0.0)


def van_leer(a, b):
    product = np.maximum(a * b, 0.0)
    return 2.0 * product / (np.abs(a) + np.abs(b) + 1e-12) * np.sign(a + b)


LIMITERS = {"minmod": minmod, "van Leer": van_leer}


class Grid:
    """Cells along a channel, with two ghost cells at each end, and what lies beyond its ends."""

    ghosts = 2

    def __init__(self, cells, length, left="wall", right="open"):
        self.cells, self.length = cells, length
        self.ends = {"left": left, "right": right}

    @property
    def width(self):
        return self.length / self.cells

    @property
    def inside(self):
        return slice(self.ghosts, self.ghosts + self.cells)

    @property
    def centres(self):
        return (np.arange(self.cells) + 0.5) * self.width

    def field(self, value=0.0):
        return np.full(self.cells + 2 * self.ghosts, value)

    def fill(self, depth, discharge):
        """The ghost cells by the names of the ends."""
        for side, name in self.ends.items():
            for k in range(self.ghosts):
                ghost, image = (k, 2 * self.ghosts - 1 - k) if side == "left" else (-1 - k, -2 * self.ghosts + k)
                if name == "open":
                    image = self.ghosts if side == "left" else -self.ghosts - 1
                depth[ghost] = depth[image]
                discharge[ghost] = -discharge[image] if name == "wall" else discharge[image]


class Solver:
    """Finite volumes of second order in space and time; a class derived from this one has fluxes and sources."""

    def __init__(self, grid, limiter="van Leer", courant=0.4):
        self.grid, self.courant = grid, courant
        self.limiter = LIMITERS[limiter]
        self.t, self.steps = 0.0, 0

    def faces(self, q):
        """Values on both sides of each face, by limited slopes."""
        slope = np.zeros_like(q)
        slope[1:-1] = self.limiter(q[1:-1] - q[:-2], q[2:] - q[1:-1])
        return (q + 0.5 * slope)[1:-2], (q - 0.5 * slope)[2:-1]

    def speed(self):
        raise NotImplementedError

    def step(self, dt):
        raise NotImplementedError

    def run(self, until):
        while self.t < until:
            dt = min(self.courant * self.grid.width / self.speed(), until - self.t)
            self.step(dt)
            self.t += dt
            self.steps += 1


class ShallowWater(Solver):
    """Depth and discharge of water over a flat bed, slowed by its roughness (Manning's, s m^(-1/3))."""

    def __init__(self, grid, roughness=0.0, flow=0.0, gauges=(), **options):
        super().__init__(grid, **options)
        self.roughness, self.flow = roughness, flow
        self.gauges = [int(place / grid.width) + grid.ghosts for place in gauges]
        self.depth, self.discharge = grid.field(1.0), grid.field()

    def start(self, depth):
        self.depth[self.grid.inside] = depth
        self.discharge[:] = self.flow
        self.t, self.steps = 0.0, 0

    def speed(self):
        return np.max(np.abs(self.discharge / self.depth) + np.sqrt(GRAVITY * self.depth))

    def rate(self, depth, discharge):
        self.grid.fill(depth, discharge)
        (h_left, h_right), (q_left, q_right) = self.faces(depth), self.faces(discharge)
        u_left, u_right = q_left / h_left, q_right / h_right
        fastest = np.maximum(np.abs(u_left) + np.sqrt(GRAVITY * h_left), np.abs(u_right) + np.sqrt(GRAVITY * h_right))
        mass = 0.5 * (q_left + q_right) - 0.5 * fastest * (h_right - h_left)
        momentum = 0.5 * (q_left * u_left + 0.5 * GRAVITY * h_left ** 2
                          + q_right * u_right + 0.5 * GRAVITY * h_right ** 2) - 0.5 * fastest * (q_right - q_left)
        h, q = depth[self.grid.inside], discharge[self.grid.inside]
        friction = GRAVITY * self.roughness ** 2 * q * np.abs(q) / h ** (7.0 / 3.0)
        return -(mass[1:] - mass[:-1]) / self.grid.width, -(momentum[1:] - momentum[:-1]) / self.grid.width - friction

    def step(self, dt):
        inside = self.grid.inside
        h, q = self.depth[inside].copy(), self.discharge[inside].copy()
        for weight in (0.0, 0.5):
            dh, dq = self.rate(self.depth, self.discharge)
            self.depth[inside] = weight * h + (1.0 - weight) * (self.depth[inside] + dt * dh)
            self.discharge[inside] = weight * q + (1.0 - weight) * (self.discharge[inside] + dt * dq)

    def record(self, times):
        """What the gauges show at some times, a row each."""
        levels = np.zeros((len(times), len(self.gauges)))
        for k, until in enumerate(times):
            self.run(until)
            for m, cell in enumerate(self.gauges):
                levels[k, m] = self.depth[cell]
        return levels


# -- the fit ----------------------------------------------------------------------------------------------------------

def misfit(channel, depth, times, observed):
    """The mean square distance to what the gauges have shown, and a little for waves that are not smooth."""
    channel.start(depth)
    levels = channel.record(times)
    return np.mean((levels - observed) ** 2) + 2e-3 * np.mean((depth[1:] - depth[:-1]) ** 2)


class Scene:
    """The channel, its gauges and what they have shown; and what nobody tells: the first wave, the roughness."""

    def __init__(self, cells, until):
        self.grid = Grid(cells, length=10.0, left="open")
        self.times = np.linspace(0.0, until, 41)[1:]
        x = self.grid.centres
        self.depth = 1.0 + 0.3 * np.exp(-(x - 3.0) ** 2) - 0.1 * np.exp(-2.0 * (x - 5.5) ** 2)
        self.roughness = 0.15                # reeds
        truth = self.channel(self.roughness)
        truth.start(self.depth)
        levels = truth.record(self.times)
        self.observed = levels + NOISE * np.random.default_rng(7).standard_normal(levels.shape)
        self.both = s2sad.value_and_gradient(s2sad.differentiate(misfit, engine="numpy"),
                                             wrt=("depth", "channel.roughness"))

    def channel(self, roughness):
        return ShallowWater(self.grid, roughness, flow=0.5, gauges=(1.0, 3.0, 5.0, 7.0, 9.0), limiter="van Leer")

    def objective(self, unknowns):
        """The misfit and its gradient."""
        depth, roughness = unknowns[:-1].copy(), float(unknowns[-1])
        value, gradient = self.both(self.channel(roughness), depth, self.times, self.observed)
        return value, np.append(gradient["depth"], gradient["channel.roughness"])


# -- the work ---------------------------------------------------------------------------------------------------------

def fit(scene, iterations, console):
    """What L-BFGS-B finds, with a progress display."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from scipy.optimize import minimize

    columns = (TextColumn("channel"), BarColumn(), TextColumn("iteration {task.completed}"),
               TextColumn("misfit {task.fields[misfit]} m"), TimeElapsedColumn())
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("", total=iterations, misfit="")

        def after_iteration(intermediate_result):
            progress.update(task, advance=1, misfit=f"{np.sqrt(intermediate_result.fun):.4f}")

        found = minimize(scene.objective, np.append(np.ones(scene.grid.cells), 0.05), jac=True, method="L-BFGS-B",
                         callback=after_iteration, options={"maxiter": iterations, "ftol": 1e-12, "gtol": 1e-9})
        progress.update(task, total=found.nit, completed=found.nit)
    return found.x[:-1], found.x[-1]


def show(scene, depth, roughness, console):
    from rich.table import Table

    table = Table("found from the gauges", "truth", "found", "error", title="First wave and roughness")
    error = depth - scene.depth
    table.add_row("height of the wave, m", f"{np.ptp(scene.depth):.3f}", f"{np.ptp(depth):.3f}",
                  f"{np.sqrt(np.mean(error ** 2)):.4f} m rms")
    table.add_row("roughness", f"{scene.roughness:.4f}", f"{roughness:.4f}",
                  f"{abs(roughness / scene.roughness - 1.0):.1%}")
    console.print(table)
    unknowns = np.append(depth, roughness) + 0.01
    exact, step = scene.objective(unknowns)[1], 1e-5 * np.eye(unknowns.size)[:: unknowns.size // 5]
    near = [(scene.objective(unknowns + s)[0] - scene.objective(unknowns - s)[0]) / 2e-5 for s in step]
    apart = np.abs(np.array(near) - exact[:: unknowns.size // 5]).max() / np.abs(exact).max()
    console.print(f"s2sad and central differences agree to {apart:.0e}.")


def show_times(scene, depth, roughness, console):
    begin = time.perf_counter()
    scene.objective(np.append(depth, roughness))
    gradient = time.perf_counter() - begin
    channel = scene.channel(roughness)
    begin = time.perf_counter()
    channel.start(depth)
    channel.record(scene.times)
    model = time.perf_counter() - begin
    console.print(f"{channel.steps} steps of the solver take {model:.2f} s, misfit and gradient {gradient:.2f} s.")


def picture(path, scene, depth, roughness):
    """The first wave as it was and as found, and the gauges."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (first, second) = pyplot.subplots(1, 2, figsize=(11, 3.8), layout="constrained")
    first.plot(scene.grid.centres, scene.depth, label="truth")
    first.plot(scene.grid.centres, depth, "--", label="found from the gauges")
    first.set(xlabel="along the channel (m)", ylabel="depth (m)", title="the first wave")
    first.legend()
    channel = scene.channel(roughness)
    channel.start(depth)
    levels = channel.record(scene.times)
    for k in range(levels.shape[1]):
        second.plot(scene.times, scene.observed[:, k], ".", color=f"C{k}", markersize=4)
        second.plot(scene.times, levels[:, k], color=f"C{k}")
    second.set(xlabel="time (s)", ylabel="depth (m)", title="gauges: recorded (dots) and computed")
    figure.savefig(path, dpi=110)


def parsed(arguments):
    parser = argparse.ArgumentParser(description="Find a wave and a channel's roughness by s2sad's gradients.")
    parser.add_argument("--n", type=int, default=80, help="cells along the channel (default: 80)")
    parser.add_argument("--time", type=float, default=4.0, help="seconds that the gauges record (default: 4)")
    parser.add_argument("--quick", action="store_true", help="few cells, a short record")
    parser.add_argument("--output", type=Path, default=Path("channel.png"), help="the picture (default: channel.png)")
    options = parser.parse_args(arguments)
    if options.quick:
        options.n, options.time = 30, 2.5
    if options.n < 10 or not 0.0 < options.time < 100.0:
        parser.error("--n is at least 10, --time at most 100")
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

    console, scene = Console(), Scene(options.n, options.time)
    depth, roughness = fit(scene, 80 if options.quick else 150, console)
    show(scene, depth, roughness, console)
    show_times(scene, depth, roughness, console)
    picture(options.output, scene, depth, roughness)
    console.print(f"The picture is {options.output}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
