"""What is kept on disk: damage, full disks, other users, what takes a file's place, and what is thrown away."""
from __future__ import annotations

import errno
import os
import pickle
import socket
import stat
import subprocess
import sys
from types import SimpleNamespace

import pytest

from s2sad.run import compiled as engine, store
from s2sad.run.module_loader import load
from s2sad.run.permissions import exposure, is_private

HALF = "def half(x):\n    return 0.5 * x\n"


pytestmark = pytest.mark.usefixtures("location")


def files(location, kind):
    return sorted((location / "v2").glob(f"*.{kind}"))


def compiled_half():
    sys.modules.pop(next((n for n in sys.modules if n.startswith("s2sad_half")), ""), None)
    module = engine.compiled(HALF, "half")
    engine.prepare(module.half, (1.0,), "'half'")
    return module.half


# -- entries --------------------------------------------------------------------------------------------------------

def test_what_is_put_is_got(location):
    assert store.get("a") is None
    assert store.put("a", b"one") and store.put("b", b"") and store.put("a", b"other", "code")
    assert (store.get("a"), store.get("b"), store.get("a", "code")) == (b"one", b"", b"other")
    assert store.put("a", b"two") and store.get("a") == b"two"
    assert {stat.S_IMODE(p.stat().st_mode) for p in files(location, "data")} == {0o600}


def test_any_flipped_bit_and_any_length_is_a_miss(location):
    store.put("key", b"the content of this entry")
    path, = files(location, "data")
    whole = path.read_bytes()
    for offset in range(len(whole)):
        damaged = bytearray(whole)
        damaged[offset] ^= 1 << offset % 8
        path.write_bytes(damaged)
        assert store.get("key") is None
        path.write_bytes(whole[:offset])
        assert store.get("key") is None
    path.write_bytes(whole + b"\0")
    assert store.get("key") is None
    path.write_bytes(whole)
    assert store.get("key") == b"the content of this entry"


def test_an_entry_under_another_name_is_a_miss(location):
    store.put("key", b"content")
    store.put("other", b"secret")
    one, other = files(location, "data")
    os.replace(one, other)
    assert store.get("key") is store.get("other") is None


def _pipe(path):
    os.mkfifo(path)


def _socket(path):
    place = os.getcwd()
    os.chdir(path.parent)       # the path of a socket must be short
    try:
        socket.socket(socket.AF_UNIX).bind(path.name)
    finally:
        os.chdir(place)


def _link(path):
    (path.parent / "copy").write_bytes(path.read_bytes() if path.exists() else b"")
    path.unlink(missing_ok=True)
    path.symlink_to(path.parent / "copy")


def _device(path):
    path.symlink_to("/dev/zero")


def _circle(path):
    path.symlink_to(path)


def _large(path):
    with open(path, "wb") as file:
        file.truncate(1 << 40)


def _exposed(path):
    path.write_bytes(b"content")
    path.chmod(0o622)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="POSIX files")
@pytest.mark.parametrize("made", [_pipe, _socket, _link, _device, _circle, _large, _exposed])
def test_what_is_no_entry_is_a_miss_and_is_replaced(location, made):
    store.put("key", b"content")
    path, = files(location, "data")
    path.unlink()
    made(path)
    assert store.get("key") is None
    assert store.put("key", b"again") and store.get("key") == b"again"
    assert path.is_file() and not path.is_symlink()


def test_a_folder_in_an_entrys_place_is_a_miss(location):
    store.put("key", b"content")
    path, = files(location, "data")
    path.unlink()
    (path / "in").mkdir(parents=True)
    assert store.get("key") is None and not store.put("key", b"again")
    assert not files(location, "part")


@pytest.mark.parametrize("name", ["mkstemp", "replace", "open", "lstat", "mkdir"])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EIO])
def test_no_error_of_the_disk_is_one_of_ours(location, monkeypatch, name, number):
    def fails(*_, **__):
        raise OSError(number, os.strerror(number))
    if name != "mkdir":
        store.put("key", b"content")
    with monkeypatch.context() as patch:
        patch.setattr(store.tempfile if name == "mkstemp" else os, name, fails)
        if name == "mkdir":
            patch.setattr(store.tempfile, "mkdtemp", fails)
        assert store.get("key") in (None, b"content")
        assert store.put("key", b"other") is (name == "lstat" and store.folder() is not None)
        assert store.keep("text.py", "x = 1\n") is None or name == "lstat"
        assert load(HALF, "half").half(3.0) == 1.5
    assert not files(location, "part")


