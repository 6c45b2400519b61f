// Draws charts as SVG in the page's colours, and pixel maps on canvases. Parameter `description`: text for screen
// readers.
"use strict";

// --- Colours in OKLCH (B. Ottosson, "A perceptual color space for image processing", 2020), a colour space in which
// all hues of a lightness look equally light.

// Returns [red, green, blue], 0..255. light: 0..1; chroma: 0 for grey, up to about 0.3; hue: degrees.
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

const hueOf = (pe, pes) => (205 + 360 * pe / pes) % 360;
// Returns the CSS colour of a PE.
const peColour = (pe, pes, light, alpha = 1) => `rgb(${rgbOf(light, 0.13, hueOf(pe, pes)).join(" ")} / ${alpha})`;
const wordOf = ([r, g, b]) => (255 << 24 | b << 16 | g << 8 | r) >>> 0;  // RGBA pixel of a canvas, little-endian

// Returns a canvas with a pixel map. word(row, column): returns the RGBA word of a pixel.
function pixelMap(width, height, description, word) {
  const canvas = make("canvas", {class: "picture", width, height, role: "img", "aria-label": description});
  const pixels = new Uint32Array(width * height), context = canvas.getContext("2d");
  for (let row = 0, at = 0; row < height; ++row)
    for (let column = 0; column < width; ++column, ++at) pixels[at] = word(row, column);
  context.putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), width, height), 0, 0);
  return canvas;
}

// Returns a function that maps a value to an RGBA word: red above the mean, blue below; the value farthest from the
// mean has the full colour.
function diverging(values) {
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const farthest = values.reduce((max, value) => Math.max(max, Math.abs(value - mean)), 0) || 1;
  return (value) => {
    const deviation = (value - mean) / farthest, size = Math.min(Math.abs(deviation), 1);
    return wordOf(rgbOf(0.93 - 0.4 * size, 0.17 * size, deviation < 0 ? 255 : 29));
  };
}

// --- SVG. Lengths are in units of the view box, in which the font size is 12.5 (style.css).

const VIEW_WIDTH = 480, VIEW_HEIGHT = 250, LEFT = 52, RIGHT = 456, TOP = 26, BOTTOM = 212;

