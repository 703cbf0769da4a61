"""cli: the command `s2sad`. `parser` has its options, `command` runs it."""
from __future__ import annotations

from s2sad.cli.command import main

__all__ = ["main"]
