"""Writes the output of studies: CSV, JSON, plots and Markdown for each study, and one HTML document for all of them."""
import base64
import dataclasses
import json
import math
import re
from collections import Counter
from pathlib import Path

import jinja2
import numpy as np
import pandas as pd
from markupsafe import Markup, escape
from raya.lab import plots
from raya.lab.claims import CONTROLS, errors_sentence, read_toml
from raya.lab.laboratory import FAMILIES
from raya.lab.page import format_value
from raya.lab.statistics import COMPATIBLE, CONDITIONAL, NOT_REPRODUCED, PLATEAU, REPRODUCED, VERDICTS
from raya.lab.store import write_atomically

OPEN_ROWS, MAX_ROWS = 24, 400  # a table of at most OPEN_ROWS rows is unfolded; HTML shows at most MAX_ROWS rows

# Content security policy: no scripts and no external resources.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
ABOUT = read_toml("about.toml", families="; ".join(FAMILIES))


def json_value(value):
    """Converts a value for JSON: numpy numbers to Python's, nan to null, inf to text."""
    if dataclasses.is_dataclass(value):
        return json_value({f.name: getattr(value, f.name) for f in dataclasses.fields(value)})
    if isinstance(value, dict):
        return {key: json_value(member) for key, member in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [json_value(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def rows_of(table):
    """Returns the cells of a table, [row][column]. Each cell has the type of its column; iterating over pandas rows would convert integers to
    floats."""
    return list(table.rows.itertuples(index=False, name=None))


def json_of(page):
    """Returns the page as a JSON value, described by study.schema.json."""
    members = {f.name: getattr(page, f.name) for f in dataclasses.fields(page) if f.name not in ("name", "placeholders")}
    return {"study": page.name, **json_value({
        **members, "claims": [record_of(judgement) for judgement in page.claims],
        "tables": [{"name": t.name, "title": t.title, "columns": list(t.rows.columns), "rows": rows_of(t)} for t in page.tables],
        "pictures": [{"name": p.name, "title": p.title, "words": p.words} for p in page.pictures],
        "comparisons": [{**json_value(c), "ratio": ratio(c)} for c in page.comparisons],
        "plots": [{**json_value(p), "description": plots.description(p)} for p in page.plots]})}


def record_of(judgement):
    """Returns a claim with its result as {name: value}: members of the JSON report and columns of claims.csv."""
    test = judgement.test
    return {**dataclasses.asdict(judgement.claim), "ensemble": judgement.ensemble, "interval": test.interval if test else "",
            "p": test.p if test else math.nan, "detectable": test.detectable if test else math.nan, "verdict": judgement.verdict,
            "random_passes": judgement.passes("random permutation"), "p5_passes": judgement.passes("p = 5"), "conditions": judgement.conditions, "reason": judgement.reason}


def ratio(comparison):
    """Returns our figure divided by the paper's; nan without a figure of the paper."""
    return comparison.ours / comparison.paper if comparison.paper else math.nan


def cells_of_comparisons(page):
    """Returns the table of comparisons, [row][column], the header first. Omits the paper's columns if no comparison has a paper's figure, and the
    column of remarks if there is none."""
    def ours(c):
        return f"{format_value(c.ours)}{f' +- {c.half_width:.2g}' if c.half_width else ''} {c.unit}".rstrip()

    def paper(c):
        return "-" if c.paper is None else f"{format_value(c.paper)} {c.unit}".rstrip() + (" (derived)" if c.derived else "")

    columns = {"": lambda c: c.what, page.compared_with or "paper": paper, "ours": ours,
               "ours / theirs": lambda c: f"{ratio(c):.3g}" if c.paper else "-", "remark": lambda c: c.remark}
    if all(c.paper is None for c in page.comparisons):
        columns = {name: columns[name] for name in ("", "ours", "remark")}
    if not any(c.remark for c in page.comparisons):
        del columns["remark"]
    return [list(columns)] + [[text(c) for text in columns.values()] for c in page.comparisons]


def title_of_comparisons(page):
    if all(c.paper is None for c in page.comparisons):
        return "Main figures"
    return f"Compared with {page.compared_with or 'the papers'}"


def cells_of_claims(pages):
    """Returns the table of claims, [row][column], the header first."""
    return [["claim", "statement", "verdict", *(f"{control} passes" for control in CONTROLS), "rule", "interval", "ensemble", "result"]] + [
        [f"{c.claim.id}: {c.claim.paper}, {c.claim.place}",
         f"{c.claim.statement} {c.claim.original and '(' + c.claim.original + ')'}".rstrip(),
         c.verdict + "".join(f"; {text}" for text in (c.qualification, c.conditions) if text), *map(c.passes, CONTROLS),
         f"{c.claim.rule} {c.claim.history}".rstrip(), c.test.interval if c.test else "", c.ensemble, " ".join(filter(None, (c.reason, c.power)))]
        for page in pages for c in page.claims]


def cells_of_points(plot):
    bars = any(any(s.half_widths) for s in plot.series)
    rows = [["series", plot.x_label, plot.y_label] + ["+-"] * bars]
    for s in plot.series:
        half = s.half_widths or [math.nan] * len(s.x)
        rows += [[s.label, format_value(x), format_value(y)] + [f"{h:.2g}"] * bars for x, y, h in zip(s.x, s.y, half)]
    return rows


def cells_of_table(table):
    return [list(table.rows.columns)] + [[format_value(cell) for cell in row] for row in rows_of(table)]


def lines_of_run(page):
    """Returns [(name, value)] of the command, version, device and settings that made a page, as text."""
    return [(key, value if isinstance(value, str) else json.dumps(json_value(value)))
            for key, value in [*page.run.items(), *page.settings.items()]]


def command_of(pages):
    """Returns the command that makes all pages. For several pages: the longest of their commands, because it has all options and scenes, with the
    study `all`."""
    command = max((page.run.get("command", "") for page in pages), key=len)
    return command if len(pages) == 1 else re.sub(r"^raya study \S+", "raya study all", command)


def verdict_sentences(pages):
    """Returns sentences with the number of claims for each verdict: one for all claims; if there are several papers, also one for each paper."""
    claims = [claim for page in pages for claim in page.claims]
    if not claims:
        return ["This study tests no claim of a paper."] if len(pages) == 1 else ["These studies test no claim of a paper."]

    def sentence(counted_claims, source):
        count = Counter(judgement.verdict for judgement in counted_claims)
        return (f"Of {len(counted_claims)} claim{'' if len(counted_claims) == 1 else 's'} {source}: "
                + ", ".join(f"{count[verdict]} {verdict}" for verdict in (*VERDICTS, "derived")) + ".")

    papers = list(dict.fromkeys(judgement.claim.paper for judgement in claims))
    sentences = [sentence(claims, f"of {papers[0]}" if len(papers) == 1 else f"of {len(papers)} papers")]
    if len(papers) > 1:
        sentences += [sentence([judgement for judgement in claims if judgement.claim.paper == paper], f"of {paper}") for paper in papers]
    return [*sentences, *filter(None, [errors_sentence(claims)])]


def summary_of(pages):
    """Returns [(title, sentences)] of the summary's sections: results, then reasons, which have places and our figures."""
    def of_verdict(verdict):
        return [c for page in pages for c in page.claims if c.verdict == verdict]

    def reasons(verdict):
        return [f'{c.claim.paper}, {c.claim.place}: "{c.claim.statement}" {c.conditions and c.conditions + " "}{c.reason}' for c in of_verdict(verdict)]

    claims = [c for page in pages for c in page.claims]
    return [("Claims that hold", [c.claim.statement + (c.qualification and f" The rule {c.qualification}.") for c in of_verdict(REPRODUCED)]),
            ("Results beyond the papers", [sentence for page in pages for sentence in page.news]),
            ("Claims that do not hold", reasons(NOT_REPRODUCED)),
            ("Conditional: the claim holds under some conditions and not under others", reasons(CONDITIONAL)),
            ("Plateau: other values are as good as the claimed best one", reasons(PLATEAU)),
            ("Compatible: the test has too little power", reasons(COMPATIBLE)),
            ("Rules that were changed after a result was known", [f"{c.claim.id}: {c.claim.history}" for c in claims if c.claim.history])]


def prose(text):
    """Returns the escaped HTML of a sentence. Text in backquotes becomes a code element, +- becomes ±."""
    return Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(text)).replace("+-", "±")))


