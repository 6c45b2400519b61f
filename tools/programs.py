"""What the tools in this folder share: starting programs without input, with a time limit, and so that no process stays behind; tables; whole files."""
from __future__ import annotations  # Python 3.8, on computers with a GPU
import contextlib, os, signal, subprocess
from pathlib import Path
from typing import NamedTuple

RUNNING = set()  # of started()


class Done(NamedTuple):
    """code: the exit code, -N after signal N, None after the time limit; out, err: what the program printed."""
    code: int | None
    out: str
    err: str | None

    @property
    def text(self):
        return self.out + (self.err or "")


@contextlib.contextmanager
def started(command, **options):
    """Starts a program, with options of subprocess.Popen. At the end of the block, the program and all processes that it has started are killed."""
    process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True, errors="replace",
                               start_new_session=True, **options)
    RUNNING.add(process)
    try:
        yield process
    finally:
        kill(process)
        process.wait()
        RUNNING.discard(process)


def kill(process):
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def run(command, limit=None, stderr=subprocess.PIPE, **options):
    """Runs a program for at most `limit` seconds. Returns Done."""
    with started(command, stderr=stderr, **options) as process:
        try:
            out, err = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            kill(process)
            return Done(None, *process.communicate())
        return Done(process.returncode, out, err)


def llvm():
    """Returns the version of this system's LLVM: "15" (tools/setup)."""
    return run([Path(__file__).with_name("setup"), "--llvm"]).out.strip()


def aligned(rows, left=0):
    """Returns a text table; the columns from number `left` on are aligned on the left, the others on the right."""
    formats = [f"{'<' if i >= left else '>'}{max(map(len, column))}" for i, column in enumerate(zip(*rows))]
    return "".join("  ".join(map(format, row, formats)).rstrip() + "\n" for row in rows)


def markdown(head, rows):
    """Returns a table in Markdown; cells are texts."""
    return "".join(f"| {' | '.join(row)} |\n" for row in [head, ["---"] * len(head), *rows])


def write_whole(path, text):
    """Writes a file that is complete or unchanged."""
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.replace(path)
