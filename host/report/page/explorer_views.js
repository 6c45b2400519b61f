// Draws the views of the explorer (image, close-up, bars of loads, curves) from the figures of model.js. The views do
// not depend on the controls.
"use strict";

// Palettes. colours() returns the RGBA words of `count` colours in LEVELS levels of lightness, [colour][level].
// colour(t, level): returns [red, green, blue]; t and level are 0..1.
const HUES = 360, LEVELS = 64;
const colours = (count, colour) => Uint32Array.from(
  {length: count * LEVELS},
  (_, i) => wordOf(colour(Math.floor(i / LEVELS) / (count - 1), (i % LEVELS) / (LEVELS - 1))));
const OWNERS =
  colours(HUES, (turn, level) => rgbOf(0.2 + 0.7 * level, 0.04 + 0.055 * Math.sin(Math.PI * level), turn * 359));
const LOADS = colours(129, (t, level) => rgbOf(0.22 + 0.66 * level, 0.19 * Math.abs(2 * t - 1), t < 0.5 ? 255 : 29));
const COSTS = colours(256, (t) => rgbOf(0.17 + 0.79 * t, 0.04 + 0.22 * t * (1.25 - t), 295 + 160 * t));

const VIEW_TEXTS = {
  owners: () => "Hue: number of the PE that owns the pixel.",
  loads: () =>
    "Red: the load of the pixel's PE is above the mean; blue: below. Full colour at twice the mean and at 0.",
  costs: (max) => `Brightness: cycles of the pixel, up to ${grouped(max)}.`,
  picture: () => "The rendered image.",
};

// Draws the image in the colours of `view`. `levels`: lightness of each pixel, 0..63. `focus`: null, or a PE whose
// pixels are drawn white, whereas the pixels of the other PEs are dimmed.
function drawPicture(canvas, f, {levels, costs, maxCost, photo}, view, focus) {
  const {owners, loads, mean, setting: {pes}} = f, shown = new Uint32Array(photo.data.buffer.slice(0));
  const colourOf = (pe) => view === "owners" ?
    Math.floor(hueOf(pe, pes)) :
    Math.round(64 * (1 + (mean > 0 ? Math.min(loads[pe] / mean - 1, 1) : 0)));
  const paletteRow = Int32Array.from({length: pes}, (_, pe) => LEVELS * colourOf(pe)),
        palette = view === "owners" ? OWNERS : LOADS;
  const dim = (word, shift) => (word >>> shift & 255) / 3 << shift;  // one colour channel
  for (let i = 0; i < shown.length; ++i) {
    if (view === "costs") shown[i] = COSTS[Math.round(255 * Math.sqrt(maxCost > 0 ? costs[i] / maxCost : 0)) * LEVELS];
    else if (view !== "picture")
      shown[i] = palette[paletteRow[owners[i]] + levels[i]];
    if (focus === null) continue;
    shown[i] = owners[i] === focus ? 0xffffffff :
                                     (0xff000000 | dim(shown[i], 16) | dim(shown[i], 8) | dim(shown[i], 0)) >>> 0;
  }
  canvas.getContext("2d").putImageData(
    new ImageData(new Uint8ClampedArray(shown.buffer), photo.width, photo.height), 0, 0);
}

// Returns a chart with the load of each PE relative to the mean, in the PE's colour. `top`: minimum for the upper end
// of the axis.
function loadBars(f, texts, focus, top) {
  const {mean, setting: {pes}} = f;
  const description = `Loads of ${pes} PEs: from ${texts.idlest} to ${texts.busiest}, mean ${texts.mean}.`;
  return bars(description, ["PE", "load / mean"], Array.from(f.loads, (load) => mean > 0 ? load / mean : 0), 1, {
    top: Math.max(top, 1.2),
    colour: (first, count) => focus >= first && focus < first + count && focus !== null ?
      "var(--ink)" :
      peColour(first, pes, 0.69, focus === null ? 1 : 0.45)
  });
}

