"""`tools/portability --setup`: fetches OpenCL implementations that Debian does not have from PyPI into the build folder.

Each implementation has a file in tests/portability/packages/ with packages, versions and hashes in pip's format. Its wheels are unpacked to
build/implementations/NAME; build/implementations/NAME.icd, which OpenCL loaders read, names the driver. Other folders are unchanged:
to uninstall everything, remove build/implementations.
"""
import os, re, shutil, sys, tempfile, zipfile
from pathlib import Path

import programs
from portability_implementations import FETCHED

DRIVERS = {"intel-cpu": "lib/libintelocl.so", "pocl-3.0": "pyopencl/.libs/libpocl-*.so"}  # path in the unpacked wheels


class SetupError(Exception):
    """A failed setup; the message has the remedy."""


def fetch(packages, folder):
    """Downloads the wheels that the file `packages` lists to the folder; pip verifies versions and hashes. Returns the wheels' paths."""
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-cache-dir", "--only-binary", ":all:", "--require-hashes",
               "--disable-pip-version-check", "-r", str(packages), "-d", str(folder)]
    done = programs.run(command)
    if "No module named pip" in done.err:
        raise SetupError(f"{sys.executable} has no pip; remedy: apt-get install python3-pip")
    if done.code != 0:
        lines = [line for line in done.err.splitlines() if "WARNING" not in line and line.strip()]
        raise SetupError(f"{packages.name}: pip got no packages: {' / '.join(lines[-6:])}; remedy: a network, or a folder with the wheels of that "
                         "file and PIP_NO_INDEX=1 PIP_FIND_LINKS=FOLDER; Linux on x86-64")
    return sorted(folder.glob("*.whl"))


def unpack(wheel, folder):
    """Unpacks a wheel's data (X.data/data/...) and packages. Equal files become hard links, because wheels cannot contain links and
    therefore contain some libraries twice."""
    seen = {}
    with zipfile.ZipFile(wheel) as members:
        for member in members.infolist():
            path = folder / re.sub(r"^[^/]*\.data/data/", "", member.filename)
            if member.is_dir():
                continue
            path.parent.mkdir(parents=True, exist_ok=True)
            original = seen.setdefault((member.CRC, member.file_size), path)
            if original != path and not path.exists():
                os.link(original, path)
            elif original == path:
                with members.open(member) as packed, open(path, "wb") as file:
                    shutil.copyfileobj(packed, file)
                path.chmod(0o755 if ".so" in path.name else 0o644)


def size_text(folder):
    files = {(s.st_ino, s.st_size) for s in (p.stat() for p in folder.rglob("*") if p.is_file())}
    return f"{sum(size for _, size in files) / 1e6:.0f} MB"


def set_up_implementation(packages, target):
    """Sets up one implementation in the folder `target`. The .icd file is written last, so that an interrupted setup is not used."""
    name, driver_file = packages.stem, target.with_name(packages.stem + ".icd")
    requested = packages.read_text()
    stamp = target / "packages.txt"
    if driver_file.exists() and stamp.exists() and stamp.read_text() == requested:
        print(f"{name}: already set up, {size_text(target)} in {target}")
        return
    pins = re.findall(r"^([^#\s]\S*)", requested, re.MULTILINE)
    print(f"{name}: fetching {', '.join(pins)}", flush=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as scratch:
        wheels = fetch(packages, Path(scratch))
        unpacked = Path(scratch) / "unpacked"
        for wheel in wheels:
            unpack(wheel, unpacked)
        drivers = sorted(unpacked.glob(DRIVERS[name]))
        if len(drivers) != 1:
            raise SetupError(f"{name}: no driver {DRIVERS[name]} in {', '.join(w.name for w in wheels)}")
        (unpacked / "packages.txt").write_text(requested)
        driver_file.unlink(missing_ok=True)
        shutil.rmtree(target, ignore_errors=True)
        fetched = sum(wheel.stat().st_size for wheel in wheels) / 1e6
        driver = target / drivers[0].relative_to(unpacked)
        unpacked.rename(target)
        target.chmod(0o755)
    driver_file.write_text(f"{driver}\n")
    print(f"{name}: {fetched:.0f} MB fetched, {size_text(target)} in {target}")


def set_up(build, folder):
    """Sets up the implementation of each file in `folder`. Returns the exit code: 0, or 3 if a setup failed."""
    target = (build / FETCHED).absolute()
    target.mkdir(parents=True, exist_ok=True)
    code = 0
    for packages in sorted(folder.glob("*.txt")):
        try:
            set_up_implementation(packages, target / packages.stem)
        except SetupError as error:
            print(f"tools/portability --setup: {error}", file=sys.stderr)
            code = 3
    return code
