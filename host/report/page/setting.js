// Converts the mapping and the number of PEs between three forms: the machine of a report, raya's options, and links
// such as #mapping=cyclic:16&pes=256. This file does not depend on the page.
//
// A state is {mapping, offset, fold, pes, grid: [A, B], tile: [w, h], seed, view, pe}. It has the parameters of all
// mappings, not only of the selected one. pe: the highlighted PE, or null.
"use strict";

const MAPPINGS = ["cyclic", "column", "rows", "blocks", "grid", "tiles", "random"];
const VIEWS = ["owners", "loads", "costs", "picture"];
const divisorsOf = (side) => Array.from({length: side}, (_, i) => i + 1).filter((d) => side % d === 0);
const pairOf = (text) => /^\d{1,5}x\d{1,5}$/.test(text) ? text.split("x").map(Number) : null;
const roundedSquareRoot = (pes) => Math.round(Math.sqrt(pes));

// Returns the initial state for the machine of a report. The mappings that the machine does not use have default
// parameters: the offset of the paper, the grid that is closest to a square, tiles of up to 8 x 8 pixels.
function stateOf(machine, {width, height}) {
  const [mapping, parameter] = str(machine, "mapping").split(":"), pes = whole(machine, "pes"),
                  slots = mapping === "cyclic" || mapping === "column";
  if (!MAPPINGS.includes(mapping)) throw new Error(`unknown machine.mapping ${mapping}`);
  if (pes > width * height) throw new Error("machine.pes is larger than the number of pixels");
  const divisor = (number, limit) => {  // returns the largest divisor up to `limit`
    while (number % limit !== 0) --limit;
    return limit;
  };
  const rows = divisor(pes, Math.floor(Math.sqrt(pes)));
  return {
    mapping,
    offset: slots ? num(machine, "offset") : roundedSquareRoot(pes) % width,
    fold: slots ? str(machine, "fold") : "cyclic",
    pes,
    grid: mapping === "grid" && pairOf(parameter) || [rows, pes / rows],
    tile: mapping === "tiles" && pairOf(parameter) || [divisor(width, 8), divisor(height, 8)],
    seed: mapping === "random" ? Number(parameter) : 1,
    view: "owners",
    pe: null
  };
}

// Returns the setting for model.js.
function settingOf(state) {
  const slots = state.mapping === "cyclic" || state.mapping === "column";
  const [a, b] = state.mapping === "grid" ? state.grid : state.mapping === "tiles" ? state.tile : [0, 0];
  return {
    kind: slots ? "slots" : state.mapping,
    offset: state.mapping === "cyclic" ? state.offset : 0,
    fold: state.fold,
    pes: state.mapping === "grid" ? a * b : state.pes,
    a,
    b,
    seed: state.seed
  };
}

// Returns the value of --mapping.
function mappingText(state) {
  const parameter = {
    cyclic: () => `:${state.offset}`,
    grid: () => `:${state.grid.join("x")}`,
    tiles: () => `:${state.tile.join("x")}`,
    random: () => `:${state.seed}`
  }[state.mapping];
  return state.mapping + (parameter ? parameter() : "");
}

function linkText(state) {
  const setting = settingOf(state), parts = [`mapping=${mappingText(state)}`, `pes=${setting.pes}`];
  if (setting.kind === "slots" && state.fold !== "cyclic") parts.push(`fold=${state.fold}`);
  if (state.view !== "owners") parts.push(`view=${state.view}`);
  if (state.pe !== null) parts.push(`pe=${state.pe}`);
  return "#" + parts.join("&");
}

function optionsText(state) {
  const setting = settingOf(state);
  const fold = setting.kind === "slots" && state.fold !== "cyclic" ? ` --fold ${state.fold}` : "";
  return `--mapping ${mappingText(state)} --pes ${setting.pes}${fold}`;
}

// Returns `state` with the values of a link, and error messages for invalid values, which do not change the state.
function withLink(state, link, {width, height}) {
  const next = {...state}, problems = [], pixels = width * height;
  const values = new Map(link.replace(/^#/, "").split("&").filter(Boolean).map((part) => part.split("=", 2)));
  const takeNumber = (text, min, max, subject) => {
    if (/^\d{1,10}$/.test(text) && Number(text) >= min && Number(text) <= max) return Number(text);
    problems.push(`${subject} must be ${min} to ${max}`);
    return null;
  };
  const takeName = (text, names, subject) => {
    if (names.includes(text)) return text;
    problems.push(`${subject} must be ${names.join(", ")}`);
    return null;
  };

  const takeMapping = (text) => {
    const [name, parameter] = text.split(":", 2), sides = pairOf(parameter || "");
    if (takeName(name, MAPPINGS, "the mapping") === null) return;
    if (name === "grid" && !(sides && sides[0] > 0 && sides[1] > 0 && sides[0] * sides[1] <= pixels))
      return problems.push(`a grid is AxB with 1 to ${pixels} PEs`);
    if (name === "tiles" && !(sides && width % sides[0] === 0 && height % sides[1] === 0))
      return problems.push(`the sides of a tile must divide ${width} and ${height}`);
    if (name === "cyclic" && parameter !== undefined)
      next.offset = takeNumber(parameter, 0, width - 1, "the offset p") ?? next.offset;
    if (name === "random" && parameter !== undefined)
      next.seed = takeNumber(parameter, 0, 2 ** 32 - 1, "the seed") ?? next.seed;
    if (name === "grid") next.grid = sides;
    if (name === "tiles") next.tile = sides;
    next.mapping = name;
  };
  if (values.has("mapping")) {
    next.fold = "cyclic";  // the default, which links omit
    takeMapping(values.get("mapping") ?? "");
  }
  if (values.has("fold")) next.fold = takeName(values.get("fold"), ["cyclic", "block"], "the fold") ?? next.fold;
  if (values.has("view")) next.view = takeName(values.get("view"), VIEWS, "the view") ?? next.view;
  if (values.has("pes") && next.mapping !== "grid")
    next.pes = takeNumber(values.get("pes") ?? "", 1, pixels, "the number of PEs") ?? next.pes;
  if (values.has("pe")) next.pe = takeNumber(values.get("pe") ?? "", 0, settingOf(next).pes - 1, "the PE to show");
  return {state: next, problems};
}
