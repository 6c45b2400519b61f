#!/usr/bin/env python3
"""Makes one memory allocation of raya fail in each run, and checks exit code, message and files (tests/cli/memory_faults.cpp).

    tests/tools/test_memory.py RAYA FAULTS CL_FAULTS [--sample N] [--seed S]

RAYA is the program, FAULTS and CL_FAULTS are the libraries made of tests/cli/memory_faults.cpp and cl_faults.cpp.
--sample N       tests N random allocations (default: every allocation site of raya once, in the first command that reaches it, and 200 allocations of
                 libraries: about an hour on one core)
--seed S         seed of the random allocations (default: random)
Exit codes: 0 done; 1 a run ended with a wrong exit code or message, or left a damaged file.
"""
import argparse, collections, hashlib, json, os, random, shutil, signal, subprocess, sys, tempfile
from pathlib import Path

SCENE = str(Path(__file__).resolve().parents[2] / "scenes" / "centre.nff")
SMALL_RENDER = ["render", SCENE, "--size", "16", "--lanes", "4", "--format", "fp32"]
BANDED_RENDER = ["render", SCENE, "--size", "16", "--lanes", "1", "--format", "fp32", "--pes", "4", "--group", "1",
                 "-o", "x.ppm", "--checkpoint", "s.rst", "--checkpoint-every", "0"]
# {name: (arguments, files that the command reads)}
COMMANDS = {
    "render": (SMALL_RENDER + ["-o", "x.ppm", "--report", "x.json", "--cost", "x.pfm", "--trace", "x.trace.json"], []),
    "tiff": (SMALL_RENDER + ["-o", "x.tif"], []),
    "page": (["page", "saved.json", "-o", "x.html"], ["saved.json"]),
    "keep": (BANDED_RENDER, []),
    "resume": (BANDED_RENDER + ["--resume"], ["s.rst"]),
}
LIBRARY_ALLOCATIONS = 200  # number of tested allocations by libraries
LIMIT_S = 120  # seconds; a run takes half a second on an idle machine


def comparable(name, content):
    """Returns the part of a file that is equal in every run: pixels of an image, names of a report's members, or the end of another complete file."""
    if name.endswith((".ppm", ".pfm", ".tif")):
        return hashlib.sha256(content).hexdigest()
    if name == "x.json":
        return sorted(json.loads(content))
    if name.endswith(".json"):
        json.loads(content)
    return content.endswith((b"</html>\n", b"]}\n", b"}\n"))


