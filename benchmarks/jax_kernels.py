"""The kernels of whole arrays as one writes them for JAX: without stores, a scan over the time steps, the same
arithmetic.

`rewritten(jax)` has a function for each; it takes the inputs that are differentiated, then what is held fixed, and
gives the outputs. `remember` is what is done to the body of a scan: nothing, or `jax.checkpoint`.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Rewritten = Callable[..., Any]


def rewritten(jax: Any, remember: Callable[[Rewritten], Rewritten]) -> dict[str, Rewritten]:
    """The kernels by name."""
    made = _Kernels(jax, remember)
    return {name: getattr(made, name) for name in ("gray_scott", "glacier", "neural_diffusion", "implicit_heat",
                                                   "attention", "masked_flow", "lattice")}


class _Kernels:
    def __init__(self, jax: Any, remember: Callable[[Rewritten], Rewritten]):
        self.jax, self.jnp, self.remember = jax, jax.numpy, remember

    def repeated(self, step: Rewritten, state: Any, steps: int) -> Any:
        """The state after so many steps."""
        body = self.remember(step)
        return self.jax.lax.scan(lambda s, _: (body(s), None), state, None, length=steps)[0]

    def gray_scott(self, u: Any, v: Any, feed: Any, kill: Any, steps: int, du: float, dv: float) -> Any:
        """The steps turn the inner field; the halo is what the last step begins with."""
        jnp = self.jnp

        def laplacian(w: Any) -> Any:
            return jnp.roll(w, 1, 0) + jnp.roll(w, 1, 1) - 4.0 * w + jnp.roll(w, -1, 1) + jnp.roll(w, -1, 0)

        def step(state: Any) -> Any:
            u, v = state
            reaction = u * v ** 2
            return (u + du * laplacian(u) - reaction + feed * (1.0 - u),
                    v + dv * laplacian(v) + reaction - (feed + kill) * v)

        before = self.repeated(step, (u[1:-1, 1:-1], v[1:-1, 1:-1]), steps - 1)
        return tuple(jnp.pad(old, 1, mode="wrap").at[1:-1, 1:-1].set(new) for old, new in zip(before, step(before)))

    def glacier(self, thickness: Any, bed: Any, rate: Any, balance: Any, dx: float, dt: float, steps: int) -> Any:
        jnp = self.jnp
        factor = 2.0 * rate * (917.0 * 9.81) ** 3 / 5.0

        def step(thickness: Any) -> Any:
            surface = bed + thickness
            slope_x = (surface[1:, :] - surface[:-1, :]) / dx
            slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
            steep = jnp.sqrt((0.5 * (slope_x[:, 1:] + slope_x[:, :-1])) ** 2
                             + (0.5 * (slope_y[1:, :] + slope_y[:-1, :])) ** 2)
            mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
            diffusivity = factor * mean ** 5 * steep ** 2
            flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
            flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
            change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
            return thickness.at[1:-1, 1:-1].set(jnp.maximum(thickness[1:-1, 1:-1] + dt * (balance - change), 0.0))

        return self.repeated(step, thickness, steps)

    def neural_diffusion(self, u: Any, w1: Any, b1: Any, w2: Any, b2: Any, dt: float, steps: int) -> Any:
        jnp = self.jnp

        def step(u: Any) -> Any:
            hidden = jnp.tanh(w1 @ u[None, :] + b1[:, None])
            diffusivity = jnp.exp(w2 @ hidden + b2)[0]
            flux = jnp.pad(0.5 * (diffusivity[1:] + diffusivity[:-1]) * (u[1:] - u[:-1]), 1)
            return u + dt * (flux[1:] - flux[:-1])

        return jnp.sum(self.repeated(step, u, steps) ** 2)

    def implicit_heat(self, u: Any, conductivity: Any, dt: float, steps: int) -> Any:
        jnp = self.jnp

        def step(u: Any) -> Any:
            left = conductivity[:-1] * (1.0 + u ** 2)
            right = conductivity[1:] * (1.0 + u ** 2)
            matrix = jnp.diag(1.0 + dt * (left + right)) - jnp.diag(dt * left[1:], -1) - jnp.diag(dt * right[:-1], 1)
            return jnp.linalg.solve(matrix, u)

        return self.repeated(step, u, steps)

    def attention(self, q: Any, k: Any, v: Any) -> Any:
        return self.jax.nn.softmax((q @ k.T) * (1.0 / np.sqrt(q.shape[1])), axis=1) @ v

    def masked_flow(self, head: Any, depth: Any, conductance: Any, steps: int) -> Any:
        jnp = self.jnp

        def step(state: Any) -> Any:
            head, depth = state
            dry = depth < 0.05
            speed = jnp.where(dry, 0.0, jnp.sqrt(jnp.where(dry, 1.0, depth)))     # no root of 0 is differentiated
            speed = jnp.where(dry, 0.5 * speed, speed)
            head = head + conductance * (jnp.mean(speed, axis=1, keepdims=True) - speed)
            lost = 0.1 * jnp.clip(head[1:, :] - head[:-1, :], -1.0, 1.0) * depth[1:, :]
            return head, depth.at[1:, :].add(-lost)

        head, depth = self.repeated(step, (head, depth), steps)
        return jnp.sum(head * depth)

    def lattice(self, f: Any, omega: Any, steps: int) -> Any:
        jnp = self.jnp
        cx, cy = (0, 1, 0, -1, 0, 1, -1, -1, 1), (0, 0, 1, 0, -1, 1, 1, -1, -1)
        weight = [4 / 9] + [1 / 9] * 4 + [1 / 36] * 4

        def step(f: Any) -> Any:
            f = [jnp.roll(g, (x, y), (0, 1)) for g, x, y in zip(f, cx, cy)]
            rho = sum(f)
            ux, uy = (sum(c * g for c, g in zip(along, f) if c) / rho for along in (cx, cy))

            def relaxed(g: Any, w: float, x: int, y: int) -> Any:
                cu = 3.0 * (x * ux + y * uy)
                return g + omega * (rho * w * (1.0 + cu + 0.5 * cu ** 2 - 1.5 * (ux ** 2 + uy ** 2)) - g)

            return tuple(map(relaxed, f, weight, cx, cy))

        return jnp.stack(self.repeated(step, tuple(f[q] for q in range(9)), steps))


__all__ = ["Rewritten", "rewritten"]
