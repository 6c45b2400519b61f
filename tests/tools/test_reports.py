#!/usr/bin/env python3
"""Compares reports of every kind with their schemas: every member is described, and every described member occurs in a report.

    tests/tools/test_reports.py RAYA SCHEMAS PATCH_KERNELS [MPIRUN]      SCHEMAS: folder; without MPIRUN, reports of ranks are skipped
Exit code 77: no jsonschema.
"""
import json, os, re, subprocess, sys, tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
try:
    import jsonschema
except ImportError:
    print("skipped: this Python has no jsonschema (Debian: python3-jsonschema)")
    sys.exit(77)

SCENES = ROOT / "scenes"
# Described members that do not occur in the reports of this test, with the reason.
RARE = {
    "render.json: measured.earlier_s": "resumed renders: tests/cli/test_checkpoint.cpp",
    "render.json: measured.no_roofline": "devices that do not time their commands, resumed renders",
    "render.json: measured.ranks[].no_roofline": "devices that do not time their commands, resumed renders",
    "bench.json: rows[].no_roofline": "devices that do not time their commands",
    "render.json: skipped[].place": "meshes, whose reports of raya info are in this test",
    "verify.json: devices[].pci_address": "GPUs",
}
# These members need MPI.
MPI_MEMBERS = "render.json: measured.ranks"
# (kernel file, text, faulty replacement): a mutant, for which a check of verify must fail.
FAULT = ("shared/mapping.h", "if (m.kind == RAYA_ROWS) return row % m.pes;", "if (m.kind == RAYA_ROWS) return (row + 1) % m.pes;")


def members_of(schema, path):
    """Yields (place, value) of every value that a schema describes, as ('render.json: load.simulated', schema)."""
    for name, member in schema.get("properties", {}).items():
        yield f"{path}{name}", member
        yield from members_of(member, f"{path}{name}.")
    if "items" in schema:
        yield from members_of(schema["items"], path.rstrip(".") + "[].")


