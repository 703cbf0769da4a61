// As much of a browser's document as the page of `explain` uses: elements with classes, attributes, listeners, and text.
"use strict";

class TextNode {
  constructor(text) { this.textContent = text; }
}

class Element {
  constructor(tag) {
    Object.assign(this, {tag, childNodes: [], parent: null, attributes: {}, dataset: {}, style: {}, listeners: {}, id: "",
                         value: "", scrollTop: 0, offsetTop: 0, clientHeight: 400, names: new Set()});
    const names = this.names;
    this.classList = {
      contains: (name) => names.has(name),
      toggle: (name, on) => { if (on) names.add(name); else names.delete(name); },
    };
  }
  get className() { return [...this.names].join(" "); }
  set className(text) { this.names.clear(); text.split(" ").filter(Boolean).forEach((name) => this.names.add(name)); }
  get textContent() { return this.childNodes.map((child) => child.textContent).join(""); }
  set textContent(text) { this.childNodes = [new TextNode(String(text))]; }
  append(...children) {
    for (const child of children) {
      const node = child instanceof Element ? child : new TextNode(String(child));
      node.parent = this;
      this.childNodes.push(node);
    }
  }
  replaceChildren(...children) { this.childNodes = []; this.append(...children); }
  setAttribute(name, value) { this.attributes[name] = String(value); }
  getAttribute(name) { return name in this.attributes ? this.attributes[name] : null; }
  removeAttribute(name) { delete this.attributes[name]; }
  addEventListener(kind, listener) { (this.listeners[kind] = this.listeners[kind] || []).push(listener); }
  dispatchEvent(event) {
    event.target = event.target || this;
    (this.listeners[event.type] || []).forEach((listener) => listener(event));
    if (event.bubbles && this.parent) this.parent.dispatchEvent(event);
  }
  click() { this.dispatchEvent(new KeyboardEvent("click", {})); }
  focus() { document.activeElement = this; this.dispatchEvent(new KeyboardEvent("focus", {})); }
  blur() { document.activeElement = document.body; }
}

globalThis.KeyboardEvent = class {
  constructor(type, given) { Object.assign(this, {type, target: null, preventDefault() { this.defaultPrevented = true; }}, given); }
};
globalThis.MouseEvent = globalThis.KeyboardEvent;
globalThis.window = {matchMedia: () => ({matches: false})};
globalThis.document = new Element("document");
document.body = document.activeElement = new Element("body");
document.documentElement = new Element("html");
document.createElement = (tag) => new Element(tag);
const known = new Map();
document.getElementById = (id) => {
  if (!known.has(id)) {
    const made = new Element("div");
    made.id = id;
    made.parent = document;
    made.textContent = IDS[id];         // a KeyError of sorts where the page has no such element
    if (IDS[id] === undefined) throw new Error("no element " + id);
    known.set(id, made);
  }
  return known.get(id);
};
