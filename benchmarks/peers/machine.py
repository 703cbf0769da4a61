"""The machine on which was measured, and the versions of what ran."""
from __future__ import annotations

import platform
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

CACHES = Path("/sys/devices/system/cpu/cpu0/cache")


def machine(distributions: Iterable[str]) -> dict[str, str]:
    """Words for the processor, its caches and memory, the system, Python, and the versions of what is installed."""
    found = {"processor": processor(), "caches": ", ".join(_caches()) or "unknown", "memory": _memory(),
             "system": f"{platform.system()} {platform.machine()}", "Python": platform.python_version()}
    for name in distributions:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def processor() -> str:
    """The processor as the system names it."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text().splitlines() if information.exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")),
                platform.processor() or platform.machine())


def _caches() -> list[str]:
    folders = sorted(CACHES.glob("index*")) if CACHES.exists() else []
    return [f"L{(f / 'level').read_text().strip()} {(f / 'size').read_text().strip()}" for f in folders
            if (f / "type").read_text().strip() != "Instruction"]


def _memory() -> str:
    information = Path("/proc/meminfo")
    if not information.exists():
        return "unknown"
    return f"{int(information.read_text().split()[1]) / 2 ** 20:.0f} GiB"
