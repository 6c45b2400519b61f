"""The options of `raya study`."""
import argparse
import re
from difflib import SequenceMatcher
from pathlib import Path
from types import SimpleNamespace

STUDIES = dict(line.split(": ", 1) for line in (Path(__file__).parent / "studies.txt").read_text().splitlines())  # {name: summary}
HEADER = """Run series of renders that test the papers' claims

Examples:
  raya study fig8 scenes/mirrors.nff --size 64 -o mirrors
      Run one study at a small size; open mirrors/index.html in a browser
  raya study all -o studies
      Run all studies and write one document"""
REPEATING = ("merge", "missing", "check")  # options whose settings are in shards or in a manifest


class Formatter(argparse.RawDescriptionHelpFormatter):
    """Prints "-o, --output DIR" for argparse's "-o DIR, --output DIR", as the other commands of raya."""

    def add_usage(self, usage, actions, groups, prefix=None):
        super().add_usage(usage, actions, groups, "Usage: ")

    def _format_action_invocation(self, action):
        if not action.option_strings or action.nargs == 0:
            return super()._format_action_invocation(action)
        return f"{', '.join(action.option_strings)} {action.metavar}"


class Parser(argparse.ArgumentParser):
    def error(self, message):
        reason = re.sub("^argument (?:-./)?([^:]*): ", r"\1 ", message)  # argparse: "argument --size: 16: must be ..."
        raise ValueError(f"study: {reason}; see raya study --help")


def refuse(text, reason):
    raise argparse.ArgumentTypeError(f"{text}: {reason}" if text else reason)


def text(value):
    return value or refuse("", "must not be empty")


def whole_number(low, high, unit=""):
    """Returns the parser of an integer in low..high."""
    def parse(value):
        return int(value) if re.fullmatch("[0-9]{1,9}", value) and low <= int(value) <= high else refuse(value, f"must be {low}..{high}{unit}")
    return parse


def shard(value):
    """Returns (I, N) of "I/N"."""
    parts = re.fullmatch("([0-9]{1,9})/([0-9]{1,9})", value)
    number, count = map(int, parts.groups()) if parts else (0, 0)
    return (number, count) if 1 <= number <= count else refuse(value, "must be I/N with I 1..N, such as 2/4")


def parser():
    command = Parser("raya study", "raya study [STUDY|all|FILE.py] [SCENE...] -o DIR [OPTIONS]", HEADER, formatter_class=Formatter, allow_abbrev=False,
                     add_help=False, epilog="Studies:\n" + "".join(f"  {name:9} {summary}\n" for name, summary in STUDIES.items()))

    def add(group, *names, **settings):
        group.add_argument(*names, **{"type": text, **settings})

    files = command.add_argument_group("Files")
    add(files, "study", nargs="?", metavar="STUDY",
        help="name of a study in the list below, all for all studies, or a file FILE.py with your own study; may be left out with --missing and --check")
    add(files, "scenes", nargs="*", metavar="SCENE",
        help="scenes in NFF, or meshes (.obj, .ply, .gltf, .glb, .stl); one of them may be -: stdin; with all, studies of a single scene take the first "
        "scene; default: the study's own scenes")
    add(files, "-o", "--output", metavar="DIR",
        help="folder for index.html, Markdown, CSV, JSON, plots and manifest.json; with --shard, for the shard's results; created if missing")
    add(files, "--shard", type=shard, metavar="I/N",
        help="compute the I-th of N parts of the study's cost images, and write them to the folder of -o; the same command continues after a stop")
    add(files, "--merge", nargs="+", default=[], metavar="DIR...", help="folders of all N shards of this study, with these scenes: write its results")
    add(files, "--missing", nargs="+", default=[], metavar="DIR...",
        help="folders of shards: list the shards that are absent, incomplete or damaged (exit code 4)")
    add(files, "--check", metavar="FILE", help="repeat the study of a manifest.json and compare the results (exit code 4: they differ)")
    image = command.add_argument_group("Image")
    add(image, "--size", type=whole_number(17, 4096, " pixels a side"), metavar="N",  # the width must exceed the paper's offset, 16
        help="image size in pixels a side, 17..4096; default: the study's size, 256 in most studies")
    add(image, "--views", type=whole_number(20, 5000), metavar="N",
        help="number of pictures in the ensembles of the studies of load, 20..5000, divided among the nine scene families and rounded up to as many of "
        "each; default: 108")
    add(image, "--seed", type=whole_number(1, 90_000), metavar="S",
        help="seed S of the first picture of a family, 1..90000; the next pictures have the seeds S + 1, ...; default: 1")
    machine = command.add_argument_group("Machine and device")
    add(machine, "--device", metavar="NAME",
        help="OpenCL device: its number, type (gpu, cpu), or part of its name or version, as raya devices lists them; default: RAYA_DEVICE, else the first "
        "GPU, else the first CPU")
    general = command.add_argument_group("General")
    for group, names, explanation in (
            (files, ("--strict",), "refuse scenes with deviations from the NFF format, instead of a warning"),
            (machine, ("--no-tuned",), "use the defaults, not the values that raya tune stored for this device and driver")):
        group.add_argument(*names, action="store_true", help=explanation)
    general.add_argument("-q", "--quiet", action="count", default=0, help="print no summary, no progress; twice: no warnings")
    general.add_argument("-v", "--verbose", action="count", default=0, help="no effect on studies")
    general.add_argument("-h", "--help", action="help", help="print this help and exit")
    general.add_argument("--help-all", action="help", help=argparse.SUPPRESS)
    return command