// Returns a chart with the imbalance u of each offset computed so far. `current`: the current offset and fold, or null.
function offsetCurves(f, texts, {values, known, best}, sqrtP, current) {
  const side = values.cyclic.length, last = Math.max(side - 1, 1), folds = Object.entries(values);
  const max = folds.reduce(
    (top, [, us]) => us.subarray(0, known).reduce((a, u) => Math.max(a, u), top), Math.max(f.imbalance, 1e-3));
  const {x, y, grid} = plane(linear("offset p", last, 5, true), linear("u", 1.06 * max, 4));
  const curve = ([fold, us]) => line(
    `curve ${fold}${current && current.fold !== fold ? " dim" : ""}`,
    ...Array.from(us.subarray(0, known), (u, p) => [x(p), y(u)]));
  const minimum =
    best ? `minimum ${fixed(best.u, 3)} at p = ${best.offset}, fold ${best.fold}` : "not all computed yet";
  return chart(`u of the offsets 0 to ${side - 1}, current ${texts.u}; ${minimum}.`, [
    grid, sqrtP < side ? [line("root", [x(sqrtP), TOP], [x(sqrtP), BOTTOM])] : [], known > 0 ? folds.map(curve) : [],
    best ? [dot(x(best.offset), y(best.u), 4, "ring")] : [],
    current ?
      [
        line("mark", [x(current.offset), TOP], [x(current.offset), BOTTOM]),
        dot(x(current.offset), y(f.imbalance), 5, "current")
      ] :
      [line("mark", [LEFT, y(f.imbalance)], [RIGHT, y(f.imbalance)])]
  ]);
}

// Draws the enlarged centre of the image: pixels in their owners' colours, marks on the pixels of one PE, and the
// shortest vector between pixels of this PE. Returns the PE and the number of pixels along a side.
function drawCloseUp(canvas, f, {width, height}, focus) {
  const context = canvas.getContext("2d"), {owners, vector, setting: {pes}} = f,
        vectorLength = vector ? Math.ceil(Math.hypot(...vector)) : 12;
  const cells = Math.min(Math.max(2 * vectorLength + 5, 17), 71, width, height), cell = canvas.width / cells,
        middle = Math.floor(cells / 2);
  const row0 = Math.floor((height - cells) / 2), column0 = Math.floor((width - cells) / 2);
  const ownerAt = (row, column) => owners[(row0 + row) * width + column0 + column],
        shownPe = focus ?? ownerAt(middle, middle);
  let nearest = null;  // the pixel of shownPe that is nearest to the centre
  for (let row = 0; row < cells; ++row)
    for (let column = 0; column < cells; ++column) {
      const pe = ownerAt(row, column), distance = Math.hypot(row - middle, column - middle);
      context.fillStyle = peColour(pe, pes, pe === shownPe ? 0.8 : 0.5 + 0.06 * (pe & 1));
      context.fillRect(column * cell, row * cell, cell + 0.5, cell + 0.5);
      if (pe !== shownPe) continue;
      context.fillStyle = "#ffffff";
      context.fillRect((column + 0.12) * cell, (row + 0.12) * cell, 0.76 * cell, 0.76 * cell);
      if (nearest === null || distance < nearest.distance) nearest = {row, column, distance};
    }
  if (vector && nearest)
    drawArrow(context, (nearest.column + 0.5) * cell, (nearest.row + 0.5) * cell, vector[1] * cell, vector[0] * cell);
  return {pe: shownPe, cells};
}

function drawArrow(context, x, y, dx, dy) {
  const length = Math.hypot(dx, dy), tip = Math.min(13, length / 2), [ux, uy] = [dx / length, dy / length];
  context.lineCap = context.lineJoin = "round";
  for (const [colour, width] of [["#000000", 7], ["#ffd84d", 3.5]]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + dx, y + dy);
    for (const turn of [1, -1]) {
      context.moveTo(x + dx, y + dy);
      context.lineTo(x + dx - tip * (ux - turn * 0.6 * uy), y + dy - tip * (uy + turn * 0.6 * ux));
    }
    context.stroke();
  }
}
