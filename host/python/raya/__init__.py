"""raya traces rays on models of distributed-memory array machines, written as OpenCL kernels.

    import raya
    scene = raya.load("scenes/centre.nff")
    result = raya.render(scene, machine="spa", offset=16, cost=True)
    result.imbalance, raya.imbalances(result.cost, pes=256, offsets=range(256))

Keyword arguments of render() are the long options of `raya render`, with underscores: --pe-memory is pe_memory,
--async async_. Bad input raises ValueError, devices DeviceError, with the command line's text.
"""
import contextlib
import os
import shutil
import sys
from pathlib import Path

from raya import _engine
from raya._engine import (
    PACKET_KINDS,
    STATUS_WORDS,
    Deadlock,
    DeviceError,
    DoesNotFit,
    InputError,
    Result,
    Scene,
    Session,
    __version__,
    compare_cycles,
    example,
    exchange_rotations,
    filter_cycles,
    generate,
    imbalances,
    job_words,
    largest_share,
    link_ends,
    load,
    loads,
    lower_bound,
    machines,
    offset_times,
    owners,
    parse,
    ranks_of_nodes,
    ranks_of_pes,
    reference,
    rotations,
    schedule,
    speedups,
    t805_ms,
)


@contextlib.contextmanager
def _shown(progress):
    """What the engine calls with the share done: `progress` itself, a bar for True, nothing for False."""
    if progress is not True:
        yield progress or None
        return
    from tqdm import tqdm

    with tqdm(total=100, unit="%", leave=False) as bar:
        yield lambda share: bar.update(round(100 * share) - bar.n)


def render(scene, *, progress=False, session=None, **options):
    """Renders a scene; returns a Result.

    scene: a Scene, or the path of an NFF file. Options: those of `raya render`; of them `cost` and `packets` may be
    True, which keeps the arrays and writes no file. progress: True draws a bar, a function is called with the share
    that is done, 0..1. session: a Session; default: one for each device, kept. Raises ValueError, DeviceError.
    """
    if not isinstance(scene, Scene):
        scene = load(scene)
    with _shown(progress) as callback:
        if session is not None:
            return session.render(scene, progress=callback, **options)
        return _engine.render(scene, progress=callback, **options)


def program():
    """The path of the program raya that lies with this package: of its build or its installation."""
    package = Path(__file__).absolute().parent
    candidates = [os.environ.get("RAYA_PROGRAM"), package / "raya", package / "../../raya", package / "../../../../bin/raya",
                  shutil.which("raya")]
    for path in candidates:
        if path and os.access(path, os.X_OK) and os.path.isfile(path):
            return os.path.realpath(path)
    raise FileNotFoundError("the program raya was not found next to its Python package; name it in RAYA_PROGRAM")


def _run_program():
    """The command `raya` of an installation by pip, whose studies run in this Python."""
    os.environ.setdefault("RAYA_PYTHON", sys.executable)
    path = program()
    os.execv(path, [path, *sys.argv[1:]])
