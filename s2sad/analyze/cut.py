"""The least weight of nodes that separates sources from sinks: what to record (Moses et al., SC 2021, section 4.2)."""
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

    def _path(self) -> dict[str, str]:
        came = {"<": "<"}
        waiting = deque(["<"])
        while waiting:
            here = waiting.popleft()
            for there, capacity in self.residual[here].items():
                if capacity > 0 and there not in came:
                    came[there] = here
                    waiting.append(there)
        return came

    def least_cut(self) -> list[str]:
        """The nodes of a least cut, in the order of their making (Edmonds, Karp, J. ACM 19, 1972)."""
        while ">" in (came := self._path()):
            path, here = [], ">"
            while here != "<":
                path.append((came[here], here))
                here = came[here]
            flow = min(self.residual[a][b] for a, b in path)
            for a, b in path:
                self.residual[a][b] -= flow
                self.residual[b][a] += flow
        return [n for n in self.weights if "in " + n in came and "out " + n not in came]
