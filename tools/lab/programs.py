"""Runs programs for studies: raya on MPI ranks, and programs that raya's build makes."""
import json
import os
import shlex
import shutil
import subprocess
import tempfile

import raya

LAUNCHER = shlex.split(os.environ.get("RAYA_MPIRUN", "mpirun --bind-to none"))


def sibling_program(name):
    """Path of a program in raya's folder; None if it was not built."""
    path = os.path.join(os.path.dirname(raya.program()), name)
    return path if os.access(path, os.X_OK) else None


def output_of(words, name, **how):
    """Standard output of a program. If the program fails, raises InputError with the last line of stderr that starts with "raya: ", else with the
    last line. how: arguments of subprocess.run()."""
    run = subprocess.run(words, capture_output=True, text=True, **how)
    if run.returncode:
        lines = [line for line in run.stderr.splitlines() if line.strip()]
        own = [line for line in lines if line.startswith("raya: ")]
        raise raya.InputError(f"{name}: {(own or lines or [f'exit code {run.returncode}'])[-1]}")
    return run.stdout


def missing_mpirun():
    """Error message with a remedy if there is no MPI launcher; else an empty string."""
    name = LAUNCHER[0] if LAUNCHER else "RAYA_MPIRUN"
    return "" if shutil.which(name) else (
        f"cannot start {name}; remedy: install openmpi-bin or mpich, whichever MPI raya was built with, or set RAYA_MPIRUN to "
        "another launcher")


def on_ranks(ranks, arguments):
    """Standard output of `raya` on `ranks` MPI ranks of one thread each."""
    settings = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    words = LAUNCHER + ["-n", str(ranks), "env", "POCL_MAX_PTHREAD_COUNT=1", raya.program(), *arguments]
    return output_of(words, f"{ranks} ranks", env={**os.environ, **settings})


def render_on_ranks(ranks, arguments):
    """The report (raya render --report) of a render on `ranks` MPI ranks."""
    with tempfile.TemporaryDirectory(prefix="raya-ranks-") as folder:
        report = os.path.join(folder, "report.json")
        on_ranks(ranks, ["render", *arguments, "--quiet", "-o", os.path.join(folder, "image.pfm"), "--report", report])
        with open(report, encoding="utf-8") as file:
            return json.load(file)
