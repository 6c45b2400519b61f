// Comfort, where scripts run: a plot tells the figures of the point that is pointed at.
"use strict";

// tools/plot.py leaves each series' points in the drawing: x, y, half width, place in % of width and height.

function pointsOf(svg) {
  const data = svg.querySelector("g.data");
  return [...data.children].map((series) =>
    series.dataset.points.split(" ").filter(Boolean).map((text) => {
      const [x, y, half, left, top] = text.split(",");
      const interval = parseFloat(half) > 0 ? ` ± ${half}` : "";
      const words = `${series.dataset.label}: ${data.dataset.x} ${x}, ${data.dataset.y} ${y}${interval}`;
      return {words, left: parseFloat(left), top: parseFloat(top)};
    })).filter((points) => points.length > 0);
}

class Pointer {
  constructor(drawing) {
    this.drawing = drawing;
    this.series = pointsOf(drawing.querySelector("svg"));
    this.mark = this.added("mark");
    this.tip = this.added("tip");
    this.tip.setAttribute("role", "status");
    this.at = [0, -1];
    drawing.addEventListener("pointermove", (event) => this.nearest(event));
    drawing.addEventListener("pointerdown", (event) => this.nearest(event));
    drawing.addEventListener("pointerleave", () => this.hide());
    drawing.parentElement.addEventListener("keydown", (event) => this.key(event));
    drawing.parentElement.addEventListener("blur", () => this.hide());
  }

  added(name) {
    const element = document.createElement("div");
    element.className = name;
    element.hidden = true;
    this.drawing.append(element);
    return element;
  }

  hide() { this.mark.hidden = this.tip.hidden = true; }

  show(series, point) {
    this.at = [series, point];
    const {words, left, top} = this.series[series][point];
    for (const element of [this.mark, this.tip]) {
      element.hidden = false;
      element.style.left = `${left}%`;
      element.style.top = `${top}%`;
    }
    this.tip.textContent = words;
    // Inside the drawing, wherever the point lies.
    this.tip.style.transform = `translate(${left > 50 ? "calc(-100% - 12px)" : "12px"}, ${top > 50 ? "-100%" : "0"})`;
  }

  nearest(event) {
    const box = this.drawing.getBoundingClientRect(), reach = 40;  // pixels
    let best = reach, found = null;
    this.series.forEach((points, i) => points.forEach(({left, top}, j) => {
      const distance = Math.hypot(box.left + left / 100 * box.width - event.clientX,
                                  box.top + top / 100 * box.height - event.clientY);
      if (distance < best) [best, found] = [distance, [i, j]];
    }));
    if (found) this.show(...found); else this.hide();
  }

  // Left and right along a series, up and down from one to another.
  key(event) {
    if (this.series.length === 0) return;
    const [series, point] = this.at;
    const along = {ArrowLeft: -1, ArrowRight: 1}[event.key], across = {ArrowUp: -1, ArrowDown: 1}[event.key];
    if (event.key === "Escape") return this.hide();
    if (!along && !across) return;
    event.preventDefault();
    const next = (series + (across || 0) + this.series.length) % this.series.length;
    const last = this.series[next].length - 1;
    this.show(next, Math.min(Math.max(point + (along || 0), 0), last));
  }
}

for (const drawing of document.querySelectorAll(".drawing")) {
  const svg = drawing.querySelector("svg"), title = svg.querySelector("title");
  svg.setAttribute("aria-label", title.textContent);  // a browser would show the title over what is pointed at
  svg.removeAttribute("aria-labelledby");
  title.remove();
  new Pointer(drawing);
}
