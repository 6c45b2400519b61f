#!/usr/bin/env python3
"""Checks the workflows of docs/ci and the commands of docs/ci.md: programs and options exist; packages are those of tools/setup, tools/portability or
docs/packages.md; files that a job uploads or summarises are written in it; ctest has the report file and the labels of tools/test; shards and
artifacts are complete. The checks themselves are tested with injected faults. tests/tools/run_workflow.py runs the workflows.

    tests/tools/test_ci_recipe.py RAYA     RAYA: the built program. Exit code 77 if Python has no yaml (Debian: python3-yaml)
"""
import functools, itertools, json, re, shlex, shutil, subprocess, sys, tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
WORKFLOW, BUNDLE_WORKFLOW = ROOT / "docs/ci/raya-portability.yml", ROOT / "docs/ci/raya-verify.yml"
PAGE = ROOT / "docs/ci.md"
SHELL = {"mkdir", "apt-get", "[", "echo", "cat", "tar", "curl"}
NO_SUCH = "--no-such-option"

# (text of the workflow, faulty replacement)
BUNDLE_FAULTS = [("raya verify --quick", "raya verify --quik"), ("{name: verify, path: verify.xml}", "{name: verify, path: v.xml}"),
                 ("pocl-opencl-icd", "pocl")]
FAULTS = [('"long|sweep"', "long"), ("--shard ${{ matrix.shard }}/3", "--shard ${{ matrix.shard }}/4"), ("shard: [1, 2, 3]", "shard: [1, 2]"),
          ("ccache\n          tools", "ccachee\n          tools"), ("--junit verify.xml", "--junit v.xml"),
          ("-czf build.tar.gz", "-czf built.tar.gz"), ("{name: build, path", "{name: built, path"), ("--junit portability.xml", "--junit p.xml"),
          ("tools/ci_summary build/junit.xml", "tools/ci_summary junit.xml"),
          ("verify --quick", "verify --quik"), ("verify --quick", "verify --lanes 3"), ("--tolerance 30", "--tolerance much"),
          ("build/raya verify", "build/raya verifies"), ("cmake --preset release", "cmake --preset relase"),
          ("cmake --build build -j2", "cmake --build bild -j2"), ("--output-on-failure", "--output-on-failures"),
          ("--output-junit junit.xml", "--output-junit tests.xml"), ("build/junit.xml", "junit.xml"), ("tools/setup\n", "tools/setup --all\n"),
          ("tools/setup\n", "tools/set-up\n"), ("tools/portability --shard", "tools/portability --shrad"),
          ("mesa-opencl-icd", "mesa-opencl"), ("--report verify.json", "--report verified.json")]


def commands(script):
    """Yields ([program, argument, ...], redirection targets) of the simple commands of a script."""
    for line in script.replace("\\\n", " ").splitlines():
        lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
        lexer.whitespace_split = True
        arguments, written = [], []
        for token in [*lexer, ";"]:
            if written and written[-1] is None:
                written[-1] = token
            elif token in (">", ">>"):
                written.append(None)
            elif token not in (";", "&&", "||", "|"):
                arguments += [token] if arguments or token not in ("if", "then", "else", "fi", "sudo") else []
            elif arguments:
                yield arguments, written
                arguments, written = [], []


def output_of(command, **more):
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL, **more)
    return done.returncode, done.stdout + done.stderr


def packages_of_setup():
    line = output_of([ROOT / "tools/setup", "--print"])[1]
    return set(line.split("--no-install-recommends")[1].split())


def optional_packages():
    """Debian packages that tools/portability names in its messages, and those of docs/packages.md."""
    cells = re.findall(r"^\| ([\w, .-]+?)[ ;]", (ROOT / "docs/packages.md").read_text(), re.M)
    named = {name for cell in cells for name in cell.split(", ")}
    return named | set(re.findall(r"\(Debian: ([\w-]+)\)", (ROOT / "tools/portability_implementations.py").read_text()))


def after(arguments, option):
    """Returns the argument after the option; None if the option is not given."""
    return arguments[arguments.index(option) + 1] if option in arguments else None


