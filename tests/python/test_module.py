"""The Python module `raya` returns the results of the command line as arrays. Random cases print their seed if they fail."""
import json
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

raya = pytest.importorskip("raya", reason="the module is not built; configure with -DRAYA_PYTHON=ON")
SCENES = Path(__file__).parents[2] / "scenes"
SEED = 32
SMALL = {"size": 32, "pes": 32, "offset": 4}


@pytest.fixture(scope="module")
def centre():
    return raya.load(SCENES / "centre.nff")


@pytest.fixture(scope="module")
def small(centre):
    return raya.render(centre, cost=True, **SMALL)


def test_image_has_the_hash_in_the_readme(centre):
    result = raya.render(centre)
    assert result.hash.startswith("474a3843")
    assert result.image.shape == (256, 256, 3) and result.image.dtype == np.float32


def test_imbalance_of_all_offsets(centre):
    cost = raya.render(centre, machine="spa", offset=16, cost=True).cost
    u = raya.imbalances(cost, pes=256, offsets=range(256))
    assert [round(u[p], 4) for p in (0, 8, 16)] == [1.5846, 0.1316, 0.1802]
    assert u.argmin() == 207 and round(u.min(), 4) == 0.0848


def test_render_agrees_with_the_program(centre, tmp_path):
    report = tmp_path / "r.json"
    arguments = ["--size", "32", "--pes", "32", "--offset", "4", "--report", str(report), "-o", str(tmp_path / "i.png")]
    subprocess.run([raya.program(), "render", str(SCENES / "centre.nff"), "-q", *arguments], check=True)
    program_report, module_report = json.loads(report.read_text()), raya.render(centre, **SMALL).report
    assert module_report.keys() == program_report.keys()
    for member in module_report.keys() - {"scene", "image", "device", "measured"}:
        assert module_report[member] == program_report[member], member
    assert module_report["image"]["hash"] == program_report["image"]["hash"]


def test_loads_are_sums_of_costs(small):
    owner = raya.owners(32, 32, offset=4, pes=32)
    assert small.cost.dtype == np.uint64 and small.cost.shape == (32, 32)
    owner_loads = np.bincount(owner.ravel(), small.cost.ravel(), minlength=32)
    assert (small.loads == owner_loads).all() and (raya.loads(small.cost, offset=4, pes=32) == owner_loads).all()
    assert small.imbalance == pytest.approx(owner_loads.max() / owner_loads.mean() - 1, rel=1e-12)
    assert small.speedup == pytest.approx(owner_loads.sum() / owner_loads.max(), rel=1e-12)


def test_owners_of_the_cyclic_mapping():
    """Kohata & Ito: the slot of a pixel is (column + p row) mod width; the cyclic fold assigns slots to PEs in turn. The test
    accepts either sign of p."""
    random = np.random.default_rng(SEED)
    for _ in range(50):
        width, height = random.integers(2, 60, 2)
        pes, p = random.integers(1, width + 1), random.integers(0, width)
        rows, columns = np.mgrid[:height, :width]
        for sign in (1, -1):
            slots = (columns + sign * p * rows) % width
            if (raya.owners(width, height, offset=p, fold="cyclic", pes=pes) == slots % pes).all():
                break
        else:
            pytest.fail(f"{width} x {height}, p = {p}, {pes} PEs, seed {SEED}")


