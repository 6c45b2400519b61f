#!/usr/bin/env python3
"""Tests tools/gpu_check with injected faults in kernels, in the budget and in the output of compilers, and without compilers. Takes some seconds.
  test_gpu_check.py BUILD     the build folder: kernel_builds and patch_kernels
Exit code 77: no compiler for GPUs; the checks that need none have passed."""
import csv, json, os, pathlib, shutil, subprocess, sys, tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv[1]).resolve()
SCRATCH = pathlib.Path(tempfile.mkdtemp())
sys.path.insert(0, str(ROOT / "tools"))
from gpu_vendors import CORES, LLVM, Amd, Figures, Nvidia  # noqa: E402

gpu_check = {"__name__": "gpu_check", "__file__": str(ROOT / "tools" / "gpu_check")}
exec(compile((ROOT / "tools" / "gpu_check").read_text(), gpu_check["__file__"], "exec"), gpu_check)
COLUMNS, Budget = gpu_check["COLUMNS"], gpu_check["Budget"]


def expect(truth, *report):
    if not truth:
        sys.exit(f"FAILED line {sys._getframe(1).f_lineno}: {' '.join(map(str, report))}")


def check(*options, code=0, path=None, texts=()):
    """Runs the tool and checks its exit code and texts. Returns its JSON report."""
    report = SCRATCH / "report.json"
    report.unlink(missing_ok=True)
    done = subprocess.run([ROOT / "tools" / "gpu_check", "--build", BUILD, "--json", report, *map(str, options)], text=True, capture_output=True,
                          env={**os.environ, **({"PATH": str(path)} if path else {})})
    output = done.stdout + done.stderr
    if done.returncode != code or not all(text in output for text in texts):
        sys.exit(f"FAILED line {sys._getframe(1).f_lineno}: exit code {done.returncode}, not {code}, or not all of {texts} in:\n{output}")
    return json.loads(report.read_text()) if report.exists() else None


def patched(file, *changes):
    """Returns a folder with a copy of the kernels; each change (find, replace) is applied to the kernel `file`."""
    folder = SCRATCH / f"kernels{len(list(SCRATCH.iterdir()))}"
    subprocess.run([BUILD / "tests" / "patch_kernels", folder, *[argument for change in changes for argument in (file, *change)]], check=True)
    return folder


# Occupancy as in the vendors' calculators: CUDA's occupancy calculator, and "Occupancy" in clang's comments in AMD assembly.
def warps(core, width, group, by_registers, local=0):
    return core.set_occupancy(Figures("k", "v", "t", width, group, 0, 0, 0, local), by_registers).warps


sm_90, gfx90a, dg2 = (CORES[name] for name in ("sm_90", "gfx90a", "dg2"))
expect([Nvidia.warps_of(r) for r in (32, 64, 96, 128, 168, 255)] == [64, 32, 20, 16, 12, 8])
expect([Amd.waves_of(v, s) for v, s in ((172, 104), (64, 96), (128, 16), (129, 16), (24, 104))] == [8, 32, 16, 12, 28])
expect(warps(sm_90, 32, 32, 64) == 32 and warps(sm_90, 32, 64, 64) == 64)  # at most 32 groups
expect(warps(sm_90, 32, 1024, 32) == 32 and warps(sm_90, 32, 1024, 31) == 0)
expect(warps(sm_90, 32, 256, 64, 57 * 1024 - 1024) == 32)  # 228 KB = 4 x 57 KB
expect(warps(gfx90a, 64, 32, 32) == 32 and warps(gfx90a, 64, 128, 32) == 32 and warps(gfx90a, 64, 128, 12) == 12)
expect(warps(dg2, 8, 32, 128) == 128 and warps(dg2, 16, 32, 64) == 64)

# Faults in the output of compilers.
expect(not Nvidia.faults_of("\tadd.rn.f32 \t%f1, %f2, %f3;\n\tcvt.rzi.s32.f32 \t%r1, %f1;\n\tsetp.gt.f32 \t%p1, %f1, %f2;\n"))
for line, fault in (("add.f32 %f1;", "nearest"), ("@%p1 mul.rz.f32 %f1;", "nearest"), ("fma.rn.ftz.f32 %f1;", "flushed"),
                    ("sqrt.approx.f32 %f1;", "nearest"), ("@%p1 call (retval0), f, (param0);", "call"), ("call.uni f;", "call"), ("mul.rn.f64 %f1;", "double"), ("max.ftz.f32 %f1;", "flushed")):
    expect(fault in " ".join(Nvidia.faults_of(f"\tmov.u32 %r1, %r2;\n\t{line}\n")), line)
for line, fault in (("\tv_fma_f64 v[0:1], v[2:3]", "double"), ("\t.amdhsa_float_denorm_mode_32 0", "flushed"),
                    ("\t.amdhsa_float_round_mode_32 3", "round"), ("\ts_add_u32 s4, s4, _Z3fooi@gotpcrel32@lo+4", "unresolved: _Z3fooi"), ("\ts_swappc_b64 s[30:31], s[4:5]", "call")):
    expect(fault in " ".join(Amd.faults_of(f"bar:\n\tv_add_f32 v0, v1, v2\n{line}\n\ts_add_u32 s4, s4, bar@rel32@lo\n")), line)
