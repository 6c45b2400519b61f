#!/usr/bin/env python3
"""Refuses committed files that are binary, such as caches and build products, unless they are of a kind that belongs here.
  test_binary.py     77: not a checkout of git"""
import fnmatch
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
WANTED = ["docs/*.png", "tests/fuzz/corpus/*"]
HEAD = 8000  # bytes, in which git looks for a zero as well


def unwanted(files):
    """Of (name, first bytes) the names of those that have a zero byte and no place in WANTED."""
    return [name for name, head in files if b"\0" in head and not any(fnmatch.fnmatch(name, kind) for kind in WANTED)]


def main():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    if listed.returncode != 0:
        return 77
    names = [name for name in listed.stdout.decode().split("\0") if name and (ROOT / name).is_file()]
    found = unwanted((name, (ROOT / name).open("rb").read(HEAD)) for name in names)
    if unwanted([("pocl-cache/a.so", b"\x7fELF\0"), ("docs/a.png", b"\0"), ("a.txt", b"a")]) != ["pocl-cache/a.so"]:
        found.append("a binary file that nobody sees")
    print(f"{len(names)} files; binary, and of no kind that belongs here: {', '.join(found) or 'none'}")
    return 1 if found or len(names) < 100 else 0


sys.exit(main())
