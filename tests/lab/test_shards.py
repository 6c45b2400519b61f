"""`raya study --shard`, --merge, --missing and --check: merged results equal those of one process, byte for byte, and every loss and damage of a shard
is found and repaired by the same command."""
import filecmp
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

raya = pytest.importorskip("raya", reason="the module is not built; configure with -DRAYA_PYTHON=ON")
from raya.lab import __main__ as program, records, store, worker  # noqa: E402
from raya.lab.store import Store  # noqa: E402

STUDY = '''"""Squares

What are the squares of the seeds {first}..{last}?

- Method.
"""
import os
from pathlib import Path

import numpy as np
from raya.lab import Page, Table

LOG = Path(__file__).with_suffix(".log")  # a line for each computed square


def square(number):
    with LOG.open("a") as log:
        log.write(f"{number}\\n")
    if os.environ.get("KILLED_AT") == str(number):
        os.kill(os.getpid(), 9)
    return {"square": np.array([number**2], np.uint64)}


def squares(lab):
    return [lab.stored(("square", number), lambda: square(number)) for number in range(lab.seed, lab.seed + 8)]


def prepare(lab, scenes):
    squares(lab)


def run(lab, scenes):
    rows = [{"number": i, "square": int(one["square"][0])} for i, one in enumerate(squares(lab), lab.seed)]
    return Page({"first": rows[0]["number"], "last": rows[-1]["number"]}, [f"The first is {rows[0]['square']}."], tables=[Table("squares", "Squares", rows)])
'''
MEASURED = STUDY.replace("def square(", "MEASURES = True\n\n\ndef square(").replace('int(one["square"][0])', "os.getpid() + __import__('time').time_ns()")


class SameProcess:
    """Runs studies in this process, because the start of a child takes a second."""

    run = staticmethod(worker.run_study)

    def close(self):
        worker.laboratory = None


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.setattr("raya.lab.run.Worker", SameProcess)
    monkeypatch.setattr(worker, "laboratory", None)
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "squares.py"
    file.write_text(STUDY)
    return file.name


def run(*arguments):
    return program.main([*map(str, arguments), "-q"])


def shard(study, number, count=3, *options):
    return run(study, "--shard", f"{number}/{count}", "-o", f"s{number}", *options)


def equal_folders(one, other):
    files = sorted(os.listdir(one))
    return files == sorted(os.listdir(other)) and filecmp.cmpfiles(one, other, files, shallow=False)[0] == files


def computed():
    """Returns the number of squares computed since the last call."""
    log = Path("squares.log")
    lines = log.read_text().split() if log.exists() else []
    log.unlink(missing_ok=True)
    return len(lines)


def results(number):
    return sorted(Path(f"s{number}").glob("*.result"))


VALUE = {"large": np.array([[2**64 - 1, 0], [1, 2**63]], np.uint64), "floats": np.array([np.nan, -0.0, np.inf, 5e-324]), "count": 2**53, "text": "e",
         "third": 1 / 3}


def test_stored_results_are_exact(tmp_path):
    for _ in range(2):  # computed, then read
        value = Store(tmp_path).get("request", lambda: VALUE)
        assert list(value) == list(VALUE)
        for name, member in VALUE.items():
            assert type(value[name]) is type(member) and np.asarray(value[name]).tobytes() == np.asarray(member).tobytes(), name
    assert store.bytes_of("n", value) == store.bytes_of("n", VALUE) != store.bytes_of("m", VALUE)


def test_each_damage_of_a_result_is_detected(tmp_path):
    Store(tmp_path).get("request", lambda: VALUE)
    file, = tmp_path.iterdir()
    data = file.read_bytes()
    damages = [data[:size] for size in range(0, len(data), 7)] + [data + b"x"]
    damages += [data[:i] + bytes([data[i] ^ 1]) + data[i + 1:] for i in range(0, len(data), 5)]
    for damage in damages:
        file.write_bytes(damage)
        assert store.read_value(file) is None
    assert Store(tmp_path).get("request", lambda: VALUE)["count"] == VALUE["count"] and file.read_bytes() == data


