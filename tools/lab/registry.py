"""Registry of the built-in studies, and loader of a user's study."""
import importlib
import importlib.util
import pkgutil
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

REGISTRY = {}


@dataclass(frozen=True)
class Study:
    name: str
    run: Callable  # (laboratory, scenes) -> Page; scenes: those on the command line, or an empty list
    prose: str  # a line with the title, a paragraph with the question, a list with the method
    one_scene: bool = False  # the study takes only one scene of the command line
    missing: Callable = lambda: ""  # returns a message with a remedy if the study cannot run on this machine, else ""
    prepare: Callable = None  # (laboratory, scenes): requests the cost images of the study's ensembles; shards compute these; None: no shards
    measures: bool = False  # the study's results contain measured times


def study(name, *, prose=None, **options):
    """Decorator that declares a study; studies.txt must list its name. `prose` defaults to the docstring of its module."""
    def declare(run):
        text = prose or importlib.import_module(run.__module__).__doc__
        REGISTRY[name] = Study(name, run, text, **options)
        return run
    return declare


# Names of the studies in the order of the document.
ORDER = [line.partition(":")[0] for line in (Path(__file__).parent / "studies.txt").read_text().splitlines()]


def studies():
    """Returns {name: Study} of all built-in studies, in the order of studies.txt."""
    from raya.lab import studies as package

    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"{package.__name__}.{module.name}")
    return {name: REGISTRY[name] for name in sorted(REGISTRY, key=ORDER.index)}


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
    name = path.stem.replace("_", "-")
    return Study(name, module.run, module.__doc__, prepare=getattr(module, "prepare", None), measures=getattr(module, "MEASURES", False))
