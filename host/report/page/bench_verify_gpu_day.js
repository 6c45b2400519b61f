// Pages of the reports of `raya bench`, `raya verify` and `tools/gpu_day`.
"use strict";

// --- raya bench

const rate = (mrays) => fixed(mrays, mrays < 10 ? 2 : 1);
const rowName = (row) =>
  `${str(row, "kernel")}, ${str(row, "format")}, ${num(row, "lanes")} lanes, group ${num(row, "group")}`;
const rowCells = (row) => [str(row, "kernel"), str(row, "format"), count(row, "lanes"), count(row, "group")];

// Returns the section of the rates. compared.rows begins with the rows of this run, in the order of the report
// (compare_bench()).
function rates(r, rows) {
  const compared = has(r, "compared") ? list(r, "compared.rows", "object") : [];
  const description = `Rays per second, medians of the samples${compared.length ? "; lines: the baseline" : ""}.`;
  return [
    caption(
      namedBars(description, rows.map((row, i) => ({
                                  name: rowName(row),
                                  text: `${rate(num(row, "mrays_per_s.median"))} Mrays/s`,
                                  value: row.mrays_per_s.median,
                                  mark: compared[i] && has(compared[i], "mrays_per_s_was") ?
                                    num(compared[i], "mrays_per_s_was.median") :
                                    undefined
                                }))),
      description),
    table(
      "Rates",
      ["kernel", "format", "lanes", "group", "Mrays/s best", "median", "ms best", "median", "samples", "image"],
      rows.map(
        (row) =>
          [...rowCells(row), rate(num(row, "mrays_per_s.best")), rate(num(row, "mrays_per_s.median")),
           fixed(num(row, "ms.best"), 2), fixed(num(row, "ms.median"), 2), count(row, "samples"),
           str(row, "hash").slice(0, 8)])),
    note(
      "image: first digits of its hash, which is equal in all rows of a format; otherwise raya bench fails.")
  ];
}

function comparison(r) {
  if (!has(r, "compared"))
    return [paragraph("No baseline; ", code("raya bench --compare"), " compares a run with one.")];
  const c = member(r, "compared", "object"), rateHeader = ["best Mrays/s", "was", "change", "median", "was", "change"];
  const kindOf = (text) => /^(OTHER IMAGE|SLOWER$)/.test(text) ? "no" :
    ["faster", "as before"].includes(text)                     ? "yes" :
                                                                 "open";
  // Returns the cells with a rate of both runs and its change. key: "best" or "median".
  const rateCells = (row, key) => {
    const [now, was] =
      ["mrays_per_s", "mrays_per_s_was"].map((name) => has(row, name) ? num(row, `${name}.${key}`) : null);
    const change = 100 * (now / was - 1);
    return [
      now === null ? "-" : rate(now), was === null ? "-" : rate(was),
      now === null || was === null ? "-" : `${change < 0 ? "" : "+"}${fixed(change, 1)} %`
    ];
  };
  return [
    paragraph(
      `Compared with ${str(c, "baseline")}: of ${num(c, "compared")} common rows, ${
        num(c, "slower")} slower by more than ${num(c, "tolerance_percent")} %, ` +
      `${num(c, "other_images")} with another image.`),
    list(c, "remarks", "text").map(message),
    table(
      "Comparison with the baseline", ["kernel", "format", "lanes", "group", ...rateHeader, "verdict"],
      list(c, "rows", "object")
        .map(
          (row) =>
            [...rowCells(row), ...rateCells(row, "best"), ...rateCells(row, "median"),
             verdict(kindOf(str(row, "verdict")), row.verdict)]))
  ];
}

