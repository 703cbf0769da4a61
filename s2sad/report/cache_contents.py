"""What the cache holds, for the command."""
from __future__ import annotations

import time

from s2sad.run import eviction, store
from s2sad.run.permissions import exposure

_KINDS = {"code": "machine code", "py": "generated text", "data": "data", "module": "derivatives"}


def describe_cache() -> str:
    """Where the cache is, what it holds of each kind, when the oldest of it was used, and its limits."""
    place = store.location()
    found = eviction.entries(place)
    lines = [str(place)]
    if reason := _unused():
        lines.append(f"  NOT USED: {reason}, and what it holds is executed")
    for kind in dict.fromkeys(map(_kind, found)):
        own = [e for e in found if _kind(e) == kind]
        lines.append(f"  {kind:16s} {_counted(len(own)):>12s} {_size(sum(e.size for e in own)):>10s}")
    if found:
        days, size = max(0.0, time.time() - found[0].used) / 86_400.0, _size(sum(e.size for e in found))
        lines.append(f"  {'in all':16s} {_counted(len(found)):>12s} {size:>10s}, the oldest used {days:.0f} days ago")
    else:
        lines.append("  nothing")
    size, age = eviction.limits()
    lines.append(f"limits: {_size(size)} (S2SAD_CACHE_SIZE), {age:g} days without use (S2SAD_CACHE_DAYS)")
    return "\n".join(lines) + "\n"


def clear_cache() -> str:
    """Empties the cache; the message with what was removed."""
    place = store.location()
    count, size = eviction.clear(place)
    left = len(eviction.entries(place))
    return f"{_counted(count)} removed ({_size(size)}) from {place}\n" + (
        f"{_counted(left)} cannot be removed\n" if left else "")


def _unused() -> str | None:
    """Why the folder of the entries is not used."""
    try:
        return exposure(str(store.location() / store.FOLDER))
    except OSError:
        return None     # it is not there yet


def _kind(entry: eviction.Entry) -> str:
    return _KINDS.get(entry.kind, entry.kind) if entry.path.parent.name == store.FOLDER else "older versions"


def _counted(count: int) -> str:
    return f"{count} {'entry' if count == 1 else 'entries'}"


def _size(size: float) -> str:
    for unit in ("bytes", "kB", "MB"):
        if size < 1000:
            return f"{size:.0f} {unit}" if unit == "bytes" else f"{size:.1f} {unit}"
        size /= 1024
    return f"{size:.1f} GB"
