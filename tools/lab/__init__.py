"""The load laboratory: the papers' experiments, and what goes beyond them, on your scenes.

A study is one file: its docstring says what is asked and how, `run(lab, scenes)` renders and returns a Page. See
docs/my_study.py for one of 30 lines, tools/lab/studies for all others.
"""
from raya.lab import papers
from raya.lab.laboratory import (Costs, Ensemble, Laboratory, balance_pass, measured, one_of, sampled, settings_of_pass,
                                 study_scenes)
from raya.lab.page import Claim, Comparison, Page, Picture, Plot, Series, Table, series_by, shown
from raya.lab.statistics import (NOT_REPRODUCED, REPRODUCED, UNDECIDED, Estimate, each_of, estimate, fitted_exponent,
                                 prediction, prediction_text, range_text, verdict, verdict_among)
from raya.lab.study import study
