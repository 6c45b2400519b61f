// From the page's controls and its pointer to the state, and back.
"use strict";

function fill(page) {
  const {width, height} = page.size;
  for (const [id, side] of [["tile-w", width], ["tile-h", height]])
    $(id).append(...divisorsOf(side).map((d) => new Option(d, d)));
}

function listen(page) {
  const change = (id, take) => $(id).addEventListener("input", () => {
    const control = $(id),
          value = control.tagName === "SELECT" && id === "mapping" ? control.value : Number(control.value);
    if (control.type === "number" && (control.value === "" || !control.checkValidity())) return;
    take(value);
    page.show(control);
  });
  change("mapping", (name) => {
    page.state.mapping = name;
  });
  for (const id of ["offset", "offset-slider"])
    change(id, (p) => {
      page.state.offset = p;
    });
  for (const id of ["pes", "pes-slider"])
    change(id, (pes) => {
      page.state.pes = pes;
    });
  change("grid-a", (a) => {
    page.state.grid = [a, page.state.grid[1]];
  });
  change("grid-b", (b) => {
    page.state.grid = [page.state.grid[0], b];
  });
  change("tile-w", (w) => {
    page.state.tile = [w, page.state.tile[1]];
  });
  change("tile-h", (h) => {
    page.state.tile = [page.state.tile[0], h];
  });
  change("seed", (seed) => {
    page.state.seed = seed;
  });
  change("pe", (pe) => {
    page.state.pe = pe;
  });
  $("pe").addEventListener("input", () => {
    if ($("pe").value === "") page.pick(null);
  });
  $("no-pe").addEventListener("click", () => page.pick(null));
  for (const name of ["view", "fold"])
    for (const radio of document.getElementsByName(name))
      radio.addEventListener("change", () => {
        page.state[name] = radio.value;
        page.show(radio);
      });
  for (const button of document.querySelectorAll("[data-offset], #root, #best"))
    button.addEventListener("click", () => {
      page.state.offset = Number(button.dataset.offset);
      page.show(button);
    });
  for (const field of document.querySelectorAll("input[type=number]"))  // what cannot be is not left standing
    field.addEventListener("change", () => sync(page, null));
  $("form").addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", () => page.follow());
  addEventListener("resize", () => page.soon());  // also where the page is zoomed
  for (const media of ["(prefers-color-scheme: dark)", "print"])
    matchMedia(media).addEventListener("change", () => page.draw());
  new ResizeObserver(() => page.soon()).observe($("bars"));
  listenToPointer(page);
}

// The pointer on picture, bars and curves.
function listenToPointer(page) {
  const over = (id, owner) => {
    const canvas = $(id);
    canvas.addEventListener("pointermove", (event) => page.hover(...owner(event)));
    canvas.addEventListener("pointerleave", () => page.hover(null));
    canvas.addEventListener("click", (event) => page.pick(owner(event)[0]));
  };
  over("picture", (event) => {
    const box = $("picture").getBoundingClientRect(), {width, height} = page.size;
    const inside = (value, end) => Math.min(Math.max(Math.floor(value), 0), end - 1);
    const row = inside((event.clientY - box.top) / box.height * height, height);
    const column = inside((event.clientX - box.left) / box.width * width, width), at = row * width + column;
    return [page.figures.owners[at], `Row ${row}, column ${column}: ${grouped(page.costs[at])} cycles.`];
  });
  over("bars", (event) => [page.barAt(event.clientX - $("bars").getBoundingClientRect().left), ""]);
  const curves = $("curves");
  const drag = (event) => {
    page.state.mapping = "cyclic";
    page.state.offset = page.offsetAt(event.clientX - curves.getBoundingClientRect().left);
    page.show(curves);
  };
  curves.addEventListener("pointerdown", (event) => {
    curves.setPointerCapture(event.pointerId);
    drag(event);
  });
  curves.addEventListener("pointermove", (event) => {
    if (event.buttons & 1) drag(event);
  });
}

// All controls say what the state is; not the field that is being written in.
function sync(page, active) {
  const {state, figures} = page, {width} = page.size;
  const values = {
    mapping: state.mapping,
    offset: state.offset,
    "offset-slider": state.offset,
    pes: state.pes,
    "pes-slider": Math.min(state.pes, width),
    "grid-a": state.grid[0],
    "grid-b": state.grid[1],
    "tile-w": state.tile[0],
    "tile-h": state.tile[1],
    seed: state.seed,
    pe: state.pe ?? ""
  };
  for (const [id, value] of Object.entries(values))
    if ($(id) !== active || active.type !== "number") $(id).value = value;
  $("pe").max = figures.setting.pes - 1;
  for (const name of ["view", "fold"])
    for (const radio of document.getElementsByName(name)) radio.checked = radio.value === state[name];
  for (const part of document.querySelectorAll("[data-for]"))
    part.hidden = !part.dataset.for.split(" ").includes(state.mapping);
  for (const part of document.querySelectorAll("[data-but]")) part.hidden = part.dataset.but === state.mapping;
  $("root").textContent = `p = √P ≈ ${page.root}`.replace("≈", page.root ** 2 === figures.setting.pes ? "=" : "≈");
  $("root").dataset.offset = page.root % width;
  $("root").hidden = page.root >= width;
}
