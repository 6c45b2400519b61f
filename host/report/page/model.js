// Computes owners, loads and other figures of a setting. The results equal raya's in every digit (host/ring/mapping.cpp,
// host/model/); tests/tools/test_pages.py compares them. JavaScript's numbers are exact for integers below 2^53. This
// file does not depend on the page, except on the functions of kernels/shared/mapping.h that page.cpp translates.
//
// A setting is {kind, offset, fold, pes, a, b, seed}. kind: "slots", "rows", "blocks", "grid", "tiles" or "random". a
// and b: numbers of rows and columns of a grid, or width and height of a tile in pixels.
"use strict";

// --- Owners of pixels

// Returns the mapping of a setting for the functions of kernels/shared/mapping.h, which are in the page as JavaScript.
function mappingOf({kind, offset, fold, pes, a, b, seed}, {width, height}) {
  const kinds = {slots: fold === "block" ? RAYA_FOLD_BLOCK : RAYA_FOLD_CYCLIC, rows: RAYA_ROWS, blocks: RAYA_BLOCKS,
                 grid: RAYA_GRID, tiles: RAYA_TILES, random: RAYA_RANDOM};
  const parameters = {slots: offset, grid: raya_pair(a, b), tiles: raya_pair(a, b), random: seed};
  return {width, height, pes, kind: kinds[kind], parameter: parameters[kind] || 0};
}

// Returns the PE of each pixel, row by row.
function ownersOf(setting, size) {
  const {width, height} = size, mapping = mappingOf(setting, size), owners = new Int32Array(width * height);
  for (let row = 0, at = 0; row < height; ++row)
    for (let column = 0; column < width; ++column, ++at) owners[at] = raya_owner(mapping, row, column);
  return owners;
}

// --- Loads

function loadsOf(owners, costs, pes) {
  const loads = new Float64Array(pes);
  for (let at = 0; at < owners.length; ++at) loads[owners[at]] += costs[at];
  return loads;
}

// Uses the formulas of host/model/t805.cpp, in the same order of operations.
function balanceOf(loads) {
  const pes = loads.length;
  let sum = 0, busiest = 0, idlest = 0;
  for (let pe = 0; pe < pes; ++pe) {
    sum += loads[pe];
    if (loads[pe] > loads[busiest]) busiest = pe;
    if (loads[pe] < loads[idlest]) idlest = pe;
  }
  const max = loads[busiest], mean = sum / pes, speedup = sum > 0 ? sum / max : pes;
  return {
    sum,
    max,
    mean,
    busiest,
    idlest,
    imbalance: sum > 0 ? (max - mean) / mean : 0,
    speedup,
    efficiency: speedup / pes
  };
}

// Computes the imbalance u of the offsets from `first` on until time `deadline`, and writes the values to the members
// of `curves`: cyclic, and block if it exists. Returns the first offset that is not computed.
function addToCurves(curves, costs, size, pes, first, deadline) {
  const {width, height} = size, settings = Object.keys(curves).map((fold) => ({kind: "slots", offset: 0, fold, pes}));
  const ownersOfSlots = settings.map((setting) => ownersOf(setting, {width, height: 1}));
  const slots = new Float64Array(width);
  let offset = first;
  for (; offset < width && performance.now() < deadline; ++offset) {
    // If P <= W, every PE owns whole slots, so the PEs' loads are sums of the slots' loads for both folds.
    if (pes <= width) {
      slots.fill(0);
      for (let row = 0, begin = 0, at = 0; row < height; ++row, at += width) {
        for (let slot = 0, column = begin; slot < width; ++slot, ++column)
          slots[slot] += costs[at + (column < width ? column : column - width)];
        begin = (begin + offset) % width;
      }
    }
    settings.forEach((setting, k) => {
      const loads = pes <= width ? loadsOf(ownersOfSlots[k], slots, pes) :
                                   loadsOf(ownersOf({...setting, offset}, size), costs, pes);
      curves[setting.fold][offset] = balanceOf(loads).imbalance;
    });
  }
  return offset;
}

// --- Neighbours

// Returns an array for each of the left, right, upper and lower neighbour. Element d is 1 if there is a pixel such that
// the pixel's owner is PE i and the neighbour's owner is PE (i + d) mod P.
function distancesOf(owners, {width, height}, pes) {
  const [left, right, above, below] = [0, 1, 2, 3].map(() => new Uint8Array(pes));
  const distance = (pe, origin) => pe >= origin ? pe - origin : pe + pes - origin;
  for (let row = 0, at = 0; row < height; ++row)
    for (let column = 0; column < width; ++column, ++at) {
      const owner = owners[at];
      if (column > 0) left[distance(owners[at - 1], owner)] = right[distance(owner, owners[at - 1])] = 1;
      if (row > 0) above[distance(owners[at - width], owner)] = below[distance(owner, owners[at - width])] = 1;
    }
  return [left, right, above, below];
}

// Returns the minimum number of rotations (circular shifts) that cover all distances: some distances in one direction,
// the others in the opposite direction. found: result of distancesOf() for one neighbour.
function rotationsOf(found) {
  const pes = found.length, distances = [];
  for (let d = 0; d < pes; ++d)
    if (found[d]) distances.push(d);
  if (distances.length === 0) return 0;
  let minimum = Infinity;
  for (let n = 0; n <= distances.length; ++n)
    minimum = Math.min(minimum, (n ? distances[n - 1] : 0) + (n < distances.length ? pes - distances[n] : 0));
  return minimum;
}

