"""Random statements whose adjoints read what they left, for `programs`: each kind is a method named after its feature.

Systems that are solved, factors and functions of whole arrays, in rounds that store into the result afterwards.
"""
from __future__ import annotations

from tests.programs.functions import FunctionStatements

# how often each kind is chosen
RESULTS = {"solved": 3, "left": 2}

# functions of one or two arrays with one axis, with values between -2 and 2 where theirs are; none has a kink at ties
_OF_ARRAYS = """
np.sort({u}) * 0.9 | np.cumsum({u}) * 0.15 | {u} / (1.0 + np.dot({u}, {v}) ** 2) | {u} * 0.4 * np.max({v})
{u} * 0.4 * np.min({v}) | np.exp({u} - np.max({u})) / np.sum(np.exp({u} - np.max({u}))) | 0.4 * ({u} - np.mean({v}))
0.4 * np.roll({u}, 1) * {v} | np.flip({u}) * 0.9 | 0.1 * np.convolve({u}, {v}[:3], mode="same") | np.gradient({u}) * 0.4
0.4 * np.diff({u}, append={v}[:1]) | np.where({u} > {v}, np.sin({u}), 0.5 * {v}) | 0.4 * {u} * np.median({v})
0.05 * np.real(np.fft.fft({u})) * {v} | 0.02 * np.abs(np.fft.fft({u})) ** 2 | 0.2 * {u} * np.var({v})
0.4 * np.outer({u}, {v})[1] | np.maximum.accumulate({u}) * 0.9 | np.take({u}, [1, 0, 2]).sum() * 0.1 * {v}
np.pad({u}[1:-1], 1) * 0.9 | np.concatenate([{u}[:1], {v}[1:]]) * 0.9 | np.stack([{u}, {v}]).prod(axis=0) * 0.4
np.hypot({u}, 1.0) * 0.8 | np.arctan2({u}, 2.0 + {v}) | np.linalg.norm(1.0 + {u}) * 0.05 * {v}
np.clip({u}, -0.71, 0.83) | np.interp(0.3 * {u}, [-1.0, 0.1, 1.0], {v}[:3])
0.1 * np.linalg.norm(np.outer({u}, {v}) + 3.0, axis=0) | np.einsum("i,i,j->j", {u}, {v}, {u}) * 0.02
np.repeat({u}[:1] * {v}[1:2], {u}.size) * 0.4 | 0.9 * {u}[np.argsort({v})]
"""
_FORMS = [form.strip() for line in _OF_ARRAYS.strip().splitlines() for form in line.split("|")]


class ResultStatements(FunctionStatements):
    """Writes statements that leave what their adjoints read."""

    def solved(self) -> None:
        """A system that changes from round to round, and whose solution is stored into."""
        c, scope = self.choices, self.scope
        vectors = [v for v, s in scope.vectors.items() if s == "3"]
        if not vectors:
            return
        u, q, found = c.pick(vectors), self.fresh("q"), self.fresh("found")
        self.write(f"{q} = 8.0 * np.eye(3) + 0.5 * np.outer({u}, {c.pick(vectors)})")
        solutions = [f"np.linalg.solve({q}, {u})", f"np.linalg.inv({q}) @ {u}",
                     f"0.1 * np.linalg.cholesky({q} @ {q}.T)[{c.integer(0, 2)}]",
                     f"np.linalg.lstsq({q}, np.sin({q} @ {u}))[0]"]
        kept = c.chance(50)
        if kept:
            self.write(f"{found} = np.zeros(3)")
        self.write(f"for {self.fresh('round')} in range({c.integer(1, 3)}):")
        self.write(f"    {found}{'[:]' if kept else ''} = {c.pick(solutions)}")
        self._used(found, "3", [f"{q}[{c.integer(0, 2)}, {c.integer(0, 2)}] += 0.2 * {found}[{c.integer(0, 2)}]"])
        if kept:
            scope.vectors[found] = "3"

    def left(self) -> None:
        """What a function of an array gives, and what is stored into it afterwards."""
        c, scope = self.choices, self.scope
        size = c.pick(["n", "3"])
        like = [v for v, s in scope.vectors.items() if s == size]
        if not like:
            return
        u, found = c.pick(like), self.fresh("left")
        self.write(f"{found} = np.zeros({size})")
        self.write(f"for {self.fresh('round')} in range({c.integer(1, 3)}):")
        given = c.pick(_FORMS).format(u=u, v=c.pick(like))
        self.write("    " + c.pick([
            f"{found}[:] = {given}", f"{found} = {given}", f"{found} += 0.5 * ({given} - {found})",
            f"{found}[:] = np.tanh({u})", f"{found}[:] = np.exp(-{u} ** 2)", f"np.tanh({u}, out={found})",
            f"{found}[1:] = 0.9 * np.sqrt(2.5 + {u}[:-1])", f"{found}[:] = np.tanh({u} + {found})",
            f"{found}[:] = np.cumprod(0.5 * {u})", f"{found}[:] = 1.0 / (2.0 + {u} ** 2)",
            f"{found}[0] = np.prod({u}[:2]) * 0.3"]))
        self._used(found, size, [f"{found} *= 0.5", f"{found}[1] = 0.3 * {found}[0]"])
        scope.vectors[found] = size

    def _used(self, found: str, size: str, changes: list[str]) -> None:
        """A result that is read in its round, before and after something is stored into it."""
        c, free = self.choices, self.vectors_to_write(size)
        if free:
            v = self.marked(c.pick(free))
            self.write(f"    {v}[:] = 0.5 * {v} + 0.3 * {c.pick([found, f'np.sin({found})', f'{found}[::-1]'])}")
        for _ in range(c.integer(1, 2)):
            self.write("    " + c.pick([f"{found}[:] = 0.0", f"{found}[{c.integer(0, 2)}] = {self.tame(1)}",
                                        f"{found}[::2] *= 0.5", *changes]))
