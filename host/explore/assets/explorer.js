// The page: reads its costs, keeps the state, and has drawn and said what model.js computes of it.
"use strict";

const $ = (id) => document.getElementById(id);

// Options break between lines, not within.
const commandWords = (text) => text.split(" ").flatMap(
  (word, i) => [i ? " " : "", Object.assign(document.createElement("span"), {textContent: word})]);

const explorer = {
  about: JSON.parse($("about").textContent),
  state: null,
  figures: null,
  hovered: null,
  curves: {pes: 0, known: 0, values: null, best: null, worst: 0},

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
    fill(this);
    listen(this);
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
    for (const element of document.querySelectorAll("[data-figure]"))
      element.textContent = texts[element.dataset.figure];
    sync(this, document.activeElement);
    this.keep();
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      $("spoken").textContent = `${mappingText(this.state)} on ${setting.pes} PEs: u ${texts.u}, ` +
        `speed-up ${texts.speedup}, efficiency ${texts.efficiency}`;
    }, 600);
    if (this.curves.pes !== setting.pes) this.trace(setting.pes);
  },

  // In the address, in the link, and as a command; not at every step of a drag, which browsers do not like.
  keep() {
    const link = linkText(this.state);
    $("link").setAttribute("href", link);
    $("command").replaceChildren(...commandWords(`${this.about.command} ${optionsText(this.state)}`));
    const before = location.hash;
    clearTimeout(this.keeping);
    this.keeping = setTimeout(() => {
      if (location.hash !== before) return;  // a link that is about to be followed
      this.hash = link;
      if (location.hash !== link) history.replaceState(null, "", link);
    }, 250);
  },

  // The curves of this number of PEs, some offsets at a time, so that nothing else waits for them.
  trace(pes) {
    const {width} = this.size, curves = {cyclic: new Float64Array(width)};
    if (pes !== width) curves.block = new Float64Array(width);
    this.curves = {pes, known: 0, values: curves, best: null, worst: 0};
    const own = this.curves, more = () => {
      if (own !== this.curves) return;  // another number of PEs by now
      own.known = addToCurves(curves, this.costs, this.size, pes, own.known, performance.now() + 10);
      if (own.known < width)
        setTimeout(more);
      else
        this.traced();
      this.soon();
    };
    setTimeout(more);
  },

  traced() {
    const {curves} = this, {values} = curves;
    for (const [fold, us] of Object.entries(values))
      us.forEach((u, offset) => {
        if (u < (curves.best?.u ?? Infinity)) curves.best = {fold, offset, u};
      });
    curves.worst = Object.values(values).reduce((most, us) => us.reduce((a, u) => Math.max(a, u), most), 0);
    writeTable(this);
  },

  draw() {
    if (!this.figures) return;
    const {figures: f, state, curves, focus} = this, slots = f.setting.kind === "slots";
    drawPicture($("picture"), f, this, state.view, focus);
    this.barAt = drawBars($("bars"), f, focus, 1 + curves.worst);
    const here = slots ? {offset: f.setting.offset, fold: curves.values.block ? state.fold : "cyclic"} : null;
    this.offsetAt = drawCurves($("curves"), curves.values, curves.known, f, this.root, curves.best, here);
    say(this, drawCloseUp($("close-up"), f, this.size, focus));
  },
};

explorer.ready = explorer.start().catch((problem) => {
  $("message").hidden = false;
  $("message").textContent =
    `This browser cannot run the page (${problem.message}); the figures are those that it came with.`;
});
