// Draws the picture, its close-up, the bars of the loads and the curves, in colours that follow the reader's. Knows the
// figures of model.js, and no control.
"use strict";

const styleColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// --- Colours: OKLCH (B. Ottosson, "A perceptual color space for image processing", 2020), so that all hues are as
// light.

function rgbOf(light, chroma, hue) {
  const a = chroma * Math.cos(hue * Math.PI / 180), b = chroma * Math.sin(hue * Math.PI / 180);
  const l = (light + 0.3963377774 * a + 0.2158037573 * b) ** 3, m = (light - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (light - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s
  ].map((linear) => {
    const v = Math.min(Math.max(linear, 0), 1);
    return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
  });
}

const wordOf = ([r, g, b]) => (255 << 24 | b << 16 | g << 8 | r) >>> 0;  // a pixel of a canvas, the least byte first
const HUES = 360, LEVELS = 64;
const table = (count, colour) => Uint32Array.from(
  {length: count * LEVELS},
  (_, i) => wordOf(colour(Math.floor(i / LEVELS) / (count - 1), (i % LEVELS) / (LEVELS - 1))));
const hueOf = (pe, pes) => (205 + 360 * pe / pes) % 360;
const OWNERS =
  table(HUES, (turn, level) => rgbOf(0.2 + 0.7 * level, 0.04 + 0.055 * Math.sin(Math.PI * level), turn * 359));
const LOADS = table(129, (t, level) => rgbOf(0.22 + 0.66 * level, 0.19 * Math.abs(2 * t - 1), t < 0.5 ? 255 : 29));
const COSTS = table(256, (t) => rgbOf(0.17 + 0.79 * t, 0.04 + 0.22 * t * (1.25 - t), 295 + 160 * t));

// --- The picture. `levels`: 0..63 for each pixel, how light it is.

const VIEW_WORDS = {
  owners: () => "Hue: the number of the PE that owns the pixel.",
  loads: () =>
    "Red: the pixel's PE has more to do than the mean, blue: less. Full colour at twice the mean, and at nothing.",
  costs: (f, most) => `The brighter, the more cycles a pixel costs; the most expensive takes ${grouped(most)}.`,
  picture: () => "What the machine has rendered.",
};

function drawPicture(canvas, f, {levels, costs, most, photo}, view, focus) {
  const context = canvas.getContext("2d"), {width, height} = canvas;
  const image = view === "picture" ? photo : context.createImageData(width, height);
  const shown = focus === null && view === "picture" ? null : new Uint32Array(image.data.buffer.slice(0));
  if (shown === null) return context.putImageData(image, 0, 0);
  const {owners, loads, mean, setting: {pes}} = f;
  const row = Int32Array.from(
    {length: pes},
    (_, pe) => LEVELS *
      (view === "owners" ? Math.floor(hueOf(pe, pes)) :
                           Math.round(64 * (1 + (mean > 0 ? Math.min(loads[pe] / mean - 1, 1) : 0)))));
  const colours = view === "owners" ? OWNERS : LOADS;
  for (let at = 0; at < shown.length; ++at) {
    if (view === "costs")
      shown[at] = COSTS[Math.round(255 * Math.sqrt(most > 0 ? costs[at] / most : 0)) * LEVELS];
    else if (view !== "picture")
      shown[at] = colours[row[owners[at]] + levels[at]];
    if (focus === null) continue;
    // One PE's pixels in white, all others at a third of their light.
    shown[at] = owners[at] === focus ? 0xffffffff :
                                       (0xff000000 | ((shown[at] >>> 16 & 255) / 3 << 16) |
                                        ((shown[at] >>> 8 & 255) / 3 << 8) | (shown[at] & 255) / 3) >>>
        0;
  }
  context.putImageData(new ImageData(new Uint8ClampedArray(shown.buffer), width, height), 0, 0);
}

// --- Canvases in the page's own pixels.

function prepared(canvas) {
  const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.font = `12px ${getComputedStyle(canvas).fontFamily}`;
  context.textBaseline = "middle";
  return {context, width, height};
}

const bright = (pe, pes, light) => `rgb(${rgbOf(light, 0.13, hueOf(pe, pes)).join(" ")})`;

// Round numbers from 0 to `most`, about `count` of them.
function ticksOf(most, count) {
  const raw = most / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((s) => s * power >= raw * 0.999) * power;
  return Array.from({length: Math.floor(most / step * 1.0001) + 1}, (_, i) => Number((i * step).toPrecision(6)));
}

function axes(context, box, ticksX, ticksY, toX, toY) {
  context.fillStyle = styleColour("soft");
  context.strokeStyle = styleColour("line");
  context.lineWidth = 1;
  context.textAlign = "right";
  for (const y of ticksY) {
    const at = Math.round(toY(y)) + 0.5;
    context.beginPath();
    context.moveTo(box.left, at);
    context.lineTo(box.right, at);
    context.stroke();
    context.fillText(String(y), box.left - 6, at);
  }
  context.textAlign = "center";
  for (const x of ticksX) context.fillText(String(x), Math.min(toX(x), box.right - 4), box.bottom + 12);
}

// --- The loads: a bar for each PE in parts of the mean; where there are more PEs than room, the highest of those
// there.

function drawBars(canvas, f, focus, most) {
  const {context, width, height} = prepared(canvas), {loads, mean, setting: {pes}} = f;
  const box = {left: 34, right: width - 4, top: 16, bottom: height - 22};
  const unit = mean > 0 ? mean : 1, top = 1.06 * Math.max(most, f.max / unit, 1.2);
  const toX = (pe) => box.left + (box.right - box.left) * pe / pes,
        toY = (y) => box.bottom - (box.bottom - box.top) * y / top;
  axes(
    context, box, ticksOf(pes, 4).filter((x) => Number.isInteger(x) && x < pes), ticksOf(top, 4), (pe) => toX(pe + 0.5),
    toY);
  const light = matchMedia("(prefers-color-scheme: dark)").matches ? 0.74 : 0.64;
  const step = Math.max(1, Math.floor(pes / (box.right - box.left)));
  for (let pe = 0; pe < pes; pe += step) {
    let highest = loads[pe];
    for (let next = pe; next < Math.min(pe + step, pes); ++next) highest = Math.max(highest, loads[next]);
    const left = toX(pe), wide = Math.max(toX(pe + step) - left - (pes < 130 ? 1 : 0), 0.7);
    const shown = focus !== null && focus >= pe && focus < pe + step;
    context.fillStyle = shown ? styleColour("ink") : bright(pe, pes, light);
    context.globalAlpha = focus === null || shown ? 1 : 0.45;
    context.fillRect(left, toY(highest / unit), shown ? Math.max(wide, 2) : wide, box.bottom - toY(highest / unit));
  }
  context.globalAlpha = 1;
  context.strokeStyle = styleColour("ink");
  context.setLineDash([5, 4]);
  context.beginPath();
  context.moveTo(box.left, toY(1));
  context.lineTo(box.right, toY(1));
  context.stroke();
  context.setLineDash([]);
  if (mean > 0) {  // u, above the bar that it is of
    const words = `u = ${fixed(f.imbalance, 3)}`, half = context.measureText(words).width / 2 + 2;
    context.fillStyle = styleColour("ink");
    context.textAlign = "center";
    context.fillText(
      words, Math.min(Math.max(toX(f.busiest + 0.5), box.left + half), box.right - half), toY(f.max / unit) - 9);
  }
  return (x) => Math.min(Math.max(Math.floor((x - box.left) / (box.right - box.left) * pes), 0), pes - 1);
}

// --- u over all offsets. curves: {cyclic, block}, as far as they are known; `here`: the offset and fold, or null.

function drawCurves(canvas, curves, known, f, root, best, here) {
  const {context, width, height} = prepared(canvas), side = curves.cyclic.length;
  const box = {left: 40, right: width - 8, top: 14, bottom: height - 22};
  let top = Math.max(f.imbalance, 1e-3);
  for (const curve of Object.values(curves))
    for (let p = 0; p < known; ++p) top = Math.max(top, curve[p]);
  top *= 1.06;
  const toX = (p) => box.left + (box.right - box.left) * p / Math.max(side - 1, 1),
        toY = (u) => box.bottom - (box.bottom - box.top) * u / top;
  axes(context, box, ticksOf(Math.max(side - 1, 1), 5).filter(Number.isInteger), ticksOf(top, 4), toX, toY);
  const line = (colour, points, wide = 1.5, dash = []) => {
    context.strokeStyle = colour;
    context.lineWidth = wide;
    context.setLineDash(dash);
    context.beginPath();
    for (const [x, y] of points) context.lineTo(x, y);
    context.stroke();
    context.setLineDash([]);
  };
  line(styleColour("soft"), [[toX(root), box.top], [toX(root), box.bottom]], 1, [2, 4]);
  const names = Object.keys(curves);
  for (const fold of [...names].sort((a) => (here && a === here.fold ? 1 : -1))) {
    const dim = here && names.length > 1 && fold !== here.fold;
    line(
      styleColour(fold === "cyclic" ? "curve" : "other"),
      Array.from(curves[fold].slice(0, known), (u, p) => [toX(p), toY(u)]), dim ? 1 : 1.6);
  }
  const dot = (p, u, radius, fill) => {
    context.beginPath();
    context.arc(toX(p), toY(u), radius, 0, 7);
    context.fillStyle = fill;
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = styleColour("ink");
    context.stroke();
  };
  if (best !== null) dot(best.offset, best.u, 3.5, styleColour("paper"));
  if (here === null)
    line(styleColour("mark"), [[box.left, toY(f.imbalance)], [box.right, toY(f.imbalance)]], 2);
  else {
    line(styleColour("mark"), [[toX(here.offset), box.top], [toX(here.offset), box.bottom]], 1.5);
    dot(here.offset, f.imbalance, 5, styleColour("mark"));
  }
  return (x) => Math.min(Math.max(Math.round((x - box.left) / (box.right - box.left) * (side - 1)), 0), side - 1);
}

// --- The middle of the picture, large: who owns what, one PE's pixels marked, and its shortest vector.

function drawCloseUp(canvas, f, {width: across, height: down}, focus) {
  const {context, width} = prepared(canvas), {owners, vector, setting: {pes}} = f;
  const reach = vector ? Math.ceil(Math.hypot(...vector)) : 12;
  const cells = Math.min(Math.max(2 * reach + 5, 17), 71, across, down), cell = width / cells;
  const row0 = Math.floor((down - cells) / 2), column0 = Math.floor((across - cells) / 2),
        middle = Math.floor(cells / 2);
  const at = (row, column) => owners[(row0 + row) * across + column0 + column], own = focus ?? at(middle, middle);
  for (let row = 0; row < cells; ++row)
    for (let column = 0; column < cells; ++column) {
      const pe = at(row, column);
      context.fillStyle = bright(pe, pes, pe === own ? 0.8 : 0.5 + 0.06 * (pe & 1));
      context.fillRect(column * cell, row * cell, cell + 0.5, cell + 0.5);
      if (pe !== own) continue;
      context.fillStyle = "#ffffff";
      context.fillRect((column + 0.12) * cell, (row + 0.12) * cell, 0.76 * cell, 0.76 * cell);
    }
  // From the pixel of that PE that is nearest to the middle.
  let from = null;
  for (let row = 0; row < cells; ++row)
    for (let column = 0; column < cells; ++column) {
      const away = Math.hypot(row - middle, column - middle);
      if (at(row, column) === own && (from === null || away < from.away)) from = {row, column, away};
    }
  if (vector && from) {
    const [x, y] = [(from.column + 0.5) * cell, (from.row + 0.5) * cell],
              [dx, dy] = [vector[1] * cell, vector[0] * cell];
    const length = Math.hypot(dx, dy), head = Math.min(9, length / 2), [ux, uy] = [dx / length, dy / length];
    for (const [colour, wide] of [["#000000", 5], ["#ffd84d", 2.5]]) {
      context.strokeStyle = colour;
      context.lineWidth = wide;
      context.lineCap = context.lineJoin = "round";
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + dx, y + dy);
      for (const turn of [1, -1]) {
        context.moveTo(x + dx, y + dy);
        context.lineTo(x + dx - head * (ux - turn * 0.6 * uy), y + dy - head * (uy + turn * 0.6 * ux));
      }
      context.stroke();
    }
  }
  return {pe: own, cells};
}
