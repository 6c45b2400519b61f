// The explorer: an interactive page about the costs of the pixels of one rendered image. This file decodes the costs,
// stores the state, and displays the figures that model.js computes.
"use strict";

// Returns the words of a command as elements, so that line breaks occur only between words.
const commandElements = (text) => text.split(" ").flatMap((word, i) => [i ? " " : "", make("span", {}, word)]);

const explorer = {
  report: null,
  size: null,
  state: null,
  figures: null,
  hovered: null,  // PE under the pointer, or null
  pointed: "",    // text about the pixel under the pointer
  // Imbalance u by offset. known: number of offsets computed so far; values: [fold][offset]; worst: maximum u.
  curves: {pes: 0, known: 0, values: null, best: null, worst: 0},

  // The highlighted PE, or null.
  get focus() { return this.hovered ?? this.state.pe; },
  get squareRoot() { return roundedSquareRoot(this.figures.setting.pes); },  // √P; may exceed the maximum offset

  // --- From the report to the first view

  async start(report) {
    const {width, height} = this.size = {width: whole(report, "image.width"), height: whole(report, "image.height")};
    this.report = report;
    this.initialState = stateOf(member(report, "machine", "object"), this.size);
    this.rates = member(report, "machine.rates", "object");
    this.costs = await this.decodeCosts();
    this.maxCost = this.costs.reduce((max, cost) => Math.max(max, cost), 0);
    await this.decodeImage();
    $("main").append($("explorer").content.cloneNode(true));
    const texts = {
      width,
      machine: str(report, "machine.name"),
      made: `Made by raya ${str(report, "raya")} on ${str(report, "device.name")} (${
        str(report, "device.platform")}, driver ${str(report, "device.driver")}).`
    };
    for (const element of document.querySelectorAll("[data-text]")) element.textContent = texts[element.dataset.text];
    fillControls(this);
    listen(this);
    listenToPointer(this);
    this.followLink();
  },

  // Decodes the costs; inverse of cost_json() in page.cpp.
  async decodeCosts() {
    const packed = Uint8Array.from(atob(str(this.report, "cost.gzip")), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const pixels = this.size.width * this.size.height, costs = new Float64Array(pixels);
    if (bytes.length !== pixels * whole(this.report, "cost.bytes"))
      throw new Error("the embedded costs are incomplete");
    for (let at = 0; at < bytes.length; ++at) costs[at % pixels] += bytes[at] * 2 ** (8 * Math.floor(at / pixels));
    return costs;
  },

  // Decodes the image's pixels, and computes their lightness, 0..63.
  async decodeImage() {
    const {width, height} = this.size, photo = picture(this.report, "image.png", "the image");
    const context = make("canvas", {width, height}).getContext("2d");
    await photo.decode();
    context.drawImage(photo, 0, 0, width, height);
    this.photo = context.getImageData(0, 0, width, height);
    this.levels = Uint8Array.from({length: width * height}, (_, at) => {
      const [r, g, b] = this.photo.data.subarray(4 * at, 4 * at + 3);
      return Math.round((0.2126 * r + 0.7152 * g + 0.0722 * b) / 255 * 63);
    });
  },

  // --- From controls and pointer to the state

  choose(name, value) {
    this.state[name] = value;
    this.show();
  },

  hover(pe, text = "") {
    if (pe === this.hovered && text === this.pointed) return;
    [this.hovered, this.pointed] = [pe, text];
    this.requestDraw();
  },

  pick(pe) { this.choose("pe", pe); },

  // Sets the state from the page's address, when the page is loaded and when the user follows a link.
  followLink() {
    if (location.hash === this.hash) return;
    const {state, problems} = withLink(this.initialState, location.hash, this.size);
    $("message").textContent = problems.length ? `Invalid values in the link: ${problems.join("; ")}.` : "";
    $("message").hidden = problems.length === 0;
    this.state = state;
    this.compute();
    this.draw();
  },

  // --- From the state to the page

  show() {
    this.computing = true;
    this.requestDraw();
  },

  // Requests one redraw at the next frame.
  requestDraw() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = null;
      if (this.computing) this.compute();
      this.draw();
    });
  },

  compute() {
    this.computing = false;
    const {width, height} = this.size, [a, b] = this.state.grid;
    if (a * b > width * height) this.state.grid = [a, Math.max(1, Math.floor(width * height / a))];
    const setting = settingOf(this.state);
    if (this.state.pe !== null && this.state.pe >= setting.pes) this.state.pe = null;
    if (this.hovered !== null && this.hovered >= setting.pes) this.hovered = null;
    this.figures = figuresOf(setting, this.size, this.costs, this.rates);
    this.texts = textsOf(this.figures);
    for (const element of document.querySelectorAll("[data-figure]"))
      element.textContent = this.texts[element.dataset.figure];
    sync(this, document.activeElement);
    this.updateLink();
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      const {u, speedup, efficiency} = this.texts;
      $("spoken").textContent =
        `${mappingText(this.state)} on ${setting.pes} PEs: u ${u}, speed-up ${speedup}, efficiency ${efficiency}`;
    }, 600);
    if (this.curves.pes !== setting.pes) this.computeCurves(setting.pes);
  },

  // Updates the link and the command. Updates the page's address after a delay, because browsers limit the rate at
  // which the address may change.
  updateLink() {
    const link = linkText(this.state), before = location.hash;
    $("link").setAttribute("href", link);
    $("command").replaceChildren(...commandElements(`${str(this.report, "command")} ${optionsText(this.state)}`));
    clearTimeout(this.updating);
    this.updating = setTimeout(() => {
      if (location.hash !== before) return;  // the browser will call followLink()
      this.hash = link;
      if (location.hash !== link) history.replaceState(null, "", link);
    }, 250);
  },

  // Computes the curves for the current number of PEs, a few offsets at a time, so that the page stays responsive.
  computeCurves(pes) {
    const {width} = this.size, values = {cyclic: new Float64Array(width)};
    if (pes !== width) values.block = new Float64Array(width);
    const started = this.curves = {pes, known: 0, values, best: null, worst: 0};
    const computeMore = () => {
      if (started !== this.curves) return;  // curves for another number of PEs have been started
      started.known = addToCurves(values, this.costs, this.size, pes, started.known, performance.now() + 10);
      if (started.known < width) setTimeout(computeMore);
      else
        this.finishCurves();
      this.requestDraw();
    };
    setTimeout(computeMore);
  },

  finishCurves() {
    const {curves} = this, {cyclic, block} = curves.values;
    for (const [fold, us] of Object.entries(curves.values))
      us.forEach((u, offset) => {
        curves.worst = Math.max(curves.worst, u);
        if (u < (curves.best?.u ?? Infinity)) curves.best = {fold, offset, u};
      });
    const rows = Array.from(cyclic, (u, p) => [String(p), fixed(u, 3), ...(block ? [fixed(block[p], 3)] : [])]);
    $("offsets").replaceChildren(
      $("offsets").firstElementChild,
      wideTable("u of every offset", ["p", ...(block ? ["u, fold cyclic", "u, fold block"] : ["u"])], rows));
  },

  draw() {
    if (!this.figures) return;
    const {figures: f, state, curves, focus, texts} = this, {best, values} = curves, setting = mappingText(state);
    drawPicture($("picture"), f, this, state.view, focus);
    $("bars").replaceChildren(loadBars(f, texts, focus, 1 + curves.worst));
    const current =
      f.setting.kind === "slots" ? {offset: f.setting.offset, fold: values.block ? state.fold : "cyclic"} : null;
    $("curves").replaceChildren(offsetCurves(f, texts, curves, this.squareRoot, current));
    const {pe, cells} = drawCloseUp($("close-up"), f, this.size, focus),
               closeUp = `${cells} × ${cells} pixels in the middle of the image, the pixels of PE ${pe} in white`;
    const ownerText = focus === null ?
      "" :
      `PE ${focus} owns ${grouped(f.sizes[focus])} pixels; its load is ${grouped(f.loads[focus])} cycles, ` +
        `${f.mean > 0 ? fixed(f.loads[focus] / f.mean, 2) : 0} of the mean.`;
    $("view-text").textContent = VIEW_TEXTS[state.view](this.maxCost);
    $("pointed").textContent = this.hovered === null ? ownerText : `${this.pointed} ${ownerText}`;
    $("picture").setAttribute(
      "aria-label", `Image, coloured by ${state.view}. ${setting} on ${f.setting.pes} PEs. ${ownerText}`);
    $("close-up").setAttribute("aria-label", `${closeUp}. Shortest vector: ${texts.vector}.`);
    $("close-up-text").textContent = `The close-up shows ${closeUp}. ` +
      (f.vector ? `The arrow is the shortest vector of its lattice: ${texts.vector}.` :
                  "Its pixels are not a lattice.");
    $("block-key").hidden = !values.block;
    $("best").disabled = !best;
    $("best-text").textContent = best ?
      `Circle: minimum, ${fixed(best.u, 3)} at p = ${best.offset}${values.block ? `, fold ${best.fold}` : ""}.` :
                                                                                    "";
    if (!best) return;
    const curve = (state.fold === "block" && values.block) || values.cyclic;  // u of each offset, for the selected fold
    $("best").dataset.offset = curve.indexOf(curve.reduce((a, u) => Math.min(a, u)));
    $("best").textContent = `best p = ${$("best").dataset.offset}`;
  },
};

