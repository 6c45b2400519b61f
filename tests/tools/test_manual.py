#!/usr/bin/env python3
"""Checks the manual pages of `raya manual` as man shows them: they contain all text of --help-all, and man prints no warnings. Exit code 77: no man.
  test_manual.py RAYA FOLDER     FOLDER holds the pages that the build has made: man1/"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

raya, built = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
if not shutil.which("man"):
    print("skipped: no man (tools/setup --package)")
    sys.exit(77)
faults = []
PLAIN_TEXT = {**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "900", "MANOPT": "--no-hyphenation --no-justification", "MAN_KEEP_FORMATTING": "",
         "MANROFFOPT": "-c", "PAGER": "cat", "GROFF_NO_SGR": "1"}


def squeezed(text):
    return re.sub(r"\s+", " ", text)


def text_of_page(page):
    """Returns the text of a manual page as man prints it, without formatting. Adds man's warnings to the faults."""
    run = subprocess.run(["man", "--warnings", "-l", page], capture_output=True, text=True, env=PLAIN_TEXT)
    if run.returncode or run.stderr:
        faults.append(f"{page}: man ends with {run.returncode}: {run.stderr}")
    return squeezed(re.sub(".\x08", "", run.stdout))


def help_of(command):
    wide = {**os.environ, "COLUMNS": "120"}
    text = subprocess.run([raya, *command, "--help"], capture_output=True, text=True, check=True, env=wide).stdout
    if "--help-all" in text:  # commands whose --help lists only common options
        text = subprocess.run([raya, *command, "--help-all"], capture_output=True, text=True, check=True, env=wide).stdout
    return re.sub(r" \\\n +", " ", text)  # joins continued lines of examples


def entries(text):
    """Yields (names, help) of every example, option and command in a help text."""
    begun = None
    for line in [*text.split("\n"), ""]:
        if line.startswith("   ") and begun:
            begun.append(line)
            continue
        if begun:
            names, _, help_text = " ".join(begun)[2:].partition("  ")
            yield names, squeezed(help_text)
        begun = [line] if re.match(r"  \S", line) else None


def commands_in(text):
    part = re.search(r"\nCommands:\n(.*?)(\n\n|$)", text, re.S)
    return re.findall(r"^  (\S+)", part[1], re.M) if part else []


def check(page, command, is_subcommand=False):
    text = help_of(command)
    for names, help_text in entries(text):
        if is_subcommand and "--help" in names:
            continue
        for name in re.findall(r"(?<!\S)--?[a-z][a-z-]*", names.replace(",", " ")):
            if not re.search(rf"(?<![\w-]){name}(?![\w-])", page):
                faults.append(f"{' '.join(command)}: the page does not contain {name}")
        if help_text not in page:
            faults.append(f"{' '.join(command)} {names}: '{help_text}' is not in the page")
    return commands_in(text)


def run():
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([raya, "manual", "-o", folder], check=True)
        names = {page.name for page in pathlib.Path(folder).iterdir()}
        commands = check(text_of_page(f"{folder}/raya.1"), [])
        if names != {"raya.1"} | {f"raya-{command}.1" for command in commands}:
            faults.append(f"unexpected pages: {sorted(names)}")
        for command in commands:
            page = text_of_page(f"{folder}/raya-{command}.1")
            for subcommand in check(page, [command]):
                check(page, [command, subcommand], is_subcommand=True)
                count += 1
            printed = subprocess.run([raya, "manual", command], capture_output=True, text=True, check=True).stdout
            if printed != pathlib.Path(f"{folder}/raya-{command}.1").read_text():
                faults.append(f"raya manual {command}: the printed page differs from the file of raya manual -o")
            if printed != (built / "man1" / f"raya-{command}.1").read_text():
                faults.append(f"raya-{command}.1 of the build differs from the program's output")
        if (built / "man1" / "raya.1").read_text() != pathlib.Path(f"{folder}/raya.1").read_text():
            faults.append("raya.1 of the build differs from the program's output")
        if "EXIT CODES 0 done, 2 bad option" not in text_of_page(str(built / "man1" / "raya.1")):
            faults.append("raya.1: the page does not contain the exit codes")
        count += len(names)
    refused = subprocess.run([raya, "manual", "rendr"], capture_output=True, text=True)
    if refused.returncode != 2 or "no command rendr (did you mean render?)" not in refused.stderr:
        faults.append(f"raya manual rendr is not refused with the name of the closest command: {refused}")
    return count


pages = run()
for fault in faults:
    print(fault)
print(f"{pages} commands, {len(faults)} faults")
sys.exit(1 if faults else 0)
