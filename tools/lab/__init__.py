"""The load laboratory: reproduces and extends the experiments of the papers, on the papers' or your scenes.

A study is one Python file: its docstring has the title, the question and the method, and its function `run(lab, scenes)` returns a Page.
Example: docs/my_study.py. The built-in studies are in tools/lab/studies; `raya study NAME` runs them.
"""
import sys
from importlib import import_module
from importlib.util import find_spec

_MISSING = [name for name in ("numpy", "scipy", "pandas", "matplotlib", "jinja2", "tqdm") if find_spec(name) is None]
if _MISSING:
    _TEXT = (f"study needs the Python packages {', '.join(_MISSING)}, which {sys.executable} does not have; remedy: "
             f"sudo apt-get install {' '.join('python3-' + name for name in _MISSING)}, or set RAYA_PYTHON to another Python")
    if sys.argv[0] != "-m":
        raise ImportError(_TEXT)
    print(f"raya: {_TEXT}", file=sys.stderr)  # `python3 -m raya.lab` imports this file before __main__.py
    sys.exit(2)

# Modules are imported when one of their names is used, because pandas, scipy and matplotlib take seconds to load: help and errors come at once.
_NAMES = {"papers": "",
          "claims": "CONTROLS Claim Judgement controlled decide judged",
          "laboratory": "Costs Ensemble Laboratory first_scene mean_seconds time_calls",
          "page": "Comparison Page Picture Plot Series Table format_value series_by with_paper",
          "statistics": "COMPATIBLE NOT_REPRODUCED REPRODUCED Estimate Test above below bonferroni_confidence counted estimate estimates every first_from "
                        "fitted_exponent lowest next_value_within prediction_interval proportion quantile_above range_text under within",
          "worker": "study"}
_MODULES = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = ["papers", *_MODULES]


def __getattr__(name):
    if name not in _MODULES:
        raise AttributeError(f"module {__name__} has no attribute {name}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
