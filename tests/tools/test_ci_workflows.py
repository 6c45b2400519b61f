#!/usr/bin/env python3
"""Runs the workflows of docs/ci on this machine (run_workflow.py): raya-verify.yml with a bundle, once with a driver that loses copies; tools/ci_summary.

    tests/tools/test_ci_workflows.py BUILD CL_FAULTS           BUILD: the build folder, with the target `bundled` built; CL_FAULTS: the library of
                                                               tests/cli/cl_faults.cpp
    tests/tools/test_ci_workflows.py BUILD CL_FAULTS --all     also raya-portability.yml: build, fast tests, all implementations; about an hour
Exit codes: 0 as expected; 1 not; 77 Python has no yaml, or there is no curl, or no ccache for --all (Debian: python3-yaml, curl, ccache)
"""
import os, shutil, subprocess, sys, tempfile
import xml.etree.ElementTree as xml
from pathlib import Path

sys.dont_write_bytecode = True
from run_workflow import ROOT, LocalRun

faults = []


def check(is_right, text):
    if not is_right:
        faults.append(text)


def run(name, scratch, variables=None):
    scratch.mkdir()
    local = LocalRun((ROOT / "docs/ci" / name).read_text(), scratch, variables)
    return local.run(), local


def summary(*files):
    done = subprocess.run([ROOT / "tools/ci_summary", *files], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def bundle_workflow(build, cl_faults, scratch):
    bundle = scratch / "bundle.tar.gz"
    subprocess.run([ROOT / "tools/bundle", "--build", build, "-o", bundle], check=True, stdout=subprocess.DEVNULL)
    variables = {"BUNDLE": f"file://{bundle}", "POCL_CACHE_DIR": os.environ["POCL_CACHE_DIR"]}
    is_right, local = run("raya-verify.yml", scratch / "right", variables)
    junit = local.store / "artifacts/verify/verify.xml"
    check(is_right, f"raya-verify.yml: {local.steps}")
    cases = list(xml.parse(junit).getroot().iter("testcase"))
    check(len(cases) > 50 and not any(case.find("failure") is not None for case in cases), f"raya-verify.yml: {junit.read_text()}")
    code, text = summary(junit, scratch / "none.xml")
    check(code == 0 and f"| {len(cases)} | 0 | 0 |" in text and "No test failed." in text and "none.xml | *not written*" in text, text)

    fault = {"LD_PRELOAD": cl_faults, "RAYA_FAULT": "clEnqueueCopyBufferRect 1 lost"}
    is_right, local = run("raya-verify.yml", scratch / "wrong", {**variables, **fault})
    check([code for _, _, code, _ in local.steps] == [0, 4, 0], f"raya-verify.yml with a fault: {local.steps}")  # the file is uploaded, too
    code, text = summary(local.store / "artifacts/verify/verify.xml")
    check(code == 0 and "| **" in text and "**copies of blocks**: " in text, text)
    bundle.write_text("not XML")
    check(summary(bundle)[0] == 1 and summary()[0] == 2, "tools/ci_summary accepts a file that is not XML, or no file")


def portability_workflow(scratch):
    is_right, local = run("raya-portability.yml", scratch / "portability")
    check(is_right, f"raya-portability.yml: {[step for step in local.steps if step[2] != 0]}")
    print(local.summary.read_text())
    artifacts = {file.name for file in (local.store / "artifacts").rglob("*")}
    check({"verify.xml", "now.json", "junit.xml", "portability.xml", "portability.md"} <= artifacts, f"artifacts: {artifacts}")


def main():
    try:
        import yaml  # noqa: F401
    except ImportError:
        return 77
    if not shutil.which("curl") or "--all" in sys.argv and not shutil.which("ccache"):
        return 77
    build = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        Path(scratch).chmod(0o755)  # some tests run raya as another user
        bundle_workflow(build, sys.argv[2], Path(scratch))
        if "--all" in sys.argv:
            portability_workflow(Path(scratch))
    print("\n".join(faults) or "the workflows: as expected")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
