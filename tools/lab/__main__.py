"""python3 -m raya.lab NAME|all|FILE.py [SCENE.nff...] -o DIR: runs studies; `raya study` is the same."""
import argparse
import os
import signal
import sys
import tempfile
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

EXIT_USER, EXIT_DEVICE = 2, 3
PACKAGES = ("numpy", "scipy", "pandas", "matplotlib", "jinja2", "tqdm")


def missing_packages():
    """A line with the remedy where a Python package is missing, else nothing."""
    from importlib.util import find_spec

    missing = [name for name in PACKAGES if find_spec(name) is None]
    if not missing:
        return ""
    return (f"study needs the Python packages {', '.join(missing)}, which {sys.executable} does not have; remedy: "
            f"sudo apt-get install {' '.join('python3-' + name for name in missing)}, or name another Python in "
            "RAYA_PYTHON")


def side(text):
    size = int(text)
    if not 17 <= size <= 4096:
        raise argparse.ArgumentTypeError("must be 17..4096 pixels a side")
    return size


def network(text):
    """'30,0.8': microseconds a message, nanoseconds a byte -> seconds."""
    alpha, beta = map(float, text.split(","))
    if not (0 <= alpha <= 1e9 and 0 <= beta <= 1e9):
        raise ValueError
    return 1e-6 * alpha, 1e-9 * beta


def parse(arguments):
    parser = argparse.ArgumentParser(prog="raya study", allow_abbrev=False, description=__doc__.split(":")[-1].strip())
    parser.add_argument("study", metavar="STUDY", help="name, all, or a Python file with a study of yours")
    parser.add_argument("scenes", metavar="SCENE.nff", nargs="*", help="scenes; default: the study's own")
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for index.html and all other files")
    parser.add_argument("--size", type=side, metavar="N", help="pixels a side, 17..4096; default: the study's")
    parser.add_argument("--network", type=network, metavar="ALPHA,BETA",
                        help="of study ranks: microseconds a message, nanoseconds a byte")
    parser.add_argument("--strict", action="store_true", help="refuse scenes with what NFF does not have")
    parser.add_argument("--device", metavar="NAME", default="", help="as raya render has it")
    parser.add_argument("--no-tuned", action="store_true", help="take the defaults, not what raya tune found")
    parser.add_argument("-q", "--quiet", action="count", default=0, help="no progress, no summary; twice: no warnings")
    parser.add_argument("-v", "--verbose", action="count", default=0)
    return parser.parse_args(arguments)


def wanted_studies(name):
    """(studies to run, why others are left out). ValueError for one that there is not, or that cannot run here."""
    from raya.lab.study import studies, study_of_file

    if name.endswith(".py"):
        return [study_of_file(name)], []
    known = studies()
    if name != "all":
        if name not in known:
            raise ValueError(f"study {name}: no such study, there are {', '.join(known)}, all, or a file FILE.py")
        if known[name].lacks():
            raise ValueError(f"study {name}: {known[name].lacks()}")
        return [known[name]], []
    left_out = [f"study {one.name} is left out: {one.lacks()}" for one in known.values() if one.lacks()]
    return [one for one in known.values() if not one.lacks()], left_out


def named_scenes(options, known):
    import raya

    scenes = []
    for file in options.scenes:
        if file in known and not os.path.exists(file):
            raise ValueError(f"{file} is a study, not a scene: studies run one at a time, all with raya study all")
        scenes.append(raya.load(file, strict=options.strict).renamed(file))
    return scenes


def command_of(study, options):
    """The command that makes one study's page and no other."""
    from shlex import quote

    scenes = options.scenes[:1] if study.one_scene else options.scenes
    words = ["raya", "study", options.study if options.study.endswith(".py") else study.name, *map(quote, scenes)]
    words += [f"--size {options.size}"] if options.size else []
    words += [f"--device {quote(options.device)}"] if options.device else []
    words += ["--strict"] if options.strict else []
    words += ["--no-tuned"] if options.no_tuned else []
    return " ".join(words + ["-o DIR"])