def run(arguments, inputs=(), **variables):
    """Runs raya in a new folder with the input files {name: content}. Returns (exit code, stderr, files {name: content}). A driver may wait forever for
    memory; raya then ends by SIGTERM, and its exit code is -SIGTERM."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in dict(inputs).items():
            Path(folder, name).write_bytes(content)
        with subprocess.Popen([options.raya, *arguments], cwd=folder, env={**os.environ, **variables}, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE) as process:
            try:
                message = process.communicate(timeout=LIMIT_S)[1]
            except subprocess.TimeoutExpired:
                process.terminate()
                message = process.communicate()[1]
        return process.returncode, message.decode(errors="replace"), {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def without_fault(arguments, inputs=(), **variables):
    code, message, files = run(arguments, inputs, **variables)
    assert code == 0, message
    return files


class Trial:
    """The five commands, with their inputs and the files that they must write."""

    def __init__(self):
        saved = without_fault([*SMALL_RENDER, "-o", "x.ppm", "--report", "saved.json"])["saved.json"]
        # A checkpoint of a render whose device fails after the checkpoint is written.
        failed = (run(BANDED_RENDER, LD_PRELOAD=options.cl_faults, RAYA_FAULT=f"clEnqueueNDRangeKernel {launch} -5") for launch in range(1, 50))
        inputs = {"saved.json": saved, "s.rst": next(files["s.rst"] for code, _, files in failed if code == 3 and "s.rst" in files)}
        self.commands = {name: (arguments, {file: inputs[file] for file in read}) for name, (arguments, read) in COMMANDS.items()}
        self.expected = {name: self.comparable(without_fault(*command)) for name, command in self.commands.items()}

    @staticmethod
    def comparable(files):
        return {name: comparable(name, content) for name, content in files.items()}

    def sites(self, name):
        """Returns (sorted numbers of the allocation sites in raya that the command reaches, number of its allocations by other libraries)."""
        with tempfile.NamedTemporaryFile("r") as sites:
            without_fault(*self.commands[name], LD_PRELOAD=options.faults, RAYA_MEMORY_SITES=sites.name)
            rows = [line.split() for line in sites]
        return sorted(row[0] for row in rows if row[0] != "elsewhere"), int(rows[-1][1])

    def ending(self, name, fault):
        """Runs a command in which one allocation fails. Returns its ending, which starts with BAD if raya is wrong."""
        by_library, cache = fault.startswith("+"), os.environ.get("POCL_CACHE_DIR")
        variables = {"LD_PRELOAD": options.faults, "RAYA_MEMORY_FAULT": fault}
        with tempfile.TemporaryDirectory() as scratch:
            variables["RAYA_MEMORY_FAILED"] = f"{scratch}/failed"
            if by_library and cache:  # a crashing driver may damage its cache
                variables["POCL_CACHE_DIR"] = shutil.copytree(cache, f"{scratch}/cache")
            code, message, files = run(*self.commands[name], **variables)
            has_failed = Path(scratch, "failed").exists()
        before = self.commands[name][1]
        if code == 0:
            is_right = self.comparable(files) == self.expected[name]
            return ("survived" if has_failed else "not reached") if is_right else "BAD: exit 0, other files"
        new = {file: content for file, content in files.items() if content != before.get(file)}
        damaged = [file for file, content in new.items() if not self.is_complete(name, file, content)]
        lost = set(before) - set(files) - {"s.rst"}  # raya removes the checkpoint after writing the image
        if damaged or lost:
            return f"BAD: damaged {damaged}, lost {lost}"
        if code in (2, 3) and "raya: " in message:
            return f"exit {code}" + (", files written before stay" if new else "")
        if by_library and code != -signal.SIGKILL:
            return "driver waits for ever" if code == -signal.SIGTERM else "driver's abort"
        return f"BAD: exit {code}: {message}"

    def is_complete(self, name, file, content):
        """Returns true if a file is complete. raya keeps the files that it wrote before the failure: a failing report must not delete the image."""
        if file != "s.rst":
            return comparable(file, content) == self.expected[name].get(file)
        code, _, files = run(COMMANDS["resume"][0], {file: content})
        return code == 0 and self.comparable(files) == self.expected["resume"]


def main():
    trial = Trial()
    seen, sites, library_faults = set(), [], []
    for name in COMMANDS:
        numbers, count = trial.sites(name)
        sites += [(name, number) for number in numbers if number not in seen]
        seen.update(numbers)
        library_faults += [(name, f"+{at}") for at in range(1, count + 1)]
    print(f"{len(sites)} allocation sites of raya, {len(library_faults)} allocations by libraries, seed {options.seed}", flush=True)
    generator = random.Random(options.seed)
    by_library = max(1, options.sample // 5) if options.sample else LIBRARY_ALLOCATIONS
    faults = generator.sample(sites, options.sample - by_library) if options.sample else sites
    endings = collections.Counter()
    for name, fault in faults + generator.sample(library_faults, by_library):
        ending = trial.ending(name, fault)
        endings[ending] += 1
        if ending.startswith("BAD"):
            print(f"{name} {fault}: {ending}", flush=True)
    print(", ".join(f"{count} {ending}" for ending, count in sorted(endings.items())))
    return any(ending.startswith("BAD") for ending in endings)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for program in ("raya", "faults", "cl_faults"):
        parser.add_argument(program, type=os.path.abspath)
    parser.add_argument("--sample", type=int, default=0)
    parser.add_argument("--seed", type=int, default=random.randrange(10**6))
    options = parser.parse_args()
    sys.exit(main())