function showExplorer(r) {
  head(
    "raya explore", "Pixel mappings and load balance",
    make(
      "p", {class: "lead"},
      `${str(r, "scene")}, ${num(r, "image.width")} × ${
        num(r, "image.height")} pixels, is rendered by processing elements (PEs) without shared ` +
        "memory. A pixel whose rays bounce many times costs more than a pixel of the background, so the mapping of " +
        "pixels to PEs determines the balance of loads. Kohata & " +
        "Ito’s ",
      make("em", {}, "cyclic mapping"), " shifts every row by an offset ", make("var", {}, "p"),
      " against the row above. Drag ", make("var", {}, "p"), " to see the effect."));
  document.title = `raya explore: ${str(r, "scene")}`;
  document.body.className = "explorer";
  return explorer.start(r).then(
    () => $("head").append(note(
      `From one render: ${str(r, "machine.name")}, ${str(r, "machine.format")}, ${
        num(r, "machine.bounces")} bounces, accelerator ${str(r, "machine.accel")}. ` +
      `All figures are computed from the counted cycles of each pixel, ${
        grouped(sum(explorer.costs))} in all.` +
      (r.machine.parts ? ` The objects rotate in ${r.machine.parts} parts; the time to trace is without the waits ` +
        "after each part, the time to rotate without the parts." : ""))));
}
