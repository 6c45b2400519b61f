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
from raya.lab.claims import decide, errors_sentence
from raya.lab.families import FAMILIES
from raya.lab.page import format_value
from raya.lab.papers import REFERENCES
from raya.lab.statistics import COMPATIBLE, NOT_REPRODUCED, REPRODUCED, UNTESTABLE
from raya.lab.store import write_atomically

OPEN_ROWS, MAX_ROWS = 24, 400  # a table of at most OPEN_ROWS rows is unfolded; HTML shows at most MAX_ROWS rows

# Content security policy: no scripts and no external resources.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
ABOUT = {
    "title": "The load laboratory",
    "question": "Which claims of the papers on two ray-tracing array machines can be reproduced on models of these machines, "
                "and what do the models show beyond the papers?",
    "method": [
        "Kohata & Ito 1993 divide the screen: the SPA has 256 processing elements (PEs) on a ring and a bus, and a cyclic mapping "
        "distributes the pixels over them. Yoshitani & Yamazaki, about 1995, divide space: each of 64 transputers on a torus holds "
        "one voxel, and rays travel between them as packets. Havran & Sixta 1999 count tests and steps in uniform grids; raya's "
        "counts are compared with theirs.",
        "Both machines are models that run as OpenCL kernels. Every machine and every mapping gives the same image, bit for bit. "
        "The kernels count loads, packets and tests. Times are modelled from these counts unless a page calls them measured.",
        "A claim is a statement of a paper. claims.toml has each claim once, with a rule that was fixed before the pictures of docs/verdicts.md "
        "were computed. Reproduced: the interval fulfils the rule. Not reproduced: the interval contradicts the rule. Compatible: neither, because the test has too little "
        "power. Untestable: no study can decide the claim. Derived, without a verdict: the claim follows from another claim, or from figures "
        "to which scenes were matched. Tests are two-sided. Holm's correction covers all "
        "tests of this document, so a claim can be compatible although its own 95 % interval fulfils the rule. \"Weakest\" is that test of a "
        "claim with several tests that supports it least.",
        "An ensemble has pictures of scene families, in this order: " + "; ".join(FAMILIES) + ". Each seed gives another scene or another "
        "view. If the command line names scenes, an ensemble has random views of these scenes instead. Intervals treat the families as strata.",
        "\"Derived\" marks a figure that we computed from figures that the paper prints. \"[D]\" marks such a figure in a "
        "text. \"+-\" precedes the half width of a 95 % confidence interval by Student's t.",
    ],
    "figures": [  # figures and tables of the papers: the study of each, or the reason why there is none
        "Kohata & Ito, Fig. 1 and Table 1, the hardware: `raya machines spa` lists its numbers; study table2 checks the totals of Table 1.",
        "Figs 2 and 3, ray tracing and its algorithm: drawings without numbers. `kernels/README.md` describes our algorithm.",
        "Figs 4 and 5, the cyclic mapping and the 2-D array: drawings. `raya explore` draws every mapping; study lattice counts Fig. 5's blocks.",
        "Fig. 6, the picture that they analyse: its scene is not published. Study table2 shows ours, study cluster has scenes like it.",
        "Figs 7, 8, 9, 12 and 13 and Tables 2, 3 and 4: the studies of the same names.",
        "Figs 10 and 11, positions of neighbours and transfers of the filter: drawings. Studies table3 and table4 count the rotations.",
        "Yoshitani & Yamazaki, Figs 1 and 2, the voxels and 2-D DDA: drawings. `docs/architecture.md` describes the packets of our 3-D DDA.",
        "Their Table 1, contents of a packet: no claim that a study can test. The studies use its 22 words; `docs/architecture.md` lists ours.",
        "Their Fig. 3: study divisions. Their Fig. 4: study objects.",
        "No curve of a figure was digitised: only numbers in the texts and tables are compared.",
    ],
}


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
    tables = [{"name": t.name, "title": t.title, "columns": list(t.rows.columns), "rows": rows_of(t)}
              for t in page.tables]
    pictures = [{"name": p.name, "title": p.title, "words": p.words} for p in page.pictures]
    comparisons = [{**json_value(c), "ratio": json_value(ratio(c))} for c in page.comparisons]
    drawn = [{**json_value(p), "description": plots.description(p)} for p in page.plots]
    members = {f.name: getattr(page, f.name) for f in dataclasses.fields(page) if f.name not in ("name", "placeholders")}
    claims = [record_of(judgement) for judgement in page.claims]
    return {"study": page.name, **json_value({**members, "tables": tables, "pictures": pictures, "claims": claims,
                                         "comparisons": comparisons, "plots": drawn})}


