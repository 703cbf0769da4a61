"""The documents run: what their blocks print is what they say. `python -m tests.harness.documents` writes it anew.

In a document a fenced block may stand under a comment that says what it is:

    <!-- file heat.py -->      written to that file
    <!-- run heat.py -->       written to that file and run (Python)
    <!-- run -->               run: Python, or shell commands; blocks of Python without a comment are run, too
    <!-- prints -->            what the block before it printed, compared with what it prints
    <!-- shown -->             neither

All Python of a document shares one namespace. An S2sadError that a block raises is printed, as its message.
"""
from __future__ import annotations

import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import s2sad

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = ("README.md", *(f"docs/{name}.md" for name in (
    "use", "processes", "own-derivatives", "functions", "design", "how-it-works", "writing-a-pass", "writing-a-rule",
    "limits", "changelog")))
BLOCK = re.compile(r"(?:^<!-- (?P<say>[^\n]*) -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S)


class Document:
    """A document with a folder of its own in which its blocks are run."""

    def __init__(self, path: Path, folder: Path):
        self.path, self.folder = path, folder
        self.space: dict[str, Any] = {"__name__": path.stem.replace("-", "_")}
        self.runs = 0
        (folder / "examples").symlink_to(ROOT / "examples")

    def renewed(self) -> str:
        """The document's text, with what its blocks print now."""
        text, out, end, printed = self.path.read_text(encoding="utf-8"), [], 0, ""
        for block in BLOCK.finditer(text):
            content, say = block["text"], (block["say"] or "").split()
            if say[:1] == ["prints"]:
                out += [text[end:block.start("text")], printed]
                end = block.end("text")
            elif say[:1] == ["file"]:
                (self.folder / say[1]).write_text(content, encoding="utf-8")
            elif say[:1] == ["run"] or not say and block["language"] == "python":
                printed = self.run(content, block["language"], say[1:])
        return "".join([*out, text[end:]])

    def run(self, content: str, language: str, name: list[str]) -> str:
        self.runs += 1
        if language == "python":
            printed = self.python(content, name[0] if name else f"{self.path.stem}_{self.runs}.py")
        else:
            printed = "".join(map(self.shell, content.splitlines()))
        printed = printed.replace(f"{self.folder}{os.sep}", "")
        return printed if printed.endswith("\n") or not printed else printed + "\n"

    def python(self, content: str, name: str) -> str:
        path, out = self.folder / name, io.StringIO()
        path.write_text(content, encoding="utf-8")
        with contextlib.redirect_stdout(out):
            try:
                exec(compile(content, str(path), "exec"), self.space)
            except s2sad.S2sadError as error:
                print(error)
        return out.getvalue()

    def shell(self, line: str) -> str:
        line = line.removeprefix("$ ")
        command, _, rest = line.partition(" ")
        ours = {"s2sad": f'"{sys.executable}" -m s2sad', "python": f'"{sys.executable}"'}
        words = f"{ours.get(command, command)} {rest}"
        done = subprocess.run(words, shell=True, cwd=self.folder, env=environment(), text=True, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8")
        return done.stdout


def environment() -> dict[str, str]:
    """The environment for a process of its own: it finds the s2sad that is tested here, and prints 100 columns wide."""
    home = str(Path(s2sad.__file__).resolve().parent.parent)
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, [home, os.environ.get("PYTHONPATH")])),
            "COLUMNS": "100", "PYTHONIOENCODING": "utf-8", "S2SAD_VERBOSE": "0"}


@contextlib.contextmanager
def document(name: str) -> Iterator[Document]:
    """A document to run; what its blocks import of their own files is forgotten afterwards."""
    with tempfile.TemporaryDirectory(prefix="document-") as temporary:
        folder, before = str(Path(temporary).resolve()), set(sys.modules)
        sys.path.insert(0, folder)
        try:
            yield Document(ROOT / name, Path(folder))
        finally:
            sys.path.remove(folder)
            for module in set(sys.modules) - before:
                if (getattr(sys.modules[module], "__file__", None) or "").startswith(folder):
                    del sys.modules[module]


def main() -> None:
    for name in sys.argv[1:] or DOCUMENTS:
        with document(name) as given:
            before, after = given.path.read_text(encoding="utf-8"), given.renewed()
        given.path.write_text(after, encoding="utf-8")
        print(name, "is current" if before == after else "is written anew")


if __name__ == "__main__":
    main()
