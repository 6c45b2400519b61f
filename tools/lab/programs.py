"""Runs programs for studies: raya on MPI ranks, and programs that the build puts next to raya."""
import json
import os
import shlex
import shutil
import subprocess
import tempfile

import raya

LAUNCHER = shlex.split(os.environ.get("RAYA_MPIRUN", "mpirun --bind-to none"))


def sibling_program(name):
    """Returns the path of a program next to raya; None if it was not built."""
    path = os.path.join(os.path.dirname(raya.program()), name)
    return path if os.access(path, os.X_OK) else None


def output_of(command, name, **options):
    """Returns the standard output of a command. If the command fails, raises InputError with `name` and the last line of stderr that starts with
    "raya: ", or the last line if none does. options: arguments of subprocess.run()."""
    run = subprocess.run(command, capture_output=True, text=True, **options)
    if run.returncode:
        lines = [line for line in run.stderr.splitlines() if line.strip()]
        raya_lines = [line for line in lines if line.startswith("raya: ")]
        raise raya.InputError(f"{name}: {(raya_lines or lines or [f'exit code {run.returncode}'])[-1]}")
    return run.stdout


def missing_mpirun():
    """Returns an error message with a remedy if there is no MPI launcher; else an empty string."""
    name = LAUNCHER[0] if LAUNCHER else "RAYA_MPIRUN"
    return "" if shutil.which(name) else (
        f"cannot start {name}; remedy: install openmpi-bin or mpich, whichever MPI raya was built with, or set RAYA_MPIRUN to "
        "another launcher")


def run_on_ranks(ranks, arguments):
    """Runs raya with these arguments on `ranks` MPI ranks with one thread each. Returns its standard output."""
    settings = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",  # Open MPI 4
                "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe", "PRTE_MCA_mapby": ":oversubscribe"}  # 5; 6
    command = LAUNCHER + ["-n", str(ranks), "env", "POCL_MAX_PTHREAD_COUNT=1", raya.program(), *arguments]
    return output_of(command, f"{ranks} ranks", env={**os.environ, **settings})


def render_on_ranks(ranks, arguments):
    """Runs raya render with these arguments on `ranks` MPI ranks. Returns its report."""
    with tempfile.TemporaryDirectory(prefix="raya-ranks-") as folder:
        report = os.path.join(folder, "report.json")
        run_on_ranks(ranks, ["render", *arguments, "--quiet", "-o", os.path.join(folder, "image.pfm"), "--report", report])
        with open(report, encoding="utf-8") as file:
            return json.load(file)
