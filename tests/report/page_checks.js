// What a reader of the page does, and what lights up; runs in a browser and in tests/report/page_dom.js.
"use strict";

function checked() {
  const texts = (side, name) => lines[side].filter((each) => each.classList.contains(name)).map((each) => each.line.text.trim());
  const lit = (name) => ({left: texts("left", name), right: texts("right", name)});
  const press = (key, target) => target.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true}));
  const line = (side, words) => lines[side].find((each) => each.line.text.includes(words));
  const chosen = () => lines.left.concat(lines.right).filter((each) => each.getAttribute("aria-selected") === "true").length;
  const found = {functions: data.functions.map((each) => each.name), titles: [by("left-title").textContent, by("right-title").textContent]};
  const words = "u[i] = u[i] * u[i]";

  line("left", words).click();
  found.clicked = lit("on");
  found.selected = chosen();
  found.active = by("left").getAttribute("aria-activedescendant") === line("left", words).id;
  found.detail = by("detail").textContent;
  line("left", words).click();
  found.clickedAgain = lit("on");
  line("right", "u_bar[i] = 2.0").click();
  found.clickedRight = lit("on");
  press("Escape", document);
  found.escaped = lit("on");

  line("left", words).dispatchEvent(new MouseEvent("mouseenter"));
  found.over = lit("over");
  line("left", words).dispatchEvent(new MouseEvent("mouseleave"));
  found.left = lit("over");

  look("left");
  press("j", document);
  found.first = texts("left", "on");
  press("ArrowDown", by("left"));
  press("j", document);
  found.third = texts("left", "on");
  press("k", document);
  found.second = texts("left", "on");
  press("l", document);
  found.side = state.side;
  press("Escape", document);

  by("search").value = "U_STACK";
  by("search").dispatchEvent(new KeyboardEvent("input", {}));
  found.matches = lit("match");
  found.count = by("count").textContent;
  press("Enter", by("search"));
  found.nextCount = by("count").textContent;
  press("j", by("search"));                                  // typed, not a command
  by("search").value = "";
  by("search").dispatchEvent(new KeyboardEvent("input", {}));

  by("bar").childNodes[0].click();
  found.bar = [by("bar").childNodes[0].textContent, lit("on").left, by("bar").childNodes[0].classList.contains("on")];
  press("]", document);
  found.turned = [by("right-title").textContent, [...by("tabs").childNodes].map((tab) => tab.getAttribute("aria-selected"))];
  by("bar").childNodes[0].click();                            // leads back to the function that records it
  found.back = [state.function, lit("on").left];
  press("t", document);
  const theme = document.documentElement.dataset.theme;
  press("t", document);
  found.themes = [theme, document.documentElement.dataset.theme].sort();
  found.tables = data.functions[0].tables.map((table) => table.title);
  found.total = by("total").textContent;
  const end = "<" + "/script>";
  found.hostile = line("left", end) ? line("left", end).textContent.trim() : "";
  found.ids = new Set(lines.left.concat(lines.right).map((each) => each.id)).size === lines.left.length + lines.right.length;
  return found;
}
