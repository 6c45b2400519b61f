#!/usr/bin/env python3
"""Tests tools/hot_lines: a line that is made slow becomes the hottest, and errors name what is missing.
  test_hot_lines.py BUILD     the build folder: raya and patch_kernels
Exit code 77: no perf, no LLVM symbolizer, or perf is not permitted (tools/setup --profile); the checks that need none have passed."""
import os, pathlib, re, shutil, subprocess, sys, tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv[1]).resolve()
SCRATCH = pathlib.Path(tempfile.mkdtemp())
LLVM = subprocess.run([ROOT / "tools" / "setup", "--llvm"], text=True, capture_output=True, check=True).stdout.strip()
SYMBOLIZER = f"llvm-symbolizer-{LLVM}"
SCENE = [ROOT / "scenes" / "centre.nff", "--machine", "grande", "--format", "fp32"]


def expect(truth, *report):
    if not truth:
        sys.exit(f"FAILED line {sys._getframe(1).f_lineno}: {' '.join(map(str, report))}")


def hot_lines(*arguments, code=0, texts=(), **environment):
    """Runs the tool, checks its exit code and texts, and returns its stdout."""
    done = subprocess.run([sys.executable, ROOT / "tools" / "hot_lines", *map(str, arguments)], text=True, capture_output=True,
                          env={**os.environ, **environment})
    output = done.stdout + done.stderr
    expect(done.returncode == code and all(text in output for text in texts),
           f"exit code {done.returncode}, not {code}, or not all of {texts} in:\n{output}")
    return done.stdout


def mock_programs(**bodies):
    """Returns a PATH with bash and these shell scripts only."""
    folder = pathlib.Path(tempfile.mkdtemp(dir=SCRATCH))
    (folder / "bash").symlink_to(shutil.which("bash"))
    for name, body in bodies.items():
        (folder / name).write_text(f"#!{shutil.which('bash')}\n{body}\n")
        (folder / name).chmod(0o755)
    return str(folder)


# Errors.
at_build = "--build", BUILD
hot_lines(*at_build, code=2, texts=["no scene"])
hot_lines("--build", SCRATCH, *SCENE, code=3, texts=[f"{SCRATCH}/raya is missing", "tools/run"])
hot_lines(*at_build, *SCENE, code=3, texts=[f"{SYMBOLIZER} is missing", "tools/setup --profile"], PATH=mock_programs())
hot_lines(*at_build, *SCENE, code=3, texts=["perf is missing", "tools/setup --profile"], PATH=mock_programs(**{SYMBOLIZER: ""}))
hot_lines(*at_build, *SCENE, code=3, texts=["perf cannot sample cpu-clock", "perf_event_paranoid", "No permission"],
          PATH=mock_programs(**{SYMBOLIZER: "", "perf": "echo No permission >&2; exit 255"}))
probe = ["perf", "record", "-q", "-N", "-o", "/dev/null", "-e", "cpu-clock", "true"]
if not shutil.which(SYMBOLIZER) or not shutil.which("perf") or subprocess.run(probe, capture_output=True).returncode:
    sys.exit(77)

# A line that is made slow is the hottest, with its function and text. The line is after an include that the preprocessor skips.
kernels = SCRATCH / "kernels"
line_text = "count_all_tests(scene, t, m); for (volatile int turn = 0; turn < 5000; ++turn) {}"
subprocess.run([BUILD / "tests" / "patch_kernels", kernels, "shading/search.clh", "count_all_tests(scene, t, m);", line_text], check=True)
lines = (kernels / "shading" / "search.clh").read_text().splitlines()
place = f"shading/search.clh:{next(number for number, line in enumerate(lines, 1) if line_text in line)}"


def share_of(output, ending):
    """Returns the share in % of the row with this ending in a table; 0 if there is none."""
    found = re.search(rf"^ *([\d.]+) .* {re.escape(ending)}$", output, re.M)
    return float(found[1]) if found else 0


slow = hot_lines(*at_build, *SCENE, "--kernel-dir", kernels, texts=["kernel trace: "])
hottest = slow.split("text\n")[1].splitlines()[0].split(maxsplit=4)
expect(float(hottest[0]) > 80 and hottest[2:] == [place, "cast_rays", line_text], hottest, slow)
expect(share_of(slow, "cast_rays") > 80, slow)  # the function
fast = hot_lines(*at_build, *SCENE)
expect(share_of(fast, "count_all_tests(scene, t, m);") < 20, fast)

# Shares of kernels and host code. perf appends :u where an ordinary user may not sample the Linux kernel.
shares = re.match(r"(\d+) samples of cpu-clock(?::u)?: ([\d.]+) % in kernels, ([\d.]+) % in host code", slow)
expect(shares and abs(float(shares[2]) + float(shares[3]) - 100) < 0.11, slow)
samples = int(re.search(r"kernel trace: (\d+) samples", slow)[1])
expect(abs(samples / int(shares[1]) - float(shares[2]) / 100) < 0.01, slow)

print("tools/hot_lines: as expected")
