"""How much memory a process may have, as far as the operating system says."""
from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

PROC = Path("/proc")
GROUPS = Path("/sys/fs/cgroup")


def most_memory() -> float:
    """The bytes that this process may have: those of the machine with what it swaps to, those of its control groups,
    and its own limits; infinity where nobody says."""
    return min([_machine(), *_of_groups(), *_own_limits()])


def _machine() -> float:
    with suppress(OSError, ValueError):
        said = dict(line.split(":", 1) for line in (PROC / "meminfo").read_text().splitlines())
        return 1024.0 * sum(int(said[k].split()[0]) for k in ("MemTotal", "SwapTotal") if k in said)
    return math.inf


def _of_groups() -> Iterator[float]:
    """The limits of the control groups of this process, of either version, and of those around them."""
    with suppress(OSError):
        for line in (PROC / "self" / "cgroup").read_text().splitlines():
            _, controllers, path = line.split(":", 2)
            if controllers and "memory" not in controllers.split(","):
                continue
            root, limit = (GROUPS / "memory", "memory.limit_in_bytes") if controllers else (GROUPS, "memory.max")
            group = Path(path.lstrip("/"))
            for place in (group, *group.parents):
                with suppress(OSError, ValueError):
                    yield float((root / place / limit).read_text())     # "max" for none


def _own_limits() -> Iterator[float]:
    with suppress(ImportError, OSError, ValueError):
        import resource

        for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA):
            soft = resource.getrlimit(kind)[0]
            if soft != resource.RLIM_INFINITY:
                yield float(soft)