@pytest.mark.skipif(not shutil.which("node"), reason="no node (Debian: nodejs)")
def test_owners_and_balances_of_random_mappings_on_the_page(tmp_path):
    """The page's script has the owners, and computes the imbalance and speed-up, of the engine."""
    (tmp_path / "r.json").write_text('{"kind": "raya render"}')
    subprocess.run([raya.program(), "page", "r.json", "-q", "-o", "r.html"], cwd=tmp_path, check=True)
    scripts = re.findall(r"<script>(.*?)</script>", (tmp_path / "r.html").read_text(), re.DOTALL)
    random, cases, wanted = np.random.default_rng(SEED), [], []
    for i in range(120):
        a, b, across, down = map(int, random.integers(1, 9, 4))
        width, height = a * across, b * down
        pes, offset, seed = int(random.integers(1, width * height + 1)), int(random.integers(width)), int(random.integers(2**32))
        kind = ("slots", "rows", "blocks", "grid", "tiles", "random")[i % 6]
        fold, text = ("cyclic", "block")[i // 6 % 2], {"slots": "cyclic", "grid": f"grid:{a}x{b}", "tiles": f"tiles:{a}x{b}", "random": f"random:{seed}"}
        if kind == "grid":
            pes = a * b
        options = {"offset": offset, "fold": fold} if kind == "slots" else {}
        owners = raya.owners(width, height, mapping=text.get(kind, kind), pes=pes, **options).ravel()
        costs = random.integers(1, 1000, width * height)
        loads = np.bincount(owners, costs, minlength=pes)
        wanted.append([owners.tolist(), (loads.max() - loads.mean()) / loads.mean(), loads.sum() / loads.max()])
        cases.append([{"kind": kind, "offset": offset, "fold": fold, "pes": pes, "a": a, "b": b, "seed": seed}, {"width": width, "height": height}, costs.tolist()])
    script = next(text for text in scripts if "raya_owner" in text) + f"""console.log(JSON.stringify({json.dumps(cases)}.map(([setting, size, costs]) => {{
        const owners = ownersOf(setting, size), balance = balanceOf(loadsOf(owners, costs, setting.pes));
        return [[...owners], balance.imbalance, balance.speedup];
    }})))"""
    found = json.loads(subprocess.run(["node", "-"], input=script, check=True, capture_output=True, text=True).stdout)
    for case, (owners, *balance), (right_owners, *right_balance) in zip(cases, found, wanted):
        assert owners == right_owners and balance == pytest.approx(right_balance, rel=1e-12), f"{case}, seed {SEED}"


def test_imbalances_agree_with_loads():
    random = np.random.default_rng(SEED)
    for fold in ("cyclic", "block"):
        cost = random.integers(1, 2**40, (24, 48)).astype(np.uint64)
        u = raya.imbalances(cost, pes=12, offsets=range(48), fold=fold)
        for p in range(48):
            loads = raya.loads(cost, offset=p, pes=12, fold=fold).astype(float)
            assert u[p] == pytest.approx(loads.max() / loads.mean() - 1, rel=1e-12), f"p = {p}, {fold}, seed {SEED}"


def test_dynamic_schedule_assigns_every_pixel_once(small):
    schedule = raya.schedule(small.cost, "dynamic:16", pes=8)
    assert schedule["loads"].sum() == small.cost.sum() and len(schedule["loads"]) == 8
    assert schedule["makespan"] >= schedule["loads"].max() and schedule["requests"] >= 32 * 32 // 16


def test_torus_packets_loads_and_supersteps_agree(centre):
    result = raya.render(centre, machine="torus", size=16, bounces=4, packets=True)
    packets = result.packets
    crossing = packets[packets["source"] != packets["destination"]]
    assert len(crossing) and crossing["superstep"].max() < len(result.supersteps["cycles"])
    assert set(np.unique(packets["kind"])) <= set(range(len(raya.PACKET_KINDS)))
    assert result.loads.shape == (64,)
    assert (result.step_cycles.sum(0) == result.loads).all()
    assert (result.step_link_words.sum(0) == result.link_words).all()
    assert raya.render(centre, size=16, bounces=4, machine="grande", format=result.report["machine"]["format"]).hash == result.hash


def test_pixels_do_not_depend_on_the_accelerator_but_on_the_format(centre):
    options = {"machine": "grande", "size": 24, "bounces": 4}
    hashes = {raya.render(centre, accel=accel, format="fp32", **options).hash for accel in ("none", "grid", "bvh")}
    assert len(hashes) == 1
    assert raya.render(centre, format="spa22", **options).hash not in hashes


@pytest.mark.parametrize("options, message_part", [
    ({"size": 0}, "--size"), ({"offset": 300}, "--offset"), ({"machine": "sap"}, "no such machine"),
    ({"sise": 16}, "sise"), ({"format": "e9m4"}, "e9m4"), ({"pes": -1}, "--pes")])
def test_bad_options_raise_value_error(centre, options, message_part):
    with pytest.raises(ValueError, match=message_part):
        raya.render(centre, **options)


def test_error_message_is_that_of_the_command_line(centre):
    run = subprocess.run([raya.program(), "render", str(SCENES / "centre.nff"), "--machine", "sap", "-o", os.devnull],
                         text=True, capture_output=True)
    with pytest.raises(ValueError) as raised:
        raya.render(centre, machine="sap")
    assert run.returncode == 2 and str(raised.value).splitlines()[0] in run.stderr


def test_unknown_device_raises_device_error(centre):
    with pytest.raises(raya.DeviceError):
        raya.render(centre, device="no such device")


def test_bad_scene_names_file_and_line(tmp_path):
    (tmp_path / "bad.nff").write_text("b 0 0 0\ns 0 0\n")
    with pytest.raises(raya.InputError, match=r"bad\.nff:3: the file ends"):
        raya.load(tmp_path / "bad.nff")
    with pytest.raises(ValueError):
        raya.load(tmp_path / "missing.nff")


def test_scene_survives_text_file_and_pickle(centre, tmp_path):
    centre.save(tmp_path / "copy.nff")
    reloaded = raya.load(tmp_path / "copy.nff")
    assert reloaded.nff == centre.nff == pickle.loads(pickle.dumps(centre)).nff == raya.parse(centre.nff).nff
    assert raya.render(reloaded, **SMALL).hash == raya.render(centre, **SMALL).hash


def test_arrays_outlive_their_result(centre):
    image = raya.render(centre, **SMALL).image
    copy = image.copy()
    raya.render(centre, size=32, pes=32, offset=5)
    assert (image == copy).all()


def test_session_can_be_reused(centre):
    session = raya.Session()
    first, second = (session.render(centre, **SMALL) for _ in range(2))
    assert first.hash == second.hash
    assert raya.render(centre, session=session, **SMALL).hash == first.hash
    assert set(session.device) == {"name", "platform", "version", "driver"}


def test_progress_is_reported_and_the_gil_is_released(centre):
    """Another Python thread can run while the engine renders."""
    fractions, counted, done = [], [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    raya.render(centre, size=256, progress=fractions.append)
    done.set()
    thread.join()
    assert fractions == sorted(fractions) and fractions and 0 <= fractions[0] and fractions[-1] <= 1
    assert counted[0] > 3


def test_import_preserves_signals_and_environment_and_render_preserves_signals():
    script = """
import ctypes, signal
signal.signal(signal.SIGUSR1, lambda *_: None)
def state():
    lines = [line.split() for line in open('/proc/self/status') if line[:3] == 'Sig' and line[3] != 'Q']
    signals = {name: int(bits, 16) & (2**31 - 1) for name, bits in lines}  # the C library uses the higher signals
    variables, environ = [], ctypes.POINTER(ctypes.c_char_p).in_dll(ctypes.CDLL(None), 'environ')
    while environ[len(variables)]:
        variables.append(environ[len(variables)])
    return signals, variables
before = state()
import raya
assert state() == before, ('import', before, state())
raya.render(raya.example('centre'), size=16)
assert state()[0] == before[0], ('render', before, state())
"""
    environment = {**os.environ, "PYTHONPATH": str(Path(raya.__file__).parents[1])}
    subprocess.run([sys.executable, "-c", script], check=True, env=environment)


def test_ctrl_c_interrupts(centre):
    def interrupt(fraction):
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        raya.render(centre, size=256, progress=interrupt)
    assert raya.render(centre, **SMALL).hash  # the session can still render


def test_skipped_parts_of_a_scene_give_warnings(tmp_path):
    (tmp_path / "odd.nff").write_text(raya.example("centre").nff + "tex 1 2 3\n")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        raya.load(tmp_path / "odd.nff")
    assert [str(warning.message).split(":", 1)[1] for warning in caught] == ["57: entity 'tex' of another dialect, skipped"]
    with pytest.raises(ValueError, match="unknown entity 'tex'"):
        raya.load(tmp_path / "odd.nff", strict=True)


def test_every_public_function_has_a_docstring():
    undocumented = [name for name in dir(raya) if not name.startswith("_") and callable(getattr(raya, name))
                    and not (getattr(raya, name).__doc__ or "").strip()]
    assert not undocumented


def test_type_stubs_agree_with_the_module():
    """The stub host/python/raya/_engine.pyi declares exactly the module's names and arguments."""
    import ast
    import inspect

    tree = ast.parse((Path(__file__).parents[2] / "host/python/raya/_engine.pyi").read_text())

    def public(body):
        named = [node for node in body if isinstance(node, (ast.ClassDef, ast.FunctionDef))]
        assigned = [node.target.id for node in body if isinstance(node, ast.AnnAssign)]
        return {name for name in [node.name for node in named] + assigned if not name.startswith("_")}

    def names_of(owner):
        return {name for name, value in vars(owner).items() if not name.startswith("_")}

    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    assert public(tree.body) == names_of(raya._engine)
    for name in ("Scene", "Result", "Session"):
        assert public(classes[name].body) == names_of(getattr(raya._engine, name)), name
    assert public(classes["_Generators"].body) == names_of(raya.generate)
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name != "render":
            declared = re.match(r"\w+\((.*)\)", getattr(raya._engine, node.name).__doc__).group(1)
            names = re.findall(r"(?:^|, )(\w+):", declared)
            assert names == [argument.arg for argument in node.args.args], node.name
    assert inspect.signature(raya.render).parameters.keys() == {"scene", "progress", "session", "options"}


def test_no_output_overwrites_a_scene(tmp_path):
    file = tmp_path / "s.nff"
    file.write_bytes((SCENES / "centre.nff").read_bytes())
    for scene in (str(file), raya.load(file)):
        with pytest.raises(ValueError, match="would overwrite the input"):
            raya.render(scene, report=str(file), **SMALL)
    assert file.read_bytes() == (SCENES / "centre.nff").read_bytes()
    raya.load(file).save(file)  # its own file
    for _ in range(2):  # a new report may replace an old one
        raya.render(raya.load(file), report=str(tmp_path / "r.json"), **SMALL)


def test_render_in_a_child_or_in_itself_is_an_error(centre, small):
    with pytest.raises(ValueError, match="in the progress function of a render"):
        raya.render(centre, progress=lambda _: raya.render(centre, **SMALL), **SMALL)
    assert raya.render(centre, **SMALL).hash == small.hash
    reader, writer = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Python 3.12 warns of fork() with threads
        child = os.fork()
    if child == 0:
        try:
            raya.render(centre, **SMALL)
        except raya.DeviceError as error:
            os.write(writer, str(error).encode())
        os._exit(0)
    os.close(writer)
    os.waitpid(child, 0)
    assert b"forked" in os.read(reader, 1000)


def test_values_of_every_kind_are_accepted_or_are_value_errors(centre, small):
    for size in (np.int64(32), (32, 32), np.array([32, 32]), "32x32"):
        assert raya.render(centre, size=size, pes=np.uint8(32), offset=4).hash == small.hash
    for wrong in ({"size": True}, {"size": [1, 2, 3]}, {"report": "-"}, {"pes": [True]}):
        for _ in range(2):
            with pytest.raises(ValueError):
                raya.render(centre, **{**SMALL, **wrong})
    with pytest.raises(ValueError, match="2\\^64"):
        raya.loads(np.full((4, 4), 2**62, np.uint64), pes=4)
    for kind in (raya.Scene, raya.Result):
        with pytest.raises(TypeError):
            kind.__new__(kind)
