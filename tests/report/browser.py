"""The page of `explain` in a real browser: `python -m tests.report.browser` checks there what a click lights up, and
with `--picture docs/explain.png` takes the picture that the documents show. Needs Chromium, by `$CHROMIUM` or on the
path.
"""
from __future__ import annotations

import argparse
import html
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.report.test_page import EXPECTED, checks, squares_page

ROOT = Path(__file__).resolve().parent.parent.parent
_FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync",
          "--disable-component-update", "--hide-scrollbars", "--virtual-time-budget=2000")
_REPORTS = """
<pre id="found"></pre><script>%s
try {
  document.getElementById("found").textContent = JSON.stringify(checked());
} catch (error) {
  document.getElementById("found").textContent = JSON.stringify({error: String(error), at: error.stack});
}
</script></body>"""
_CHOSEN = """<script>
choose(lines.left.find((each) => each.line.text.includes("u[i] = here")).line.link, "left", false);
panes.right.style.scrollBehavior = "auto";
panes.right.scrollTop = lines.right.find((each) => each.line.text.includes("u_stack[_, i] = ")).offsetTop - 220;
</script></body>"""


def browse(page: str, *options: str) -> str:
    """What the browser prints for a page."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        sys.exit("no Chromium was found: install it, or name it in CHROMIUM")
    with tempfile.TemporaryDirectory(prefix="page-") as folder:
        path = Path(folder) / "page.html"
        path.write_text(page, encoding="utf-8")
        done = subprocess.run([program, *_FLAGS, f"--user-data-dir={folder}/profile", *options, path.as_uri()],
                              check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, encoding="utf-8")
    return done.stdout


def found_in_browser() -> dict[str, object]:
    page = squares_page().replace("</body>", _REPORTS % checks())
    printed = re.search(r'<pre id="found">(.*?)</pre>', browse(page, "--dump-dom"), re.S)
    assert printed is not None
    return json.loads(html.unescape(printed[1]))


def picture(path: str) -> None:
    """The page of a limited advection scheme, a line chosen."""
    command = [sys.executable, "-m", "s2sad", "explain", "benchmarks/kernels/loops.py:advect", "--wrt", "u,c", "--of",
               "u", "--arguments", "u=np.ones(10_000), c=0.5, steps=100", "--html"]
    page = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout
    browse(page.replace("</body>", _CHOSEN), "--window-size=1280,760", f"--screenshot={Path(path).resolve()}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--picture", metavar="PNG")
    options = parser.parse_args()
    found = found_in_browser()
    wrong = [what for what, expected in EXPECTED.items() if found.get(what) != expected]
    if "error" in found:
        print(found["at"])
    for what in wrong:
        print(f"{what}: {found.get(what)!r}, expected {EXPECTED[what]!r}")
    print(f"{len(EXPECTED) - len(wrong)} of {len(EXPECTED)} as expected in the browser")
    if options.picture:
        picture(options.picture)
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
