"""`performance.md` and its pictures, from what the chapters have stored: nothing in them is typed.

The same stored files give the same document, byte for byte, so it can be written anew without measuring.
"""
from __future__ import annotations

import importlib
import importlib.util
import json
from pathlib import Path
from typing import Any

from benchmarks.peers.sections import MODULES, Chapter, Part, Picture, Section, section
from benchmarks.tables import NOISE, Table, markdown

INTRODUCTION = """Written by `python -m benchmarks peers`, pictures included; on another machine, too.

Measured on {date}{quick}, one thread on one core: {machine}. Versions: {versions}.

Times are medians of the processor's time that a process takes, all its threads together: waiting for other work on
the machine is not counted. Behind ± stands half the distance of the quartiles. A time whose quartiles are further apart
than {noise:.0f} % of its median does not repeat: it is not shown, and it is said where it would stand."""


def write(folder: Path) -> Path:
    """Writes `performance.md` beside the folder of stored files, and the pictures into it; gives the document's path.

    Args:
        folder: has `machine.json` and a `NAME.json` for each chapter that was measured.
    """
    machine = json.loads((folder / "machine.json").read_text())
    chapters = [(found, stored(folder, found)) for found in map(section, MODULES) if found is not None]
    rendered = [(found, _rendered(found, data)) for found, data in chapters]
    lines = ["# Performance", "", _introduction(machine)]
    for _, chapter in rendered:
        lines += _texts(chapter.summary, folder)
    dates = {found.name: data.get("date", machine["date"]) for found, data in chapters}
    for found, chapter in rendered:
        later: list[Part] = [f"Measured on {dates[found.name]}."] if dates[found.name] != machine["date"] else []
        lines += ["", f"## {found.title}", *_texts([*later, *chapter.body], folder)]
    for name in MODULES:
        if section(name) is None:
            lines += ["", f"The chapter {name} is not in this tree."]
    document = folder.parent / "performance.md"
    document.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return document


def stored(folder: Path, found: Section) -> dict[str, Any]:
    """What a chapter has stored; `{"failed": why}` where it has not."""
    path = folder / f"{found.name}.json"
    return json.loads(path.read_text()) if path.exists() else {"failed": "it has not been measured"}


def draw(picture: Picture, folder: Path) -> bool:
    """Writes a picture as SVG, the same bytes each time; False where matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        return False
    matplotlib = importlib.import_module("matplotlib")
    figures = importlib.import_module("matplotlib.figure")
    settings = {"svg.hashsalt": "s2sad", "svg.fonttype": "none", "font.size": 9, "axes.grid": True,
                "grid.color": "#dddddd", "axes.axisbelow": True}
    with matplotlib.rc_context(settings):
        figure = figures.Figure(figsize=picture.size, layout="constrained", facecolor="white")
        picture.draw(figure)        # on white, so that it can be read on a dark page, too
        figure.savefig(folder / f"{picture.name}.svg", metadata={"Date": None, "Creator": None})
    return True


def _introduction(machine: dict[str, Any]) -> str:
    words = {**machine["machine"]}
    described = ", ".join(words.pop(name) for name in ("processor", "caches", "memory", "system") if name in words)
    return INTRODUCTION.format(
        date=machine["date"], quick=" with few rounds (`--quick`), to see that it works" if machine["quick"] else "",
        machine=described, versions=", ".join(f"{n} {v}" for n, v in words.items()), noise=100.0 * NOISE)


def _rendered(found: Section, data: dict[str, Any]) -> Chapter:
    if "failed" in data:
        return Chapter(body=[f"This chapter was left out: {data['failed']}."])
    return found.render(data)


def _texts(parts: list[Part], folder: Path) -> list[str]:
    lines: list[str] = []
    for part in parts:
        lines.append("")
        if isinstance(part, Table):
            lines.append(markdown(part))
        elif isinstance(part, Picture):
            drawn = draw(part, folder)
            lines.append(f"![{part.caption}]({folder.name}/{part.name}.svg)" if drawn
                         else f"(A picture that needs matplotlib: {part.caption})")
        else:
            lines.append(part)
    return lines
