"""What `tools/portability --setup` does: OpenCL implementations that Debian lacks come from PyPI into the build folder.

Each is a file of tests/portability/packages/, which names packages, versions and hashes as pip reads them. Its wheels are unpacked to
build/implementations/NAME, and build/implementations/NAME.icd, which an OpenCL loader reads, names the driver. Nothing is installed: no file
lies anywhere else, and to remove the folder removes all.
"""
import os, re, shutil, subprocess, sys, tempfile, zipfile
from pathlib import Path

from portability_implementations import FETCHED

DRIVERS = {"intel-cpu": "lib/libintelocl.so", "pocl-3.0": "pyopencl/.libs/libpocl-*.so"}  # in what is unpacked


class SetupError(Exception):
    """With the remedy."""


def fetch(packages, folder):
    """The wheels that the file `packages` names: pip verifies versions and hashes."""
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-cache-dir", "--only-binary", ":all:", "--require-hashes",
               "--disable-pip-version-check", "-r", str(packages), "-d", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", stdin=subprocess.DEVNULL)
    if "No module named pip" in done.stderr:
        raise SetupError(f"{sys.executable} has no pip; remedy: apt-get install python3-pip")
    if done.returncode != 0:
        told = [line for line in done.stderr.splitlines() if "WARNING" not in line and line.strip()]
        raise SetupError(f"{packages.name}: pip got no packages: {' / '.join(told[-6:])}; remedy: a network, or a folder with the wheels of that "
                         "file and PIP_NO_INDEX=1 PIP_FIND_LINKS=FOLDER; Linux on x86-64")
    return sorted(folder.glob("*.whl"))


def unpack(wheel, folder):
    """The wheel's data (X.data/data/...) and packages. Members that are equal become one file: wheels know no links and hold libraries twice."""
    seen = {}
    with zipfile.ZipFile(wheel) as members:
        for member in members.infolist():
            path = folder / re.sub(r"^[^/]*\.data/data/", "", member.filename)
            if member.is_dir():
                continue
            path.parent.mkdir(parents=True, exist_ok=True)
            same = seen.setdefault((member.CRC, member.file_size), path)
            if same != path and not path.exists():
                os.link(same, path)
            elif same == path:
                with members.open(member) as packed, open(path, "wb") as file:
                    shutil.copyfileobj(packed, file)
                path.chmod(0o755 if ".so" in path.name else 0o644)


def cpu_that_llvm_14_lacks(cpuinfo):
    """A name that LLVM 14 has for what this CPU can do, where it has none for the CPU itself. None: it knows the CPU.

    Of AMD's after family 25 it says "generic", a name that its own compiler then refuses; Zen 4 it takes for Zen 3, family 25 too, which has
    no AVX-512, and ends on vectors of 16 floats ("Cannot emit physreg copy instruction")."""
    def value(key):
        return (re.search(rf"^{key}\s*: (.*)$", cpuinfo, re.MULTILINE) or ["", ""])[1]
    family, wide = int(value("cpu family") or 0), "avx512vl" in value("flags").split()
    if value("vendor_id") != "AuthenticAMD" or family < 25 or (family == 25 and not wide):
        return None
    return "skylake-avx512" if wide else "haswell"


def name_cpu(library, cpu):
    """PoCL 3.0 asks LLVM for the CPU's name and has no variable for it, so our copy gets the answer: where pocl_get_llvm_cpu_name() calls LLVM
    and looks whether there is a name, it takes this one. Addresses of code and constants are offsets in this file."""
    content = bytearray(library.read_bytes())
    calls = [match.start(1) for match in re.finditer(rb"\x55\x53\x48\x83\xec\x08(\xe8....\x48\x85\xd2\x74\x30)\x48\x89\xc5", content, re.DOTALL)]
    text = content.find(b"\0" + cpu.encode() + b"\0") + 1
    if len(calls) != 1 or text == 0:
        raise SetupError(f"{library.name} is not PoCL 3.0 as PyPI had it: its LLVM does not know this CPU, and the place to name it was not found")
    lea, after = calls[0], calls[0] + 7
    content[lea:lea + 10] = b"\x48\x8d\x05" + (text - after).to_bytes(4, "little", signed=True) + bytes([0x6a, len(cpu), 0x5a])  # lea rax; push, pop rdx
    library.write_bytes(content)


def size_text(folder):
    files = {(s.st_ino, s.st_size) for s in (p.stat() for p in folder.rglob("*") if p.is_file())}
    return f"{sum(size for _, size in files) / 1e6:.0f} MB"


def set_up_one(packages, target, cpuinfo):
    """`target`: the folder to be. It appears whole or not at all, and the .icd file last."""
    name, driver_file = packages.stem, target.with_name(packages.stem + ".icd")
    asked = packages.read_text()
    stamp = target / "packages.txt"
    if driver_file.exists() and stamp.exists() and stamp.read_text() == asked:
        print(f"{name}: is here, {size_text(target)} in {target}")
        return
    pins = re.findall(r"^([^#\s]\S*)", asked, re.MULTILINE)
    print(f"{name}: fetching {', '.join(pins)}", flush=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as scratch:
        wheels = fetch(packages, Path(scratch))
        unpacked = Path(scratch) / "unpacked"
        for wheel in wheels:
            unpack(wheel, unpacked)
        drivers = sorted(unpacked.glob(DRIVERS[name]))
        if len(drivers) != 1:
            raise SetupError(f"{name}: no driver {DRIVERS[name]} in {', '.join(w.name for w in wheels)}")
        cpu = cpu_that_llvm_14_lacks(cpuinfo) if name == "pocl-3.0" else None
        if cpu:
            name_cpu(drivers[0], cpu)
        (unpacked / "packages.txt").write_text(asked)
        driver_file.unlink(missing_ok=True)
        shutil.rmtree(target, ignore_errors=True)
        fetched = sum(wheel.stat().st_size for wheel in wheels) / 1e6
        driver = target / drivers[0].relative_to(unpacked)
        unpacked.rename(target)
        target.chmod(0o755)
    driver_file.write_text(f"{driver}\n")
    named = f"; its LLVM 14 does not know this CPU and is told that it is {cpu}" if cpu else ""
    print(f"{name}: {fetched:.0f} MB fetched, {size_text(target)} in {target}{named}")


def set_up(build, folder):
    """All files of `folder`; exit code 0, or 3 where one could not be had."""
    target = (build / FETCHED).absolute()
    target.mkdir(parents=True, exist_ok=True)
    cpuinfo = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    code = 0
    for packages in sorted(folder.glob("*.txt")):
        try:
            set_up_one(packages, target / packages.stem, cpuinfo)
        except SetupError as error:
            print(f"tools/portability --setup: {error}", file=sys.stderr)
            code = 3
    return code