# A cell of a numeric column: empty, '-', or a number, optionally with interval, unit and "(derived)".
NUMBER = re.compile(r"-?|(-?[\d.]+(e[-+]?\d+)?|-?inf)( \+- \S+)?( [^\s\d]+)?( \(derived\))?")


def classes_of(cells):
    """Returns the CSS class of each column. n: only numbers; w: longest cell over 60 characters; t: over 15 characters; otherwise empty."""
    columns = list(zip(*cells[1:])) or [()] * len(cells[0])
    return ["n" if all(map(NUMBER.fullmatch, c)) else "w" if max(map(len, c)) > 60 else
            "t" if max(map(len, c)) > 15 else "" for c in columns]


def markdown_table(cells):
    lines = ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in cells]
    return "\n".join([lines[0], "|" + "---|" * len(cells[0])] + lines[1:])


def items(lines):
    return "\n".join(f"- {line}" for line in lines)


def environment():
    templates = Path(__file__).resolve().parent / "templates"  # an installation has style.css there, too
    folders = [templates, templates.parents[2] / "host" / "report" / "page"]
    made = jinja2.Environment(loader=jinja2.FileSystemLoader(folders), autoescape=jinja2.select_autoescape(["html.j2"]), trim_blocks=True,
                              lstrip_blocks=True, undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    made.filters.update(classes=classes_of, items=items, markdown_table=markdown_table, prose=prose)
    made.globals.update({function.__name__: function for function in (
        cells_of_claims, cells_of_comparisons, cells_of_points, cells_of_table, command_of, len, lines_of_run, summary_of, title_of_comparisons,
        verdict_sentences)}, about=ABOUT, policy=Markup(POLICY), OPEN_ROWS=OPEN_ROWS, MAX_ROWS=MAX_ROWS)
    return made


def csv_of(rows):
    """Returns a table as CSV. A text that a spreadsheet would take for a formula, such as a scene's name, gets an apostrophe."""
    def safe(cell):
        return f"'{cell}" if isinstance(cell, str) and cell[:1] in ("=", "+", "-", "@", "\t", "\r") else cell
    return rows.apply(lambda column: column.map(safe) if column.dtype == object else column).to_csv(index=False, na_rep="-")


def markdown_of(template, **values):
    """Returns the Markdown of a template, in which names and texts cannot be HTML."""
    return environment().get_template(template).render(**values).replace("<", "&lt;")


def texts_of(page):
    """Returns {file name: content} of the page as JSON and Markdown."""
    return {f"{page.name}.json": json.dumps(json_of(page), indent=2, ensure_ascii=False) + "\n",
            f"{page.name}.md": markdown_of("page.md.j2", page=page)}


def write(folder, files):
    """Writes {file name: content}, only after all content has been made, so that an error leaves no files. Returns the names."""
    for name, content in files.items():
        write_atomically(folder / name, content)
    return list(files)


def write_page(folder, page):
    """Writes all files of one study, whose verdicts decide() must have set. Returns (their names, drawings for the document: {name: SVG of a plot, or
    base64 text of a PNG})."""
    drawings = {picture.name: base64.b64encode(picture.png).decode() for picture in page.pictures}
    files = {**{f"{table.name}.csv": csv_of(table.rows) for table in page.tables}, **{f"{one.name}.png": one.png for one in page.pictures}}
    for plot in page.plots:
        drawn = plots.files_of(plot)
        files.update({f"{plot.name}.{kind}": content for kind, content in drawn.items()})
        svg = drawn["svg"].decode()  # colours become CSS variables, which the dark colour scheme redefines
        drawings[plot.name] = Markup(re.sub(r": #([0-9a-f]{6})", r": var(--plot-\1, #\1)", svg[svg.index("<svg"):]))
    return write(folder, {**files, **texts_of(page)}), drawings


def write_document(folder, pages, drawings, skip_notes=()):
    """Writes index.html; for several pages, also index.md, claims.md and claims.csv. `skip_notes`: sentences on studies that did not run. Returns
    the names of the files of all pages."""
    judgements, values = [judgement for page in pages for judgement in page.claims], {"pages": pages, "skip_notes": skip_notes}
    files = {"index.html": environment().get_template("document.html.j2").render(drawings=drawings, **values)}
    if len(pages) > 1:
        files |= {name: markdown_of(f"{name}.j2", **values) for name in ("index.md", "claims.md")}
        files["claims.csv"] = csv_of(pd.DataFrame(map(record_of, judgements)))
    return write(folder, files)
