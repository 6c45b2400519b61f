#!/usr/bin/env python3
"""Checks that git tracks no binary files, such as caches and build products, except those in WANTED.
  test_binary.py     exit codes: 0 no unwanted file; 1 an unwanted file; 77 not a git checkout"""
import fnmatch
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
WANTED = ["docs/*.png", "tests/fuzz/corpus/*"]
HEAD_BYTES = 8000  # number of bytes at the start of a file that are searched for a zero byte, as git does


def unwanted(files):
    """Returns the names of the files that are not in WANTED and have a zero byte in `head`. files: (name, head) of each file."""
    return [name for name, head in files if b"\0" in head and not any(fnmatch.fnmatch(name, kind) for kind in WANTED)]


def main():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    if listed.returncode != 0:
        return 77
    names = [name for name in listed.stdout.decode().split("\0") if name and (ROOT / name).is_file()]
    found = unwanted((name, (ROOT / name).open("rb").read(HEAD_BYTES)) for name in names)
    if unwanted([("pocl-cache/a.so", b"\x7fELF\0"), ("docs/a.png", b"\0"), ("a.txt", b"a")]) != ["pocl-cache/a.so"]:
        found.append("this test does not find a binary file")
    print(f"{len(names)} files; unwanted binary files: {', '.join(found) or 'none'}")
    return 1 if found or len(names) < 100 else 0


sys.exit(main())
