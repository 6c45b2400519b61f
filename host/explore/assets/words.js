// What is seen, in words, for those who see it and those who do not.
"use strict";

// Beside the drawings, and in their place; pe and cells: what the close-up shows.
function say(page, {pe, cells}) {
  const {figures: f, state, curves, focus} = page, texts = textsOf(f), {best} = curves, setting = mappingText(state);
  const label = (id, text) => $(id).setAttribute("aria-label", text);
  $("view-words").textContent = VIEW_WORDS[state.view](f, page.most);
  const parts = focus !== null && f.mean > 0 ? fixed(f.loads[focus] / f.mean, 2) : 0;
  let owns = "";
  if (focus !== null)
    owns = `PE ${focus} owns ${grouped(f.sizes[focus])} pixels and has ${grouped(f.loads[focus])} cycles to do, ` +
      `${parts} of the mean.`;
  $("pointed").textContent = focus === null || page.hovered === null ? owns : `${page.pointed} ${owns}`;
  label("picture", `The picture, coloured by ${state.view}. ${setting} on ${f.setting.pes} PEs. ${owns}`);
  label("bars", `Loads of ${f.setting.pes} PEs: from ${texts.idlest} to ${texts.busiest}, mean ${texts.mean}.`);
  const least = best ? `least ${fixed(best.u, 3)} at p = ${best.offset}, fold ${best.fold}` : "not all computed yet";
  label("curves", `u over the offsets 0 to ${page.about.width - 1}, now ${texts.u}; ${least}.`);
  const close = `${cells} × ${cells} pixels of the middle of the picture, those of PE ${pe} in white`;
  label("close-up", `${close}. Shortest vector: ${texts.vector}.`);
  $("close-words").textContent = `The close-up shows ${close}. ` +
    (f.vector ? `The arrow is the shortest vector of its lattice: ${texts.vector}.` : "Its pixels are no lattice.");
  const fold = curves.values.block ? `, fold ${best?.fold}` : "";
  $("best-words").textContent = best ? `Circle: the least, ${fixed(best.u, 3)} at p = ${best.offset}${fold}.` : "";
  $("block-key").hidden = !curves.values.block;
  $("best").disabled = !best;
  if (!best) return;
  const own = (state.fold === "block" && curves.values.block) || curves.values.cyclic;  // of the fold that is chosen
  const offset = own.indexOf(own.reduce((a, u) => Math.min(a, u)));
  $("best").textContent = `best here: p = ${offset}`;
  $("best").dataset.offset = offset;
}

// The curves as a table.
function writeTable({curves: {values: {cyclic, block}}}) {
  const cell = (tag, text) => Object.assign(document.createElement(tag), {textContent: text, className: "n"});
  const head = ["p", ...(block ? ["u, fold cyclic", "u, fold block"] : ["u"])].map((text) => cell("th", text));
  for (const element of head) element.scope = "col";
  const table = $("offsets").querySelector("table");
  table.tHead.rows[0].replaceChildren(...head);
  table.tBodies[0].replaceChildren(...Array.from(cyclic, (u, p) => {
    const row = document.createElement("tr");
    row.append(cell("td", p), cell("td", fixed(u, 3)), ...(block ? [cell("td", fixed(block[p], 3))] : []));
    return row;
  }));
}
