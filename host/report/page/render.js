// The page of a report of `raya render`.
"use strict";

const percent = (fraction, digits = 1) => `${fixed(100 * fraction, digits)} %`;
const sum = (values) => values.reduce((a, b) => a + b, 0);
const titled = (name) => name.replaceAll("_", " ");
const kilobytes = (bytes) => bytes < 1024 ? `${bytes} bytes` : `${fixed(bytes / 1024, 1)} KB`;
const msText = (ms) => ms > 0 && ms < 1 ? `${fixed(ms, 3)} ms` : timeText(ms);
const count = (object, path) => grouped(num(object, path));
const RED_AND_BLUE = "Red: above the mean; blue: below; full colour: farthest from the mean.";

function rateText(rays) {
  const [unit, name] = rays >= 1e6 ? [1e6, "Mrays/s"] : rays >= 1e3 ? [1e3, "krays/s"] : [1, "rays/s"];
  return `${fixed(rays / unit, 1)} ${name}`;
}

// Returns an element with an image that is embedded in the report.
function picture(r, path, description) {
  const png = str(r, path);
  if (!/^iVBORw0KGgo[\w+/]*=*$/.test(png)) throw new Error(`${path} is not a PNG file in base64`);
  return make("img", {class: "picture", alt: description, src: "data:image/png;base64," + png});
}

// --- Head

function renderHead(r) {
  const torus = has(r, "torus"), machine = member(r, "machine", "object"), seconds = num(r, "measured.render_s");
  const rays = sum(["primary", "reflected", "refracted", "shadow"].map((kind) => num(r, `rays.${kind}`)));
  const machineText = torus ? `${num(machine, "pes")} nodes, ${str(machine, "topology")}` :
                              `${num(machine, "pes")} PEs, ${str(machine, "mapping")} mapping` +
      (has(machine, "offset") ? `, offset ${num(machine, "offset")}, fold ${str(machine, "fold")}` : "");
  const modelledPath = torus ? "modelled_ms.stepwise" : "modelled_ms.total";
  head(
    "raya render", str(r, "scene"),
    paragraph(
      `${num(r, "image.width")} × ${num(r, "image.height")} pixels on ${str(machine, "name")} (${machineText}), ` +
      `${str(machine, "format")}, ${num(machine, "bounces")} bounces.`),
    tiles([
      ["imbalance u", fixed(num(r, "load.imbalance"), 3)],
      ["speed-up", `${fixed(num(r, "load.speedup"), 1)} of ${num(machine, "pes")}`],
      ["efficiency", percent(num(r, "load.efficiency"))], ["rays", grouped(rays)],
      [torus ? "modelled, step by step" : "modelled time", has(r, modelledPath) ? timeText(num(r, modelledPath)) : ""],
      ["measured", timeText(1e3 * seconds)], ["measured rate", rateText(rays / seconds)]
    ]),
    list(r, "warnings", "text").map(message));
}

// --- Image, and maps of loads and owners

// Returns the range of the loads as text.
const loadRangeText = (r) => !(num(r, "load.mean") > 0) ?
  "all 0" :
  `from ${percent(1 - num(r, "load.min") / num(r, "load.mean"))} below to ${
    percent(num(r, "load.max") / num(r, "load.mean") - 1)} above the mean`;

// Returns two maps. The map of loads has at most 256 x 256 cells; the value of a cell is the mean over its pixels of
// the load of the pixel's owner. The map of owners shows the pixels in the upper left corner.
function ownerMaps(r, size) {
  const {width, height} = size, machine = member(r, "machine", "object"), setting = settingOf(stateOf(machine, size));
  const loads = list(r, "load.per_pe", "number"), owners = ownersOf(setting, size), colour = diverging(loads);
  const shrink = Math.max(1, Math.max(width, height) / 256), w = Math.max(1, Math.round(width / shrink)),
        h = Math.max(1, Math.round(height / shrink));
  if (loads.length !== setting.pes) throw new Error("load.per_pe does not have machine.pes values");
  const cellColour = (row, column) => {
    const [top, bottom, left, right] =
      [row * height / h, (row + 1) * height / h, column * width / w, (column + 1) * width / w].map(Math.floor);
    let total = 0;
    for (let y = top; y < bottom; ++y)
      for (let x = left; x < right; ++x) total += loads[owners[y * width + x]];
    return colour(total / ((bottom - top) * (right - left)));
  };
  const side = [Math.min(width, 48), Math.min(height, 48)], mapping = mappingText(stateOf(machine, size));
  const hues = Uint32Array.from({length: setting.pes}, (_, pe) => wordOf(rgbOf(0.72, 0.14, hueOf(pe, setting.pes))));
  return [
    caption(
      pixelMap(w, h, `Map of the image: each pixel coloured by the load of its PE, ${loadRangeText(r)}`, cellColour),
      `Each pixel by the load of its PE, ${loadRangeText(r)}. ${RED_AND_BLUE}`),
    caption(
      pixelMap(
        ...side, `Close-up of the owners of pixels, mapping ${mapping}`,
        (row, column) => hues[owners[row * width + column]]),
      `Owners of the upper left ${side.join(" × ")} pixels. Hue: number of the PE, of ${setting.pes}; mapping ${
        mapping}.`)
  ];
}

