// Modelled and measured times of a render, and rooflines.
"use strict";

// Each row: name of the part, member of modelled_ms, meaning, pattern for the labels of the corresponding commands.
const RING_PARTS = [
  ["objects", "objects", "the scene over the bus to all PEs", /^bus\.broadcast/],
  ["compute", "compute", "tracing, and anti-aliasing", /^(trace|supersample|filter\.)/],
  ["compute: filter", "filter", "sums and means of neighbours", /^filter\./],
  ["compute: compare", "compare", "finding pixels that differ from a neighbour", /^supersample\.compare/],
  ["communication", "communication", "neighbouring pixels over ring or bus", /^(ring\.|bus\.send|bus\.pe)/],
  ["image", "image", "pixels to the host", /^bus\.gather/],
  ["display", "display", "the image on the host's screen", /^$/]
];
const TORUS_PARTS = [
  ["compute", "compute", "the busiest processor: generating and tracing packets", /^(inject|trace_voxel)/],
  ["messages", "messages", "the busiest processor: handling packets", /^(route|read status|accept)/],
  ["links", "links", "the busiest link", /^(exchange|return)/]
];

function model(r) {
  const torus = has(r, "torus"), machine = torus ? "the torus of T805s" : str(r, "machine.name");
  const commands = list(r, "measured.commands", "object"), rows = [],
        ms = (key) => msText(num(r, `modelled_ms.${key}`));
  for (const [name, key, what, labels] of torus ? TORUS_PARTS : RING_PARTS) {
    const partCommands = commands.filter((command) => labels.test(str(command, "label")));
    if (name.startsWith("compute: ") && num(r, `modelled_ms.${key}`) === 0 && partCommands.length === 0) continue;
    rows.push([
      name, what, ms(key),
      partCommands.length ? msText(1e-6 * sum(partCommands.map((command) => num(command, "total_ns")))) : "-",
      [...new Set(partCommands.map((command) => command.label))].join(", ")
    ]);
  }
  const measured = [msText(1e3 * num(r, "measured.render_s")), "the whole render on the host's clock"];
  if (torus) {
    rows.push(
      ["whole, if nothing waits", "a lower bound", ms("overlapped"), "-", ""],
      ["whole, step by step", "an upper bound", ms("stepwise"), ...measured]);
    if (has(r, "modelled_ms.asynchronous"))
      rows.push(["whole, without supersteps", "simulated packet by packet", ms("asynchronous.finish"), "-", ""]);
  } else
    rows.push(["whole", "the sum; compute includes the parts named \"compute: ...\"", ms("total"), ...measured]);
  return [
    paragraph(`Modelled time of ${
      machine} at its own rates, next to the measured time of this device's corresponding commands.`),
    table("Modelled and measured time", ["part", "what", "modelled", "measured here", "commands here"], rows)
  ];
}

function labels(r) {
  const commands = list(r, "measured.commands", "object"),
        total = sum(commands.map((command) => num(command, "total_ns")));
  if (commands.length === 0) return [paragraph("The device does not time its commands.")];
  const ms = (command, key) => fixed(1e-6 * num(command, key), 3),
        description = "Commands of the device with the longest total times.";
  const longest = [...commands].sort((a, b) => b.total_ns - a.total_ns).slice(0, 8);
  return [
    paragraph(
      `On the host's clock the build of the kernels took ${timeText(1e3 * num(r, "measured.build_s"))}, and the render ${
        timeText(1e3 * num(r, "measured.render_s"))}. ` +
      "Times of commands are the device's, from start to end."),
    caption(
      namedBars(description, longest.map((command) => ({
                                     name: `${str(command, "label")} (${str(command, "kind")})`,
                                     text: `${ms(command, "total_ns")} ms`,
                                     value: command.total_ns
                                   }))),
      description),
    table(
      "Times by label", ["label", "kind", "launches", "total ms", "share", "minimum ms", "mean ms", "maximum ms", "MB"],
      commands.map(
        (command) =>
          [str(command, "label"), str(command, "kind"), count(command, "launches"), ms(command, "total_ns"),
           percent(total > 0 ? command.total_ns / total : 0), ms(command, "min_ns"), ms(command, "mean_ns"),
           ms(command, "max_ns"),
           has(command, "bytes") && num(command, "bytes") ? fixed(1e-6 * command.bytes, 3) : "-"]))
  ];
}

