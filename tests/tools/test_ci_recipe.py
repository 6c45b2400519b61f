#!/usr/bin/env python3
"""The workflow of docs/ci: every command in it is there, and raya's commands have the options that it gives them.

    tests/tools/test_ci_recipe.py RAYA     RAYA: the built program. Exit code 77 where Python has no yaml (Debian: python3-yaml)
"""
import re, shlex, shutil, subprocess, sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
WORKFLOW = ROOT / "docs/ci/raya-portability.yml"
PAGE = ROOT / "docs/ci.md"
SHELL = {"if", "then", "fi", "mkdir", "cmake", "ctest", "apt-get", "["}


def commands(script):
    """The simple commands of a script, each as words."""
    for line in script.splitlines():
        for part in re.split(r";|&&", "" if line.lstrip().startswith("#") else line):
            words = [w for w in shlex.split(part) if w not in ("if", "then", "fi")]
            if words:
                yield words


def wrong_with(words, raya):
    """What is wrong with one command, or nothing."""
    name = words[0]
    if name == "build/raya":
        done = subprocess.run([raya, words[1], "--help"], capture_output=True, text=True)
        if done.returncode != 0:
            return f"raya has no command {words[1]}"
        missing = [w for w in words[2:] if w.startswith("--") and not re.search(rf"{w}\b", done.stdout)]
        return f"raya {words[1]} has no {missing}" if missing else ""
    if name.startswith("tools/"):
        return "" if (ROOT / name).exists() else f"no {name}"
    if name == "cmake" and words[1:2] == ["--preset"]:
        known = f'"name": "{words[2]}"' in (ROOT / "CMakePresets.json").read_text()
        return "" if known else f"no preset {words[2]}"
    if name == "ctest":
        missing = [w for w in words if w.startswith("--") and w not in subprocess.run(["ctest", "--help"], capture_output=True, text=True).stdout]
        return f"ctest has no {missing}" if missing else ""
    return "" if name in SHELL and (shutil.which(name) or name == "apt-get") else f"unknown command {name}"


def main():
    try:
        import yaml
    except ImportError:
        print("skipped: this Python has no yaml (Debian: python3-yaml)")
        return 77
    raya = sys.argv[1]
    steps = [step for job in yaml.safe_load(WORKFLOW.read_text())["jobs"].values() for step in job["steps"]]
    scripts = [step["run"] for step in steps if "run" in step]
    # The page's own commands: blocks of code that start with one.
    page = [line.strip() for line in PAGE.read_text().splitlines() if line.startswith("    ")]
    scripts += [re.sub(r"\s+#.*", "", line) for line in page if line.startswith(("build/raya", "tools/", "ctest", "cmake"))]
    faults = [f"{' '.join(words)}: {wrong}" for script in scripts for words in commands(script) if (wrong := wrong_with(words, raya))]
    print("\n".join(faults) or f"{len(scripts)} scripts: every command is there")
    return 1 if faults or len(scripts) < 8 else 0


if __name__ == "__main__":
    sys.exit(main())
