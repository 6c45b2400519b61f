#!/usr/bin/env python3
"""Tests which OpenCL implementations tools/portability finds: drivers without a device, drivers with a fault, rows of SPIR-V."""
import sys, tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools"))
import portability_implementations  # noqa: E402


def expect(condition, what):
    if not condition:
        sys.exit(f"FAILED: {what}")


with tempfile.TemporaryDirectory() as folder:
    scratch = Path(folder)
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
print("drivers without a device: as expected")
