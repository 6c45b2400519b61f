// Comfort, where scripts run: columns sort. Numbers by size, the first one of a cell; words by the alphabet; empty cells
// last.
"use strict";

function sortKey(row, column, numeric) {
  const text = row.cells[column].textContent.trim();
  if (!numeric) return text;
  const number = text.startsWith("inf") ? Infinity : text.startsWith("-inf") ? -Infinity : parseFloat(text.replaceAll("\u202f", ""));
  return Number.isNaN(number) ? null : number;
}

function sortBy(table, header) {
  const column = header.cellIndex, numeric = header.classList.contains("n");
  const sign = header.getAttribute("aria-sort") === "ascending" ? -1 : 1;
  const order = (a, b) => {
    if (a === b) return 0;
    if (a === null || b === null) return a === null ? 1 : -1;
    return sign * (numeric ? a - b || 0 : a.localeCompare(b));
  };
  const body = table.tBodies[0];
  const keyed = [...body.rows].map((row) => [sortKey(row, column, numeric), row]);
  body.append(...keyed.sort((a, b) => order(a[0], b[0])).map((pair) => pair[1]));
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
}

for (const table of document.querySelectorAll("table"))
  for (const header of table.tHead.rows[0].cells) {
    if (header.textContent === "") continue;
    const button = document.createElement("button");
    button.append(...header.childNodes);
    header.append(button);
    button.addEventListener("click", () => sortBy(table, header));
  }
