"""Runs studies and writes their results to a folder. `raya study` runs this module.

    python3 -m raya.lab NAME|all|FILE.py [SCENE.nff...] -o DIR     options as for `raya study`: see `raya study --help`

Writes for each study DIR/NAME.json, NAME.md, its tables (.csv), plots (.svg, .png) and pictures (.png); for all studies DIR/index.html and
manifest.json, and index.md if there are several. With --shard writes a part of the cost images (records.py). Exit codes: 0 done; 2 bad option, scene or
study; 3 no usable OpenCL device, or its driver crashed; 4 other results than those of the manifest, or a shard is missing. A signal ends the program
with that signal's status.
"""
import os
import signal
import sys

import raya
from raya.lab.options import settings_of

EXIT_USER, EXIT_DEVICE = 2, 3


def main(arguments):
    options = settings_of(arguments)
    from raya.lab.run import run  # after the options, because it imports packages that take seconds to load
    handle_signals(terminate)
    return run(options)


class Terminated(BaseException):
    """A signal that terminates the program."""


def terminate(number, frame):
    raise Terminated(number)


def end(number, frame=None):
    """Ends the process by the signal, so that its parent sees the signal in the exit status. While Python imports packages, an exception from a
    handler could get lost."""
    os.write(sys.stderr.fileno(), b"raya: interrupted\n")
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)


def handle_signals(handler):
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, handler)


if __name__ == "__main__":
    handle_signals(end)
    try:
        try:
            sys.exit(main(sys.argv[1:]))
        finally:
            sys.stdout.flush()  # at exit, an error would be a traceback
    except Terminated as signalled:
        end(signalled.args[0])
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python flushes stdout at exit
        print("raya: cannot write to stdout: Broken pipe", file=sys.stderr)
        sys.exit(EXIT_USER)
    except (ValueError, OSError) as error:
        print(f"raya: {error}", file=sys.stderr)
        sys.exit(EXIT_USER)
    except raya.DeviceError as error:
        print(f"raya: {error}", file=sys.stderr)
        sys.exit(EXIT_DEVICE)
