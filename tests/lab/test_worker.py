"""A crash of the driver in a study is reported and ends only that study. The next study runs in a new process."""
from types import SimpleNamespace

import pytest
import raya
from raya.lab.worker import Worker

OPTIONS = SimpleNamespace(verbosity=0, no_tuned=True, size=32, views=None, seed=1, device=None, shard=None, merge=[], version="")
STUDY = '''"""Title

Question?

- method.
"""
from raya.lab import Page


def run(lab, scenes):
    {}
    return Page({{}}, ["Found."])
'''


def test_a_crash_ends_only_its_study(tmp_path):
    crash, valid, invalid = (tmp_path / f"{name}.py" for name in ("crash", "valid", "invalid"))
    crash.write_text(STUDY.format("__import__('os').kill(__import__('os').getpid(), 11)"))
    valid.write_text(STUDY.format("pass"))
    invalid.write_text(STUDY.format("return lab"))
    worker = Worker()
    try:
        with pytest.raises(raya.DeviceError, match="crashed"):
            worker.run(str(crash), [], str(tmp_path), OPTIONS)
        page = worker.run(str(valid), [], str(tmp_path), OPTIONS)
        assert page.title == "Title" and page.run["device"]
        with pytest.raises(ValueError, match=r"run\(\) returns Laboratory"):
            worker.run(str(invalid), [], str(tmp_path), OPTIONS)
    finally:
        worker.close()