def wrong_with_raya(arguments, raya, scratch):
    """Runs the command with an additional unknown option. raya parses all options, must complain about this one only, and renders nothing."""
    code, output = output_of([raya, *arguments[1:], NO_SUCH], cwd=scratch)
    return "" if code == 2 and f": no option {NO_SUCH}; see raya {arguments[1]} --help\n" in output else output.strip()


def wrong_with_tool(arguments):
    tool = ROOT / arguments[0]
    if not tool.exists():
        return "no such file"
    if "argparse" in tool.read_text():
        code, output = output_of([tool, *arguments[1:], NO_SUCH])
        return "" if code == 2 and f"unrecognized arguments: {NO_SUCH}\n" in output else output.strip().splitlines()[-1]
    if arguments[0] == "tools/ci_summary":  # files_read() checks its files
        return "" if len(arguments) > 1 else "no file"
    return "" if set(arguments[1:]) <= ({"--print"} if arguments[0] == "tools/setup" else set()) else f"unknown options {arguments[1:]}"


def wrong_with_cmake(arguments):
    if arguments[1] == "--preset":
        presets = {p["name"]: p for p in json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]}
        return "" if arguments[2] in presets else f"no preset {arguments[2]}"
    is_right = arguments[1:3] == ("--build", "build") and re.fullmatch(r"(-j\d+)?", "".join(arguments[3:]))
    return "" if is_right else "differs from the build command of tools/test"


def wrong_with_ctest(arguments):
    known = output_of(["ctest", "--help"])[1]
    missing = [w for w in arguments[1:] if w.startswith("-") and not re.search(rf"(^|\s){re.sub(r'(?<=^-j)[0-9]+$', '', w)}\b", known)]
    tool = (ROOT / "tools/test").read_text()
    wanted = after(shlex.split(re.search(r"^ *ctest .*", tool, re.M)[0]), "--output-junit")
    labels = after(shlex.split(re.search(r"^ *run_tests build -LE .*", tool, re.M)[0]), "-LE")
    if missing:
        return f"ctest has no options {missing}"
    if after(arguments, "-LE") != labels:
        return f"runs other tests than tools/test, which has -LE {labels}"
    return "" if after(arguments, "--output-junit") == wanted else f"writes a report file other than that of tools/test, {wanted}"


def wrong_with_packages(arguments):
    if arguments[1] != "install":
        return "" if arguments[1:] == ("update",) else f"unknown command of apt-get: {arguments[1:]}"
    strange = {w for w in arguments[2:] if not w.startswith("-")} - packages_of_setup() - optional_packages()
    return f"packages that neither tools/setup nor tools/portability names: {strange}" if strange else ""


@functools.cache  # most commands are the same with each injected fault
def wrong_with(arguments, raya, scratch):
    """Returns a text that says what is wrong with one command; "" if the command is right."""
    name = arguments[0]
    if name in ("build/raya", "raya-*/raya"):
        return wrong_with_raya(arguments, raya, scratch)
    if name.startswith("tools/"):
        return wrong_with_tool(arguments)
    if name == "ccache":
        return "" if arguments[1:] in (("--zero-stats",), ("--show-stats",)) else "unknown option"
    known = {"cmake": wrong_with_cmake, "ctest": wrong_with_ctest, "apt-get": wrong_with_packages}
    if name in known:
        return known[name](arguments)
    return "" if name in SHELL else "unknown command"


def files_of(arguments, written):
    """Files that a command writes, relative to the repository's root."""
    reports = [next_one for word, next_one in zip(arguments, arguments[1:]) if word in ("--report", "--junit", "-czf")]
    return {*written, *reports, *([f"build/{after(arguments, '--output-junit')}"] if "--output-junit" in arguments else [])}


def files_read(arguments):
    """Files that a command reads and an earlier one of the job, or of the job that made an artifact, must write."""
    return {"tools/ci_summary": arguments[1:], "cat": arguments[1:], "tar": arguments[2:] if "-xzf" in arguments else []}.get(arguments[0], [])


