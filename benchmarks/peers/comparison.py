"""Every kernel under every tool: run time against error, growth, first gradients, lines changed."""
from __future__ import annotations

from typing import Any

from benchmarks.peers.sections import Chapter, Section
from benchmarks.peers.tools import missing


def measure(quick: bool) -> dict[str, Any]:
    """What is said of tools that are not installed."""
    return {"missing": missing()}


def render(found: dict[str, Any]) -> Chapter:
    """The chapter's text."""
    return Chapter(body=[found["missing"]])


SECTION = Section("peers", "Against other tools", measure, render, minutes=24)
