"""A process that runs studies: a driver that crashes ends one of them, and the next has a new process."""
import os
import sys
import traceback
import warnings
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context

import raya
from raya.lab.laboratory import Laboratory
from raya.lab.page import Page
from raya.lab.study import studies, study_of_file

laboratory = None  # of this process: it keeps its device from one study to the next


def warn_as_raya(options):
    """From now on warnings are lines on stderr as the program writes them; none with -qq."""
    warnings.showwarning = lambda text, *_: options.verbosity > -2 and print(f"raya: warning: {text}", file=sys.stderr)


def run_study(study, scenes, folder, options):
    """(page, device)"""
    global laboratory
    warn_as_raya(options)
    one = study_of_file(study) if study.endswith(".py") else studies()[study]
    if laboratory is None:
        more = {"no_tuned": True} if options.no_tuned else {}
        laboratory = Laboratory(folder, options.size, options.network, device=options.device, **more)
    try:
        page = one.run(laboratory, scenes)
    except (raya.InputError, raya.DeviceError, OSError):
        raise
    except Exception as error:
        raise ValueError(f"study {one.name}: {place_of(error, one.run)}{type(error).__name__}: {error}") from error
    if not isinstance(page, Page):
        raise ValueError(f"study {one.name}: run() returns {type(page).__name__}, not a Page")
    return page.describe(one.name, one.prose), laboratory.session.device


def place_of(error, run):
    """'file.py, line N: ', the last one of the study's own that led to the error."""
    file = run.__code__.co_filename
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
    return f"{os.path.basename(file)}, line {lines[-1]}: " if lines else ""


class Worker:
    def __init__(self):
        self._pool = None

    def run(self, *arguments):
        if self._pool is None:
            self._pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
        try:
            return self._pool.submit(run_study, *arguments).result()
        except BrokenProcessPool:
            self._pool = None
            raise

    def close(self):
        if self._pool is not None:
            for process in list(getattr(self._pool, "_processes", {}).values()):
                process.kill()
            self._pool.shutdown(wait=False, cancel_futures=True)