// Returns the function that maps (i, j, k) to the number of the node, as kernels/shared/torus.h does. On a 2-D torus
// (`flat`), the slabs of nodes with equal k are next to each other.
function nodeNumbers([I, J, K], flat) {
  let slabs = 1;
  const sideDifference = (c) => Math.abs(I * c - J * (K / c));
  for (let c = 2; c <= K; ++c)
    if (K % c === 0 && sideDifference(c) < sideDifference(slabs)) slabs = c;
  return flat ? (i, j, k) => i + I * (k % slabs) + I * slabs * (j + J * Math.floor(k / slabs)) :
                (i, j, k) => i + I * (j + J * k);
}

// Returns a map with a cell for each node. A slice has the nodes of equal z; x points to the right, y down. The slices
// are arranged in rows.
function nodeMap(r, values, description) {
  const nodes = list(r, "torus.nodes", "number"), [I, J, K] = nodes,
        slices = Math.ceil(Math.sqrt(K));  // slices per row
  if (nodes.length !== 3 || I * J * K !== values.length)
    throw new Error("a list does not have one value for each node");
  const number = nodeNumbers(nodes, str(r, "torus.links") === "torus2d"), colour = diverging(values);
  return pixelMap(slices * (I + 1) - 1, Math.ceil(K / slices) * (J + 1) - 1, description, (y, x) => {
    const k = Math.floor(y / (J + 1)) * slices + Math.floor(x / (I + 1)), i = x % (I + 1), j = y % (J + 1);
    return i < I && j < J && k < K ? colour(values[number(i, j, k)]) : wordOf(rgbOf(0.45, 0, 0));
  });
}

function nodeMaps(r) {
  const nodes = `${list(r, "torus.nodes", "number").join(" × ")} nodes`;
  return [
    ["load.per_pe", `Load of each of ${nodes}, by slices of equal z, ${loadRangeText(r)}.`],
    ["torus.bytes_per_link.sent_by_node", `Bytes that each of ${nodes} sends over its links, by slices of equal z.`]
  ].map(
    ([path, description]) =>
      caption(nodeMap(r, list(r, path, "number"), description), `${description} ${RED_AND_BLUE}`));
}

function pictures(r) {
  const size = {width: whole(r, "image.width"), height: whole(r, "image.height")}, shown = [];
  const pixels = `${size.width} × ${size.height} pixels`, previewWidth = num(r, "image.preview.width");
  shown.push(caption(
    picture(r, "image.preview.png", `The rendered image of ${str(r, "scene")}, ${pixels}`),
    `${str(r, "image.file")}, ${pixels}${
      previewWidth < size.width ? `; shown with ${previewWidth} × ${num(r, "image.preview.height")}` : ""}.`));
  if (has(r, "torus")) shown.push(...nodeMaps(r));
  else if (!has(r, "load.requests") && size.width * size.height <= 2 ** 24)
    shown.push(...ownerMaps(r, size));
  return [
    make("div", {class: "pictures"}, shown),
    has(r, "load.requests") &&
      note(
        "PEs request pixels at run time, so there are no fixed owners; loads are simulated from the pixels' costs.")
  ];
}

// --- Loads and traffic