// Returns a chart for each number format, because a peak is measured for one format.
function rooflines(rows) {
  const formats = new Map(), shown = [];
  for (const row of rows) {
    if (has(row, "no_roofline")) shown.push(paragraph(`${rowName(row)}: no roofline: ${str(row, "no_roofline")}.`));
    if (!has(row, "roofline") || !has(row, "peak")) continue;
    const format = str(row, "peak.format");
    formats.set(format, [...formats.get(format) ?? [], row]);
  }
  for (const [format, formatRows] of formats)
    shown.push(...part(
      `In ${format}`,
      ...rooflineOf(
        member(formatRows.at(-1), "peak", "object"),
        formatRows.map((row) => [rowName(row), member(row, "roofline", "object")])),
      formatRows.length > 1 &&
        note(
          "Percentages refer to the peak measured with the row's own lanes; chart and text show the peak of the last row.")));
  return shown.length ?
    shown :
    [paragraph(
      "The device's peak was not measured; ", code("raya bench --page"), " measures it, for rows of one kernel.")];
}

function showBench(r) {
  const rows = list(r, "rows", "object");
  if (rows.length === 0) throw new Error("rows is empty");
  const best = rows.reduce((a, b) => num(b, "mrays_per_s.best") > num(a, "mrays_per_s.best") ? b : a);
  head(
    "raya bench", `${str(rows[0], "scene")} on ${str(r, "device.name")}`,
    paragraph(`${str(rows[0], "size")} pixels, ${str(rows[0], "array")}, ${count(rows[0], "rays")} rays an image.`),
    tiles([
      ["best rate", `${rate(num(best, "mrays_per_s.best"))} Mrays/s`], ["best row", rowName(best)],
      ["rows", String(rows.length)]
    ]));
  section("rates", "Rates", () => rates(r, rows));
  section("compared", "Comparison with the baseline", () => comparison(r));
  section("roof", "Roofline", () => rooflines(rows));
  section(
    "made", "Device and build",
    () =>
      [definitions(deviceRows(r)),
       part(
         "Build options",
         definitions(rows.map((row) => [rowName(row), code(str(row, "build_options"))]), {class: "long"}))]);
}

// --- raya verify

function failure(check) {
  const block = (title, key) => str(check, key) && [make("h4", {}, title), make("pre", {tabindex: 0}, check[key])];
  const remedies = list(check, "remedies", "text");
  return [
    paragraph(verdict("no", "FAIL"), ` ${str(check, "layer")} ${str(check, "name")}: `, prose(str(check, "result"))),
    block("Where", "where"), block("Expected", "expected"), block("Got", "got"),
    block("Build options", "build_options"),
    remedies.length > 0 &&
      [make("h4", {}, "Remedies"), make("ul", {}, remedies.map((remedy) => make("li", {}, prose(remedy))))]
  ].flat(2)
    .filter(Boolean);
}

function deviceChecks(device) {
  const checks = list(device, "checks", "object"), failed = checks.find((check) => str(check, "status") === "FAIL");
  const rows = checks.map(
    (check) =>
      [verdict({PASS: "yes", FAIL: "no", XPASS: "no"}[str(check, "status")] ?? "open", check.status), str(check, "layer"),
       str(check, "name"), fixed(num(check, "seconds"), 2), str(check, "result").slice(0, 300)]);
  return [
    tiles([
      ["passed", count(device, "passed")], ["failed", count(device, "failed")], ["skipped", count(device, "skipped")],
      ["took", `${fixed(num(device, "seconds"), 1)} s`]
    ]),
    definitions([
      ...["platform", "version", "driver"].map((key) => [key, str(device, key)]),
      ...(has(device, "pci_address") ? [["PCI address", str(device, "pci_address")]] : [])
    ]),
    failed ? part("First failure", ...failure(failed)) : [],
    part(
      "All checks",
      ...rows.length ?
        table(`All checks on ${str(device, "name")}`, ["status", "layer", "check", "seconds", "result"], rows) :
        [paragraph("No check ran.")])
  ];
}

