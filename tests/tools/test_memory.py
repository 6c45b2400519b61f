#!/usr/bin/env python3
"""Makes one memory allocation of raya fail in each run, and checks exit code, message and files (tests/cli/memory_faults.cpp).

    tests/tools/test_memory.py RAYA FAULTS CL_FAULTS [--sample N] [--seed S] [--log FILE] [--results FILE]

RAYA is the program, FAULTS and CL_FAULTS are the libraries made of tests/cli/memory_faults.cpp and cl_faults.cpp.
--sample N       tests N random allocations (default: every allocation site of raya once, in the first command that reaches it, and 200 allocations of
                 libraries: about an hour on one core)
--seed S         seed of the random allocations (default: 1; with --sample: a random seed)
--log FILE       records finished runs, so that an interrupted test resumes
--results FILE   writes the summary that is committed as tests/limits/memory.csv
Exit codes: 0 done; 1 a run ended with a wrong exit code or message, or left a damaged file.
"""
import argparse
import collections
import csv
import datetime
import hashlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SCENE = str(ROOT / "scenes" / "centre.nff")
SMALL_RENDER = ["render", SCENE, "--size", "16", "--lanes", "4", "--format", "fp32"]
BANDED_RENDER = ["render", SCENE, "--size", "16", "--lanes", "1", "--format", "fp32", "--pes", "4", "--group", "1",
         "-o", "x.ppm", "--checkpoint", "s.rst", "--checkpoint-every", "0"]
COMMANDS = {
    "render": SMALL_RENDER + ["-o", "x.ppm", "--report", "x.json", "--cost", "x.pfm", "--trace", "x.trace.json"],
    "png": SMALL_RENDER + ["-o", "x.png"],
    "page": ["page", "saved.json", "-o", "x.html"],
    "keep": BANDED_RENDER,
    "resume": BANDED_RENDER + ["--resume"],
}
INPUTS = {"page": ["saved.json"], "resume": ["s.rst"]}
LIBRARY_ALLOCATIONS = 200  # number of tested allocations by libraries
LIMIT_S = 120  # seconds; a run takes half a second on an idle machine


def environment(**more):
    names = {"RAYA_TUNED": "off", **more}
    return {**os.environ, **names}