def record_of(judgement):
    """Returns a claim with its result as {name: value}: members of the JSON report and columns of claims.csv."""
    test = judgement.test
    return {**dataclasses.asdict(judgement.claim), "ensemble": judgement.ensemble, "interval": test.interval if test else "",
            "p": test.p if test else math.nan, "detectable": test.detectable if test else math.nan, "verdict": judgement.verdict,
            "reason": judgement.reason}


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
    return [["claim", "statement", "verdict", "rule", "interval", "ensemble", "result"]] + [
        [f"{c.claim.id}: {c.claim.paper}, {c.claim.place}",
         f"{c.claim.statement} {c.claim.original and '(' + c.claim.original + ')'}".rstrip(), c.verdict,
         c.claim.rule, c.test.interval if c.test else "", c.ensemble, " ".join(filter(None, (c.reason, c.power)))]
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
                + ", ".join(f"{count[verdict]} {verdict}" for verdict in (REPRODUCED, COMPATIBLE, NOT_REPRODUCED, UNTESTABLE, "derived")) + ".")

    papers = list(dict.fromkeys(judgement.claim.paper for judgement in claims))
    sentences = [sentence(claims, f"of {papers[0]}" if len(papers) == 1 else f"of {len(papers)} papers")]
    if len(papers) > 1:
        sentences += [sentence([judgement for judgement in claims if judgement.claim.paper == paper], f"of {paper}") for paper in papers]
    return [*sentences, *filter(None, [errors_sentence(claims)])]


def claims_with(verdict, pages):
    """Returns a sentence with place, statement and our figures for each claim with the verdict."""
    return [f'{c.claim.paper}, {c.claim.place}: "{c.claim.statement}" {c.reason}' for page in pages for c in page.claims if c.verdict == verdict]


def statements_with(verdict, pages):
    """Returns the statement of each claim with the verdict."""
    return [c.claim.statement for page in pages for c in page.claims if c.verdict == verdict]


def news_of(pages):
    """Returns a sentence for each result beyond the papers."""
    return [sentence for page in pages for sentence in page.news]


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


def inlined(svg):
    """Returns inline SVG for the document: colours become CSS variables, which the dark colour scheme redefines."""
    return Markup(re.sub(r": #([0-9a-f]{6})", r": var(--plot-\1, #\1)", svg[svg.index("<svg"):]))


def markdown_table(cells):
    lines = ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in cells]
    return "\n".join([lines[0], "|" + "---|" * len(cells[0])] + lines[1:])


def items(lines):
    return "\n".join(f"- {line}" for line in lines)


def environment():
    templates = Path(__file__).resolve().parent / "templates"  # an installation has style.css there, too
    jinja_environment = jinja2.Environment(loader=jinja2.FileSystemLoader([templates, templates.parents[2] / "host" / "report" / "page"]), trim_blocks=True,
                              autoescape=jinja2.select_autoescape(["html.j2"]), lstrip_blocks=True,
                              undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    jinja_environment.filters.update(classes=classes_of, items=items, markdown_table=markdown_table, prose=prose)
    jinja_environment.globals.update({function.__name__: function for function in (
        cells_of_claims, cells_of_comparisons, cells_of_points, cells_of_table, command_of, len, lines_of_run,
        claims_with, news_of, statements_with, title_of_comparisons, verdict_sentences)}, about=ABOUT, policy=Markup(POLICY),
        OPEN_ROWS=OPEN_ROWS, MAX_ROWS=MAX_ROWS)
    return jinja_environment


def write_page(folder, page):
    """Writes all files of one study, whose verdicts decide() must have set. Returns its drawings for the document: {name: SVG of a plot, or base64
    text of a PNG}."""
    drawings, files = {}, {}
    for table in page.tables:
        files[f"{table.name}.csv"] = csv_of(table.rows)
    for picture in page.pictures:
        drawings[picture.name] = base64.b64encode(picture.png).decode()
        files[f"{picture.name}.png"] = picture.png
    for plot in page.plots:
        drawn = plots.files_of(plot)
        files.update({f"{plot.name}.{kind}": content for kind, content in drawn.items()})
        drawings[plot.name] = inlined(drawn["svg"].decode())
    files.update(texts_of(page))
    for name, content in files.items():  # only after all content has been made, so that an error leaves no files
        write_atomically(folder / name, content)
    return drawings


def names_of(pages):
    """Returns the names of all files of a document, as {name: names of the studies whose results the file contains}."""
    names = {}
    for page in pages:
        names.update(dict.fromkeys([f"{table.name}.csv" for table in page.tables] + [f"{picture.name}.png" for picture in page.pictures]
                                   + [f"{plot.name}.{kind}" for plot in page.plots for kind in ("svg", "png")]
                                   + [f"{page.name}.json", f"{page.name}.md"], {page.name}))
    shared = ["index.html"] + ["claims.csv", "index.md", "claims.md"] * (len(pages) > 1)
    return {**names, **dict.fromkeys(shared, {page.name for page in pages})}


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


def write_document(folder, pages, drawings, skip_notes=()):
    """Writes index.html. For several pages, also writes index.md, claims.md and claims.csv, and rewrites the pages' JSON and Markdown, because their
    verdicts now take all claims into account. `skip_notes`: sentences on studies that did not run."""
    decide([judgement for page in pages for judgement in page.claims])
    if len(pages) > 1:
        claims = pd.DataFrame([record_of(judgement) for page in pages for judgement in page.claims])
        write_atomically(folder / "claims.csv", csv_of(claims))
        for name, content in (item for page in pages for item in texts_of(page).items()):
            write_atomically(folder / name, content)
    body = environment().get_template("document.html.j2").render(pages=pages, drawings=drawings, skip_notes=skip_notes, references=REFERENCES)
    write_atomically(folder / "index.html", body)
    if len(pages) > 1:
        for name in ("index.md", "claims.md"):
            write_atomically(folder / name, markdown_of(f"{name}.j2", pages=pages, skip_notes=skip_notes, references=REFERENCES))