def test_a_failed_write_leaves_no_file(tmp_path, monkeypatch):
    def fail(*_):
        raise OSError("injected")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="injected"):
        Store(tmp_path).get("request", lambda: VALUE)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("count", [1, 3, 8, 9])
def test_merged_results_are_those_of_one_process(study, count):
    assert run(study, "-o", "out") == 0 and computed() == 8
    for number in range(1, count + 1):
        shard(study, number, count)
    assert computed() == 8  # each result in one shard
    folders = [f"s{number}" for number in range(count, 0, -1)]
    assert run("--missing", *folders) == 0
    assert run(study, "--merge", *folders, "-o", "merged") == 0 and computed() == 0
    assert equal_folders("out", "merged") and {"manifest.json", "squares.csv", "index.html"} <= set(os.listdir("out"))


def truncate(file):
    os.truncate(file, file.stat().st_size // 2)


def flip(file):
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 16
    file.write_bytes(data)


def forge(file, header):
    """Writes a result with a valid digest."""
    body = json.dumps(header).encode()
    body = len(body).to_bytes(8, "little") + body + bytes(64)
    file.write_bytes(hashlib.sha256(file.name.encode() + body).digest() + body)


DAMAGES = {
    "no folder": (lambda: shutil.rmtree("s2"), "absent", 3),
    "no shard.json": (lambda: Path("s2/shard.json").unlink(), "absent", 0),
    "truncated shard.json": (lambda: truncate(Path("s2/shard.json")), "absent", 0),
    "damaged shard.json": (lambda: flip(Path("s2/shard.json")), "absent", 0),
    "lost result": (lambda: results(2)[0].unlink(), "damaged: s2/", 1),
    "truncated result": (lambda: truncate(results(2)[1]), "damaged: s2/", 1),
    "empty result": (lambda: results(2)[1].write_bytes(b""), "damaged: s2/", 1),
    "damaged results": (lambda: [flip(file) for file in results(2)], "damaged: s2/", 3),
    "exchanged result": (lambda: results(2)[0].write_bytes(results(2)[1].read_bytes()), "damaged: s2/", 1),
    "huge result": (lambda: forge(results(2)[0], {"square": {"type": "<u8", "shape": [10**12]}}), "damaged: s2/", 1)}


@pytest.mark.parametrize("name", DAMAGES)
def test_a_damaged_shard_is_found_and_repaired(study, capsys, name):
    damage, problem, repairs = DAMAGES[name]
    run(study, "-o", "out")
    for number in (1, 2, 3):
        shard(study, number)
    damage()
    computed()
    assert run("--missing", "s1", "s2", "s3") == 4
    assert capsys.readouterr().out.startswith(f"2/3 {problem}")
    with pytest.raises(ValueError, match=f"shard 2/3 is {problem}"):
        run(study, "--merge", "s1", "s2", "s3", "-o", "merged")
    assert not Path("merged").exists() and computed() == 0
    shard(study, 2)
    assert computed() == repairs and run("--missing", "s1", "s2", "s3") == 0
    assert run(study, "--merge", "s1", "s2", "s3", "-o", "merged") == 0 and equal_folders("out", "merged")


@pytest.mark.parametrize("ending", [signal.SIGKILL, "driver"])
def test_a_killed_shard_continues(study, capsys, ending):
    """The kernel ends the whole program (SIGKILL), or the driver crashes in the child process."""
    path = os.pathsep.join([str(Path(raya.__file__).absolute().parents[1]), os.environ.get("PYTHONPATH", "")])
    code = "import raya.lab.__main__ as m, sys; m.main(sys.argv[1:])" if ending == "driver" else (
        "import raya.lab.__main__ as m, raya.lab.run as r, raya.lab.worker as w, sys\n"
        "r.Worker = type('W', (), {'run': staticmethod(w.run_study), 'close': lambda self: None})\nm.main(sys.argv[1:])")
    Path("run.py").write_text(f"if __name__ == '__main__':\n    {code.replace(chr(10), chr(10) + '    ')}\n")
    command = [sys.executable, "run.py", study, "--shard", "1/1", "-o", "s1"]
    stopped = subprocess.run(command, env={**os.environ, "PYTHONPATH": path, "KILLED_AT": "5"}, capture_output=True, text=True, timeout=120)
    assert stopped.returncode == (1 if ending == "driver" else -ending), stopped.stderr
    assert len(results(1)) == 4 and computed() == 5
    assert run("--missing", "s1") == 4 and capsys.readouterr().out == "1/1 incomplete: s1\n"
    shard(study, 1, 1)
    assert computed() == 4 and run("--missing", "s1") == 0  # the four finished results were not computed again


def test_shards_of_different_runs_are_refused(study):
    shard(study, 1)
    with pytest.raises(ValueError, match="-o s1: contains shard 1/3 of study squares.py; its settings"):
        shard(study, 1, 3, "--seed", "2")
    with pytest.raises(ValueError, match="its shards"):
        shard(study, 1, 2)
    with pytest.raises(ValueError, match="its shard "):
        run(study, "--shard", "2/3", "-o", "s1")
    shard(study, 2, 3, "--seed", "2")
    with pytest.raises(ValueError, match="s2 and s1: are shards of different runs: they differ in settings"):
        run("--missing", "s1", "s2")
    shutil.copytree("s1", "s1-copy")
    with pytest.raises(ValueError, match="s1-copy and s1: both contain shard 1/3"):
        run("--missing", "s1", "s1-copy")
    with pytest.raises(ValueError, match="none: contains no shard"):
        run(study, "--merge", "none", "-o", "merged")
    with pytest.raises(ValueError, match="study table2: has no ensembles to divide"):
        run("table2", "--shard", "1/2", "-o", "t")
    assert not Path("t").exists()


def test_merge_refuses_another_program_study_or_scene(study, monkeypatch):
    shutil.copy(Path(__file__).parents[2] / "scenes/glass.nff", "a.nff")
    shard(study, 1, 1, "a.nff")
    with pytest.raises(ValueError, match="s1: it is of study squares.py, not of fig7"):
        run("fig7", "--merge", "s1", "-o", "merged")
    with monkeypatch.context() as patch:
        patch.setattr(records, "program_version", lambda: "raya 9.9.9")
        with pytest.raises(ValueError, match="this is raya 9.9.9; remedy: merge with that version"):
            run(study, "a.nff", "--merge", "s1", "-o", "merged")
    Path("a.nff").rename("b.nff")
    with pytest.raises(ValueError, match="a.nff: .*remedy: name the study and its scenes"):
        run(study, "--merge", "s1", "-o", "merged")
    assert run(study, "b.nff", "--merge", "s1", "-o", "merged") == 0
    shutil.copy(Path(__file__).parents[2] / "scenes/mirrors.nff", "a.nff")
    with pytest.raises(ValueError, match="a.nff: differs from the file a.nff of s1"):
        run(study, "a.nff", "--merge", "s1", "-o", "merged2")
    Path(study).write_text("open('ran', 'w')\n")  # the hash of the study is compared before the study runs
    with pytest.raises(ValueError, match="squares.py: differs from the file squares.py of s1"):
        run(study, "b.nff", "--merge", "s1", "-o", "merged2")
    assert not Path("merged2").exists() and not Path("ran").exists()


def change_header(**members):
    """Changes members of s2/shard.json, with a new digest, as somebody could who passes on a shard."""
    file = Path("s2/shard.json")
    records.write_header(file.parent, {**json.loads(file.read_text()), **members})


FOREIGN = [
    {"command": {"study": "evil.py", "scenes": [], "device": "", "no_tuned": False}}, {"study": "evil.py"}, {"output": "stolen"},
    {"settings": {"size": 64, "views": 20, "seed": 1, "strict": False, "output": "stolen"}}, {"settings": []}, {"shards": 10**12},
    {"shard": 0}, {"shard": "2"}, {"study": ["x"]}, {"version": 7}, {"inputs": [7]}, {"inputs": [{"name": "x"}]}, {"inputs": "x"}, {"results": ["../x"]},
    {"results": ["/etc/passwd"]}, {"results": [7]}, {"results": {"x": 1}}, {"results": ["0" * 64 + ".result"]},
    {"settings": {"size": None, "views": None, "seed": "1 --output=stolen", "strict": False}},
    {"settings": {"size": [1], "views": None, "seed": 1, "strict": False}}]


@pytest.mark.parametrize("members", FOREIGN, ids=str)
def test_a_foreign_shard_is_data(study, members):
    for number in (1, 2, 3):
        shard(study, number)
    Path("evil.py").write_text("open('ran', 'w')\n" + STUDY)
    computed()
    change_header(**members)
    if "settings" in members or "study" in members:  # otherwise the shards would be of different runs
        for other in ("s1", "s3"):
            header = json.loads(Path(other, "shard.json").read_text())
            records.write_header(Path(other), {**header, **{name: members[name] for name in members if name in ("settings", "study")}})
    before = sorted(os.listdir())
    with pytest.raises(ValueError) as error:
        run(study, "--merge", "s1", "s2", "s3", "-o", "merged")
    assert "\n" not in str(error.value) and len(str(error.value)) < 3000
    assert sorted(os.listdir()) == before and computed() == 0


def test_manifest_is_complete_and_has_no_path_or_time(study):
    run(study, "-o", "one")
    Path("deeper").mkdir()
    run(Path(study).absolute(), "-o", "deeper/two")
    manifest = Path("one/manifest.json").read_bytes()
    assert json.loads(manifest)["inputs"][0]["name"] == "squares.py" and str(Path.cwd()) not in manifest.decode()
    assert [one["name"] for one in json.loads(manifest)["outputs"]] == sorted(set(os.listdir("one")) - {"manifest.json"})
    assert all(one["sha256"] for one in json.loads(manifest)["outputs"])
    command_lines = [json.loads(Path(folder, "squares.json").read_text())["run"]["command"] for folder in ("one", "deeper/two")]
    assert command_lines[0] != command_lines[1]  # so that Markdown and HTML differ, and no other file
    drop = {"squares.md", "index.html"}
    outputs = [[one for one in json.loads(Path(folder, "manifest.json").read_text())["outputs"] if one["name"] not in drop] for folder in ("one", "deeper/two")]
    assert outputs[0] == outputs[1]


def test_a_failed_run_leaves_no_old_manifest(study):
    run(study, "-o", "out")
    Path(study).write_text(STUDY.replace("return Page(", "return (").replace("tables=", ""))
    with pytest.raises(ValueError):
        run(study, "-o", "out")
    assert not Path("out/manifest.json").exists() and Path("out/squares.csv").exists()


def test_check_accepts_the_same_results(study, capsys):
    run(study, "-o", "out", "--seed", "3")
    assert run("--check", "out/manifest.json") == 0
    assert capsys.readouterr().out == "out/manifest.json: the same results: of the data files, 2 equal, 0 different\n"
    assert run("--check", "out/manifest.json", "-o", "again") == 0 and equal_folders("out", "again")


def change(**members):
    manifest = json.loads(Path("out/manifest.json").read_text())
    Path("out/manifest.json").write_text(json.dumps({**manifest, **members}))


def test_check_names_what_differs(study, capsys):
    run(study, "-o", "out")
    recorded = json.loads(Path("out/manifest.json").read_text())
    change(devices=["another device"])
    assert run("--check", "out/manifest.json") == 0  # another machine, the same results
    assert capsys.readouterr().out.startswith("devices: ")
    outputs = [{**one, "sha256": "0"} if one["name"] == "squares.csv" else one for one in recorded["outputs"][:-1]]
    change(**{**recorded, "outputs": [*outputs, {"name": "lost.csv", "sha256": "0"}]})
    assert run("--check", "out/manifest.json") == 4
    assert capsys.readouterr().out.splitlines() == ["lost.csv: absent", "squares.csv: differs", "squares.md: not in the manifest",
                                                   "out/manifest.json: other results: of the data files, 1 equal, 2 different"]


def test_check_refuses_damaged_manifests_and_other_inputs(study):
    run(study, "-o", "out")
    file, whole = Path("out/manifest.json"), Path("out/manifest.json").read_text()
    for size in range(0, len(whole) - 2, 97):
        file.write_text(whole[:size])
        with pytest.raises(ValueError, match="out/manifest.json: is not a manifest of raya study: .*; remedy: raya study NAME -o DIR"):
            run("--check", file)
    for member in json.loads(whole):
        file.write_text(json.dumps({name: value for name, value in json.loads(whole).items() if name != member}))
        with pytest.raises(ValueError, match=f"it has no member '{member}'"):
            run("--check", file)
        file.write_text(json.dumps({**json.loads(whole), member: 7}))
        with pytest.raises(ValueError, match="out/manifest.json: is not a manifest"):
            run("--check", file)
    file.write_text(whole.replace('"seed": 1', '"seed": 0'))
    with pytest.raises(ValueError, match="out/manifest.json: study: --seed 0: must be 1..90000"):
        run("--check", file)
    file.write_text(whole)
    with pytest.raises(ValueError, match="out/manifest.json: it is of study squares.py, not of fig7"):
        run("fig7", "--check", file)
    Path(study).write_text(STUDY + "# another\n")
    with pytest.raises(ValueError, match="squares.py: differs from the file squares.py of out/manifest.json"):
        run("--check", file)


def test_measured_times_are_not_compared(study, capsys):
    Path(study).write_text(MEASURED)
    run(study, "-o", "out")
    assert not any(one["sha256"] for one in json.loads(Path("out/manifest.json").read_text())["outputs"])
    assert run("--check", "out/manifest.json") == 0
    assert capsys.readouterr().out == "out/manifest.json: the same results: of the data files, 0 equal, 0 different, 2 with measured times not compared\n"


def test_a_study_that_exits_and_names_with_paths_are_errors(study):
    Path(study).write_text(STUDY.replace('def prepare(', 'raise SystemExit(3)\n\n\ndef prepare('))
    with pytest.raises(ValueError, match="squares.py: SystemExit: 3"):
        run(study, "-o", "out")
    Path(study).write_text(STUDY.replace("    rows = ", "    raise SystemExit(3)\n    rows = "))
    with pytest.raises(ValueError, match="study squares: squares.py, line .*: SystemExit: 3"):
        run(study, "-o", "out")
    for name in ("../x", "/tmp/x", ".x", "a/b", ""):
        Path(study).write_text(STUDY.replace('Table("squares"', f'Table("{name}"'))
        with pytest.raises(ValueError, match="use letters, digits"):
            run(study, "-o", "out")
    assert not Path("x.csv").exists()


def test_names_of_scenes_are_neither_html_nor_formulas(study):
    Path(study).write_text(STUDY.replace('"number": i', '"number": "=1+1<b>"'))
    run(study, "-o", "out")
    assert "'=1+1<b>" in Path("out/squares.csv").read_text() and "\n=1" not in Path("out/squares.csv").read_text()
    assert "&lt;b>" in Path("out/squares.md").read_text() and "<b>" not in Path("out/squares.md").read_text()


def test_ctrl_c_while_a_study_starts_prints_no_traceback(study):
    for delay in (0.05, 0.3, 0.8, 1.5):
        process = subprocess.Popen([raya.program(), "study", study, "-o", "out"], stderr=subprocess.PIPE, text=True, start_new_session=True)
        time.sleep(delay)
        os.killpg(process.pid, signal.SIGINT)
        error = process.communicate(timeout=60)[1]
        assert "Traceback" not in error and "leaked" not in error, error
