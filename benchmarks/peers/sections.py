"""The chapters of `docs/performance.md`: what one is, and the list of all.

A chapter is a module that has `SECTION`, and one line in `MODULES` below. To write one:

    from benchmarks.peers.sections import Chapter, Picture, Section
    from benchmarks.tables import Table, shown
    from s2sad.report.timing import Times, sampled

    def measure(quick: bool) -> dict:          # slow; what is returned is stored as NAME.json, so: plain JSON
        return {"kernels": {"heat": {"s2sad": asdict(Times.of(taken))}}}

    def render(found: dict) -> Chapter:        # pure: the same stored data give the same text and pictures
        table = Table("Gradients", ("kernel", "s2sad"))
        table.rows.append(("heat", shown(Times(**found["kernels"]["heat"]["s2sad"]))))
        return Chapter(summary=["One sentence or table for the top of the document."],
                       body=["A paragraph in Markdown.", table, Picture("heat", "What it shows.", draw)])

    SECTION = Section("mine", "Title of the chapter", measure, render, minutes=6)

`measure` runs in a process of its own, on one core, with the C library told to keep its memory; it is killed when
`minutes` are over, and a crash costs the chapter only. What it needs and does not find installed it says in its data.
`draw` takes an empty matplotlib figure. All chapters together have 50 minutes on two cores; `quick` has one.
"""
from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from benchmarks.tables import Table

MODULES = {"peers": "benchmarks.peers.comparison", "gradbench": "benchmarks.peers.gradbench",
           "published": "benchmarks.published.section", "snapshots": "benchmarks.snapshot_curves",
           "jacobians": "benchmarks.jacobians", "equations": "benchmarks.equations"}


@dataclass(frozen=True)
class Picture:
    """A picture's name (of its file), what it shows, how it is drawn on an empty figure, and its inches."""
    name: str
    caption: str
    draw: Callable[[Any], None]
    size: tuple[float, float] = (7.0, 4.5)


Part = str | Table | Picture


@dataclass(frozen=True)
class Chapter:
    """What goes to the top of the document, and what follows under the chapter's title."""
    summary: list[Part] = field(default_factory=list)
    body: list[Part] = field(default_factory=list)


@dataclass(frozen=True)
class Section:
    """A chapter: its stored file's name, its title, how it is measured and rendered, the minutes it may take, and how
    what was stored is completed where these did not suffice (None: they do)."""
    name: str
    title: str
    measure: Callable[[bool], dict[str, Any]]
    render: Callable[[dict[str, Any]], Chapter]
    minutes: float = 8.0
    resume: Callable[[dict[str, Any]], dict[str, Any]] | None = None


def section(name: str) -> Section | None:
    """The section of that name, or None where this tree has none."""
    try:
        found = importlib.util.find_spec(MODULES[name])
    except ModuleNotFoundError:     # not even its package
        return None
    return importlib.import_module(MODULES[name]).SECTION if found is not None else None


__all__ = ["MODULES", "Chapter", "Part", "Picture", "Section", "section"]
