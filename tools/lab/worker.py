"""A process that runs studies: a driver that crashes ends one of them, and the next has a new process."""
import os
import signal
import sys
import traceback
import warnings
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


def answer(pipe):
    """Runs what the pipe brings until nobody is at its other end, and sends back (result, error)."""
    for number in (signal.SIGINT, signal.SIGQUIT):  # of a terminal, which goes to every process: the first one ends this one
        signal.signal(number, signal.SIG_IGN)
    while True:
        try:
            arguments = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send((run_study(*arguments), None))
        except Exception as error:
            pipe.send((None, error))


class Worker:
    """Not an executor of concurrent.futures: a signal leaves that one's semaphores behind, and Python warns of them."""

    def __init__(self):
        self._process = None

    def run(self, *arguments):
        """(page, device) of run_study(). DeviceError when the process dies of it."""
        if self._process is None:
            context = get_context("spawn")
            self._pipe, theirs = context.Pipe()
            self._process = context.Process(target=answer, args=(theirs,), daemon=True)
            self._process.start()
            theirs.close()
        try:
            self._pipe.send(arguments)
            result, error = self._pipe.recv()
        except (EOFError, ConnectionError):
            self.close()
            raise raya.DeviceError("the OpenCL driver crashed") from None
        if error:
            raise error
        return result

    def close(self):
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None
