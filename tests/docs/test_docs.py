"""Every document says what its blocks print, its links lead somewhere, and README's commands hold together."""
from __future__ import annotations

import os
import re
import shlex

import pytest

from tests.harness.documents import BLOCK, DOCUMENTS, ROOT, document

PRESENT = [*DOCUMENTS, "docs/semantics.md"]


@pytest.mark.skipif(os.name == "nt", reason="the documents show POSIX commands and paths")
@pytest.mark.parametrize("name", DOCUMENTS)
def test_current(name):
    pytest.importorskip("numba")
    with document(name) as given:
        written = given.path.read_text(encoding="utf-8")
        assert given.renewed() == written, "python -m tests.harness.documents writes it anew"


@pytest.mark.parametrize("name", PRESENT)
def test_links(name):
    text = BLOCK.sub("", (ROOT / name).read_text(encoding="utf-8"))
    for target in re.findall(r"\]\(([^)#]+)\)", text):
        assert target.startswith("https://") or (ROOT / name).parent.joinpath(target).exists(), target


def commands() -> list[str]:
    """README's commands, the lines of the blocks that are shown and not run."""
    found = [b["text"].splitlines() for b in BLOCK.finditer((ROOT / "README.md").read_text(encoding="utf-8"))
             if (b["say"] or "") == "shown" and b["language"] == "sh"]
    return [line for lines in found for line in lines]


def test_readme_commands():
    both = commands()
    assert len(both) == 2
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for line in both:
        parts = [shlex.split(part) for part in line.split("&&")]
        assert parts[0][:3] == ["python3", "-m", "venv"]
        assert parts[1][0] == f"{parts[0][3]}/bin/pip"
        extra = re.fullmatch(r"\.\[(\w+)\]", parts[1][2])
        assert extra and re.search(rf"^{extra[1]} = \[", text, re.M)
        assert parts[2][0] == f"{parts[0][3]}/bin/python"
    assert (ROOT / shlex.split(both[0].split("&&")[2])[1]).is_file()
    assert shlex.split(both[1].split("&&")[2])[1:] == ["-m", "pytest"]
    assert "README.md" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_no_long_lines_and_no_absolute_paths():
    for name in PRESENT:
        text = (ROOT / name).read_text(encoding="utf-8")
        assert not re.search(r"(?<![\w.])/(home|root|tmp|work|usr)/", text), name
        code = [b["text"] for b in BLOCK.finditer(text) if b["language"] == "python"]
        assert all(len(line) <= 120 for block in code for line in block.splitlines()), name


@pytest.mark.parametrize("name", PRESENT)
def test_modules_that_are_named_exist(name):
    text = BLOCK.sub("", (ROOT / name).read_text(encoding="utf-8"))
    for path in re.findall(r"`(?:s2sad/)?(\w+(?:/\w+)+(?:\.py|/)?)`", text):
        room = path.partition("/")[0]
        if (ROOT / "s2sad" / room).is_dir():
            found = ROOT / "s2sad" / path
            assert found.exists() or found.with_suffix(".py").exists(), path