def check(options, error):
    """Calls error(reason) for options that contradict each other."""
    given = {name for name, value in vars(options).items() if value not in (None, False, [], 0, "")}
    for name in REPEATING:
        for other in ("shard", "size", "views", "seed", "strict", "no_tuned", *REPEATING[REPEATING.index(name) + 1:]):
            if {name, other} <= given:
                error(f"--{name} excludes --{other.replace('_', '-')}")
    repeats = options.missing or options.check  # a manifest contains the study and its settings
    for wrong, reason in ((options.quiet and options.verbose, "--quiet and --verbose: give one of them"),
                          (not repeats and not options.study, "STUDY is required; remedy: raya study NAME -o DIR"),
                          (not repeats and not options.output, "--output is required; remedy: raya study NAME -o DIR"),
                          (options.missing and options.output, "--output with --missing: no effect; leave it out"),
                          (options.output == "-", "-o -: a study writes several files, not stdout; name a folder")):
        if wrong:
            error(reason)
    names = [*STUDIES, "all"]
    if options.study and options.study not in names:
        if not options.study.endswith(".py"):
            likeness, nearest = max(((SequenceMatcher(None, options.study, name).ratio(), name) for name in names), key=lambda pair: pair[0])
            error(f"no study {options.study}{f' (did you mean {nearest}?)' * (likeness > 0.6)}; your own study is a file FILE.py")
        if not Path(options.study).is_file():
            error(f"{options.study}: no such file")
    for scene in options.scenes:
        if scene in names and not Path(scene).exists():
            error(f"{scene} is a study, not a scene; run one study at a time, or all studies with raya study all")


def check_output_folder(options):
    """Raises ValueError if the output folder contains an input of the study, which a result might replace."""
    inputs = [Path(name) for name in (options.study or "", options.check or "") if Path(name).is_file()]
    inputs += [file for folder in options.merge if Path(folder).is_dir() for file in Path(folder).iterdir()]
    for file in Path(options.output).iterdir() if options.output and Path(options.output).is_dir() else []:
        for one in inputs:
            if file.samefile(one):
                raise ValueError(f"study: --output {file}: would overwrite the input {one}; name another folder")


def settings_of(arguments):
    """Returns the options in `arguments` as a namespace. Raises ValueError. --help prints the help and raises SystemExit."""
    command = parser()
    options = command.parse_intermixed_args(arguments)
    check(options, command.error)
    check_output_folder(options)
    return SimpleNamespace(**{**vars(options), "study": options.study or "", "device": options.device or "", "seed": options.seed or 1,
                              "verbosity": options.verbose - options.quiet})
