#!/usr/bin/env python3
"""Compares reports of every kind with the schemas of docs/schema: every member is described, and every described member occurs in a report.

    tests/tools/test_reports.py RAYA PATCH_KERNELS [MPIRUN]      without MPIRUN, reports of ranks are skipped. Exit code 77: no jsonschema
"""
import json, os, re, shlex, subprocess, sys, tempfile, warnings
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True
from report_schema import read_schemas
try:
    import jsonschema
except ImportError:
    print("skipped: this Python has no jsonschema (Debian: python3-jsonschema)")
    sys.exit(77)
warnings.simplefilter("ignore", DeprecationWarning)  # RefResolver, required by Debian's version, is deprecated in later ones

SCENES = ROOT / "scenes"
# Described members that do not occur in the reports of this test, with the reason.
RARE = {
    "render.json: measured.earlier_s": "resumed renders: tests/cli/test_checkpoint.cpp",
    "render.json: measured.no_roofline": "devices that do not time their commands, resumed renders",
    "render.json: rank.no_roofline": "devices that do not time their commands, resumed renders",
    "bench.json: rows[].no_roofline": "devices that do not time their commands",
    "verify.json: devices[].pci_address": "GPUs",
}
# These members need MPI.
MPI_MEMBERS = ("ping.json: ", "render.json: measured.ranks", "render.json: rank.")
# (kernel file, text, faulty replacement): a mutant, for which a check of verify must fail.
FAULT = ("shared/mapping.h", "if (m.kind == RAYA_ROWS) return row % m.pes;", "if (m.kind == RAYA_ROWS) return (row + 1) % m.pes;")


class Rules:
    """The schemas, with jsonschema's validators."""

    def __init__(self, change=lambda schema: schema):
        self.schemas = read_schemas()
        for root in self.schemas.values():
            root.value = change(root.value)
        self.store = {"file:///" + name: root.value for name, root in self.schemas.items()}
        self.whole = {name: self.validator(root) for name, root in self.schemas.items()}

    def validator(self, node):
        resolver = jsonschema.RefResolver("file:///" + node.file, self.schemas[node.file].value, store=self.store)
        return jsonschema.Draft202012Validator(node.value, resolver=resolver)

    def wrong(self, name, report):
        """Returns a message for each error in a report."""
        return [f"{'.'.join(map(str, e.absolute_path)) or 'the report'}: {e.message[:200]}" for e in self.whole[name].iter_errors(report)]

    def mark_used(self, node, value, used):
        """Adds to `used` the places of all schema members that describe parts of `value`."""
        if node.has("$ref"):
            self.mark_used(node.target(), value, used)
        for key in ("anyOf", "oneOf"):
            for i in range(len(node.get(key, []))):
                if self.validator(node[key][i]).is_valid(value):
                    self.mark_used(node[key][i], value, used)
        if node.has("if"):
            branch = "then" if self.validator(node["if"]).is_valid(value) else "else"
            if node.has(branch):
                self.mark_used(node[branch], value, used)
        if isinstance(value, dict):
            for name, member in node.members():
                if name in value:
                    used.add(place(member))
                    self.mark_used(member, value[name], used)
        if isinstance(value, list) and node.has("items"):
            for item in value:
                self.mark_used(node["items"], item, used)


def place(node):
    """Returns the place of a member's node, as 'render.json: load.simulated'; in a definition, the path starts with the definition's name."""
    keys, path = iter(node.pointer.strip("/").split("/")), ""
    for key in keys:
        if key in ("properties", "$defs"):
            path += ("." if path else "") + next(keys)
        elif key == "items":
            path += "[]"
    return f"{node.file}: {path}"


