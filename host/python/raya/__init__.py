"""raya traces rays on models of distributed-memory array machines, written as OpenCL kernels.

    import raya
    scene = raya.load("scenes/centre.nff")
    result = raya.render(scene, machine="spa", offset=16, cost=True)
    result.imbalance, raya.imbalances(result.cost, pes=256, offsets=range(256))

The keyword arguments of render() are the long options of `raya render` with underscores instead of hyphens: pe_memory for
--pe-memory. A name that is a Python keyword has an underscore at its end: async_ for --async. Invalid input raises
ValueError and a failure of the device raises DeviceError, with the same messages as the command line.
"""
import contextlib
import os
import shutil
import sys
from pathlib import Path

from raya import _engine
from raya._engine import *  # noqa: F403
from raya._engine import __version__  # noqa: F401


def _unpickled(text, name):
    """Returns a pickled scene. pickle cannot name functions of the engine."""
    return _engine.parse(text, name)


@contextlib.contextmanager
def _callback(progress):
    """Context manager that yields the progress callback for the engine: if `progress` is True, a function that draws a
    progress bar; if it is False, None; else `progress` itself."""
    if progress is not True:
        yield progress or None
        return
    from tqdm import tqdm

    with tqdm(total=100, unit="%", leave=False) as bar:
        yield lambda fraction: bar.update(round(100 * fraction) - bar.n)


def render(scene, *, progress=False, session=None, **options):
    """Renders a scene and returns a Result.

    scene: a Scene, or the path of an NFF file. options: those of `raya render`; cost=True and packets=True store the
    arrays in the Result instead of writing files. progress: True draws a progress bar; a function is called with the completed
    fraction of the work, 0..1. session: a Session; by default, all renders on the same device use one session. Raises
    ValueError, DeviceError.
    """
    if not isinstance(scene, _engine.Scene):
        scene = _engine.load(scene)
    with _callback(progress) as callback:
        if session is not None:
            return session.render(scene, progress=callback, **options)
        return _engine.render(scene, progress=callback, **options)


def program():
    """Returns the path of the program `raya`: the value of the environment variable RAYA_PROGRAM if it is the path of a program, else
    the program of the build or installation that contains this package, else the program in PATH. Raises FileNotFoundError."""
    package = Path(__file__).absolute().parent
    candidates = [os.environ.get("RAYA_PROGRAM"), package / "raya", package / "../../raya", package / "../../../../bin/raya",
                  shutil.which("raya")]
    for path in candidates:
        if path and os.access(path, os.X_OK) and os.path.isfile(path):
            return os.path.realpath(path)
    raise FileNotFoundError("the program raya was not found next to its Python package; set RAYA_PROGRAM to its path")


def _run_program():
    """Replaces this process with the program `raya`. Entry point of the command `raya` that pip installs. Studies that this
    command starts use this Python interpreter."""
    os.environ.setdefault("RAYA_PYTHON", sys.executable)
    path = program()
    os.execv(path, [path, *sys.argv[1:]])