def faults_of_job(name, job, uploads):
    """Returns (commands, texts that say what is wrong with the files of a job). uploads: {artifact: its files}; adds those of this job."""
    steps = job["steps"]
    pairs = [pair for step in steps for pair in commands(step.get("run", ""))]
    written = set().union(*(files_of(*pair) for pair in pairs))
    faults = []
    for step in steps:
        action, options = step.get("uses", "").split("@")[0], step.get("with", {})
        if action == "actions/download-artifact":
            written |= uploads.get(options["name"], set())
            faults += [] if options["name"] in uploads else [f"{name}: no earlier job uploads {options['name']}"]
        elif action == "actions/upload-artifact":
            uploads[options["name"]] = set(options["path"].split())
            faults += [f"{name}: {file} is uploaded, but no step writes it" for file in options["path"].split() if file not in written]
    read = {file for arguments, _ in pairs for file in files_read(arguments)}
    return pairs, faults + [f"{name}: {file} is read, but no step writes it" for file in sorted(read - written)]


def wrong_shards(job):
    """Returns a text if the shards of the commands differ from those of the job's matrix."""
    counts = {int(count) for step in job["steps"] for count in re.findall(r"--shard \$\{\{ matrix.shard \}\}/(\d+)", step.get("run", ""))}
    shards = job.get("strategy", {}).get("matrix", {}).get("shard", [])
    return "" if all(shards == list(range(1, count + 1)) for count in counts) else f"shards {shards} are not all of {counts}"


def checked(pairs, raya, scratch):
    """Returns a text for each command that is wrong."""
    wrong = [(arguments, wrong_with(tuple(arguments), raya, scratch)) for arguments, _ in pairs]
    return [f"{' '.join(arguments)}: {text}" for arguments, text in wrong if text]


def faults_of(workflow, raya, scratch):
    """Returns (texts that say what is wrong in the workflow, number of its commands)."""
    import yaml
    faults, uploads, all_pairs = [], {}, []
    for name, job in yaml.safe_load(workflow)["jobs"].items():
        faults += [f"{name}: {text}" for text in [wrong_shards(job)] if text]
        job = yaml.safe_load(re.sub(r"\$\{\{ matrix\.\w+ \}\}", "1", yaml.safe_dump(job)))
        pairs, wrong = faults_of_job(name, job, uploads)
        faults += wrong + checked(pairs, raya, scratch)
        uses_container = any(arguments[0].startswith(("tools/", "build/")) for arguments, _ in pairs)
        faults += [] if ["tools/setup"] in [arguments for arguments, _ in pairs] or not uses_container else [f"{name}: no step runs tools/setup"]
        all_pairs += pairs
    return faults, len(all_pairs)


def faults_of_page(page, raya, scratch):
    """Returns (texts that say what is wrong in the page, number of its commands): its indented lines that start with a program."""
    lines = [line.strip() for line in page.splitlines() if line.startswith("    ")]
    programs = ("build/raya", "tools/", "ctest", "cmake", "apt-get")
    pairs = list(itertools.chain.from_iterable(commands(line) for line in lines if line.startswith(programs)))
    return checked(pairs, raya, scratch), len(pairs)


def main():
    try:
        import yaml  # noqa: F401
    except ImportError:
        print("skipped: this Python has no yaml (Debian: python3-yaml)")
        return 77
    raya = str(Path(sys.argv[1]).resolve())
    count, injected = 0, 0
    with tempfile.TemporaryDirectory() as scratch:
        faults, count = faults_of_page(PAGE.read_text(), raya, scratch)
        for file, injections in ((WORKFLOW, FAULTS), (BUNDLE_WORKFLOW, BUNDLE_FAULTS)):
            workflow = file.read_text()
            more, number = faults_of(workflow, raya, scratch)
            faults, count, injected = faults + more, count + number, injected + len(injections)
            for old, new in injections:
                if old not in workflow:
                    faults.append(f"{file.name} has no '{old}' any more: update the faults of this test")
                elif not faults_of(workflow.replace(old, new), raya, scratch)[0]:
                    faults.append(f"'{new}' instead of '{old}' is not detected")
    print("\n".join(faults) or f"{count} commands: all right; {injected} injected faults: all detected")
    return 1 if faults or count < 30 else 0


if __name__ == "__main__":
    sys.exit(main())