function showVerify(r) {
  const devices = list(r, "devices", "object");
  const deviceVerdict = (device) => num(device, "failed") > 0 ? verdict("no", "failed") :
    num(device, "passed") === 0                               ? verdict("open", "was not checked") :
                                                                verdict("yes", "passed every check that ran");
  head(
    "raya verify", devices.length === 1 ? str(devices[0], "name") : `${devices.length} devices`,
    devices.map((device) => paragraph(`${str(device, "name")} `, deviceVerdict(device), ".")),
    note(`Depth: ${
      str(r, "depth")}. Each layer relies on the layers before it, so the first failure is nearest to the cause.`));
  devices.forEach((device, i) => section(`device-${i + 1}`, str(device, "name"), () => deviceChecks(device)));
}

// --- tools/gpu_day

const stepKind = (step) => str(step, "verdict") === "right" ? "yes" :
  step.verdict.startsWith("not here")                       ? "open" :
                                                              "no";

function goalRows(r) {
  const goals = list(r, "goals", "object"), description = "Best rates of the trace kernel; lines: goals.";
  const measured = goals.filter((goal) => has(goal, "measured"));
  return [
    measured.length > 0 &&
      caption(
        namedBars(description, measured.map((goal) => ({
                                        name: str(goal, "what"),
                                        text: `${rate(num(goal, "measured"))} Mrays/s`,
                                        value: goal.measured,
                                        mark: num(goal, "asked")
                                      }))),
        description),
    table(
      "Goals", ["kernel", "goal, Mrays/s", "measured", "verdict"],
      goals.map(
        (goal) =>
          [str(goal, "what"), rate(num(goal, "asked")), has(goal, "measured") ? rate(num(goal, "measured")) : "-",
           !has(goal, "measured")        ? verdict("open", "not measured") :
             goal.measured >= goal.asked ? verdict("yes", "reached") :
                                           verdict("no", "missed")]))
  ];
}

function stageRows(r, steps) {
  const rows = list(r, "stages", "object").map((stage, i) => {
    const stageSteps = steps.filter((step) => num(step, "stage") === i + 1), kinds = stageSteps.map(stepKind),
          countOf = (kind) => String(kinds.filter((k) => k === kind).length);
    return [
      String(i + 1), str(stage, "name") + (stage.done ? "" : " (not done)"), countOf("yes"), countOf("no"),
      countOf("open"), grouped(sum(stageSteps.map((step) => num(step, "seconds"))))
    ];
  });
  return [table("Stages", ["stage", "what", "right", "wrong", "not here", "s"], rows)];
}

const stepText = (step) =>
  str(step, "command") && make("pre", {tabindex: 0}, `$ ${step.command}\n${str(step, "output")}`);

function showGpuDay(r) {
  const steps = list(r, "steps", "object"), stepsOf = (kind) => steps.filter((step) => stepKind(step) === kind),
        wrong = stepsOf("no");
  head(
    "raya gpu_day", str(r, "device") || "no device",
    paragraph(`${str(r, "raya")}, ${str(r, "date")}, ${str(r, "system")}.`),
    r.small === true && message("Small images: the rates are not meaningful."), tiles([
      ["steps right", String(stepsOf("yes").length)], ["wrong", String(wrong.length)],
      ["not here", String(stepsOf("open").length)]
    ]));
  section(
    "wrong", "Wrong",
    () => wrong.length === 0 ?
      [paragraph("No step failed.")] :
      wrong.map((step) => [paragraph(verdict("no", str(step, "name")), `: ${step.verdict}`), stepText(step)]).flat());
  section("goals", "Goals", () => goalRows(r));
  section("stages", "Stages", () => stageRows(r, steps));
  section(
    "said", "Rates and rooflines",
    () => steps.filter((step) => /^(verify|bench|roofline|goal|large|ranks|tune)/.test(step.name) && stepText(step))
            .map((step) => make("details", {}, make("summary", {}, step.name), stepText(step))));
  section(
    "steps", "All steps",
    () => [table(
      "All steps", ["step", "stage", "verdict", "s"],
      steps.map(
        (step) =>
          [str(step, "name"), count(step, "stage"), verdict(stepKind(step), step.verdict), count(step, "seconds")]))]);
}