class Reports:
    """Reports of the program, made in a folder."""

    def __init__(self, raya, patch_kernels, mpirun, folder):
        self.raya, self.patch_kernels, self.mpirun, self.folder = raya, patch_kernels, mpirun, folder
        self.made = []  # (file of the schema, command, report)

    def run(self, *command, code=0, stdout=subprocess.DEVNULL, **variables):
        command = [str(argument) for argument in command]
        done = subprocess.run(command, cwd=self.folder, env={**os.environ, **variables}, stdout=stdout, stderr=subprocess.PIPE, text=True)
        assert done.returncode == code, f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr}"
        return done.stdout

    def make(self, schema_name, *command, file="r.json", code=0, launcher=(), **variables):
        (self.folder / file).unlink(missing_ok=True)
        self.run(*launcher, self.raya, *command, code=code, **variables)
        self.add_report(schema_name, " ".join(map(str, command)), (self.folder / file).read_text())

    def add_report(self, schema_name, name, text):
        self.made.append((schema_name + ".json", name, json.loads(text)))

    def file(self, name, text):
        (self.folder / name).write_text(text)
        return self.folder / name

    def make_renders(self):
        # A scene for which raya warns, with a polygon without area and an unknown entity.
        odd = self.file("odd.nff", (SCENES / "planes.nff").read_text() + "p 3\n0 0 0\n0 0 0\n1 1 1\ntt 1\n")
        quick_options = ["--size", "16", "--lanes", "1", "--format", "fp32", "--quiet", "--report", "r.json"]  # building kernels takes most of the time
        spheres, ring = SCENES / "spheres.nff", ["--pes", "8"]

        def render(scene, *options, output="x.ppm", launcher=()):
            self.make("render", "render", scene, *options, *quick_options, "-o", output, launcher=launcher)

        render(spheres, *ring, "--page", "r.html")
        render(odd, *ring, "--mapping", "rows", "--light", "1,2,3", output="x.pfm")
        render(spheres, *ring, "--antialias", "filter", "--exchange", "bus", "--exposure", "1", "--fold", "block")
        render(spheres, *ring, "--antialias", "supersample", "--points", "diagonals")
        render(spheres, *ring, "--mapping", "dynamic:4")
        render(spheres, *ring, "--mapping", "hybrid:4,10,0.5", "--exposure", "-1")
        for accel in ("grid", "bvh"):
            render(spheres, "--accel", accel, "--machine", "grande")
        torus = ["--machine", "torus", "--nodes", "2x2x2", "--returns", "rays"]
        render(spheres, *torus, "--async", "--packets", "p.csv.gz")
        if self.mpirun:
            launcher = [self.mpirun, "-n", "2"]
            render(spheres, *ring, launcher=launcher)
            render(spheres, *torus, "--profile", launcher=launcher)
            self.add_report("ping", "ping", self.run(*launcher, self.raya, "ping", stdout=subprocess.PIPE))

    def make_other_reports(self):
        scene = SCENES / "spheres.nff"
        quick_options = ["--format", "fp32", "--size", "16", "--lanes", "1", "--samples", "1", "--report"]
        self.make("bench", "bench", scene, *quick_options, "base.json", file="base.json")
        self.make("bench", "bench", scene, "--compare", "base.json", "--tolerance", "100", "--page", "b.html", *quick_options, "r.json")
        self.make("bench", "bench", scene, "--variants", "none", *quick_options, "r.json")
        self.make("bench", "bench", scene, "--build", "--variants", "none,torus", *quick_options, "r.json")
        self.run(self.raya, "tune", scene, "--seconds", 3, "--variants", "none", "--format", "fp32", "--size", "16", XDG_CACHE_HOME=self.folder / "cache")
        self.add_report("tuned", "the stored settings", next(self.folder.glob("cache/raya/tuned-*.json")).read_text())
        check = ["verify", "--brief", "--lanes", "1", "--only", "machine mapping: rows", "--report", "r.json"]
        self.make("verify", *check)
        # The only check is skipped, because there are no stored results in this format.
        skipped = f"render {shlex.quote(str(scene))} --lanes 1 --format e7m11"
        self.make("verify", "verify", "--as", skipped, "--only", "number", "--report", "r.json", code=4)
        self.run(self.patch_kernels, "kernels", *FAULT)
        self.make("verify", *check, "--kernel-dir", "kernels", code=4)
        mesh = self.file("odd.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n")  # with a face without area
        for arguments in (("odd.nff", "--accel", "grid"), (mesh,), (SCENES / "centre.nff", "--offset", "3")):
            self.add_report("info", f"info {arguments[0]}", self.run(self.raya, "info", *arguments, "--json", stdout=subprocess.PIPE))
        self.gpu_day()
        for mapping in ("cyclic:3", "rows"):
            self.run(self.raya, "explore", scene, "--mapping", mapping, "--pes", "8", "--size", "16", "--lanes", "1", "--format", "fp32", "-o", "e.html")
            self.add_report("explore", "raya explore", re.search(r'<pre id="report".*?>(.*?)</pre>', (self.folder / "e.html").read_text(), re.S)[1])
        for study in ("table2", "table4", "fig8"):
            self.make("study", "study", study, "--size", "32", "--views", "20", "-o", "study", file=f"study/{study}.json")
        self.make("manifest", "study", "fig8", scene, "--size", "32", "--views", "20", "-o", "manifest", file="manifest/manifest.json")

    def gpu_day(self):
        """Makes a report of tools/gpu_day with steps that are right, wrong, late or impossible on this machine."""
        steps = self.folder / "day/steps"
        steps.mkdir(parents=True)
        # (step, "STAGE SECONDS VERDICT", output)
        for name, code, text in [("devices", "1 0 right", "$ raya devices\nGPU"),
                                 ("verify-quick", "1 12 exit code 4", "$ raya verify --quick\nGPU (maker, driver 1)\nFAIL  grid \"a\\b\""),
                                 ("goal-spheres-group32", "5 3 right", "$ raya bench\ntrace  fp32  1  32  5120.5  5"),
                                 ("hash-ring-cones-fp32", "3 1 late", "not started"), ("ranks", "5 0 not here: no mpirun", "")]:
            (steps / f"{name}.code").write_text(code + "\n")
            (steps / f"{name}.txt").write_text(text + "\n")
        (self.folder / "day/stage-1").touch()
        self.run(ROOT / "tools/gpu_day", "--out", self.folder / "day", "--raya", self.raya, code=4)  # a step is wrong
        self.add_report("gpu_day", "tools/gpu_day", (self.folder / "day/report.json").read_text())