function svg(tag, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

const pos = (v) => v.toFixed(2);  // a coordinate as text
const path = (css, d) => svg("path", {class: css, d});
const line = (css, ...points) => path(css, "M" + points.map(([x, y]) => `${pos(x)} ${pos(y)}`).join("L"));
const box = (css, x0, y0, x1, y1) => path(css, `M${pos(x0)} ${pos(y0)}H${pos(x1)}V${pos(y1)}H${pos(x0)}Z`);
const label = (anchor, x, y, text) => svg("text", {x: pos(x), y: pos(y), "text-anchor": anchor}, text);
const dot = (x, y, radius = 4, css = "dot") => svg("circle", {class: css, cx: pos(x), cy: pos(y), r: radius});

const chart = (description, marks, height = VIEW_HEIGHT) => svg(
  "svg", {class: "chart", viewBox: `0 0 ${VIEW_WIDTH} ${height}`, role: "img", "aria-label": description},
  box("ground", 0, 0, VIEW_WIDTH, height), ...marks.flat());

// Returns about `count` round numbers from 0 to `max`.
function ticksOf(max, count) {
  const raw = max / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((s) => s * power >= raw * 0.999) * power;
  return Array.from({length: Math.floor(max / step * 1.0001) + 1}, (_, i) => Number((i * step).toPrecision(6)));
}

// Returns a linear axis from 0 to `max` with about `count` ticks. fraction(): maps a value to 0..1. `whole`: true if
// the ticks are integers without a unit prefix.
function linear(name, max, count, whole = false) {
  const [unit, prefix] = max >= 1e9 ? [1e9, "thousand million "] :
    max >= 1e6                      ? [1e6, "million "] :
    max >= 1e4                      ? [1e3, "thousand "] :
                                      [1, ""];
  const ticks = ticksOf(max, count).filter((tick) => !whole || Number.isInteger(tick));
  return {
    name: whole ? name : prefix + name,
    fraction: (v) => v / max,
    ticks,
    text: (tick) => String(Number((tick / (whole ? 1 : unit)).toPrecision(6)))
  };
}

// Returns a logarithmic axis over the decades that contain the values from `min` to `max`.
function decades(name, min, max) {
  const begin = Math.floor(Math.log10(min)), end = Math.max(begin + 1, Math.ceil(Math.log10(max)));
  const step = Math.max(1, Math.ceil((end - begin) / 8)), ticks = [];
  for (let power = begin; power <= end; power += step) ticks.push(10 ** power);
  return {
    name,
    fraction: (v) => (Math.log10(v) - begin) / (end - begin),
    ticks,
    text: (tick) => String(Number(tick.toPrecision(6))),
    min: 10 ** begin
  };
}

// Returns a coordinate system with the axes `across` and `up`: x() and y() map values to positions; `grid` has the
// SVG elements of grid lines and labels.
function plane(across, up) {
  const x = (v) => LEFT + (RIGHT - LEFT) * across.fraction(v), y = (v) => BOTTOM - (BOTTOM - TOP) * up.fraction(v);
  const grid = [label("start", 4, 14, up.name), label("end", RIGHT, VIEW_HEIGHT - 4, across.name)];
  for (const tick of up.ticks)
    grid.push(line("grid", [LEFT, y(tick)], [RIGHT, y(tick)]), label("end", LEFT - 6, y(tick) + 4, up.text(tick)));
  for (const tick of across.ticks) grid.push(label("middle", x(tick), BOTTOM + 16, across.text(tick)));
  return {x, y, grid};
}

// Returns a chart with a vertical bar for each of `values`, and a line at `mean`. [across, up]: names of the axes. If
// there are more than 416 values, a column shows several values: dark up to their minimum, pale up to their maximum.
// colour(first, count), optional: returns the colour of the column that shows the values first .. first + count - 1.
// top: minimum for the upper end of the axis.
function bars(description, [across, up], values, mean, {colour = null, top = 0} = {}) {
  const count = values.length, columns = count <= 416 ? count : 208, columnWidth = (RIGHT - LEFT) / columns,
        gap = columns > 100 ? 0.1 : 0.2;
  const max = values.reduce((a, b) => Math.max(a, b), Math.max(top, 1e-9));
  const {x, y, grid} = plane(linear(across, count, 8, true), linear(up, max * 1.04, 5)), marks = [];
  for (let column = 0; column < columns; ++column) {
    const first = Math.floor(column * count / columns),
          shown = values.slice(first, Math.floor((column + 1) * count / columns));
    const low = Math.min(...shown), high = Math.max(...shown),
          left = x(column * count / columns) + columnWidth * gap / 2, right = left + columnWidth * (1 - gap);
    if (high > low) marks.push(box("bar pale", left, y(high), right, y(low)));
    marks.push(box("bar", left, y(low), right, BOTTOM));
    if (colour)
      for (const mark of marks.slice(high > low ? -2 : -1)) mark.style.fill = colour(first, shown.length);
  }
  return chart(description, [grid, marks, line("mark", [LEFT, y(mean)], [RIGHT, y(mean)])]);
}

// Returns a chart with a horizontal bar for each row {name, text, value, mark}, and the name above the bar. mark,
// optional: value at which a line crosses the bar.
function namedBars(description, rows) {
  const max = rows.reduce((a, {value, mark = 0}) => Math.max(a, value, mark), 1e-300), x = (v) => 6 + 358 * v / max;
  return chart(
    description, rows.map(({name, text, value, mark}, i) => {
      const y = 36 * i + 14, end = Math.max(x(value), 7);
      return [
        label("start", 6, y, name), box("bar", 6, y + 4, end, y + 16),
        label("start", Math.max(end, x(mark ?? 0)) + 6, y + 14, text),
        ...(mark === undefined ? [] : [line("mark", [x(mark), y + 1], [x(mark), y + 19])])
      ];
    }),
    36 * rows.length + 6);
}

// Returns a roofline chart: numbered points [operations per byte, thousand million operations per second], and the roof
// min(x * slope, top). slope: thousand million bytes per second. tops: [name, top] of one or two roofs; the second roof
// is lower and dashed.
function roof(description, slope, tops, points) {
  const xs = [tops[0][1] / slope, ...points.map(([x]) => x)],
        ys = [...tops.map(([, v]) => v), ...points.map(([, y]) => y)];
  const across = decades("operations per byte", Math.min(...xs) / 2, Math.max(...xs) * 2);
  const up = decades("thousand million operations per second", Math.min(...ys) / 1.5, Math.max(...ys) * 1.2);
  const {x, y, grid} = plane(across, up), roofStart = Math.max(across.min, up.min / slope);
  for (const tick of across.ticks) grid.push(line("grid", [x(tick), TOP], [x(tick), BOTTOM]));
  const marks = tops.flatMap(
    ([name, top], i) =>
      [i ? line("roof dashed", [x(Math.max(roofStart, top / slope)), y(top)], [RIGHT, y(top)]) :
           line("roof", [x(roofStart), y(roofStart * slope)], [x(top / slope), y(top)], [RIGHT, y(top)]),
       label("end", RIGHT, y(top) - 5, name)]);
  marks.push(label("start", x(roofStart) + 4, Math.min(y(roofStart * slope) + 14, BOTTOM - 4), "copies"));
  const taken = [];  // positions of labels; a label too close to another label is placed below that label
  const places = points.map(([px, py], i) => [x(px), y(py), i + 1]).sort((a, b) => a[1] - b[1]);
  for (const [px, py, number] of places) {
    const labelIsLeft = px + 22 > RIGHT, lx = labelIsLeft ? px - 8 : px + 8;
    let ly = py + 4;
    for (const [ox, oy] of taken)
      if (Math.abs(ox - lx) < 18 && ly < oy + 12) ly = oy + 12;
    taken.push([lx, ly]);
    marks.push(dot(px, py), label(labelIsLeft ? "end" : "start", lx, ly, String(number)));
  }
  return chart(description, [grid, marks]);
}