expect(not Amd.faults_of("bar:\n\tv_add_f32 v0, v1, v2\n\ts_add_u32 s4, s4, bar@rel32@lo\n"))

# The budget: every figure at its limit and above the limit.
file = SCRATCH / "budget.csv"
base_figures = Figures("k", "v", "t", 32, 32, 100, 0, 40, 0)
Budget(file).write([base_figures], {"t": "a 1"})
budget = Budget(file)
expect(not budget.all_faults([base_figures], {"t": "a 1"}, True) and not budget.all_faults([], {"t": "a 2"}, True))
for change, fault in (({}, ""), ({"registers": 105}, ""), ({"registers": 106}, "registers: 106, 100 in the budget"), ({"spills": 1}, "spills: 1, 0"),
                      ({"scalar_spills": 1}, "scalar spills"), ({"stack": 43}, "stack"), ({"local": 4}, "local"),
                      ({"width": 16}, "threads of 16 work-items, 32"), ({"width": 64, "registers": 50}, ""), ({"variant": "w"}, "no budget")):
    found = list(budget.faults(Figures(**{**base_figures.__dict__, **change})))
    expect(len(found) == (fault != "") and fault in "".join(found), change, found)
Budget(file).write([Figures("l", "v", "t", 32, 32, 7, 0, 0, 0)], {"t": "a 1"}, whole=False)
expect([row["registers"] for row in Budget(file).rows.values()] == ["100", "7"])
Budget(file).write([Figures("k", "v", "u", 32, 32, 9, 0, 0, 0)], {"u": "b 1"})
expect(len(Budget(file).rows) == 3 and Budget(file).versions == {"t": "a 1", "u": "b 1"})
expect(budget.stale({("k", "other", "t")}, ["t"]) == [("k", "v", "t")] and not budget.stale(set(), ["u"]))

# Bad options; no compilers.
check("--targets", "sm_1", code=2, texts=["sm_1"])
check("--write-budget", "--group", "64", code=2, texts=["--write-budget"])
program_folder = SCRATCH / "bin"
program_folder.mkdir()
for program in ("env", "python3", "bash"):
    (program_folder / program).symlink_to(shutil.which(program))
check(code=3, path=program_folder, texts=[f"Debian: clang-{LLVM}", "Debian: intel-opencl-icd", "tools/setup --gpu"])

# The remaining checks compile kernels.
only_compose = ["--only", "torus/compose fp32"]
done = subprocess.run([ROOT / "tools" / "gpu_check", "--build", BUILD, *only_compose], capture_output=True, text=True)
if done.returncode == 3:
    print("skipped: no compiler for GPUs (tools/setup --gpu); the checks that need none have passed")
    sys.exit(77)
report = check(*only_compose)
versions, kernels = report["versions"], report["kernels"]
expect([k["target"] for k in kernels] == list(versions) and all(k["kernel"] == "torus/compose" and k["registers"] > 0 for k in kernels), kernels)


def budget_of(change=lambda row: None, change_version=lambda version: version):
    rows = [{key: kernel[key] for key in COLUMNS} for kernel in kernels]
    for row in rows:
        change(row)
    path = SCRATCH / "changed.csv"
    with open(path, "w") as to:
        to.writelines(f"# made for {target}: {change_version(version)}\n" for target, version in versions.items())
        csv.DictWriter(to, COLUMNS).writeheader()
        csv.DictWriter(to, COLUMNS).writerows(rows)
    return "--budget", path


check(*only_compose, *budget_of())
lower_budget = budget_of(lambda row: row.update(registers=int(row["registers"] / 1.06)))
check(*only_compose, *lower_budget, code=4, texts=[f"torus/compose fp32, {target}: registers: " for target in versions] + ["--write-budget"])
check(*only_compose, *lower_budget, "--write-budget")
check(*only_compose, "--budget", lower_budget[1])
other_budget = budget_of(lambda row: row.update(registers=1), lambda version: version + "x")
check(*only_compose, *other_budget, texts=[f"{target}: not compared: the budget is of other compilers" for target in versions])

# A kernel with an injected fault is detected for every target.
sum_line = "sum = vec_mad(vec_of(c.x, c.y, c.z), c.w, sum);"
head = "__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))\nvoid compose("
for text, changes in (("double precision", [(sum_line, "sum = vec_mad(vec_of((float)((double)c.x * c.y / 3.0), c.y, c.z), c.w, sum);")]),
                      ("nowhere", [(sum_line, "sum.x = nowhere(c.x);"), (head, "float nowhere(float x);\n" + head)]),
                      ("does not build", [(sum_line, "sum = vec_nad(sum);")])):
    report = check(*only_compose, "--kernel-dir", patched("torus/compose.cl", *changes), code=4, texts=[text])
    expect({fault["target"] for fault in report["faults"]} == set(versions), text, report["faults"])

print(f"tools/gpu_check: as expected, for {', '.join(versions)}")
