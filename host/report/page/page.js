// Displays the report that is embedded in the page. If an error occurs, shows its message above the JSON.
"use strict";

// [kind of report]: function that displays it.
const VIEWERS = {
  "raya render": showRender,
  "raya bench": showBench,
  "raya verify": showVerify,
  "raya gpu_day": showGpuDay,
  "raya explore": showExplorer
};

async function show() {
  const report = JSON.parse($("report").textContent), kind = str(report, "kind");
  if (!Object.hasOwn(VIEWERS, kind)) throw new Error(`unknown kind ${kind}`);
  await VIEWERS[kind](report);
}

const ready = show().then(
  () => {
    $("json").open = false;
  },
  (problem) => {
    $("head").append(
      message(`This report cannot be shown: ${problem.message}. Below is its JSON.`));
  });