class Trial:
    """Runs one program, each time in a new folder."""

    def __init__(self, options, folder):
        self.raya = options.raya
        self.faults = options.faults
        self.folder = folder
        self.inputs = folder / "inputs"
        self.inputs.mkdir()
        self.cache = os.environ.get("POCL_CACHE_DIR")
        self.resumable = {}  # {hash of a checkpoint file that a run left: True if raya can resume it}
        self.run_without_fault(SMALL_RENDER + ["-o", "x.ppm", "--report", str(self.inputs / "saved.json")])
        self.make_checkpoint(options.cl_faults)
        self.expected = {name: self.files_without_fault(name) for name in COMMANDS}

    def run_without_fault(self, arguments, inputs=(), **variables):
        """Runs raya without a failing allocation. Returns (process, files)."""
        with tempfile.TemporaryDirectory(dir=self.folder) as run_folder:
            for name in inputs:
                shutil.copy(self.inputs / name, run_folder)
            done = subprocess.run([self.raya, *arguments], cwd=run_folder, env=environment(**variables), capture_output=True,
                                  timeout=LIMIT_S)
            return done, files_of(run_folder)

    def make_checkpoint(self, cl_faults):
        """Makes a checkpoint, by a render whose device fails after the checkpoint is written."""
        for launch in range(1, 50):
            done, files = self.run_without_fault(BANDED_RENDER, LD_PRELOAD=cl_faults, RAYA_FAULT=f"clEnqueueNDRangeKernel {launch} -5")
            if done.returncode == 3 and "s.rst" in files:
                (self.inputs / "s.rst").write_bytes(files["s.rst"])
                return
        raise AssertionError("no failed render left a checkpoint")

    def files_without_fault(self, name):
        done, files = self.run_without_fault(COMMANDS[name], INPUTS.get(name, ()))
        assert done.returncode == 0, done.stderr.decode()
        return {file: comparable(file, content) for file, content in files.items()}

    def sites(self, name):
        """Returns (sorted numbers of the allocation sites in raya that the command reaches, number of its allocations by other libraries)."""
        sites_file = self.folder / "sites"
        done, _ = self.run_without_fault(COMMANDS[name], INPUTS.get(name, ()), LD_PRELOAD=self.faults,
                             RAYA_MEMORY_SITES=str(sites_file))
        assert done.returncode == 0, done.stderr.decode()
        rows = [line.split() for line in sites_file.read_text().splitlines()]
        return sorted(row[0] for row in rows if row[0] != "elsewhere"), int(rows[-1][1])

    def run_with_fault(self, name, fault):
        """Runs a command in which one allocation fails. Returns (ending, exit code, message)."""
        by_library = fault.startswith("+")
        with tempfile.TemporaryDirectory(dir=self.folder) as work:
            run_folder, failed_file, cache = Path(work, "run"), Path(work, "failed"), Path(work, "cache")
            run_folder.mkdir()
            for file in INPUTS.get(name, ()):
                shutil.copy(self.inputs / file, run_folder)
            before = files_of(run_folder)
            variables = {"LD_PRELOAD": self.faults, "RAYA_MEMORY_FAULT": fault, "RAYA_MEMORY_FAILED": str(failed_file)}
            if by_library and self.cache:  # a crashing driver may damage its cache
                shutil.copytree(self.cache, cache)
                variables["POCL_CACHE_DIR"] = str(cache)
            code, output = self.run(COMMANDS[name], run_folder, variables)
            message = " | ".join(line for line in output.splitlines() if line.startswith("raya: "))
            return self.classify(name, by_library, code, message, failed_file.exists(), before, files_of(run_folder)), code, message

    def run(self, arguments, run_folder, variables):
        """Runs raya; returns (exit code, stderr). Terminates a run in which the driver waits for memory forever; its exit code is that of SIGTERM."""
        with subprocess.Popen([self.raya, *arguments], cwd=run_folder, env=environment(**variables),
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
            try:
                _, output = process.communicate(timeout=LIMIT_S)
            except subprocess.TimeoutExpired:
                process.terminate()
                try:
                    _, output = process.communicate(timeout=LIMIT_S)
                except subprocess.TimeoutExpired:
                    process.kill()
                    _, output = process.communicate()
            return process.returncode, output.decode(errors="replace")

    def classify(self, name, by_library, code, message, failed, before, after):
        """Returns the ending of a run as a text, which starts with BAD if raya is wrong. `by_library`: a library made the failed allocation."""
        if code == 0:
            if {file: comparable(file, content) for file, content in after.items()} != self.expected[name]:
                return "BAD: exit 0, other files"
            return "survived" if failed else "not reached"
        new_files = sorted(file for file in after if after[file] != before.get(file))
        damaged = [file for file in new_files if not self.is_complete(name, file, after[file])]
        lost = sorted(set(before) - set(after) - {"s.rst"})  # raya removes the checkpoint after writing the image
        if damaged or lost:
            return f"BAD: damaged {damaged}, lost {lost}"
        if code in (2, 3) and "raya: " in message:
            return f"exit {code}" + (", files written before stay" if new_files else "")
        if by_library and code != -signal.SIGKILL:
            return "driver waits for ever" if code == -signal.SIGTERM else "driver's abort"
        return f"BAD: exit {code}"

    def is_complete(self, name, file, content):
        """Returns true if a file is complete. raya keeps the files that it wrote before the failure: a failing report must not delete the image."""
        if file == "s.rst":
            return self.can_resume(content)
        return comparable(file, content) == self.expected[name].get(file)

    def can_resume(self, checkpoint):
        key = hashlib.sha256(checkpoint).hexdigest()
        if key not in self.resumable:
            with tempfile.TemporaryDirectory(dir=self.folder) as run_folder:
                Path(run_folder, "s.rst").write_bytes(checkpoint)
                done = subprocess.run([self.raya, *COMMANDS["resume"]], cwd=run_folder, env=environment(),
                                      capture_output=True, timeout=LIMIT_S)
                found = {file: comparable(file, content) for file, content in files_of(run_folder).items()}
            self.resumable[key] = done.returncode == 0 and found == self.expected["resume"]
        return self.resumable[key]


def files_of(folder):
    return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def comparable(name, content):
    """Returns the part of a file that is equal in every run: pixels of an image, names of a report's members, or the end of another complete file."""
    if name.endswith((".ppm", ".pfm", ".png")):
        return hashlib.sha256(content).hexdigest()
    if name == "x.json":
        return sorted(json.loads(content))
    if name.endswith(".json"):
        json.loads(content)
    return content.endswith((b"</html>\n", b"]}\n", b"}\n"))


def faults_of(trial, seed, sample):
    """Returns [(command, fault)]: every allocation site once, in the first command that reaches it, and allocations by other libraries."""
    seen, sites, library_faults = set(), [], []
    for name in COMMANDS:
        numbers, count = trial.sites(name)
        sites += [(name, number) for number in numbers if number not in seen]
        seen.update(numbers)
        library_faults += [(name, f"+{at}") for at in range(1, count + 1)]
    print(f"{len(sites)} allocation sites of raya, {len(library_faults)} allocations by libraries, seed {seed}", flush=True)
    generator = random.Random(seed)
    if sample:
        library_count = max(1, sample // 5)
        return generator.sample(sites, sample - library_count) + generator.sample(library_faults, library_count)
    return sites + generator.sample(library_faults, LIBRARY_ALLOCATIONS)


def read_log(path, program):
    """Returns {(command, fault): outcome} of finished runs of this program. Starts a new log if `path` is the log of another program."""
    lines = Path(path).read_text().splitlines() if path and Path(path).exists() else []
    if lines[:1] == [program]:
        return {(row[0], row[1]): row[2:] for row in csv.reader(lines[1:]) if len(row) == 5}
    if path:
        Path(path).write_text(program + "\n")
    return {}


def processor():
    names = re.findall(r"^model name\s*:\s*(.*)$", Path("/proc/cpuinfo").read_text(), re.M)
    return names[0] if names else "unknown"


def write_results(path, outcomes):
    counts = collections.Counter()
    for (name, fault), (ending, _, _) in outcomes.items():
        counts[name, "elsewhere" if fault.startswith("+") else "raya", ending] += 1
    with open(path, "w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["command", "allocations", "ending", "runs", "date", "processor"])
        for key, count in sorted(counts.items()):
            rows.writerow([*key, count, datetime.date.today().isoformat(), processor()])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("raya", "faults", "cl_faults"):
        parser.add_argument(name, type=os.path.abspath)
    parser.add_argument("--sample", type=int, default=0)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--log")
    parser.add_argument("--results")
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.randrange(10**6) if options.sample else 1
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(options, Path(folder))
        outcomes = {}
        done = read_log(options.log, hashlib.sha256(Path(options.raya).read_bytes()).hexdigest())
        for name, fault in faults_of(trial, seed, options.sample):
            outcome = done.get((name, fault)) or trial.run_with_fault(name, fault)
            outcomes[name, fault] = outcome
            if outcome[0].startswith("BAD"):
                print(f"{name} {fault}: {outcome[0]} {outcome[2]}", flush=True)
            if options.log and (name, fault) not in done:
                with open(options.log, "a", newline="") as file:
                    csv.writer(file, lineterminator="\n").writerow([name, fault, *outcome])
    if options.results:
        write_results(options.results, outcomes)
    endings = collections.Counter(ending for ending, _, _ in outcomes.values())
    print(", ".join(f"{count} {ending}" for ending, count in sorted(endings.items())))
    return any(ending.startswith("BAD") for ending in endings)


if __name__ == "__main__":
    sys.exit(main())
