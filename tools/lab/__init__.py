"""The load laboratory: reproduces and extends the experiments of the papers, on the papers' or your scenes.

A study is one Python file: its docstring has the title, the question and the method, and its function `run(lab, scenes)` returns a Page.
Example: docs/my_study.py. The built-in studies are in tools/lab/studies; `raya study NAME` runs them.
"""
import sys
from importlib.util import find_spec

_MISSING = [name for name in ("numpy", "scipy", "pandas", "matplotlib", "jinja2", "tqdm") if find_spec(name) is None]
if _MISSING:
    _TEXT = (f"study needs the Python packages {', '.join(_MISSING)}, which {sys.executable} does not have; remedy: "
             f"sudo apt-get install {' '.join('python3-' + name for name in _MISSING)}, or set RAYA_PYTHON to another Python")
    if sys.argv[0] != "-m":
        raise ImportError(_TEXT)
    print(f"raya: {_TEXT}", file=sys.stderr)  # `python3 -m raya.lab` imports this file before __main__.py
    sys.exit(2)

from raya.lab import papers
from raya.lab.claims import Claim, Judgement, decide, judged
from raya.lab.laboratory import Costs, Ensemble, Laboratory, first_scene, mean_seconds, time_calls
from raya.lab.page import Comparison, Page, Picture, Plot, Series, Table, format_value, series_by, with_paper
from raya.lab.statistics import (COMPATIBLE, NOT_REPRODUCED, REPRODUCED, UNTESTABLE, Estimate, Test, above, below, bonferroni_confidence, counted,
                                 estimate, estimates, every, fitted_exponent, next_value_within, prediction_interval, prediction_text, proportion,
                                 range_text, tail_where, within)
from raya.lab.study import study