def used_members(schema, value, path):
    """Yields the places of the members that occur in a report."""
    for name in value if isinstance(value, dict) and "properties" in schema else ():
        yield f"{path}{name}"
        yield from used_members(schema["properties"][name], value[name], f"{path}{name}.")
    for item in value if isinstance(value, list) and "items" in schema else ():
        yield from used_members(schema["items"], item, path.rstrip(".") + "[].")


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
        # The kernels are those of other tests, because building them takes most of the time.
        quick_options = ["--size", "16", "--lanes", "4", "--bounces", "4", "--format", "fp32", "--quiet", "--report", "r.json"]
        spheres, ring = SCENES / "spheres.nff", ["--pes", "8"]

        def render(scene, *options, output="x.ppm", launcher=()):
            self.make("render", "render", scene, *options, *quick_options, "-o", output, launcher=launcher)

        render(spheres, *ring, "--page", "r.html")
        render(odd, *ring, "--mapping", "rows", "--light", "1,2,3", output="x.pfm")
        render(spheres, *ring, "--antialias", "filter", "--exchange", "bus", "--exposure", "1", "--fold", "block")
        render(spheres, *ring, "--antialias", "supersample", "--points", "diagonals")
        render(spheres, *ring, "--mapping", "dynamic:4")
        render(spheres, *ring, "--split", "4")
        render(spheres, *ring, "--mapping", "hybrid:4,10,0.5", "--exposure", "-1")
        for accel in ("grid", "bvh"):
            render(spheres, "--accel", accel, "--machine", "grande")
        torus = ["--machine", "torus", "--nodes", "2x2x2", "--returns", "rays"]
        render(spheres, *torus, "--async")
        if self.mpirun:
            launcher = [self.mpirun, "-n", "2"]
            render(spheres, *ring, launcher=launcher)
            render(spheres, *torus, "--profile", launcher=launcher)

    def make_other_reports(self):
        scene = SCENES / "spheres.nff"
        quick_options = ["--format", "fp32", "--size", "16", "--lanes", "4", "--bounces", "4", "--samples", "1", "--report"]
        self.make("bench", "bench", scene, *quick_options, "base.json", file="base.json")
        self.make("bench", "bench", scene, "--compare", "base.json", "--tolerance", "100", "--page", "b.html", *quick_options, "r.json")
        self.make("bench", "bench", scene, "--variants", "none,grid,bvh,torus", *quick_options, "r.json")
        hashes = {row["hash"] for row in self.made[-1][2]["rows"]}
        assert len(hashes) == 1, hashes  # all variants render the same image
        # Exit code 4: a build took longer than --limit.
        self.make("bench", "bench", scene, "--build", "--variants", "none", "--limit", "0.001", *quick_options, "r.json", code=4)
        builds = self.made[-1][2]["builds"]
        assert [build["kernel"] for build in builds] == ["ring/trace.cl", "ring/filter.cl", "ring/contrast.cl"], builds
        assert all(build["build_s"] > 0 and build["first_launch_s"] > 0 for build in builds), builds
        self.run(self.raya, "tune", scene, "--seconds", 3, "--variants", "none", "--format", "fp32", "--size", "16", XDG_CACHE_HOME=self.folder / "cache")
        self.add_report("tuned", "the stored settings", next(self.folder.glob("cache/raya/tuned-*.json")).read_text())
        check = ["verify", "--brief", "--lanes", "4", "--only", "machine mapping: rows", "--report", "r.json"]
        self.make("verify", *check)
        self.run(self.patch_kernels, "kernels", *FAULT)
        self.make("verify", *check, "--kernel-dir", "kernels", code=4)
        mesh = self.file("odd.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n")  # with a face without area
        many = self.folder / "many.nff"  # more than a PE of the SPA holds
        self.run(self.raya, "generate", "uniform", "2000", "--voxels", "2x2x2", "-o", many)
        for arguments in (("odd.nff", "--accel", "grid"), (mesh,), (SCENES / "centre.nff", "--offset", "3"), (many,)):
            self.add_report("info", f"info {arguments[0]}", self.run(self.raya, "info", *arguments, "--json", stdout=subprocess.PIPE))
        self.gpu_day()
        for mapping, explored in (("cyclic:3", scene), ("rows", many)):
            self.run(self.raya, "explore", explored, "--mapping", mapping, "--pes", "8", "--size", "16", "--lanes", "4", "--bounces", "4", "--format", "fp32", "-o", "e.html")
            self.add_report("explore", "raya explore", re.search(r'<pre id="report".*?>(.*?)</pre>', (self.folder / "e.html").read_text(), re.S)[1])
        for study in ("table2", "table4", "fig8"):
            self.make("study", "study", study, "--size", "32", "--views", "20", "-o", "study", file=f"study/{study}.json")
        self.make("manifest", "study", "fig8", scene, "--size", "32", "--views", "20", "-o", "manifest", file="manifest/manifest.json")

    def gpu_day(self):
        """Makes a report of tools/gpu_day with steps that are right, wrong, late or impossible on this machine."""
        steps = self.folder / "day/steps"
        steps.mkdir(parents=True)
        # (step, verdict, output)
        for name, verdict, text in [("devices", "[stage 1, 0 s] right", "$ raya devices\nGPU"),
                                    ("verify-quick", "[stage 1, 12 s] exit code 4", "$ raya verify --quick\nGPU (maker, driver 1)\nFAIL  grid \"a\\b\""),
                                    ("goal-spheres-group32", "[stage 5, 3 s] right", "$ raya bench\ntrace  fp32  1  32  5120.5  5"),
                                    ("hash-ring-cones-fp32", "[stage 3, 1 s] late", "not started"),
                                    ("ranks", "[stage 5, 0 s] not here: no mpirun", "")]:
            (steps / f"{name}.txt").write_text(f"{text}\n{verdict}\n")
        (self.folder / "day/stage-1").touch()
        self.run(ROOT / "tools/gpu_day", "--out", self.folder / "day", "--raya", self.raya, code=4)  # a step is wrong
        self.add_report("gpu_day", "tools/gpu_day", (self.folder / "day/report.json").read_text())


def unused_members(schemas, made, ranks):
    """Yields members of the schemas that are in no report, and members of RARE that are in a report."""
    used = {name for schema, _, report in made for name in used_members(schemas[schema], report, f"{schema}: ")}
    for name in (name for schema, root in schemas.items() for name, _ in members_of(root, f"{schema}: ")):
        if name not in used and name not in RARE and (ranks or not name.startswith(MPI_MEMBERS)):
            yield f"{name}: described, but in no report of this test"
    yield from (f"{name}: in RARE, but in a report of this test" for name in RARE if name in used)


def main(raya, folder_of_schemas, patch_kernels, mpirun=""):
    schemas = {path.name: json.loads(path.read_text()) for path in Path(folder_of_schemas).glob("*.json")}
    rules = {name: jsonschema.Draft202012Validator(schema) for name, schema in schemas.items()}
    with tempfile.TemporaryDirectory() as folder:
        reports = Reports(Path(raya).resolve(), Path(patch_kernels).resolve(), mpirun, Path(folder))
        reports.make_renders()
        reports.make_other_reports()
    made = reports.made
    wrong = [f"{schema}, {name}: {list(error.absolute_path)}: {error.message[:200]}" for schema, name, report in made
             for error in rules[schema].iter_errors(report)]
    wrong += unused_members(schemas, made, bool(mpirun))
    for change in ({"unknown": 1}, {"image": 1}):
        if rules[made[0][0]].is_valid({**made[0][2], **change}):
            wrong.append(f"{change} in a report is not detected")
    print("\n".join(wrong) or f"{len(made)} reports compared with {len(schemas)} schemas: no fault")
    return bool(wrong)


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
