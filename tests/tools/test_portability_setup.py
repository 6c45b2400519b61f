#!/usr/bin/env python3
"""Tests tools/portability --setup without a network, with mock wheels in a folder that pip searches; and drivers without a device."""
import hashlib, os, subprocess, sys, tempfile, zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools"))
import portability_implementations

def expect(condition, what):
    if not condition:
        sys.exit(f"FAILED: {what}")


def make_wheel(folder, name, version, files):
    """Writes a wheel that pip accepts as pure Python. Returns its line for a requirements file."""
    path = folder / f"{name.replace('-', '_')}-{version}-py3-none-any.whl"
    info = f"{name.replace('-', '_')}-{version}.dist-info"
    with zipfile.ZipFile(path, "w") as wheel:
        for file, content in files.items():
            wheel.writestr(file.format(data=f"{name.replace('-', '_')}-{version}.data/data"), content)
        wheel.writestr(f"{info}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        wheel.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        wheel.writestr(f"{info}/RECORD", "")
    return f"{name}=={version} --hash=sha256:{hashlib.sha256(path.read_bytes()).hexdigest()}\n"


def set_up(build, packages, wheels):
    """Runs tools/portability --setup. Returns (exit code, output)."""
    variables = {k: v for k, v in os.environ.items() if not k.startswith("PIP_")}
    variables |= {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(wheels)}
    done = subprocess.run([ROOT / "tools" / "portability", "--setup", "--build", build, "--packages", packages], env=variables,
                          capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def check_setting_up(scratch):
    build, packages, wheels, empty = (scratch / name for name in ("build", "packages", "wheels", "empty"))
    for folder in (packages, wheels, empty):
        folder.mkdir()
    library = {"{data}/lib/libintelocl.so": b"driver 1", "{data}/lib/libintelocl.so.1": b"driver 1", "{data}/share/LICENCE": b"text"}
    (packages / "intel-cpu.txt").write_text("# a comment\n" + make_wheel(wheels, "intel-stand-in", "1.0", library))
    pocl = {"pyopencl/.libs/libpocl-21.so": b"driver", "pyopencl/.libs/pocl.icd": b"libpocl-21.so"}
    (packages / "pocl-3.0.txt").write_text(make_wheel(wheels, "pocl-stand-in", "3.0", pocl))

    code, output = set_up(build, packages, empty)
    expect(code == 3 and "intel-cpu.txt: pip got no packages" in output and "remedy: a network" in output, f"no packages: {code} {output}")
    expect([p.name for p in (build / "implementations").iterdir()] == [], "something was left behind")

    code, output = set_up(build, packages, wheels)
    expect(code == 0 and "intel-cpu: fetching intel-stand-in==1.0" in output and "MB fetched" in output, f"set up: {code} {output}")
    installed = build / "implementations"
    for name, driver in (("intel-cpu", "lib/libintelocl.so"), ("pocl-3.0", "pyopencl/.libs/libpocl-21.so")):
        expect((installed / f"{name}.icd").read_text() == f"{installed / name / driver}\n", f"wrong content of {name}.icd")
        expect((installed / name / driver).exists(), f"no {driver}")
    listed = subprocess.run([ROOT / "tools" / "portability", "--list", "--build", build, "--raya", "/bin/true"], capture_output=True, text=True).stdout
    expect("Intel CPU: available\n" in listed, listed)

    code, output = set_up(build, packages, empty)
    expect(code == 0 and "intel-cpu: already set up" in output and "pocl-3.0: already set up" in output, f"again, without packages: {output}")

    wrong = (packages / "intel-cpu.txt").read_text().replace("sha256:", "sha256:0")[:-2] + "\n"
    (packages / "intel-cpu.txt").write_text(wrong)
    code, output = set_up(build, packages, wheels)
    expect(code == 3 and "intel-cpu" in output, f"a wrong hash: {code} {output}")
    expect((installed / "intel-cpu.icd").exists() and (installed / "intel-cpu" / "lib" / "libintelocl.so").read_bytes() == b"driver 1",
           "the old driver is gone")

    library["{data}/lib/libintelocl.so"] = b"driver 2"
    (packages / "intel-cpu.txt").write_text(make_wheel(wheels, "intel-stand-in", "2.0", library))
    code, output = set_up(build, packages, wheels)
    expect(code == 0 and (installed / "intel-cpu" / "lib" / "libintelocl.so").read_bytes() == b"driver 2", f"a newer version: {output}")


def check_missing_devices(scratch):
    portability_implementations.VENDORS = scratch
    for driver in ("pocl", "gpu", "other"):
        (scratch / f"{driver}.icd").write_text(f"lib{driver}.so\n")
    raya = scratch / "raya"
    raya.write_text("#!/bin/sh\ncase $OCL_ICD_VENDORS in */other.icd) exit 1 ;; esac; exit 3\n")  # 3: no device; 1: a fault
    raya.chmod(0o755)
    found = portability_implementations.known_implementations(scratch)
    expect({"PoCL, SPIR-V", "Oclgrind, SPIR-V", "gpu, SPIR-V"} <= {i.name for i in found}, "no rows of SPIR-V")
    expect(not any(i.name in ("PoCL loops, SPIR-V", "PoCL basic, SPIR-V") for i in found), "variants have rows of SPIR-V")
    portability_implementations.mark_missing_devices(found, str(raya))
    unavailable = {i.name: i.unavailable for i in found}
    expect(unavailable["gpu"] == "its driver is installed, but reports no device", f"a driver without its device: {unavailable['gpu']}")
    expect(unavailable["other"] is None and unavailable["PoCL"] is None, "a driver with a fault, and PoCL without a device, were left out")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        check_missing_devices(Path(scratch))
        if subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True).returncode != 0:
            print("skipped: no pip; fetching packages was not tested")
            return 77
        check_setting_up(Path(scratch))
    print("tools/portability --setup: as expected")
    return 0


if __name__ == "__main__":
    sys.exit(main())
