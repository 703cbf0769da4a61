"""`s2sad cache`: what is kept, where, and its removal."""
from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from s2sad.run import store


def test_the_cache_is_shown_and_cleared(ran, tmp_path, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("S2SAD_CACHE_SIZE", "200M")
    limits = "limits: 200.0 MB (S2SAD_CACHE_SIZE), 90 days without use (S2SAD_CACHE_DAYS)\n"
    assert ran("cache") == (0, f"{tmp_path / 'cache'}\n  nothing\n{limits}", "")
    store.put("a", bytes(2000), "code")
    store.put("b", bytes(200), "code")
    store.keep("f_0123456789abcdef0123.py", "x = 1\n")
    for k, path in enumerate(sorted((tmp_path / "cache" / "v2").iterdir(), key=lambda p: p.suffix)):
        os.utime(path, (time.time() + k - 86_400.0 * 7,) * 2)
    assert ran("cache")[1] == (
        f"{tmp_path / 'cache'}\n"
        "  machine code        2 entries     2.2 kB\n"
        "  generated text        1 entry    6 bytes\n"
        f"  in all              3 entries     2.2 kB, the oldest used 7 days ago\n{limits}")
    assert ran("cache", "--where") == (0, f"{tmp_path / 'cache'}\n", "")
    assert ran("cache", "--clear") == (0, f"3 entries removed (2.2 kB) from {tmp_path / 'cache'}\n", "")
    assert "  nothing\n" in ran("cache")[1]


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="POSIX permissions")
def test_a_cache_that_others_can_write_is_shown_as_such(ran, tmp_path, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path / "cache"))
    store.put("a", bytes(2000), "code")
    (tmp_path / "cache").chmod(0o777)
    assert f"  NOT USED: {tmp_path / 'cache'} can be written by other users, and what it holds is executed\n" in ran(
        "cache")[1]


def test_a_user_without_a_home_has_no_cache(ran, monkeypatch):
    def homeless(*_):
        raise RuntimeError("Could not determine home directory.")
    monkeypatch.delenv("S2SAD_CACHE_DIR", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", homeless)
    monkeypatch.setattr(sys, "platform", "linux")
    for option in ((), ("--where",), ("--clear",)):
        assert ran("cache", *option) == (1, "", "error[S407]: there is no cache: Could not determine home directory.\n"
                                         "  help: set S2SAD_CACHE_DIR to a folder of your own\n")
    assert store.put("key", b"content") and store.get("key") == b"content"      # in a folder of the process