// Returns the numbers of rotations of the ring, transfers over the bus, and broadcasts over the bus that the 3 x 3
// filter needs; each of the three kinds suffices alone.
function movesOf(owners, size, pes) {
  const moves = {rotations: 0, transfers: 0, broadcasts: 0};
  for (const found of distancesOf(owners, size, pes)) {
    let otherPes = 0;  // number of other PEs from which a PE needs pixels
    for (let d = 1; d < pes; ++d) otherPes += found[d];
    moves.rotations += rotationsOf(found);
    moves.transfers += otherPes * pes;
    moves.broadcasts += otherPes > 0 ? pes : 0;
  }
  return moves;
}

// --- Lattices

// Returns a shortest vector [rows down, columns to the right] of the lattice columns = rows * offset mod side.
function shortestVector(offset, side) {
  let shortest = [0, side], squaredLength = side * side;
  for (let rows = 1; rows * rows < squaredLength; ++rows) {
    const right = rows * offset % side, columns = right <= side - right ? right : right - side;
    if (rows * rows + columns * columns < squaredLength)
      [shortest, squaredLength] = [[rows, columns], rows * rows + columns * columns];
  }
  return shortest;
}

// Returns the shortest vector between pixels of a PE; null if they do not form a lattice.
function vectorOf({kind, fold, offset, pes, a, b}, {width}) {
  if (kind === "slots" && (fold === "cyclic" ? width % pes === 0 : width === pes))
    return shortestVector(offset % pes, pes);
  if (kind === "rows") return [0, 1];
  if (kind === "grid") return b <= a ? [0, b] : [a, 0];
  return null;
}

// --- All figures of a setting

function figuresOf(setting, size, costs, rates) {
  const owners = ownersOf(setting, size), loads = loadsOf(owners, costs, setting.pes),
        sizes = new Int32Array(setting.pes);
  for (const pe of owners) ++sizes[pe];
  const maxShare = sizes.reduce((max, pixels) => Math.max(max, pixels), 0);
  const balance = balanceOf(loads), moves = movesOf(owners, size, setting.pes);
  const figures =
    {setting, owners, loads, sizes, maxShare, ...balance, ...moves, vector: vectorOf(setting, size), time: null};
  // As in host/model/t805.cpp.
  const words = moves.rotations * 3 * maxShare, moving = moves.rotations > 0;
  figures.time = {
    compute: 1e-6 * rates.cycle_ns * rates.cycle_factor * balance.max,
    rotations: (moving ? rates.setup_ms : 0) + moves.rotations * rates.rotation_sync_ms +
      1e3 * words / rates.link_words_per_s
  };
  return figures;
}

// --- As text

// Formats `value` with `digits` decimals as raya does: ties are rounded to even, whereas toFixed() rounds ties up. 100
// decimals represent doubles of typical magnitude exactly.
function fixed(value, digits) {
  const exact = value.toFixed(100), point = exact.indexOf("."), cut = point + 1 + digits;
  if (!/^50*$/.test(exact.slice(cut))) return value.toFixed(digits);
  const truncated = exact.slice(0, digits ? cut : point);
  return Number(truncated.at(-1)) % 2 === 0 ? truncated : value.toFixed(digits);
}

// Groups thousands with narrow no-break spaces.
const grouped = (number) => String(number).replace(/\B(?=(\d{3})+(\.|$))(?<!\.\d*)/g, "\u202f");

// Formats a time as time_text() in host/model/number_format.cpp does.
function timeText(ms) {
  const units = [[1e4, 1, "ms"], [6e5, 1e3, "s"], [3.6e7, 6e4, "min"], [Infinity, 3.6e6, "h"]];
  const [, unit, name] = units.find(([below]) => ms < below);
  return `${fixed(ms / unit, 1)} ${name}`;
}

function vectorText(vector) {
  if (!vector) return "not a lattice";
  const [rows, columns] = vector;
  const across = columns === 0 ? "" : `, ${Math.abs(columns)} ${columns > 0 ? "right" : "left"}`;
  return `${fixed(Math.sqrt(rows * rows + columns * columns), 2)} pixels (${rows} down${across})`;
}

function textsOf(f) {
  return {
    u: fixed(f.imbalance, 3),
    speedup: `${fixed(f.speedup, 1)} of ${f.setting.pes}`,
    efficiency: `${fixed(100 * f.efficiency, 1)} %`,
    busiest: `${grouped(f.max)} cycles (PE ${f.busiest})`,
    mean: `${grouped(fixed(f.mean, 1))} cycles`,
    idlest: `${grouped(f.loads[f.idlest])} cycles (PE ${f.idlest})`,
    vector: vectorText(f.vector),
    rotations: `${grouped(f.rotations)} rotations of ${grouped(3 * f.maxShare)} words`,
    bus: `${grouped(f.transfers)} transfers or ${grouped(f.broadcasts)} broadcasts`,
    time: f.time ? `${timeText(f.time.compute)} to trace, ${timeText(f.time.rotations)} to rotate` :
                   "unknown for this machine",
  };
}
