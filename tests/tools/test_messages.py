#!/usr/bin/env python3
"""Checks the texts of all errors and warnings of host/: no private words, and no full stop at the end.

  test_messages.py           prints the faults
  test_messages.py --list    prints every message with its file and line

Exit codes: 0 no fault; 1 a fault, or fewer than 200 messages were found.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CALLS = re.compile(r"\b(?:throw\s+)?(UserError|DeviceError|NffError|JsonError|CheckFailure|runtime_error|warn|add_warning|complain|refuse)\s*[({]")
# Private words; docs/glossary.md has the standard terms.
PRIVATE = re.compile(r"\b(told|tells|beside|standstill|stands still|in place of|of use|thrown away|put aside|held against|wants to|no longer goes)\b", re.I)


def literals(text, start):
    """Returns (string literals in the parentheses that open at `start`, " | " between separate arguments; end of the parentheses)."""
    depth, at, found = 0, start, []
    joins = False  # true: only white space since the last literal, which the compiler concatenates with the next one
    while at < len(text):
        character = text[at]
        if character == '"':
            end = at + 1
            while text[end] != '"':
                end += 2 if text[end] == "\\" else 1
            if found and not joins:
                found.append(" | ")
            found.append(text[at + 1:end])
            at, joins = end, True
        elif text.startswith("//", at):
            at = text.index("\n", at)
        elif character == "'":
            at = text.index("'", at + (3 if text[at + 1] == "\\" else 1))
            joins = False
        elif not character.isspace():
            joins = False
        if character in "({":
            depth += 1
        elif character in ")}":
            depth -= 1
            if depth == 0:
                break
        at += 1
    return "".join(found), at


def messages():
    for path in sorted((ROOT / "host").rglob("*.?pp")):
        text = path.read_text()
        for call in CALLS.finditer(text):
            message, _ = literals(text, call.end() - 1)
            if len(message.split()) > 2:
                yield f"{path.relative_to(ROOT)}:{text.count(chr(10), 0, call.start()) + 1}", message.replace("\\n", " / ").replace('\\"', '"')


def faults_of(message):
    if PRIVATE.search(message):
        yield f"contains '{PRIVATE.search(message)[0]}'"
    if message.endswith((".", "!")) and not message.endswith("..."):
        yield "ends with a full stop"


def main():
    all_messages = list(messages())
    if "--list" in sys.argv[1:]:
        print("\n".join(f"{where}: {message}" for where, message in all_messages))
        return 0
    faults = [f"{where}: {fault}: {message}" for where, message in all_messages for fault in faults_of(message)]
    if not list(faults_of("the queue is told to wait.")):
        faults.append("test_messages.py: finds no fault where there are two")
    print("\n".join(faults) or f"{len(all_messages)} messages: no fault")
    return 1 if faults or len(all_messages) < 200 else 0


if __name__ == "__main__":
    sys.exit(main())
