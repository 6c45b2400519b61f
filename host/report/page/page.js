// Shows the report that the page carries. What cannot be shown is named, and the report stays readable as JSON.
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
  if (!Object.hasOwn(SHOWN, kind)) throw new Error(`its kind is ${kind}, which this page does not know`);
  await SHOWN[kind](report);
}

const ready = show().then(
  () => {
    $("json").open = false;
  },
  (problem) => {
    $("head").append(
      message(`This report cannot be shown: ${problem.message}. Below it is as raya saved it, in JSON.`));
  });
