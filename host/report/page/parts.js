// Building blocks of pages: access to members of a report, HTML elements, tables. Text from a report is never parsed as
// HTML: it is written only to text nodes and inert attributes.
"use strict";

const $ = (id) => document.getElementById(id);

// --- Members of a report, by paths such as "load.mean". All functions except find() and has() throw an Error if the
// member is missing or has a wrong type.

const TYPES = {
  number: (value) => typeof value === "number",
  "whole number": (value) => Number.isSafeInteger(value) && value > 0,
  text: (value) => typeof value === "string",
  list: Array.isArray,
  object: (value) => value !== null && typeof value === "object" && !Array.isArray(value),
};

function find(object, path) {
  return path.split(".").reduce(
    (value, name) => TYPES.object(value) && Object.hasOwn(value, name) ? value[name] ?? undefined : undefined, object);
}

const has = (object, path) => find(object, path) !== undefined;

function member(object, path, type) {
  const value = find(object, path);
  if (value === undefined) throw new Error(`${path} is missing`);
  if (!TYPES[type](value)) throw new Error(`${path} is not a ${type}`);
  return value;
}

const num = (object, path) => member(object, path, "number");
const whole = (object, path) => member(object, path, "whole number");  // integer >= 1
const str = (object, path) => member(object, path, "text");
const list = (object, path, type) => member(object, path, "list").map((value, i) => {
  if (!TYPES[type](value)) throw new Error(`${path}[${i}] is not a ${type}`);
  return value;
});

// --- Elements

// Returns an element. `children`: elements, texts, arrays of elements and texts; null and false are skipped.
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children.flat(Infinity).filter((child) => child !== null && child !== false));
  return element;
}

// Returns the text as nodes: text in backticks as code, +- as ±.
const prose = (text) => text.replaceAll("+-", "±").split("`").map(
  (part, i, parts) => i % 2 && i < parts.length - 1 ? make("code", {}, part) :
    i % 2                                           ? "`" + part :
                                                      part);

const paragraph = (...children) => make("p", {}, ...children);
const note = (...children) => make("p", {class: "note"}, ...children);
const message = (text) => make("p", {class: "message"}, prose(text));
const code = (text) => make("code", {}, text);
const part = (title, ...children) => children.flat().length ? [make("h3", {}, prose(title)), ...children] : [];

// definitions() and tiles() return a list of names and values. rows: [name, text or element]; rows whose text is "" are
// skipped.
const definitions = (rows, attributes = {}) => make(
  "dl", attributes,
  rows.filter(([, value]) => value !== "").map(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
const tiles = (rows) => make(
  "dl", {class: "chief"},
  rows.filter(([, value]) => value !== "")
    .map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value))));

// Returns a text coloured as a verdict. kind: "yes", "no" or "open".
const verdict = (kind, text) => make("span", {class: `verdict ${kind}`}, text);

// --- Tables. A cell is a text, a number as text, or an element. Columns of numbers are right-aligned and sorted by
// value. Tables with more than OPEN_ROWS rows are collapsed.

const OPEN_ROWS = 24, MAX_ROWS = 400;
const NUMBER = /^(-|[-+]?(inf|[\d.,\u202f]+(e[-+]?\d+)?)( (%|ms|s|min|h))?)?$/;

function wideTable(label, header, rows) {
  const classOf = (texts) => texts.every((text) => NUMBER.test(text)) && texts.some((text) => /\d/.test(text)) ? "n" :
    texts.some((text) => text.length > 60)                                                                     ? "w" :
                                                                                                                 "";
  const classes = header.map((_, column) => classOf(rows.map((row) => row[column].textContent ?? row[column])));
  const heads = header.map(
    (text, column) => make("th", {scope: "col", class: classes[column]}, make("button", {type: "button"}, text)));
  const body = make(
    "tbody", {},
    rows.map(
      (row) => make(
        "tr", {},
        row.map(
          (cell, column) => make("td", {class: classes[column]}, typeof cell === "string" ? prose(cell) : cell)))));
  heads.forEach((head, column) => head.firstChild.addEventListener("click", () => sortBy(head, column, body)));
  return make(
    "div", {class: "wide", tabindex: 0, role: "region", "aria-label": label},
    make("table", {"aria-label": label}, make("thead", {}, make("tr", {}, heads)), body));
}

// `rest`: text of the note below a table with more than MAX_ROWS rows.
function table(label, header, rows, rest = "All rows are in the report.") {
  if (rows.length === 0) return [];
  const tableElement = wideTable(label, header, rows.slice(0, MAX_ROWS));
  if (rows.length <= OPEN_ROWS) return [tableElement];
  const cutNote = rows.length > MAX_ROWS && note(...prose(`The first ${MAX_ROWS} of ${rows.length} rows. ${rest}`));
  return [make("details", {}, make("summary", {}, `${rows.length} rows`), tableElement, cutNote)];
}

// Sorts the rows by a column; in a column of numbers, cells without a number come last. If the rows are already sorted
// in ascending order, sorts them in descending order.
function sortBy(head, column, body) {
  const sign = head.getAttribute("aria-sort") === "ascending" ? -1 : 1, numeric = head.className === "n";
  const key = (row) => {
    const text = row.cells[column].textContent;
    if (!numeric) return text;
    const number = Number.parseFloat(text.replaceAll("\u202f", "").replace(/^([-+]?)inf/, "$1Infinity"));
    return Number.isNaN(number) ? Infinity * sign : number;
  };
  const keyed = [...body.rows].map((row) => [key(row), row]);
  keyed.sort(([a], [b]) => a === b ? 0 : sign * (numeric ? a - b : a.localeCompare(b)));
  body.append(...keyed.map(([, row]) => row));
  for (const cell of head.parentElement.cells) cell.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
}

// --- The page itself

const caption = (element, ...texts) => make(
  "figure", {}, element, make("figcaption", {}, texts.map((text) => typeof text === "string" ? prose(text) : text)));

// Adds a section, and a link to it in the contents. If build() throws, the section shows the error.
function section(id, title, build) {
  let children;
  try {
    children = build();
  } catch (problem) {
    children = [message(`This part cannot be shown: ${problem.message}.`)];
  }
  if (children === null) return;
  $("main").append(make("section", {id}, make("h2", {}, title), ...children));
  const nav = document.querySelector("nav");
  if (!nav.firstChild) nav.append(make("ul"));
  nav.firstChild.append(make("li", {}, make("a", {href: `#${id}`}, title)));
}

// Builds the head of the page. If build() throws, shows the error instead.
function heading(build) {
  try {
    build();
  } catch (problem) {
    $("head").append(message(`The head of this report cannot be shown: ${problem.message}.`));
  }
}

function head(kicker, title, ...lead) {
  document.title = `${kicker}: ${title}`;
  $("head").append(...make("div", {}, make("p", {class: "kicker"}, kicker), make("h1", {}, title), lead).childNodes);
}