def print_page(page, folder):
    from raya.lab.page import shown

    print(page.title)
    for c in page.comparisons:
        paper = "" if c.paper is None else f" paper {shown(c.paper)}, ratio {c.ours / c.paper:.3f}"
        print(f"  {c.what:<34} {shown(c.ours):>12} {c.unit:<4}{paper}{f'  ({c.remark})' if c.remark else ''}")
    for line in page.findings:
        print(f"  {line}")
    print(f"  {folder / (page.name + '.md')}", flush=True)


def make_folder(path):
    """Makes a folder and says which of its parents were missing, the innermost first."""
    missing = [one for one in [path, *path.parents] if not one.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"-o {path}: cannot create directory: {error.strerror}") from None
    if not os.access(path, os.W_OK):
        raise ValueError(f"-o {path}: is not writable")
    return missing


def run_all(options, chosen, left_out, scenes):
    import raya
    from raya.lab.document import write_document, write_page
    from raya.lab.worker import Worker
    from tqdm import tqdm

    folder, worker, pages, drawings, code = Path(options.output), Worker(), [], {}, 0
    missing = make_folder(folder)
    with tempfile.TemporaryDirectory(prefix="raya-lab-") as kept:
        try:
            bar = tqdm(chosen, disable=options.quiet > 0 or not sys.stderr.isatty(), unit="study", leave=False)
            for one in bar:
                bar.set_description(f"study {one.name}")
                try:
                    name = options.study if options.study.endswith(".py") else one.name
                    page, device = worker.run(name, scenes, kept, options)
                except (BrokenProcessPool, raya.DeviceError) as error:
                    reason = "the OpenCL driver crashed" if isinstance(error, BrokenProcessPool) else str(error)
                    left_out.append(f"study {one.name} is left out: {reason}")
                    print(f"raya: {left_out[-1]}", file=sys.stderr)
                    code = EXIT_DEVICE
                    continue
                page.run = {"command": command_of(one, options), "version": f"raya {raya.__version__}",
                            "device": f"{device['name']} ({device['platform']}, driver {device['driver']})"}
                drawings[page.name] = write_page(folder, page)
                pages.append(page)
                if options.quiet == 0:
                    bar.clear()
                    print_page(page, folder)
        finally:
            worker.close()
            for one in missing if not pages else []:
                if one.exists() and not any(one.iterdir()):
                    one.rmdir()
    if pages:
        write_document(folder, pages, drawings, left_out)
        if options.quiet == 0:
            print(folder / "index.html")
    return code


def main(arguments):
    options = parse(arguments)
    lacking = missing_packages()
    if lacking:
        raise ValueError(lacking)
    import warnings

    import raya

    warnings.showwarning = lambda text, *_: options.quiet < 2 and print(f"raya: warning: {text}", file=sys.stderr)
    if options.output == "-":
        raise ValueError("-o -: a study is many files, which stdout cannot hold; name a folder")
    chosen, left_out = wanted_studies(options.study)
    for line in left_out:
        print(f"raya: {line}", file=sys.stderr)
    if len(chosen) == 1 and chosen[0].one_scene and len(options.scenes) > 1:
        raise ValueError(f"study {chosen[0].name} takes one scene, {len(options.scenes)} were given: run it for each, "
                         "into a folder of its own")
    from raya.lab.study import REGISTRY

    return run_all(options, chosen, left_out, named_scenes(options, REGISTRY))


def end_by(number):
    """Ends as the signal would have, so that the caller sees why."""
    print("raya: interrupted", file=sys.stderr)
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)


class Ended(BaseException):
    """A signal that ends the call."""


if __name__ == "__main__":
    def end(number, frame):
        raise Ended(number)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, end)
    try:
        sys.exit(main(sys.argv[1:]))
    except Ended as ended:
        end_by(ended.args[0])
    except ValueError as error:
        print(f"raya: {error}", file=sys.stderr)
        sys.exit(EXIT_USER)
    except Exception as error:
        import raya

        if not isinstance(error, raya.DeviceError):
            raise
        print(f"raya: {error}", file=sys.stderr)
        sys.exit(EXIT_DEVICE)
