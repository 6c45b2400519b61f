#!/usr/bin/env python3
"""Tests the completions of `raya completion` in bash, zsh and fish, if these are installed.
  test_completion.py RAYA"""
import functools
import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time

raya = pathlib.Path(sys.argv[1]).resolve()
faults = []

# (start of a command line, names that the completion must offer, names that it must not offer). FOLDER: the folder of FILES.
FILES = ["ball.nff", "notes.txt", "below/cube.nff"]
EXPECTED = [
    ("raya ", ["render", "study", "verify", "completion"], ["fig7", "--size"]),
    ("raya stu", ["study"], ["render"]),
    ("raya study fi", ["fig7", "fig13"], ["table2"]),
    ("raya study fig7 --s", ["--size", "--strict"], ["--samples"]),
    ("raya render --ma", ["--machine", "--mapping", "--mask"], ["--pes"]),
    ("raya render --machine ", ["spa", "pixel-machine", "torus"], ["ball.nff"]),
    ("raya bench --machine g", ["grande"], ["torus"]),
    ("raya render --machine=p", ["pixel-machine"], ["grande"]),
    ("raya render --mapping cyclic:8 --ex", ["--exchange"], ["--machine"]),
    ("raya render --accel ", ["none", "bvh", "grid"], ["AxBxC"]),
    ("raya render -o study --exchange b", ["bus", "bus-broadcast"], ["ring"]),
    ("raya render ", ["ball.nff", "below"], ["notes.txt"]),
    ("raya render FOLDER/", ["ball.nff"], ["notes.txt"]),
    ("raya render x.nff -o n", ["notes.txt"], ["ball.nff"]),
    ("raya study fig7 -o ", ["below"], ["notes.txt"]),
    ("raya bench --variants none,g", ["grid"], ["bvh"]),
    ("raya verify --lanes ", ["1", "4", "8", "16"], ["notes.txt"]),
    ("raya render --size ", [], ["notes.txt", "ball.nff"]),
    ("raya manual gen", ["generate"], ["ball.nff"]),
    ("raya help stu", ["study"], ["render"]),
    ("raya help study ", [], ["fig7", "render"]),
    ("raya render -", ["--quiet", "--verbose", "-q"], ["--worker"]),
    ("raya completion ", ["bash", "zsh", "fish"], ["notes.txt"]),
]

BASH = r"""source "$1"
line=$2
read -ra COMP_WORDS <<<"$(sed 's/[=:]/ & /g' <<<"$line")"
[[ $line != *' ' ]] || COMP_WORDS+=("")
COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
_raya
printf '%s\n' "${COMPREPLY[@]}"
"""


def in_bash(script, line):
    return subprocess.run(["bash", "-c", BASH, "bash", script, line], capture_output=True, text=True, check=True).stdout.split("\n")


def in_fish(script, line):
    output = subprocess.run(["fish", "-N", "-c", f"source {script}; complete -C '{line}'"], capture_output=True, text=True, check=True).stdout
    return [line.split("\t")[0] for line in output.split("\n")]


class Zsh:  # on a pseudo-terminal
    def __init__(self, script):
        folder = pathlib.Path(script).parent / "functions"
        folder.mkdir()
        shutil.copy(script, folder / "_raya")  # the name under which distributions install it
        self.pending = ""  # output after the text that until() has returned
        pid, self.terminal = pty.fork()
        if pid == 0:
            os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "TERM": "dumb", "COLUMNS": "200", "LINES": "200"})
        self.keys(f"PS1='>''>>'; unset zle_bracketed_paste; unsetopt prompt_sp; stty cols 200 rows 200; fpath=({folder} $fpath); autoload -Uz compinit && compinit -D -u; "
                  "zstyle ':completion:*' list-prompt ''; LISTMAX=1000; setopt no_auto_menu no_beep; echo EN''D\n")
        self.until("END")
        self.until(">>>")  # before the prompt, keys would go to the terminal, not to zsh's line editor

    def keys(self, text):
        os.write(self.terminal, text.encode())

    def until(self, mark, seconds=20):
        """Returns the output before `mark`."""
        shown, self.pending, end = self.pending, "", time.time() + seconds
        while mark not in shown and time.time() < end:
            if select.select([self.terminal], [], [], 0.1)[0]:
                shown += os.read(self.terminal, 65536).decode(errors="replace")
        assert mark in shown, f"zsh does not answer: {shown!r}"
        shown, _, self.pending = shown.partition(mark)
        return shown

    def offered(self, line):
        """Returns the completions of a line: ^D lists them, ^U clears the line, and the output of `echo` marks the end."""
        self.keys(line + "\x04" + "\x15echo EN''D\n")
        shown = self.until("END")
        self.until(">>>")
        return re.split(r"[\s]+", shown.replace(line, "", 1))


def check_completions(shell, offered, line, wanted, unwanted):
    names = {text.rstrip("/").rsplit("/", 1)[-1].rsplit(",", 1)[-1].rsplit("=", 1)[-1] for text in offered} | set(offered)
    for name in wanted:
        if name not in names:
            faults.append(f"{shell}: '{line}' does not offer {name}: {sorted(names)[:40]}")
    for name in unwanted:
        if name in names and not (shell == "fish" and name.endswith(".txt") and ".nff" in str(offered)):  # fish lists other files last
            faults.append(f"{shell}: '{line}' offers {name}")


def run():
    count = 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "files"
        for name in FILES:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text("")
        os.chdir(folder)
        for shell in ("bash", "zsh", "fish"):
            if not shutil.which(shell):
                print(f"skipped: {shell} is not installed (tools/setup --package)")
                continue
            script = str(pathlib.Path(scratch) / f"raya.{shell}")
            subprocess.run([raya, "completion", shell, "-o", script], check=True)
            subprocess.run([shell, "-n", script], check=True)
            complete = {"bash": in_bash, "fish": in_fish}.get(shell)
            offered = Zsh(script).offered if shell == "zsh" else functools.partial(complete, script)
            for line, wanted, unwanted in EXPECTED:
                line = line.replace("FOLDER", str(folder))
                check_completions(shell, offered(line), line, wanted, unwanted)
                count += 1
        os.chdir("/")
    refused = subprocess.run([raya, "completion", "tcsh"], capture_output=True, text=True)
    if refused.returncode != 2 or "tcsh: must be bash, zsh, fish" not in refused.stderr:
        faults.append(f"raya completion tcsh is not refused with the known shells: {refused}")
    return count


lines = run()
for fault in faults:
    print(fault)
print(f"{lines} lines, {len(faults)} faults")
sys.exit(1 if faults else 0)
