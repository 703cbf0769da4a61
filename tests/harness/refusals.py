"""What a call refuses, by the whole text of its error."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from s2sad import S2sadError


def refused(text: str, call: Callable[..., Any], *arguments: Any, **keywords: Any) -> None:
    """The call raises an error with exactly this text."""
    with pytest.raises(S2sadError) as caught:
        call(*arguments, **keywords)
    assert str(caught.value) == text