function loads(r) {
  const load = member(r, "load", "object"), values = list(r, "load.per_pe", "number"), mean = num(load, "mean");
  const unit = has(r, "torus") ? "node" : "PE";
  const phases =
    Object.keys(load)
      .filter((key) => has(load, `${key}.imbalance`))
      .map(
        (key) =>
          `${key}: u = ${fixed(num(load, `${key}.imbalance`), 3)}, speed-up ${fixed(num(load, `${key}.speedup`), 1)}`);
  const description = `Load of each ${unit}: modelled cycles, from ${grouped(num(load, "min"))} to ${
    grouped(num(load, "max"))}; the line is the mean, ${grouped(fixed(mean, 1))}.`;
  return [
    paragraph(
      `u = (max − mean) / mean = ${fixed(num(load, "imbalance"), 3)}. The load of a ${
        unit} is the sum over the events of its rays of the cycles that an event costs in the ` +
      `machine's instruction budget.${phases.length ? ` By phase: ${phases.join("; ")}.` : ""}`),
    caption(bars(description, [`number of the ${unit}`, "cycles"], values, mean), description),
    table(
      `Load of each ${unit}`, [unit, "cycles", "of the mean"],
      values.map((value, i) => [String(i), grouped(value), mean > 0 ? percent(value / mean) : "-"]),
      "The report has all loads in `load.per_pe`.")
  ];
}

function traffic(r) {
  if (!has(r, "torus")) return null;
  const links = "torus.bytes_per_link", description = "Bytes over the links of all nodes, by direction on the torus.";
  const packets = member(r, "torus.packets", "object"), directions = list(r, `${links}.by_direction`, "number");
  return [
    tiles([
      ["hops", count(r, "torus.hops")], ["bytes over links", count(r, `${links}.total`)],
      ["busiest link", `${count(r, `${links}.max`)} bytes`],
      ["mean of links", `${fixed(num(r, `${links}.mean`), 0)} bytes`], ["supersteps", count(r, "torus.supersteps")]
    ]),
    caption(
      namedBars(description, directions.map((bytes, i) => ({
                                        name: ["+x", "-x", "+y", "-y", "+z", "-z"][i] ?? "?",
                                        text: `${Number((1e-6 * bytes).toPrecision(3))} MB`,
                                        value: bytes
                                      }))),
      description),
    table(
      "Packets", ["packets", "made", "ended"],
      Object.keys(packets).map((kind) => [kind, count(packets, `${kind}.made`), count(packets, `${kind}.ended`)]))
  ];
}

// --- Counts, device and build

const counts = (r) => [make(
  "div", {class: "tables"},
  Object
    .entries({
      rays: "rays",
      tests: "intersection tests",
      shading: "shading",
      communication: "bus and ring",
    })
    .filter(([key]) => key !== "communication" || has(r, key))
    .map(
      ([key, title]) => table(
        title, [title, "count"],
        Object.keys(member(r, key, "object")).map((name) => [titled(name), count(r, `${key}.${name}`)]))))];

const deviceRows = (r) => ["name", "platform", "version", "driver"].map(
  (key) => [key === "name" ? "device" : key, str(r, `device.${key}`)]);

function deviceAndBuild(r) {
  const used = kilobytes(num(r, "machine.pe_memory_used_bytes")),
        seconds = (object, path) => fixed(num(object, path), 3);
  return [
    definitions([
      ...deviceRows(r), ["lanes, group", `${num(r, "device.lanes")}, ${num(r, "device.group_size")}`],
      ["lanes and group from", str(r, "device.tuned")],
      [
        "memory of a PE",
        has(r, "machine.pe_memory_bytes") ? `${used} of ${kilobytes(num(r, "machine.pe_memory_bytes"))}` :
                                            `${used}, no limit`
      ],
      ["hash of the image", code(str(r, "image.hash"))], ["build options", code(str(r, "device.build_options"))]
    ]),
    has(r, "measured.builds") &&
      part(
        "Builds",
        table(
          "Builds", ["program", "build s"],
          list(r, "measured.builds", "object").map((build) => [str(build, "program"), seconds(build, "seconds")]))),
    has(r, "measured.ranks") &&
      part(
        "Ranks",
        table(
          "Ranks", ["rank", "host", "device", "render s", "waiting s", "messages", "bytes sent"],
          list(r, "measured.ranks", "object")
            .map(
              (rank) =>
                [count(rank, "rank"), str(rank, "host"), str(rank, "device.name"), seconds(rank, "render_s"),
                 seconds(rank, "waiting_s"), count(rank, "messages_sent"), count(rank, "bytes_sent")])))
  ];
}

function showRender(r) {
  heading(() => renderHead(r));
  const torus = has(r, "torus");
  section("pictures", torus ? "Image and nodes" : "Image and owners", () => pictures(r));
  section("loads", torus ? "Load of each node" : "Load of each PE", () => loads(r));
  section("traffic", "Traffic of the links", () => traffic(r));
  section("model", "Modelled and measured", () => model(r));
  section("labels", "Times by label", () => labels(r));
  section("roof", "Roofline", () => roofline(r));
  section("counts", "Counts", () => counts(r));
  section("made", "Device and build", () => deviceAndBuild(r));
}
