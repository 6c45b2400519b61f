"""The studies, and the child process that runs them, so that a crash of the OpenCL driver ends only one study."""
import importlib
import importlib.util
import os
import pkgutil
import signal
import sys
import traceback
import warnings
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Callable

import raya
from raya.lab.laboratory import Laboratory
from raya.lab.options import STUDIES
from raya.lab.page import Page
from raya.lab.store import Store

REGISTRY = {}


@dataclass(frozen=True)
class Study:
    name: str
    run: Callable  # (laboratory, scenes) -> Page; scenes: those on the command line, or an empty list
    prose: str  # a line with the title, a paragraph with the question, a list with the method
    one_scene: bool = False  # the study takes only one scene of the command line
    prepare: Callable = None  # (laboratory, scenes): requests the cost images of the study's ensembles; shards compute these; None: no shards
    measures: bool = False  # the study's results contain measured times
    file: str = ""  # of a user's study

    source = property(lambda self: self.file or self.name)  # as on the command line


def study(name, *, prose=None, **options):
    """Decorator that declares a study; studies.txt must list its name. `prose` defaults to the docstring of its module."""
    def declare(run):
        REGISTRY[name] = Study(name, run, prose or sys.modules[run.__module__].__doc__, **options)
        return run
    return declare


def studies():
    """Returns {name: Study} of all built-in studies, in the order of studies.txt."""
    from raya.lab import studies as package

    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"{package.__name__}.{module.name}")
    return {name: REGISTRY[name] for name in STUDIES}


def study_of_file(path):
    """Loads a user's study: a Python file with a docstring and a function run(lab, scenes) -> Page. Raises ValueError if the file fails or is not a
    study."""
    path = Path(path)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise ValueError(f"{path}: {type(error).__name__}: {error}") from error
    if not callable(getattr(module, "run", None)) or not module.__doc__:
        raise ValueError(f"{path}: not a study: it needs a docstring (title, question, method) and run(lab, scenes)")
    return Study(path.stem.replace("_", "-"), module.run, module.__doc__, prepare=getattr(module, "prepare", None),
                 measures=getattr(module, "MEASURES", False), file=str(path))


laboratory = None  # the Laboratory of this process; all studies use its device session


def warn_as_raya(options):
    """Makes Python print warnings to stderr in raya's format; with -qq, no warnings."""
    warnings.showwarning = lambda text, *_: options.verbosity > -2 and print(f"raya: warning: {text}", file=sys.stderr)


def run_study(study, scenes, folder, options):
    """Runs one study with a store in `folder`. Returns its page; in a shard, (names of the shard's results so far, number of them that were
    computed now). Raises ValueError for an error in the study's code."""
    global laboratory
    warn_as_raya(options)
    chosen_study = study_of_file(study) if study.endswith(".py") else studies()[study]
    if laboratory is None:
        tuning_options = {"no_tuned": True} if options.no_tuned else {}
        store = Store(folder, options.merge, options.version, options.shard)
        laboratory = Laboratory(store, options.size, options.views, options.seed, device=options.device, **tuning_options)
    laboratory.devices.clear()
    try:
        if options.shard:
            chosen_study.prepare(laboratory, scenes)
            return laboratory.store.names, laboratory.store.computed
        page = chosen_study.run(laboratory, scenes)
    except (raya.InputError, raya.DeviceError, OSError):
        raise
    except (Exception, SystemExit) as error:
        raise ValueError(f"study {chosen_study.name}: {error_location(error, chosen_study.run)}{type(error).__name__}: {error}") from error
    if not isinstance(page, Page):
        raise ValueError(f"study {chosen_study.name}: run() returns {type(page).__name__}, not a Page")
    page.run = {"device": "; ".join(sorted(laboratory.devices)) or laboratory.device}
    return page.describe(chosen_study.name, chosen_study.prose)


def error_location(error, run):
    """Returns 'FILE.py, line N: ' for the study's innermost frame in the error's traceback; empty if there is none."""
    file = run.__code__.co_filename
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
    return f"{os.path.basename(file)}, line {lines[-1]}: " if lines else ""


def serve(pipe):
    """Main loop of the child: receives arguments of run_study() from the pipe, sends (result, error), and ends when the pipe is closed."""
    for number in (signal.SIGINT, signal.SIGQUIT):  # a terminal sends these signals to both processes; the parent ends this one
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
    """A child process that runs studies. A concurrent.futures pool would leak semaphores on a signal, and Python would warn of them."""

    def __init__(self):
        self._process = None

    def run(self, *arguments):
        """Runs run_study(*arguments) in the child and returns its result. Raises its error, or DeviceError if the child crashes."""
        if self._process is None:
            context = get_context("spawn")
            self._pipe, child_pipe = context.Pipe()
            self._process = context.Process(target=serve, args=(child_pipe,), daemon=True)
            handler = signal.signal(signal.SIGINT, signal.SIG_IGN)  # inherited: Ctrl-C while the child starts is for the parent
            self._process.start()
            signal.signal(signal.SIGINT, handler)
            child_pipe.close()
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
