#!/usr/bin/env python3
"""Checks the workflow of docs/ci and the commands of docs/ci.md: programs and options exist; packages are those of tools/setup or tools/portability;
uploaded files are written; ctest writes the same report file as in tools/test. The checks themselves are tested with injected faults.

    tests/tools/test_ci_recipe.py RAYA     RAYA: the built program. Exit code 77 if Python has no yaml (Debian: python3-yaml)
"""
import functools, json, re, shlex, shutil, subprocess, sys, tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
WORKFLOW = ROOT / "docs/ci/raya-portability.yml"
PAGE = ROOT / "docs/ci.md"
SHELL = {"mkdir", "apt-get", "[", "echo", "cat"}
NO_SUCH = "--no-such-option"

# (text of the workflow, faulty replacement)
FAULTS = [("verify --quick", "verify --quik"), ("verify --quick", "verify --lanes 3"), ("--tolerance 30", "--tolerance much"),
          ("build/raya verify", "build/raya verifies"), ("cmake --preset release", "cmake --preset relase"),
          ("cmake --build build -j2", "cmake --build bild -j2"), ("--output-on-failure", "--output-on-failures"),
          ("--output-junit junit.xml", "--output-junit tests.xml"), ("build/junit.xml", "junit.xml"), ("tools/setup\n", "tools/setup --all\n"),
          ("tools/setup\n", "tools/set-up\n"), ("tools/portability >", "tools/portability --wirte >"),
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
            elif token not in (";", "&&", "||"):
                arguments += [token] if arguments or token not in ("if", "then", "else", "fi") else []
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
    """Debian packages that tools/portability names in its messages."""
    return set(re.findall(r"\(Debian: ([\w-]+)\)", (ROOT / "tools/portability_implementations.py").read_text()))


def junit_of(arguments):
    return arguments[arguments.index("--output-junit") + 1] if "--output-junit" in arguments else None


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
    wanted = junit_of(shlex.split(re.search(r"^ *ctest .*", (ROOT / "tools/test").read_text(), re.M)[0]))
    if missing:
        return f"ctest has no options {missing}"
    return "" if junit_of(arguments) == wanted else f"writes a report file other than that of tools/test, {wanted}"


def wrong_with_packages(arguments):
    if arguments[1] != "install":
        return "" if arguments[1:] == ("update",) else f"unknown command of apt-get: {arguments[1:]}"
    strange = {w for w in arguments[2:] if not w.startswith("-")} - packages_of_setup() - optional_packages()
    return f"packages that neither tools/setup nor tools/portability names: {strange}" if strange else ""


@functools.cache  # most commands are the same with each injected fault
def wrong_with(arguments, raya, scratch):
    """Returns a text that says what is wrong with one command; "" if the command is right."""
    name = arguments[0]
    if name == "build/raya":
        return wrong_with_raya(arguments, raya, scratch)
    if name.startswith("tools/"):
        return wrong_with_tool(arguments)
    known = {"cmake": wrong_with_cmake, "ctest": wrong_with_ctest, "apt-get": wrong_with_packages}
    if name in known:
        return known[name](arguments)
    return "" if name in SHELL and shutil.which(name) else "unknown command"


def files_of(arguments, written):
    """Files that a command writes, relative to the repository's root."""
    reports = [after for word, after in zip(arguments, arguments[1:]) if word == "--report"]
    return {*written, *reports, *([f"build/{junit_of(arguments)}"] if junit_of(arguments) else [])}


def faults_of(workflow, page, raya, scratch):
    """Returns (texts that say what is wrong in the workflow and in the page, total number of their commands)."""
    import yaml
    steps = [step for job in yaml.safe_load(workflow)["jobs"].values() for step in job["steps"]]
    workflow_commands = [pair for step in steps for pair in commands(step.get("run", ""))]
    # The page's commands: indented lines that start with a program.
    lines = [line.strip() for line in page.splitlines() if line.startswith("    ")]
    page_commands = [pair for line in lines if line.startswith(("build/raya", "tools/", "ctest", "cmake", "apt-get")) for pair in commands(line)]
    checked = [(arguments, wrong_with(tuple(arguments), raya, scratch)) for arguments, _ in workflow_commands + page_commands]
    faults = [f"{' '.join(arguments)}: {wrong}" for arguments, wrong in checked if wrong]
    written = set().union(*(files_of(*pair) for pair in workflow_commands))
    uploaded = [name for step in steps for name in step.get("with", {}).get("path", "").split() if "upload" in step.get("uses", "")]
    faults += [f"{name} is uploaded, but no step writes it" for name in uploaded if name not in written]
    faults += [] if ["tools/setup"] in [arguments for arguments, _ in workflow_commands] else ["no step runs tools/setup"]
    return faults, len(workflow_commands + page_commands)


def main():
    try:
        import yaml  # noqa: F401
    except ImportError:
        print("skipped: this Python has no yaml (Debian: python3-yaml)")
        return 77
    raya = str(Path(sys.argv[1]).resolve())
    workflow, page = WORKFLOW.read_text(), PAGE.read_text()
    with tempfile.TemporaryDirectory() as scratch:
        faults, count = faults_of(workflow, page, raya, scratch)
        for old, new in FAULTS:
            if old not in workflow:
                faults.append(f"the workflow has no '{old}' any more: update FAULTS of this test")
            elif not faults_of(workflow.replace(old, new), "", raya, scratch)[0]:
                faults.append(f"'{new}' instead of '{old}' is not detected")
    print("\n".join(faults) or f"{count} commands: all right; {len(FAULTS)} injected faults: all detected")
    return 1 if faults or count < 15 else 0


if __name__ == "__main__":
    sys.exit(main())
