// The page: reads its costs, listens to its controls, and says what model.js computes.
"use strict";

const $ = (id) => document.getElementById(id);

// Options break between lines, not within.
const commandWords = (text) => text.split(" ").flatMap((word, i) => [i ? " " : "", Object.assign(document.createElement("span"), {textContent: word})]);

const explorer = {
  about: JSON.parse($("about").textContent),
  state: null, figures: null, hovered: null,
  curves: {pes: 0, known: 0, values: null, best: null},

  get size() { return {width: this.about.width, height: this.about.height}; },
  get focus() { return this.hovered ?? this.state.pe; },
  get root() { return Math.round(Math.sqrt(this.figures.setting.pes)); },  // may lie beyond the last offset

  // --- From the page's text

  async start() {
    this.costs = await this.read();
    const {width, height} = this.size, photo = $("photo");
    this.most = this.costs.reduce((most, cost) => Math.max(most, cost), 0);
    const canvas = Object.assign(document.createElement("canvas"), {width, height}), context = canvas.getContext("2d");
    await photo.decode();
    context.drawImage(photo, 0, 0, width, height);
    this.photo = context.getImageData(0, 0, width, height);
    this.levels = Uint8Array.from({length: width * height}, (_, at) => {
      const [r, g, b] = this.photo.data.subarray(4 * at, 4 * at + 3);
      return Math.round((0.2126 * r + 0.7152 * g + 0.0722 * b) / 255 * 63);
    });
    this.state = {...this.about.state, view: "owners", pe: null};
    this.fill();
    this.listen();
    for (const element of document.querySelectorAll(".live")) element.hidden = false;
    photo.hidden = true;
    this.follow();
  },

  // Planes of bytes, the lowest first, packed by gzip.
  async read() {
    const packed = Uint8Array.from(atob($("costs").textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const pixels = this.about.width * this.about.height, costs = new Float64Array(pixels);
    if (bytes.length !== pixels * this.about.bytes) throw new Error("the costs within the page are not whole");
    for (let at = 0; at < bytes.length; ++at) costs[at % pixels] += bytes[at] * 2 ** (8 * Math.floor(at / pixels));
    return costs;
  },

  fill() {
    const {width, height} = this.size;
    for (const [id, side] of [["tile-w", width], ["tile-h", height]])
      $(id).append(...divisorsOf(side).map((d) => new Option(d, d)));
  },

  // --- From controls to the state

  listen() {
    const change = (id, take) => $(id).addEventListener("input", () => {
      const control = $(id), value = control.tagName === "SELECT" && id === "mapping" ? control.value : Number(control.value);
      if (control.type === "number" && (control.value === "" || !control.checkValidity())) return;
      take(value);
      this.show(control);
    });
    change("mapping", (name) => { this.state.mapping = name; });
    for (const id of ["offset", "offset-slider"]) change(id, (p) => { this.state.offset = p; });
    for (const id of ["pes", "pes-slider"]) change(id, (pes) => { this.state.pes = pes; });
    change("grid-a", (a) => { this.state.grid = [a, this.state.grid[1]]; });
    change("grid-b", (b) => { this.state.grid = [this.state.grid[0], b]; });
    change("tile-w", (w) => { this.state.tile = [w, this.state.tile[1]]; });
    change("tile-h", (h) => { this.state.tile = [this.state.tile[0], h]; });
    change("seed", (seed) => { this.state.seed = seed; });
    change("pe", (pe) => { this.state.pe = pe; });
    $("pe").addEventListener("input", () => { if ($("pe").value === "") this.pick(null); });
    $("no-pe").addEventListener("click", () => this.pick(null));
    for (const name of ["view", "fold"])
      for (const radio of document.getElementsByName(name))
        radio.addEventListener("change", () => { this.state[name] = radio.value; this.show(radio); });
    for (const button of document.querySelectorAll("[data-offset], #root, #best"))
      button.addEventListener("click", () => { this.state.offset = Number(button.dataset.offset); this.show(button); });
    for (const field of document.querySelectorAll("input[type=number]"))  // what cannot be is not left standing
      field.addEventListener("change", () => this.sync(null));
    $("form").addEventListener("submit", (event) => event.preventDefault());
    addEventListener("hashchange", () => this.follow());
    addEventListener("resize", () => this.soon());  // also where the page is zoomed
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.soon()).observe($("bars"));
    this.point();
  },

  // The pointer on picture, bars and curves.
  point() {
    const over = (id, owner) => {
      const canvas = $(id);
      canvas.addEventListener("pointermove", (event) => this.hover(...owner(event)));
      canvas.addEventListener("pointerleave", () => this.hover(null));
      canvas.addEventListener("click", (event) => this.pick(owner(event)[0]));
    };
    over("picture", (event) => {
      const box = $("picture").getBoundingClientRect(), {width, height} = this.size;
      const inside = (value, end) => Math.min(Math.max(Math.floor(value), 0), end - 1);
      const row = inside((event.clientY - box.top) / box.height * height, height);
      const column = inside((event.clientX - box.left) / box.width * width, width), at = row * width + column;
      return [this.figures.owners[at], `Row ${row}, column ${column}: ${grouped(this.costs[at])} cycles.`];
    });
    over("bars", (event) => [this.barAt(event.clientX - $("bars").getBoundingClientRect().left), ""]);
    const curves = $("curves");
    const drag = (event) => {
      this.state.mapping = "cyclic";
      this.state.offset = this.offsetAt(event.clientX - curves.getBoundingClientRect().left);
      this.show(curves);
    };
    curves.addEventListener("pointerdown", (event) => { curves.setPointerCapture(event.pointerId); drag(event); });
    curves.addEventListener("pointermove", (event) => { if (event.buttons & 1) drag(event); });
  },

  hover(pe, words = "") {
    if (pe === this.hovered && words === this.pointed) return;
    [this.hovered, this.pointed] = [pe, words];
    this.soon();
  },

  pick(pe) {
    this.state.pe = pe;
    this.show($("no-pe"));
  },

  // A link that was followed, or the page's own.
  follow() {
    if (location.hash === this.hash) return;
    const {state, problems} = withLink({...this.about.state, view: "owners", pe: null}, location.hash, this.size);
    $("message").textContent = problems.length ? `The link asks for what cannot be: ${problems.join("; ")}.` : "";
    $("message").hidden = problems.length === 0;
    this.state = state;
    this.compute();
    this.draw();
  },

  // --- From the state to the page

  show() {
    this.computing = true;
    this.soon();
  },

  // Once for all that happens before the next picture.
  soon() {
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
    this.figures = figuresOf(setting, this.size, this.costs, this.about.rates);
    const texts = textsOf(this.figures);
    for (const element of document.querySelectorAll("[data-figure]")) element.textContent = texts[element.dataset.figure];
    this.sync(document.activeElement);
    this.keep();
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      $("spoken").textContent = `${mappingText(this.state)} on ${setting.pes} PEs: u ${texts.u}, speed-up ${texts.speedup}, efficiency ${texts.efficiency}`;
    }, 600);
    if (this.curves.pes !== setting.pes) this.trace(setting.pes);
  },

  // All controls say what the state is; not the field that is being written in.
  sync(active) {
    const {state, figures} = this, {width} = this.size;
    const values = {mapping: state.mapping, offset: state.offset, "offset-slider": state.offset, pes: state.pes,
                    "pes-slider": Math.min(state.pes, width), "grid-a": state.grid[0], "grid-b": state.grid[1],
                    "tile-w": state.tile[0], "tile-h": state.tile[1], seed: state.seed, pe: state.pe ?? ""};
    for (const [id, value] of Object.entries(values))
      if ($(id) !== active || active.type !== "number") $(id).value = value;
    $("pe").max = figures.setting.pes - 1;
    for (const name of ["view", "fold"])
      for (const radio of document.getElementsByName(name)) radio.checked = radio.value === state[name];
    for (const part of document.querySelectorAll("[data-for]")) part.hidden = !part.dataset.for.split(" ").includes(state.mapping);
    for (const part of document.querySelectorAll("[data-but]")) part.hidden = part.dataset.but === state.mapping;
    $("root").textContent = `p = √P ≈ ${this.root}`.replace("≈", this.root ** 2 === figures.setting.pes ? "=" : "≈");
    $("root").dataset.offset = this.root % width;
    $("root").hidden = this.root >= width;
  },

  // In the address, in the link, and as a command; not at every step of a drag, which browsers do not like.
  keep() {
    const link = linkText(this.state);
    $("link").setAttribute("href", link);
    $("command").replaceChildren(...commandWords(`${this.about.command} ${optionsText(this.state)}`));
    clearTimeout(this.keeping);
    this.keeping = setTimeout(() => {
      this.hash = link;
      if (location.hash !== link) history.replaceState(null, "", link);
    }, 250);
  },

  // The curves of this number of PEs, some offsets at a time, so that nothing else waits for them.
  trace(pes) {
    const {width} = this.size, curves = {cyclic: new Float64Array(width)};
    if (pes !== width) curves.block = new Float64Array(width);
    this.curves = {pes, known: 0, values: curves, best: null};
    const own = this.curves, more = () => {
      if (own !== this.curves) return;  // another number of PEs by now
      own.known = addToCurves(curves, this.costs, this.size, pes, own.known, performance.now() + 10);
      if (own.known === width) this.traced(); else setTimeout(more);
      this.soon();
    };
    setTimeout(more);
  },

  traced() {
    const {values} = this.curves;
    const ranked = Object.entries(values).flatMap(([fold, us]) => Array.from(us, (u, offset) => ({fold, offset, u})));
    this.curves.best = ranked.reduce((best, next) => (next.u < best.u ? next : best));
    const rows = Array.from(values.cyclic, (u, p) => [p, fixed(u, 3), ...(values.block ? [fixed(values.block[p], 3)] : [])]);
    const table = $("offsets").querySelector("table"), cell = (tag, text) => {
      const element = document.createElement(tag);
      element.textContent = text;
      element.className = "n";
      return element;
    };
    const head = ["p", ...(values.block ? ["u, fold cyclic", "u, fold block"] : ["u"])].map((text) => cell("th", text));
    for (const element of head) element.scope = "col";
    table.tHead.rows[0].replaceChildren(...head);
    table.tBodies[0].replaceChildren(...rows.map((texts) => {
      const row = document.createElement("tr");
      row.append(...texts.map((text) => cell("td", text)));
      return row;
    }));
  },

  draw() {
    if (!this.figures) return;
    const {figures: f, state, curves, focus} = this, slots = f.setting.kind === "slots";
    drawPicture($("picture"), f, this, state.view, focus);
    const worst = curves.best ? Object.values(curves.values).reduce((most, us) => us.reduce((a, u) => Math.max(a, u), most), 0) : 0;
    this.barAt = drawBars($("bars"), f, focus, 1 + worst);
    const here = slots ? {offset: f.setting.offset, fold: curves.values.block ? state.fold : "cyclic"} : null;
    this.offsetAt = drawCurves($("curves"), curves.values, curves.known, f, this.root, curves.best, here);
    this.say(drawCloseUp($("close-up"), f, this.size, focus));
  },

  // What is seen, in words.
  say({pe, cells}) {
    const {figures: f, state, curves, focus} = this, texts = textsOf(f), {best} = curves;
    $("view-words").textContent = VIEW_WORDS[state.view](f, this.most);
    const load = (which) => `PE ${which} owns ${grouped(f.sizes[which])} pixels and has ${grouped(f.loads[which])} cycles to do, ` +
      `${f.mean > 0 ? fixed(f.loads[which] / f.mean, 2) : 0} of the mean.`;
    $("pointed").textContent = focus === null ? "" : `${this.hovered === null ? "" : this.pointed} ${load(focus)}`;
    $("picture").setAttribute("aria-label", `The picture, coloured by ${state.view}. ${mappingText(state)} on ${f.setting.pes} PEs.`);
    $("bars").setAttribute("aria-label", `Loads of ${f.setting.pes} PEs: from ${texts.idlest} to ${texts.busiest}, mean ${texts.mean}.`);
    $("curves").setAttribute("aria-label", `u over the offsets 0 to ${this.about.width - 1}, now ${texts.u}` +
      (best ? `; least ${fixed(best.u, 3)} at p = ${best.offset}, fold ${best.fold}.` : "."));
    $("close-up").setAttribute("aria-label", `Close-up of ${cells} × ${cells} pixels, those of PE ${pe} marked. Shortest vector: ${texts.vector}.`);
    $("close-words").textContent = `The close-up shows the middle of the picture, ${cells} × ${cells} pixels, those of PE ${pe} in white. ` +
      (f.vector ? `The arrow is the shortest vector of its lattice: ${texts.vector}.` : "Its pixels are no lattice.");
    $("block-key").hidden = !curves.values.block;
    $("best-words").textContent = best ? `Circle: the least, ${fixed(best.u, 3)} at p = ${best.offset}${curves.values.block ? `, fold ${best.fold}` : ""}.` : "";
    const least = curves.best && Object.values(curves.values.block && state.fold === "block" ? {u: curves.values.block} : {u: curves.values.cyclic})[0];
    $("best").disabled = !least;
    if (!least) return;
    const offset = least.indexOf(least.reduce((a, u) => Math.min(a, u)));
    $("best").textContent = `best here: p = ${offset}`;
    $("best").dataset.offset = offset;
  },
};

explorer.ready = explorer.start().catch((problem) => {
  $("message").hidden = false;
  $("message").textContent = `This browser cannot run the page (${problem.message}); the figures are those that it came with.`;
});
