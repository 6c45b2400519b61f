// Displays the report embedded in the page. If that fails, shows the error above the JSON.
"use strict";

const SHOWN = {
  "raya render": showRender,
  "raya bench": showBench,
  "raya verify": showVerify,
  "raya gpu_day": showGpuDay,
  "raya explore": showExplorer
};

async function show() {
  const report = JSON.parse($("report").textContent), kind = str(report, "kind");
  if (!Object.hasOwn(SHOWN, kind)) throw new Error(`unknown kind ${kind}`);
  await SHOWN[kind](report);
}

const ready = show().then(
  () => {
    $("json").open = false;
  },
  (problem) => {
    $("head").append(
      message(`This report cannot be shown: ${problem.message}. Below is its JSON.`));
  });
