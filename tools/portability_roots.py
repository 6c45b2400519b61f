"""`tools/portability --root RELEASE`: runs the checks in a Debian of its own, made by tools/debian_root in ~/.cache/raya/roots/RELEASE. The sources of this
checkout are mounted there, not writable; the build folder is BUILD/roots/RELEASE, so each checkout has its own. `--arch ARCH`: as --root forky, where raya
is cross-built; the packages of the architecture are in /sysroots/ARCH of that Debian, and programs run there in qemu-user, which Linux starts
(binfmt_misc)."""
import json, os, subprocess, sys, time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DEBIAN_ROOT = ROOT / "tools" / "debian_root"
FOLDER = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "raya" / "roots"
PACKAGES = "cd /raya && tools/setup --gpu --package && apt-get install -qq -y --no-install-recommends git mesa-opencl-icd"
SYSROOT_PACKAGES = "base-files,pocl-opencl-icd,libopenimageio-dev,libassimp-dev,ocl-icd-opencl-dev,opencl-clhpp-headers,libfmt-dev,libcli11-dev," \
                   "nlohmann-json3-dev,zlib1g-dev,libxxhash-dev,,libc6-dev,libmpfr-dev,catch2"
# With --variant=extract no program of the packages runs, so that the Debian of another architecture needs no emulator.
SYSROOT = """cd /raya && tools/setup && apt-get install -qq -y --no-install-recommends git g++-{compiler} qemu-user mmdebstrap
[[ -e /sysroots/{arch} ]] || {{
    rm -rf --one-file-system /sysroots/{arch}.part && mkdir -p /sysroots
    mmdebstrap --variant=extract --architectures={arch} --aptopt=/etc/apt/apt.conf.d/raya --include={packages} forky /sysroots/{arch}.part /etc/apt/sources.list
    mv /sysroots/{arch}.part /sysroots/{arch}
}}"""
# Registers qemu with Linux, which keeps the file open ("F"), and mounts what programs need into the Debian of the other architecture.
EMULATE = """cd /raya && if [[ {qemu} != i386 ]]; then
    registry=/proc/sys/fs/binfmt_misc
    [[ -e $registry/register ]] || mount -t binfmt_misc binfmt_misc $registry || {{ echo "Linux here has no binfmt_misc (modprobe binfmt_misc)" >&2; exit 77; }}
    [[ -e $registry/raya-{qemu} ]] || sed "s,^:[^:]*,:raya-{qemu},; s,[^:]*:[^:]*$,/usr/bin/qemu-{qemu}:PF," /usr/share/qemu/binfmt.d/qemu-{qemu}.conf >$registry/register
fi
for folder in proc sys dev tmp raya; do mkdir -p /sysroots/{arch}/$folder && mount --rbind /$folder /sysroots/{arch}/$folder; done
"""
TARGETS = {"vectors": "test_number", "defects": "portability_defects"}  # {check: the program that it needs besides raya}


def preset_of(architecture):
    """Returns (GNU's name, qemu's name) of one of Debian's architectures; None if there is no preset for it."""
    presets = json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]
    found = [p["cacheVariables"] for p in presets if p.get("inherits") == "cross" and p["name"] == architecture]
    return (found[0]["RAYA_TRIPLET"], found[0]["RAYA_QEMU"]) if found else None


def run_in_root(release, build, checks, arguments, architecture=None):
    """Makes the Debian if there is none, installs packages, builds, and runs tools/portability there with these arguments. Returns its exit code; 77 if the
    Debian could not be made. Prints the seconds of each step."""
    name = architecture or release
    folder, build = FOLDER / release, (build / "roots" / name).absolute()
    inside = [DEBIAN_ROOT, "run", "--project", ROOT, build, folder, "bash", "-ec"]
    build.mkdir(parents=True, exist_ok=True)
    FOLDER.mkdir(parents=True, exist_ok=True)
    targets = " ".join(["raya", *(TARGETS[check] for check in checks if check in TARGETS)])
    packages, compile_all, start_all = PACKAGES, f"cd /raya && tools/build {targets}", "cd /raya\n"
    if architecture:
        triplet, qemu = preset_of(architecture)
        names = {"arch": architecture, "qemu": qemu, "compiler": triplet.replace("_", "-"), "packages": SYSROOT_PACKAGES}
        packages, start_all = SYSROOT.format(**names), EMULATE.format(**names)
        compile_all = f"cd /raya && cmake --preset {architecture} -B build && cmake --build build --target {targets}"
        arguments = [*arguments, "--sysroot", f"/sysroots/{architecture}"]
    steps = [] if folder.exists() else [("root", [DEBIAN_ROOT, "make", release, folder])]
    steps += [("packages", [*inside, packages]), ("build", [*inside, compile_all])]
    for step, command in steps:
        start = time.monotonic()
        with open(build / f"{step}.log", "w") as log:
            code = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT).returncode
        print(f"{name}, {step}: {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
        if code:
            print(f"tools/portability: {name}: {step} failed:\n{(build / f'{step}.log').read_text()[-2000:]}", file=sys.stderr)
            return code
    return subprocess.run([*inside, start_all + 'exec tools/portability "$@"', "-", *arguments], stdin=subprocess.DEVNULL).returncode
