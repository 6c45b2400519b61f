"""Studies: how one is declared, found and run."""
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
    run: Callable  # (laboratory, scenes) -> Page; `scenes` are those that the user named, or none
    prose: str  # title, question, method: a line, a paragraph, a list
    one_scene: bool = False
    lacks: Callable = lambda: ""  # what it needs and this machine does not have, with the remedy


def study(name, *, prose=None, **more):
    """Declares a study, of which studies.txt has a line; its prose is the docstring of its module unless given."""
    def declare(run):
        text = prose or importlib.import_module(run.__module__).__doc__
        REGISTRY[name] = Study(name, run, text, **more)
        return run
    return declare


# Their names, in the order in which they tell the story.
ORDER = [line.partition(":")[0] for line in (Path(__file__).parent / "studies.txt").read_text().splitlines()]


def studies():
    """All studies of the laboratory, by name."""
    from raya.lab import studies as package

    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"{package.__name__}.{module.name}")
    return {name: REGISTRY[name] for name in sorted(REGISTRY, key=ORDER.index)}


def study_of_file(path):
    """A user's study: a Python file with a docstring and a function run(lab, scenes) -> Page."""
    path = Path(path)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise ValueError(f"{path}: {type(error).__name__}: {error}") from error
    if not callable(getattr(module, "run", None)) or not module.__doc__:
        raise ValueError(f"{path}: is not a study: it needs a docstring (title, question, method) and run(lab, scenes)")
    name = path.stem.replace("_", "-")
    return Study(name, module.run, module.__doc__)
