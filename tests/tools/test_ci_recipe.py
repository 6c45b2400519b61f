#!/usr/bin/env python3
"""Checks the commands of docs/verify.md and of the workflows in docs/ci: programs and options exist; packages are those of tools/setup, tools/portability or
docs/packages.md; ctest runs the tests of tools/test. Injected faults test the checks.

    tests/tools/test_ci_recipe.py RAYA     RAYA: the built program. Exit code 77 if Python has no yaml (Debian: python3-yaml)
"""
import json, re, shlex, subprocess, sys, tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
NO_SUCH = "--no-such-option"
SHELL = {"mkdir", "[", "echo", "cat", "tar", "curl", "ccache", "if", "then", "else", "fi"}
FAULTS = ["raya verify --quik", "build/raya bench --tolerance much", "tools/portability --shrad 1/3", "tools/set-up", "cmake --preset relase",
          "ctest --test-dir build -LE long", "apt-get install mesa-opencl", "make all"]


def commands(script):
    """Yields [program, argument, ...] of the simple commands of a script, without redirections."""
    for line in script.replace("\\\n", " ").splitlines():
        lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
        lexer.whitespace_split = True
        arguments = []
        for token in [*lexer, ";"]:
            if token not in (";", "&&", "||", "|"):
                arguments += [token] if arguments or token not in ("if", "then", "else", "fi", "sudo") else []
            elif arguments:
                yield arguments[:next((i for i, word in enumerate(arguments) if word in (">", ">>")), None)]
                arguments = []


def output_of(command, **more):
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL, **more)
    return done.returncode, done.stdout + done.stderr


def known_packages():
    line = output_of([ROOT / "tools/setup", "--print"])[1]
    cells = re.findall(r"^\| ([\w, .-]+?)[ ;]", (ROOT / "docs/packages.md").read_text(), re.M)
    optional = re.findall(r"\(Debian: ([\w-]+)\)", (ROOT / "tools/portability_implementations.py").read_text())
    return {*line.split("--no-install-recommends")[1].split(), *(name for cell in cells for name in cell.split(", ")), *optional}


def rejects_only_the_added_option(program, arguments, message, scratch):
    """Runs a command with an additional unknown option: the program parses all options, must complain about this one only, and does nothing."""
    code, output = output_of([program, *arguments, NO_SUCH], cwd=scratch)
    return code == 2 and message in output


def is_right(arguments, raya, scratch):
    name, options = arguments[0], arguments[1:]
    if name.endswith("raya"):
        return rejects_only_the_added_option(raya, options, f": no option {NO_SUCH}; see raya {options[0]} --help\n", scratch)
    if name.startswith("tools/"):
        tool = ROOT / name
        if tool.exists() and "argparse" in tool.read_text():
            return rejects_only_the_added_option(tool, options, f"unrecognized arguments: {NO_SUCH}\n", ROOT)
        return tool.exists() and all(not option.startswith("-") or option in tool.read_text() for option in options)
    if name == "cmake":
        presets = [preset["name"] for preset in json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]]
        return options[:2] in (["--build", "build"], ["--build", "light"]) or options == ["-B", "light", "-DRAYA_LIGHT=ON"] or options[0] == "--preset" and options[1] in presets
    if name == "ctest":
        labels = re.search(r'run_tests build -LE "(.*?)"', (ROOT / "tools/test").read_text())[1]
        return options[options.index("-LE") + 1] == labels
    if name == "apt-get":
        return {option for option in options[1:] if not option.startswith("-")} <= known_packages()
    return name in SHELL


def main():
    try:
        import yaml
    except ImportError:
        print("skipped: this Python has no yaml (Debian: python3-yaml)")
        return 77
    raya = str(Path(sys.argv[1]).resolve())
    page = (ROOT / "docs/verify.md").read_text()
    programs = ("build/raya", "tools/", "ctest", "cmake", "apt-get")
    scripts = [line.strip() for line in page.splitlines() if line.startswith("    ") and line.strip().startswith(programs)]
    for workflow in sorted((ROOT / "docs/ci").glob("*.yml")):
        steps = [step for job in yaml.safe_load(workflow.read_text())["jobs"].values() for step in job["steps"]]
        scripts += [re.sub(r"\$\{\{ matrix\.\w+ \}\}", "1", step["run"]) for step in steps if "run" in step]
    found = [command for script in scripts for command in commands(script)]
    with tempfile.TemporaryDirectory() as scratch:
        faults = [" ".join(command) for command in found if not is_right(command, raya, scratch)]
        faults += [f"not detected: {fault}" for fault in FAULTS if is_right(fault.split(), raya, scratch)]
    print("\n".join(faults) or f"{len(found)} commands: all right; {len(FAULTS)} injected faults: all detected")
    return 1 if faults or len(found) < 30 else 0


if __name__ == "__main__":
    sys.exit(main())
