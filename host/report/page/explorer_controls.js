// Connects the explorer's controls and pointer events with its state.
"use strict";

// [control]: the member of the state that it edits, as [name] or, for an element of an array, [name, index].
const CONTROLS = {
  mapping: ["mapping"],
  offset: ["offset"],
  "offset-slider": ["offset"],
  pes: ["pes"],
  "pes-slider": ["pes"],
  "grid-a": ["grid", 0],
  "grid-b": ["grid", 1],
  "tile-w": ["tile", 0],
  "tile-h": ["tile", 1],
  seed: ["seed"],
  pe: ["pe"]
};

function fillControls(page) {
  const {width, height} = page.size, paperOffset = roundedSquareRoot(width) % width;
  const maxima = {
    "offset-slider": width - 1,
    offset: width - 1,
    "pes-slider": width,
    pes: width * height,
    "grid-a": height,
    "grid-b": width
  };
  for (const [id, maximum] of Object.entries(maxima)) $(id).max = maximum;
  for (const [id, side] of [["tile-w", width], ["tile-h", height]])
    $(id).append(...divisorsOf(side).map((d) => new Option(d, d)));
  Object.assign($("picture"), page.size);
  const examples = [
    [`cyclic:0&pes=${width}&view=loads`, "Columns, by load", ": red columns where rays bounce."],
    [
      `cyclic:${paperOffset}&pes=${width}&view=loads`, "The paper’s choice, p = √P, by load",
      ": the same cycles, spread over all PEs."
    ],
    [`cyclic:${paperOffset}&pes=${width}&pe=0`, "One PE’s pixels", ": the lattice over the whole image."],
    [`blocks&pes=${Math.min(width, height)}&view=loads`, "Contiguous blocks of lines", ": the simplest mapping."],
    [
      `random:1&pes=${width}`, "Pixels at random",
      ": even loads, but the neighbours of a PE's pixels are on all PEs; raya refuses to filter with this mapping."
    ]
  ];
  $("tries").append(
    ...examples.map(([link, name, text]) => make("li", {}, make("a", {href: `#mapping=${link}`}, name), text)));
}

function listen(page) {
  for (const [id, [name, index]] of Object.entries(CONTROLS))
    $(id).addEventListener("input", ({target: {type, value}}) => {
      if (id === "pe" && value === "") return page.pick(null);
      if (type === "number" && (value === "" || !$(id).checkValidity())) return;
      const newValue = id === "mapping" ? value : Number(value);
      page.state[name] = index === undefined ? newValue : page.state[name].with(index, newValue);
      page.show();
    });
  $("no-pe").addEventListener("click", () => page.pick(null));
  for (const radio of document.querySelectorAll("[name=view], [name=fold]"))
    radio.addEventListener("change", () => page.choose(radio.name, radio.value));
  for (const button of document.querySelectorAll("[data-offset], #root, #best"))
    button.addEventListener("click", () => page.choose("offset", Number(button.dataset.offset)));
  // Replaces an invalid number by the value of the state.
  for (const field of document.querySelectorAll("input[type=number]"))
    field.addEventListener("change", () => sync(page, null));
  $("form").addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", () => page.followLink());
}

// Handles pointer events on image, bars and curves.
function listenToPointer(page) {
  // Returns [x, y] of the pointer, relative to the element's width and height.
  const relativePosition = (id, {clientX, clientY}) => {
    const {left, top, width, height} = $(id).getBoundingClientRect();
    return [(clientX - left) / width, (clientY - top) / height];
  };
  const clampedIndex = (value, end) => Math.min(Math.max(Math.floor(value), 0), end - 1);
  const positionOnAxis = (id, event) => (relativePosition(id, event)[0] * VIEW_WIDTH - LEFT) / (RIGHT - LEFT);  // 0..1
  // owner(event): returns [PE, text] for the pointer's position.
  const listenForOwner = (id, owner) => {
    $(id).addEventListener("pointermove", (event) => page.hover(...owner(event)));
    $(id).addEventListener("pointerleave", () => page.hover(null));
    $(id).addEventListener("click", (event) => page.pick(owner(event)[0]));
  };
  listenForOwner("picture", (event) => {
    const [x, y] = relativePosition("picture", event), {width, height} = page.size;
    const row = clampedIndex(y * height, height), column = clampedIndex(x * width, width), at = row * width + column;
    return [page.figures.owners[at], `Row ${row}, column ${column}: ${grouped(page.costs[at])} cycles.`];
  });
  listenForOwner(
    "bars",
    (event) => [clampedIndex(positionOnAxis("bars", event) * page.figures.setting.pes, page.figures.setting.pes), ""]);
  const drag = (event) => {
    page.state.mapping = "cyclic";
    page.choose("offset", clampedIndex(positionOnAxis("curves", event) * (page.size.width - 1) + 0.5, page.size.width));
  };
  $("curves").addEventListener("pointerdown", (event) => {
    $("curves").setPointerCapture(event.pointerId);
    drag(event);
  });
  $("curves").addEventListener("pointermove", (event) => event.buttons & 1 && drag(event));
}

// Updates all controls from the state, except the field in which the user is typing (`active`).
function sync(page, active) {
  const {state, size: {width}} = page, pes = settingOf(state).pes;
  for (const [id, [name, index]] of Object.entries(CONTROLS))
    if ($(id) !== active || active.type !== "number")
      $(id).value = (index === undefined ? state[name] : state[name][index]) ?? "";
  $("pe").max = pes - 1;
  for (const radio of document.querySelectorAll("[name=view], [name=fold]"))
    radio.checked = radio.value === state[radio.name];
  for (const part of document.querySelectorAll("[data-for]"))
    part.hidden = !part.dataset.for.split(" ").includes(state.mapping);
  const squareRoot = roundedSquareRoot(pes);
  $("root").textContent = `p = √P ${squareRoot ** 2 === pes ? "=" : "≈"} ${squareRoot}`;
  $("root").dataset.offset = squareRoot % width;
  $("root").hidden = squareRoot >= width;
}
