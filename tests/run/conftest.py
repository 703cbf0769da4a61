"""A place of their own for the files of tests of what is kept on disk."""
from __future__ import annotations

import sys

import pytest

from s2sad.run import eviction, store


@pytest.fixture
def location(tmp_path, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(store, "_ACCOUNT", eviction.Account())
    for name in [n for n in sys.modules if n.startswith("s2sad_")]:
        monkeypatch.delitem(sys.modules, name)
    store._say.cache_clear()
    store._temporary.cache_clear()
    return tmp_path / "cache"
