#!/usr/bin/env python3
"""Checks of all pages that raya writes, in a browser (browser.py).

    tests/tools/page_checks.py PAGE.html [--pictures FOLDER]      prints the complaints about a page; writes screenshots into FOLDER
"""
import argparse, json, sys
from pathlib import Path

import browser

WIDTHS = (400, 820, 1400)

# Returns complaints about the page, and numbers of checked elements. A link that starts with # and contains = has settings, not an anchor. SVG text
# has the colour of its `fill` and the background of the SVG's first path.
INSPECT = r"""(() => {
  const wrong = [];
  const isVisible = (e) => e.checkVisibility() && e.getClientRects().length > 0;
  const complain = (what, e) => wrong.push(`${what}: ${(e.textContent || e.outerHTML).trim().slice(0, 60)}`);

  const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
  ids.filter((id, i) => ids.indexOf(id) !== i).forEach((id) => wrong.push("an id twice: " + id));
  for (const a of document.querySelectorAll("a[href^='#']"))
    if (!a.getAttribute("href").includes("=") && !document.getElementById(a.getAttribute("href").slice(1))) complain("a link to nowhere", a);
  for (const e of document.querySelectorAll("*"))
    for (const {name, value} of e.attributes)
      if (name.startsWith("on") || (/href|src/.test(name) && /^[a-z]+:/i.test(value) && !value.startsWith("data:")))
        wrong.push(`attribute ${name}="${value.slice(0, 60)}"`);

  const figures = [...document.querySelectorAll("figure.plot")];
  for (const figure of figures) {
    const svg = figure.querySelector("svg");
    if (!svg) { if (!figure.querySelector(".missing")) complain("a figure without a drawing", figure); continue; }
    const box = svg.getBoundingClientRect();
    if (box.width < 300 || box.height < 150) complain(`a drawing of ${box.width} x ${box.height}`, figure);
    const ink = [...svg.querySelectorAll("path, use, text")].filter((e) => e.getBoundingClientRect().width > 0);
    if (ink.length < 20 || svg.querySelectorAll("text").length < 3) complain("an empty drawing", figure);
    const textsOf = (name) => (svg.getAttribute(name) || "").split(" ").map((id) => document.getElementById(id)?.textContent || "").join(" ");
    if (svg.getAttribute("role") !== "img") complain("a drawing without role=img", figure);
    if (!(svg.getAttribute("aria-label") || textsOf("aria-labelledby")).trim()) complain("a drawing without a name", figure);
    if (!/Horizontal axis: .+ Vertical axis: .+ Series: .+/s.test(textsOf("aria-describedby"))) complain("a drawing without a description", figure);
  }
  for (const img of document.querySelectorAll("img"))
    if (!img.alt.trim() || !img.complete || img.naturalWidth === 0) complain("an image without alternative text or pixels", img);

  const canvas = document.createElement("canvas").getContext("2d", {willReadFrequently: true});
  const rgb = (colour) => {
    canvas.clearRect(0, 0, 1, 1);
    canvas.fillStyle = colour;
    canvas.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = canvas.getImageData(0, 0, 1, 1).data;
    return {rgb: [r, g, b], a};
  };
  const luminance = ({rgb}) => rgb.map((v) => v / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
      .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const contrast = (a, b) => (Math.max(luminance(a), luminance(b)) + 0.05) / (Math.min(luminance(a), luminance(b)) + 0.05);
  const backgroundOf = (e) => {
    for (; e; e = e.parentElement) {
      const colour = rgb(getComputedStyle(e).backgroundColor);
      if (colour.a === 255) return colour;
    }
    return rgb("white");
  };
  let texts = 0;
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const e = walker.currentNode.parentElement;
    if (!walker.currentNode.data.trim() || !isVisible(e) || e.closest("script, style")) continue;
    ++texts;
    const svg = e.closest("svg"), style = getComputedStyle(e);
    const background = svg ? rgb(getComputedStyle(svg.querySelector("path")).fill) : backgroundOf(e);
    const ratio = contrast(rgb(svg ? style.fill : style.color), background);
    if (ratio < 4.5) complain(`a contrast of ${ratio.toFixed(2)}`, e);
  }
  const wide = document.scrollingElement.scrollWidth;
  if (wide > innerWidth) wrong.push(`a page of ${wide} pixels in a window of ${innerWidth}`);
  return {wrong: [...new Set(wrong)], texts, figures: figures.length, title: document.title, buttons: document.querySelectorAll("th button").length};
})()"""


def complaints(page):
    """Yields complaints: network requests, exceptions, and messages in the console."""
    for method, event in page.events:
        if method == "Network.requestWillBeSent":
            url = event["request"]["url"]
            if not url.startswith("data:") and event.get("type") != "Document":
                yield "a request: " + url
        elif method == "Runtime.exceptionThrown":
            yield "an exception: " + event["exceptionDetails"].get("exception", {}).get("description", "")[:200]
        elif method == "Runtime.consoleAPICalled":
            yield "in the console: " + json.dumps(event["args"])[:200]
        elif method == "Log.entryAdded":
            yield "in the log: " + event["entry"]["text"][:200]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page")
    parser.add_argument("--pictures")
    arguments = parser.parse_args()
    url, wrong = Path(arguments.page).resolve().as_uri(), []
    with browser.Browser() as page:
        for width, dark, scripts in [(w, d, True) for w in WIDTHS for d in (False, True)] + [(WIDTHS[1], False, False)]:
            page.open(url, width, dark, scripts)
            if scripts:  # waits until the scripts have run
                page.value("new Promise((done) => setTimeout(done, 1500))")
            name = f"{width}-{'dark' if dark else 'light'}{'' if scripts else '-no-scripts'}"
            wrong += [f"{name}: {text}" for text in [*page.value(INSPECT)["wrong"], *complaints(page)]]
            if arguments.pictures:
                page.picture(Path(arguments.pictures, f"{Path(arguments.page).stem}-{name}.png"))
    print("\n".join(wrong) or "no complaints")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
