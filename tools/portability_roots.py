"""`tools/portability --root RELEASE`: runs the checks in a Debian of its own, made by tools/debian_root in ~/.cache/raya/roots/RELEASE. The sources of this
checkout are mounted there, not writable; the build folder is BUILD/roots/RELEASE, so each checkout has its own."""
import json, os, subprocess, sys, time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DEBIAN_ROOT = ROOT / "tools" / "debian_root"
FOLDER = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "raya" / "roots"
PACKAGES = "tools/setup --gpu --package && apt-get install -qq -y --no-install-recommends git mesa-opencl-icd"
TARGETS = {"vectors": "test_number", "defects": "portability_defects"}  # {check: the program that it needs besides raya}


def saved_results(build):
    """Returns {release: results that `tools/portability --root` saved}, for the build folder of this checkout."""
    return {file.parent.name: json.loads(file.read_text()) for file in sorted(build.glob("roots/*/portability.json"))}


def run_in_root(release, build, checks, arguments):
    """Makes the Debian if there is none, installs packages, builds, and runs tools/portability there with these arguments. Returns its exit code; 77 if the
    Debian could not be made. Prints the seconds of each step."""
    folder, build = FOLDER / release, (build / "roots" / release).absolute()
    inside = [DEBIAN_ROOT, "run", "--project", ROOT, build, folder, "bash", "-c"]
    build.mkdir(parents=True, exist_ok=True)
    FOLDER.mkdir(parents=True, exist_ok=True)
    targets = " ".join(["raya", *(TARGETS[check] for check in checks if check in TARGETS)])
    steps = [] if folder.exists() else [("root", [DEBIAN_ROOT, "make", release, folder])]
    steps += [("packages", [*inside, f"cd /raya && {PACKAGES}"]), ("build", [*inside, f"cd /raya && tools/build {targets}"])]
    for name, command in steps:
        start = time.monotonic()
        with open(build / f"{name}.log", "w") as log:
            code = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT).returncode
        print(f"{release}, {name}: {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
        if code:
            print(f"tools/portability: {release}: {name} failed:\n{(build / f'{name}.log').read_text()[-2000:]}", file=sys.stderr)
            return code
    return subprocess.run([*inside, 'cd /raya && exec tools/portability "$@"', "-", *arguments], stdin=subprocess.DEVNULL).returncode
