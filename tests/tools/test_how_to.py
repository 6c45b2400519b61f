#!/usr/bin/env python3
"""Follows docs/how-to/count.md in a copy of the sources: adds a count of lit shadow rays, builds raya, and compares the count with the one that
raya already has, on both machines.
  test_how_to.py ROOT FOLDER     FOLDER: for the copy and its build, which later runs reuse"""
import json
import subprocess
import sys
from pathlib import Path

root, copy = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
STEPS = [  # (file, text after which the step inserts, inserted text)
    ("kernels/shared/events.h", 'EVENT(RAYA_DISCARDED, "discarded", "") /* primary rays that a torus node made for another one */',
     ' \\\n    EVENT(RAYA_AGAIN, "again", "shading.again") /* as RAYA_LIT */'),
    ("kernels/shading/shade.clh", "    count_event(t, RAYA_LIT, lit);\n", "    count_event(t, RAYA_AGAIN, lit);\n"),
    ("kernels/torus/shade_packets.clh", "    count_event(f, RAYA_LIT, arrived);\n", "    count_event(f, RAYA_AGAIN, arrived);\n"),
    ("host/model/budget.cpp", '             "the same"},\n', '    {.event = RAYA_AGAIN, .work = "counted only for the report"},\n'),
    ("docs/schema/render.json", '"lit": {"type": "integer", "minimum": 0, "description": "Number of contributions of light sources to hits."},\n',
     '        "again": {"type": "integer", "minimum": 0, "description": "The same number again."},\n'),
]


def run(*command):
    subprocess.run([str(argument) for argument in command], cwd=copy, check=True, stdout=subprocess.DEVNULL)


copy.mkdir(parents=True, exist_ok=True)
for name in subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True, check=True).stdout.splitlines():
    text = (root / name).read_bytes() if (root / name).is_file() else None
    for file, before, inserted in STEPS:
        if file == name:
            assert text.count(before.encode()) == 1, f"{file}: not once: {before}"
            text = text.replace(before.encode(), (before + inserted).encode())
    if text is not None and (not (copy / name).is_file() or (copy / name).read_bytes() != text):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        (copy / name).write_bytes(text)
        (copy / name).chmod((root / name).stat().st_mode)
run("cmake", "-S", copy, "-B", copy / "build", "-DBUILD_TESTING=OFF", "-DRAYA_PYTHON=OFF")
run("cmake", "--build", copy / "build", "--target", "raya", "-j2")
for machine in (["--machine", "spa"], ["--machine", "torus", "--nodes", "2x2x2"]):
    run(copy / "build/raya", "render", copy / "scenes/spheres.nff", *machine, "--size", 20, "--report", copy / "r.json", "-o", copy / "x.ppm")
    shading = json.loads((copy / "r.json").read_text())["shading"]
    assert shading["again"] == shading["lit"] > 0, shading
print(f"a count in {len(STEPS)} files: right on both machines")
