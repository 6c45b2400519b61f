#!/usr/bin/env python3
"""Runs the commands of transcripts and compares what they print with the transcripts.

  run_transcripts.py RAYA [FILE...]    FILE: default all in tests/cli/transcripts. With RAYA_WRITE_TRANSCRIPTS=1, writes the files again

A transcript has comments (# ...), commands for bash ($ ...) and below each command its stdout, its stderr (! ...) and its exit code unless it is 0
(= 2). The commands of a file run one after another in a folder of their own, with the project's scenes in scenes/. mask() replaces what differs
between computers. "# needs COMMAND": the file is skipped if the command fails. Exit codes: 0 equal, 1 a difference.
"""
import difflib
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEPT = ("ASAN_", "LD_", "OCL_", "POCL_", "RAYA_FAULT", "UBSAN_")  # beginnings of the environment variables that the commands inherit


def mask(text, device, folder):
    """Replaces names of device and folder, and measured times and rates. Removes the lines about compiling, which depend on the kernel cache."""
    text = re.sub(r"raya: compiling kernels [^\n]*\n", "", text)
    text = text.replace(str(folder), "FOLDER")
    text = re.sub(re.escape(device) + r"( \([^\n]*driver [^\n)]*\))?", "DEVICE", text)
    text = re.sub(r"kernel build [^\n]* rays/s on|kernel build [^\n]*rays/s on", "TIMES on", text)
    return re.sub(r" *\b\d+\.\d+ s\b", " N s", text)


class Transcript:
    def __init__(self, raya, file):
        self.file, self.before = file, file.read_text()
        self.scratch = tempfile.TemporaryDirectory(prefix="raya-transcript-")
        self.folder = Path(self.scratch.name).resolve()
        for folder in ("bin", "home", "work"):
            (self.folder / folder).mkdir()
        (self.folder / "bin/raya").symlink_to(raya)
        (self.folder / "work/scenes").symlink_to(ROOT / "scenes")
        self.environment = {name: value for name, value in os.environ.items() if name.startswith(KEPT)} | {
            "PATH": f"{self.folder}/bin:/usr/bin:/bin", "HOME": f"{self.folder}/home", "LC_ALL": "C.UTF-8", "TZ": "UTC", "RAYA_TUNED": "off",
            "RAYA_DEVICE": "0"}
        self.device = self.run("raya devices").stdout.split("\n")[0].removeprefix("0  ")

    def run(self, command):
        return subprocess.run(["bash", "-c", "umask 022; " + command], cwd=self.folder / "work", env=self.environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, errors="backslashreplace", timeout=300, check=False)

    def after(self):
        """Returns the transcript with what the commands print now."""
        lines = []
        for line in self.before.splitlines():
            if line.startswith("# needs ") and self.run(line.removeprefix("# needs ")).returncode != 0:
                return self.before
            if not line or line.startswith("#"):
                lines.append(line)
            if line.startswith("$ "):
                run = self.run(line.removeprefix("$ "))
                out, err = (mask(text, self.device, self.folder / "work").splitlines() for text in (run.stdout, run.stderr))
                # An empty line of the output is written as a blank, because an empty line in a transcript separates commands.
                lines += [line, *(text or " " for text in out), *("! " + text for text in err)]
                lines += [f"= {run.returncode}"] if run.returncode != 0 else []
        return "\n".join(lines) + "\n"

    def difference(self):
        after = self.after()
        if os.environ.get("RAYA_WRITE_TRANSCRIPTS") == "1":
            self.file.write_text(after)
            return ""
        return "".join(difflib.unified_diff(self.before.splitlines(True), after.splitlines(True), self.file.name, "now"))


def main():
    raya = Path(sys.argv[1]).resolve()
    files = [Path(name) for name in sys.argv[2:]] or sorted((ROOT / "tests/cli/transcripts").glob("*.txt"))
    with ThreadPoolExecutor(2) as pool:
        differences = [text for text in pool.map(lambda file: Transcript(raya, file).difference(), files) if text]
    print("\n".join(differences) or f"{len(files)} transcripts: equal")
    return 1 if differences or not files else 0


if __name__ == "__main__":
    sys.exit(main())