LIMITED = """
import resource, signal, sys
import numpy as np
from s2sad.run import store
store.put("before", bytes(100))
resource.setrlimit(resource.RLIMIT_FSIZE, (512, 512))
print(store.put("key", bytes(5000)), store.get("key"), len(store.get("before")), store.put("small", b"content"))
print([p.suffix for p in store.folder().iterdir()])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_a_limit_on_the_size_of_files():
    done = subprocess.run([sys.executable, "-c", LIMITED], capture_output=True, text=True, check=True)
    assert done.stdout == "False None 100 True\n['.data', '.data']\n"


# -- other users ----------------------------------------------------------------------------------------------------

ME, OTHER = 1000, 1001
DIRECTORY, STICKY, LINK = stat.S_IFDIR | 0o755, stat.S_IFDIR | stat.S_ISVTX | 0o777, stat.S_IFLNK | 0o777


def of_tree(tree, links):
    """`lstat` and `readlink` of folders that are not there: their modes and owners by path."""
    def lstat(path):
        if path not in tree:
            raise FileNotFoundError(path)
        mode, owner = tree[path]
        return SimpleNamespace(st_mode=mode, st_uid=owner)
    return {"uid": ME, "lstat": lstat, "readlink": links.__getitem__}


HOME = {"/": (DIRECTORY, 0), "/home": (DIRECTORY, 0), "/home/me": (DIRECTORY, ME), "/home/me/cache": (DIRECTORY, ME)}


@pytest.mark.parametrize("change, links, reason", [
    ({}, {}, None),
    ({"/home/me": (stat.S_IFDIR | 0o775, ME)}, {}, "/home/me can be written by other users"),
    ({"/home": (stat.S_IFDIR | 0o777, 0)}, {}, "/home can be written by other users"),
    ({"/": (stat.S_IFDIR | 0o775, 0)}, {}, "/ can be written by other users"),
    ({"/home": (STICKY, 0)}, {}, None),
    ({"/home": (STICKY, OTHER)}, {}, "/home belongs to another user"),
    ({"/home/me": (DIRECTORY, OTHER)}, {}, "/home/me belongs to another user"),
    ({"/home/me/cache": (DIRECTORY, OTHER)}, {}, "/home/me/cache belongs to another user"),
    ({"/home/me/cache": (DIRECTORY, 0)}, {}, "/home/me/cache belongs to root"),
    ({"/home/me/cache": (STICKY, ME)}, {}, "/home/me/cache can be written by other users"),
    ({"/home/me/cache": (stat.S_IFDIR | 0o720, ME)}, {}, "/home/me/cache can be written by other users"),
    # a link, and what it leads through
    ({"/home/me/cache": (LINK, ME), "/scratch": (STICKY, 0), "/scratch/me": (DIRECTORY, ME)},
     {"/home/me/cache": "/scratch/me"}, None),
    ({"/home/me/cache": (LINK, ME), "/scratch": (stat.S_IFDIR | 0o777, 0), "/scratch/me": (DIRECTORY, ME)},
     {"/home/me/cache": "/scratch/me"}, "/scratch can be written by other users"),
    ({"/home/me/cache": (LINK, OTHER), "/scratch": (DIRECTORY, 0), "/scratch/me": (DIRECTORY, ME)},
     {"/home/me/cache": "/scratch/me"}, "/home/me/cache belongs to another user"),
    ({"/home/me/cache": (LINK, ME), "/home/me/a": (LINK, ME), "/home/me/b": (stat.S_IFDIR | 0o770, ME),
      "/home/me/b/c": (DIRECTORY, ME), "/home/me/d": (DIRECTORY, ME)},
     {"/home/me/cache": "a/../../d", "/home/me/a": "b/c"}, "/home/me/b can be written by other users"),
    ({"/home/me/cache": (LINK, ME), "/home/me/d": (DIRECTORY, ME)}, {"/home/me/cache": "./d/../d/."}, None),
    ({"/home/me/cache": (LINK, ME)}, {"/home/me/cache": "/"}, "/ belongs to root"),
])
def test_every_folder_from_the_root_is_looked_at(change, links, reason):
    assert exposure("/home/me/cache", **of_tree({**HOME, **change}, links)) == reason


def test_links_in_a_circle_and_files_are_no_folders():
    with pytest.raises(OSError):
        exposure("/home/me/cache", **of_tree({**HOME, "/home/me/cache": (LINK, ME)}, {"/home/me/cache": "cache"}))
    with pytest.raises(NotADirectoryError):
        exposure("/home/me/cache", **of_tree({**HOME, "/home/me": (stat.S_IFREG | 0o644, ME)}, {}))


@pytest.mark.parametrize("mode, owner, private", [
    (stat.S_IFREG | 0o600, ME, True), (stat.S_IFREG | 0o644, ME, True), (stat.S_IFREG | 0o664, ME, False),
    (stat.S_IFREG | 0o602, ME, False), (stat.S_IFREG | 0o600, OTHER, False), (stat.S_IFREG | 0o600, 0, False),
    (stat.S_IFDIR | 0o700, ME, False), (stat.S_IFIFO | 0o600, ME, False), (stat.S_IFLNK | 0o600, ME, False)])
def test_private_files(mode, owner, private):
    assert is_private(SimpleNamespace(st_mode=mode, st_uid=owner), ME) is private


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="POSIX permissions")
@pytest.mark.parametrize("part, mode", [("..", 0o777), ("..", 0o770), (".", 0o775), ("v2", 0o777), ("v2", 0o1777)])
def test_an_exposed_folder_is_left_alone_and_that_is_said_once(location, caplog, part, mode):
    store.put("key", b"content")
    exposed = os.path.normpath(location / part)
    os.chmod(exposed, mode)
    try:
        assert store.get("key") is None
        assert store.put("key", b"of this process") and store.get("key") == b"of this process"
        assert not load(HALF, "half").__file__.startswith(str(location))
    finally:
        os.chmod(exposed, 0o700)
    assert caplog.messages == [
        f"s2sad: the cache {location} is not used: {exposed} can be written by other users, and what it holds is "
        "executed. A temporary folder of this process is used; set S2SAD_CACHE_DIR to a folder of your own, or correct "
        "owner and mode."]
    assert store.get("key") == b"content"


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="POSIX permissions")
def test_a_sticky_folder_above_is_allowed_and_the_umask_is_not_asked(location, caplog, monkeypatch):
    location.parent.chmod(0o1777)
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(location / "deep" / "er"))
    before = os.umask(0)
    try:
        assert store.put("key", b"content") and store.get("key") == b"content"
    finally:
        os.umask(before)
        location.parent.chmod(0o700)
    assert not caplog.messages and store.folder() == location / "deep" / "er" / "v2"


class Planted:
    """Says so when it is unpickled."""

    def __reduce__(self):
        return os.mkdir, (os.environ["S2SAD_PLANTED"],)


@pytest.mark.parametrize("variable", ["NUMBA_CACHE_DIR", ""])
def test_numba_unpickles_nothing_that_others_planted(location, tmp_path, monkeypatch, variable):
    numba = pytest.importorskip("numba")
    monkeypatch.setenv("S2SAD_PLANTED", str(tmp_path / "executed"))
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "foreign") if variable else "")
    function = load(HALF, "half", engine._key(False)).half
    caching = pytest.importorskip("numba.core.caching")
    theirs = caching.FunctionCache(function)._cache_file
    with open(theirs._index_path, "wb") as file:
        pickle.dump(Planted(), file)
    theirs.load(None)       # Numba's own cache executes it
    os.rmdir(tmp_path / "executed")
    assert compiled_half()(3.0) == 1.5
    assert not (tmp_path / "executed").exists()


# -- machine code and texts -----------------------------------------------------------------------------------------


# -- size and age ---------------------------------------------------------------------------------------------------
