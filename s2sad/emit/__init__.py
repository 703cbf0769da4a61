"""The tree becomes text: `text` prints a piece of it, `module_text` a whole file."""
from __future__ import annotations

from s2sad.emit.layout import Layout, text
from s2sad.emit.module import module_text

__all__ = ["Layout", "module_text", "text"]
