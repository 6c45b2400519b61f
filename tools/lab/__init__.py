"""The load laboratory: repeats and extends the papers' experiments, on your scenes.

A study is one file. Its docstring has the title, the question and the method. Its function `run(lab, scenes)` renders the scenes and returns a Page.
Example: docs/my_study.py. The built-in studies are in tools/lab/studies.
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
from raya.lab.laboratory import Costs, Ensemble, Laboratory, balance_pass, measured, one_of, sampled
from raya.lab.page import Claim, Comparison, Page, Picture, Plot, Series, Table, series_by, shown, with_paper
from raya.lab.statistics import (NOT_REPRODUCED, REPRODUCED, UNDECIDED, Estimate, each_of, estimate, fitted_exponent,
                                 holding_to_the_end, prediction, prediction_text, range_text, verdict, verdict_among)
from raya.lab.study import study