def unused_members(rules, made, ranks):
    """Yields members of the schemas that are in no report, and members of RARE that are in a report."""
    used = set()
    for schema_name, _, report in made:
        rules.mark_used(rules.schemas[schema_name], report, used)
    for root in rules.schemas.values():
        for node in root.walk():
            for _, member in node.members():
                name = place(member)
                if name not in used and name not in RARE and (ranks or not name.startswith(MPI_MEMBERS)):
                    yield f"{name}: described, but in no report of this test"
    yield from (f"{name}: in RARE, but in a report of this test" for name in RARE if name in used)


def description(node):
    return node.get("description") or node.has("$ref") and description(node.target())


def incomplete_schemas(rules):
    """Yields schema members without a description, and objects that accept undescribed members."""
    for root in rules.schemas.values():
        jsonschema.Draft202012Validator.check_schema(root.value)
        closed = {id(n.target().value) for n in root.walk() if n.has("$ref") and n.get("unevaluatedProperties") is False}
        closed |= {id(n[key].value) for n in root.walk() for key in ("then", "else") if n.has(key)}
        for node in root.walk():
            if "/if/" in node.pointer + "/":
                continue
            for name, member in node.members():
                if not description(member):
                    yield f"{place(member)}: no description"
            is_closed = False in (node.get("additionalProperties"), node.get("unevaluatedProperties"))
            if node.has("properties") and not is_closed and id(node.value) not in closed:
                yield f"{node.file}{node.pointer}: accepts any member"


def relaxed(schema):
    """Returns the schema with all members optional, for shortened examples."""
    if isinstance(schema, list):
        return [relaxed(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    return {key: value if key == "if" else relaxed(value) for key, value in schema.items() if key not in ("required", "dependentRequired", "minItems")}


def wrong_examples():
    rules = Rules(relaxed)
    for name, root in rules.schemas.items():
        yield from (f"{name}: its example: {line}" for example in root.get("examples", []) for line in rules.wrong(name, example))


def main(raya, patch_kernels, mpirun=""):
    rules = Rules()
    with tempfile.TemporaryDirectory() as folder:
        reports = Reports(Path(raya).resolve(), Path(patch_kernels).resolve(), mpirun, Path(folder))
        reports.make_renders()
        reports.make_other_reports()
    made = reports.made
    wrong = [f"{schema_name}, {name}: {line}" for schema_name, name, report in made for line in rules.wrong(schema_name, report)]
    wrong += [*incomplete_schemas(rules), *wrong_examples(), *unused_members(rules, made, bool(mpirun))]
    if not rules.wrong(made[0][0], {**made[0][2], "unknown": 1}) or not rules.wrong(made[0][0], {**made[0][2], "image": 1}):
        wrong.append("an unknown member, or one of another type, is not detected")
    print("\n".join(wrong) or f"{len(made)} reports compared with {len(rules.schemas)} schemas: no fault")
    return bool(wrong)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
