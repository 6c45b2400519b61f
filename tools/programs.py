"""Starts programs for the tools in this folder: without input, with a time limit, and so that no process stays behind."""
import contextlib, os, signal, subprocess
from typing import NamedTuple


class Done(NamedTuple):
    """code: the exit code, -N after signal N, None after the time limit; out, err: what the program printed."""
    code: int | None
    out: str
    err: str

    @property
    def text(self):
        return self.out + self.err


@contextlib.contextmanager
def started(command, **options):
    """Starts a program, with options of subprocess.Popen. At the end of the block, the program and all processes that it has started are killed."""
    process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True, errors="replace",
                               start_new_session=True, **options)
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def run(command, limit=None, **options):
    """Runs a program for at most `limit` seconds. Returns Done."""
    with started(command, stderr=subprocess.PIPE, **options) as process:
        try:
            out, err = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return Done(None, *process.communicate())
        return Done(process.returncode, out, err)