// Returns a roofline chart and a table. rows: [name, row of the report].
function rooflineOf(peak, rows) {
  const format = str(peak, "format"), points = [], giga = (path, digits = 2) => fixed(1e-9 * num(peak, path), digits);
  const cells = rows.map(([name, row]) => {
    const operations = num(row, "operations_per_s"), intensity = num(row, "operations_per_byte"),
          rays = num(row, "rays_per_s");
    if (operations > 0 && intensity > 0) points.push([intensity, 1e-9 * operations]);
    return [
      operations > 0 && intensity > 0 ? String(points.length) : "-", name, rays > 0 ? fixed(1e-6 * rays, 2) : "-",
      operations > 0 ? fixed(1e-9 * operations, 3) : "-", fixed(1e-9 * num(row, "bytes_per_s"), 3),
      intensity > 0 ? String(Number(intensity.toPrecision(3))) : "-", str(row, "bound"),
      percent(num(row, "share_of_roof"), 2), has(row, "share_of_format") ? percent(num(row, "share_of_format"), 2) : "-"
    ];
  });
  const tops = [["multiply-adds in fp32", 1e-9 * num(peak, "fp32_multiply_adds_per_s")]];
  if (format !== "fp32") tops.push([`in ${format}`, 1e-9 * num(peak, "format_multiply_adds_per_s")]);
  const slope = 1e-9 * num(peak, "copy_bytes_per_s");
  if (![slope, ...tops.map(([, top]) => top)].every((rate) => rate > 0))
    throw new Error("peak has a rate that is not above 0");
  const description =
    "Kernels, numbered as in the table, below the device's roof: the rate of copies, or the rate of multiply-adds.";
  return [
    caption(roof(description, slope, tops, points), description),
    table(
      "Roofline", ["no.", "kernel", "Mrays/s", "Gop/s", "GB/s", "op/byte", "bound", "of the roof", "of the format"],
      cells),
    paragraph(
      `The peak was measured by small programs in the same run: ${
        giga("fp32_multiply_adds_per_s")} Gop/s of multiply-adds in fp32; in ${format} ` +
      `${giga("format_multiply_adds_per_s")} of multiply-adds, ${giga("format_divisions_per_s")} of divisions, ${
        giga("format_roots_per_s")} of square roots; ` +
      `${
        giga(
          "copy_bytes_per_s")} GB/s copied, each byte counted as read and as written. Operations are those in the budgets of the counted events; bytes are the ` +
      "minimum that the kernel has to move."),
    num(peak, "scatter") > 0.15 &&
      message(`Three measurements of the peak differ by ${
        percent(peak.scatter, 0)}: other programs used the device, and percentages of the peak are unreliable.`)
  ];
}

function roofline(r) {
  if (has(r, "measured.no_roofline")) return [paragraph(`No roofline: ${str(r, "measured.no_roofline")}.`)];
  if (!has(r, "measured.peak"))
    return [paragraph(
      "The device's peak was not measured; ", code("raya render --page"), " and ", code("--profile"), " measure it.")];
  const ranks = has(r, "measured.ranks") ? list(r, "measured.ranks", "object").filter((rank) => has(rank, "peak")) : [],
        ofKernels = (owner) => rooflineOf(
          member(owner, "peak", "object"), list(owner, "roofline", "object").map((row) => [str(row, "label"), row]));
  if (ranks.length === 0) return ofKernels(member(r, "measured", "object"));
  return ranks
    .map(
      (rank) => part(
        `Rank ${num(rank, "rank")} on ${str(rank, "host")}, ${str(rank, "device.name")}`, ...ofKernels(rank)))
    .flat();
}
