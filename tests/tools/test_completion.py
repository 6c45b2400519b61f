#!/usr/bin/env python3
"""Tests tools/raya.bash, the completion of raya in bash.
  test_completion.py RAYA"""
import os, pathlib, subprocess, sys, tempfile

raya = pathlib.Path(sys.argv[1]).resolve()
script = pathlib.Path(__file__).resolve().parents[2] / "tools" / "raya.bash"
# (start of a command line, names that the completion must offer, names that it must not offer). FOLDER: the folder of FILES.
FILES = ["ball.nff", "notes.txt", "below/cube.nff"]
EXPECTED = [
    ("raya ", ["render", "study", "verify"], ["fig7", "--size", "ball.nff"]),
    ("raya stu", ["study"], ["render"]),
    ("raya study fig7 --s", ["--size", "--strict"], ["--samples"]),
    ("raya render --fold=b", ["block"], ["cyclic"]),
    ("raya render --mapping cyclic:8 --ex", ["--exchange"], ["--machine"]),
    ("raya render --accel ", ["none", "bvh", "grid"], ["AxBxC"]),
    ("raya render -o study --exchange b", ["bus", "bus-broadcast"], ["ring"]),
    ("raya render ", ["ball.nff", "below"], []),
    ("raya render FOLDER/", ["ball.nff"], []),
    ("raya render x.nff -o n", ["notes.txt"], ["ball.nff"]),
    ("raya render --size ", [], ["notes.txt", "ball.nff"]),
    ("raya render -", ["--quiet", "--verbose", "--output"], ["--worker"]),
]
COMPLETE = r"""source "$1"
line=$2
read -ra COMP_WORDS <<<"$(sed 's/[=:]/ & /g' <<<"$line")"
[[ $line != *' ' ]] || COMP_WORDS+=("")
COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) COMP_WORDS[0]=$3
_raya
printf '%s\n' "${COMPREPLY[@]}"
"""
faults = []
with tempfile.TemporaryDirectory() as folder:
    for name in FILES:
        (pathlib.Path(folder) / name).parent.mkdir(exist_ok=True)
        (pathlib.Path(folder) / name).touch()
    for line, wanted, unwanted in EXPECTED:
        command = ["bash", "-c", COMPLETE, "bash", script, line.replace("FOLDER", folder), raya]
        offered = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout.split("\n")
        names = {os.path.basename(name) for name in offered}
        faults += [f"'{line}' does not offer {name}: {sorted(names)[:40]}" for name in wanted if name not in names]
        faults += [f"'{line}' offers {name}" for name in unwanted if name in names]
print("\n".join([*faults, f"{len(EXPECTED)} lines, {len(faults)} faults"]))
sys.exit(1 if faults else 0)
