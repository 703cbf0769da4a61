"""Machine code and texts on disk, and which of them go when there are too many."""
from __future__ import annotations

import os
import subprocess
import sys
import time
import traceback
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import s2sad
from s2sad.run import compiled as engine, eviction, store
from s2sad.run.module_loader import load
from tests.run.test_store import HALF, compiled_half, files

pytestmark = pytest.mark.usefixtures("location")


def test_machine_code_is_kept_and_damage_is_compiled_again(location):
    pytest.importorskip("numba")
    assert not compiled_half().stats.cache_hits
    path, = files(location, "code")
    assert sum(compiled_half().stats.cache_hits.values()) == 1
    whole = path.read_bytes()
    for offset in (0, len(whole) // 3, len(whole) - 1):
        damaged = bytearray(whole)
        damaged[offset] ^= 4
        path.write_bytes(damaged)
        again = compiled_half()
        assert not again.stats.cache_hits and again(3.0) == 1.5
        assert sum(compiled_half().stats.cache_hits.values()) == 1      # it was written anew
    store.put(*_entry(path, b"no machine code"), "code")
    assert compiled_half()(3.0) == 1.5


def _entry(path, data):
    """The key of an entry in a folder of one."""
    from s2sad.run.machine_code import MachineCode
    found = []
    keep, MachineCode._key = MachineCode._key, lambda *args: found.append(keep(*args)) or found[-1]
    try:
        compiled_half()
    finally:
        MachineCode._key = keep
    return found[0], data


def test_a_numba_without_what_it_takes_keeps_nothing(location, monkeypatch):
    pytest.importorskip("numba")
    monkeypatch.delattr("numba.core.compiler.CompileResult._rebuild")
    assert compiled_half()(3.0) == 1.5 and not files(location, "code")


def test_one_entry_from_many_threads(location):
    def turn(k):
        return store.put("key", bytes([k]) * 5000) and store.get("key")
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(turn, range(64)))
    assert all(len(f) == 5000 and len(set(f)) == 1 for f in found) and not files(location, "part")


def test_functions_as_arguments_are_not_kept(location):
    numba = pytest.importorskip("numba")
    text = "def applied(function, x):\n    return function(x)\n"
    module = engine.compiled(text, "applied")
    assert module.applied(numba.njit(lambda x: 2.0 * x), 3.0) == 6.0
    assert not files(location, "code")


def test_nothing_can_be_written_anywhere(tmp_path, monkeypatch):
    """No cache, no temporary folder: derivatives are right, and tracebacks show their lines."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path / "file" / "in"))
    monkeypatch.setattr(store.tempfile, "tempdir", str(tmp_path / "nowhere"))
    assert store.folder() is None and store.get("key") is None and not store.put("key", b"content")
    module = load("def fails(x):\n    return x / 0  # here\n", "fails")
    with pytest.raises(ZeroDivisionError) as caught:
        module.fails(1)
    assert "return x / 0  # here" in "".join(traceback.format_exception(caught.value))

    def square(x):
        return x * x
    for name in ("numpy", "numba"):
        assert s2sad.gradient(s2sad.differentiate(square, engine=name))(3.0) == 6.0
    assert np.isclose(engine.compiled(HALF, "half").half(3.0), 1.5)


def test_the_platforms_folder(monkeypatch):
    monkeypatch.delenv("S2SAD_CACHE_DIR")
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", "/elsewhere")
    assert str(store.location()) == "/elsewhere/s2sad"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert str(store.location()).endswith(".cache/s2sad")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="POSIX processes")
def test_a_forked_process_leaves_its_parents_folder(monkeypatch, tmp_path):
    program = ("import os\nfrom s2sad.run import store\nplace = store.folder()\nchild = os.fork()\n"
               "if child:\n    os.waitpid(child, 0)\n    print(place.is_dir(), flush=True)\n")
    (tmp_path / "file").write_text("")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True,
                          env={**os.environ, "S2SAD_CACHE_DIR": str(tmp_path / "file"), "TMPDIR": str(tmp_path)})
    assert done.stdout == "True\n"
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


def test_the_least_recently_used_go_first(location, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_SIZE", "1K")
    for k in range(20):
        assert store.put(str(k), bytes(150))
        for path in files(location, "data"):
            os.utime(path, (time.time() - 3600 * (20 - k),) * 2)
        if k >= 3:
            os.utime(store.folder() / store._name("0", "data"))
    left = [k for k in range(20) if store.get(str(k)) is not None]
    assert left[0] == 0 and left[-1] == 19 and len(left) < 8
    assert sum(e.size for e in eviction.entries(location)) <= 1024 + 1024 // 10 + 250


def test_what_is_old_goes_and_what_is_used_stays(location, monkeypatch):
    store.put("old", b"content")
    store.put("used", b"content")
    for path in files(location, "data"):
        os.utime(path, (time.time() - 80 * 86_400,) * 2)
    assert store.get("used") == b"content"
    monkeypatch.setenv("S2SAD_CACHE_DAYS", "30")
    eviction.prune(location)
    assert store.get("old") is None and store.get("used") == b"content"


def test_files_of_older_versions_and_of_broken_writes_go_and_others_stay(location):
    store.put("key", b"content")
    digest = "0123456789abcdef0123"
    ours = [f"v1-plain/step_{digest}.py", f"v1-numba-0123456789ab-bounds/step_{digest}.py",
            f"v1-numba-0123456789ab-bounds/__pycache__/step_{digest}.step-3.py311.1.nbc", "v2/tmpx.part"]
    others = ["notes.txt", f"step_{digest}.py", "v2/notes.txt", "v1-plain/notes.txt", f"version/step_{digest}.py"]
    for name in (*ours, *others):
        (location / name).parent.mkdir(parents=True, exist_ok=True)
        (location / name).write_bytes(bytes(10))
        os.utime(location / name, (1, 1))
    (location / "v3").symlink_to(location / "version")
    eviction.prune(location)
    assert not any((location / name).exists() for name in ours)
    assert not (location / "v1-numba-0123456789ab-bounds").exists()
    assert all((location / name).exists() for name in others) and store.get("key") == b"content"
    assert eviction.clear(location)[0] == 1
    assert all((location / name).exists() for name in others) and store.get("key") is None


def test_limits_are_read_with_their_units(monkeypatch, caplog):
    assert eviction.limits() == (1 << 30, 90.0)
    for text, size in (("500M", 500 << 20), ("1.5 GB", 3 << 29), ("2GiB", 2 << 30), ("4096", 4096), ("0", 0)):
        monkeypatch.setenv("S2SAD_CACHE_SIZE", text)
        assert eviction.limits()[0] == size
    monkeypatch.setenv("S2SAD_CACHE_SIZE", "much")
    assert eviction.limits() == eviction.limits() == (1 << 30, 90.0)
    assert caplog.messages == ["s2sad: S2SAD_CACHE_SIZE=much is not understood"]
