"""min_cut: nodes of least weight that separate sources from sinks: what to record (Moses et al., SC 2021, 4.2)."""
from __future__ import annotations

from collections import deque

UNBOUNDED = 1 << 60


class Network:
    """A directed graph with weights on its nodes.

    >>> network = Network()
    >>> network.node("x", 8), network.node("y", 8), network.node("z", 3)
    (None, None, None)
    >>> for a, b in [("x", "z"), ("y", "z")]: network.edge(a, b)
    >>> network.source("x"); network.source("y"); network.sink("z")
    >>> network.least_cut()
    ['z']
    """

    def __init__(self) -> None:
        self.residual: dict[str, dict[str, int]] = {"<": {}, ">": {}}
        self.weights: dict[str, int] = {}

    def node(self, name: str, weight: int) -> None:
        self.weights[name] = weight
        self._arc("in " + name, "out " + name, weight)

    def edge(self, a: str, b: str) -> None:
        self._arc("out " + a, "in " + b, UNBOUNDED)

    def source(self, name: str) -> None:
        self._arc("<", "in " + name, UNBOUNDED)

    def sink(self, name: str) -> None:
        self._arc("out " + name, ">", UNBOUNDED)

    def _arc(self, a: str, b: str, capacity: int) -> None:
        self.residual.setdefault(a, {})[b] = self.residual.get(a, {}).get(b, 0) + capacity
        self.residual.setdefault(b, {}).setdefault(a, 0)

    def _distances(self) -> dict[str, int]:
        """The distance in arcs of each node that is still reachable from the sources."""
        found = {"<": 0}
        waiting = deque(["<"])
        while waiting:
            here = waiting.popleft()
            for there, capacity in self.residual[here].items():
                if capacity > 0 and there not in found:
                    found[there] = found[here] + 1
                    waiting.append(there)
        return found

    def _fill(self, distances: dict[str, int]) -> None:
        """A blocking flow along shortest paths; an arc that leads no further is not tried again."""
        untried = {here: list(self.residual[here]) for here in distances}
        path = ["<"]
        while path:
            here = path[-1]
            if here == ">":
                arcs = list(zip(path, path[1:]))
                flow = min(self.residual[a][b] for a, b in arcs)
                for a, b in arcs:
                    self.residual[a][b] -= flow
                    self.residual[b][a] += flow
                full = next(k for k, (a, b) in enumerate(arcs) if not self.residual[a][b])
                del path[full + 1:]
            elif untried[here]:
                there = untried[here][-1]
                if self.residual[here][there] > 0 and distances.get(there) == distances[here] + 1:
                    path.append(there)
                else:
                    untried[here].pop()
            else:
                path.pop()
                if path:
                    untried[path[-1]].pop()

    def least_cut(self) -> list[str]:
        """The nodes of a least cut, in the order of their making (Dinic, Soviet Math. Doklady 11, 1970)."""
        while ">" in (distances := self._distances()):
            self._fill(distances)
        return [n for n in self.weights if "in " + n in distances and "out " + n not in distances]
