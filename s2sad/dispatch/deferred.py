"""The one place where the compiler is imported while derivatives run: when something must be derived."""
from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from s2sad.dispatch import compiler as the_compiler


def compiler() -> the_compiler:  # pyright: ignore[reportGeneralTypeIssues]
    """The module `s2sad.dispatch.compiler`, with all that it needs."""
    found: Any = importlib.import_module("s2sad.dispatch.compiler")
    return found
