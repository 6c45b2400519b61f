"""Programs that studies start: raya itself on MPI ranks, and those that are built beside it."""
import json
import os
import shlex
import shutil
import subprocess
import tempfile

import raya

LAUNCHER = shlex.split(os.environ.get("RAYA_MPIRUN", "mpirun --bind-to none"))


def beside_raya(name):
    """The path of a program that was built with raya; None where it was not."""
    path = os.path.join(os.path.dirname(raya.program()), name)
    return path if os.access(path, os.X_OK) else None


def output_of(words, name, **how):
    """What a program prints. Where it fails, its last complaint is an InputError, one of raya's own before others."""
    run = subprocess.run(words, capture_output=True, text=True, **how)
    if run.returncode:
        said = [line for line in run.stderr.splitlines() if line.strip()]
        own = [line for line in said if line.startswith("raya: ")]
        raise raya.InputError(f"{name}: {(own or said or [f'exit code {run.returncode}'])[-1]}")
    return run.stdout


def lacks_mpirun():
    name = LAUNCHER[0] if LAUNCHER else "RAYA_MPIRUN"
    return "" if shutil.which(name) else (
        f"cannot start {name}; remedy: install openmpi-bin or mpich, of the MPI that raya was built with, or name "
        "another launcher in RAYA_MPIRUN")


def on_ranks(ranks, arguments):
    """What `raya` prints on so many ranks of one thread each."""
    settings = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    words = LAUNCHER + ["-n", str(ranks), "env", "POCL_MAX_PTHREAD_COUNT=1", raya.program(), *arguments]
    return output_of(words, f"{ranks} ranks", env={**os.environ, **settings})


def render_on_ranks(ranks, arguments):
    """The report of a render."""
    with tempfile.TemporaryDirectory(prefix="raya-ranks-") as folder:
        report = os.path.join(folder, "report.json")
        on_ranks(ranks, ["render", *arguments, "--quiet", "-o", os.path.join(folder, "image.pfm"), "--report", report])
        with open(report, encoding="utf-8") as file:
            return json.load(file)
