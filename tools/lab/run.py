"""What `raya study` does: runs studies, shards or a comparison, and writes their results."""
import os
import sys
import tempfile
from pathlib import Path
from shlex import quote
from types import SimpleNamespace

import raya
from raya.lab import records
from raya.lab.claims import decide
from raya.lab.document import write_document, write_page
from raya.lab.options import settings_of
from raya.lab.page import format_value
from raya.lab.worker import Worker, studies, study_of_file, warn_as_raya
from tqdm import tqdm

EXIT_DEVICE, EXIT_DIFFERENT = 3, 4


def repeating_options(options, recorded, source):
    """Returns the options that repeat the study that `source`, a manifest or shard, records. Raises ValueError if it has an invalid option."""
    try:
        arguments = records.arguments_of(recorded, options.study, options.scenes)
        repeated = settings_of([*arguments, "-o", options.output or os.devnull])
    except (ValueError, TypeError, LookupError) as error:
        raise ValueError(f"{source}: {error}") from None
    kept = {name: getattr(options, name) for name in ("output", "device", "verbosity", "check", "merge", "version")}
    return SimpleNamespace(**{**vars(repeated), **kept})


def selected_studies(options):
    """Returns the studies to run. Raises ValueError for several scenes of a study of one."""
    if options.study.endswith(".py"):
        chosen = [study_of_file(options.study)]
    else:
        chosen = [study for name, study in studies().items() if options.study in ("all", name)]
    if len(chosen) == 1 and chosen[0].one_scene and len(options.scenes) > 1:
        raise ValueError(f"study {chosen[0].name} takes one scene, {len(options.scenes)} were given: run it for each, "
                         "into a folder of its own")
    return chosen


def command_of(study, options):
    """Returns the command line that repeats one study."""
    scenes = options.scenes[:1] if study.one_scene else options.scenes
    settings = [argument.replace("=", " ", 1) for argument in records.setting_arguments(vars(options))]
    device = [f"--device {quote(options.device)}"] if options.device else []
    return " ".join(["raya study", study.source, *map(quote, scenes), *settings, *device, *["--no-tuned"] * options.no_tuned, "-o DIR"])


def print_page(page, folder):
    print(page.title)
    for c in page.comparisons:
        paper = "" if c.paper is None else f" paper {format_value(c.paper)}, ratio {c.ours / c.paper:.3f}"
        print(f"  {c.what:<34} {format_value(c.ours):>12} {c.unit:<4}{paper}{f'  ({c.remark})' if c.remark else ''}")
    for line in page.findings:
        print(f"  {line}")
    print(f"  {folder / (page.name + '.md')}", flush=True)


def make_folder(path):
    """Creates a folder and its missing parents. Returns the created folders, the innermost first. Raises ValueError if the folder is not writable."""
    missing = [folder for folder in [path, *path.parents] if not folder.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"-o {path}: cannot create directory: {error.strerror}") from None
    if not os.access(path, os.W_OK):
        raise ValueError(f"-o {path}: is not writable")
    return missing


def run_shard(options, chosen, scenes):
    """Computes a shard of the studies' cost images. Raises ValueError if no study has any."""
    if not any(study.prepare for study in chosen):
        raise ValueError(f"study {chosen[0].name}: has no ensembles to divide; remedy: run it without --shard")
    folder, (number, count), worker = Path(options.output), options.shard, Worker()
    make_folder(folder)
    header = records.header_of(options, scenes)
    records.start_shard(folder, header)
    try:
        for study in filter(lambda study: study.prepare, chosen):
            names, computed = worker.run(study.source, scenes, folder, options)
    finally:
        worker.close()
    records.write_header(folder, {**header, "results": names})
    if options.verbosity >= 0:
        print(f"{folder}: shard {number}/{count} of study {options.study}: {computed} of {len(names)} results computed now")


def print_missing(options):
    """Prints a line for each shard that is absent, incomplete or damaged. Returns the exit code."""
    _, problems, notes = records.find_shards(options.missing)
    for line in notes:
        print(f"raya: {line}", file=sys.stderr)
    for shard, problem in problems.items():
        print(shard, problem)
    return EXIT_DIFFERENT if problems else 0


def check_manifest(options, recorded, chosen, scenes):
    """Runs the study of a manifest again and prints the differences. Returns the exit code."""
    with tempfile.TemporaryDirectory(prefix="raya-check-") as temporary:
        folder = Path(options.output or temporary)
        code = run_all(SimpleNamespace(**{**vars(options), "output": str(folder), "verbosity": min(-1, options.verbosity)}), chosen, scenes)
        if not (folder / records.MANIFEST).exists():
            return code
        lines, counts = records.compare(recorded, records.read_manifest(folder / records.MANIFEST))
    for line in lines:
        print(line)
    measured = f", {counts['measured']} with measured times not compared" if counts["measured"] else ""
    print(f"{options.check}: {'other' if counts['different'] else 'the same'} results: of the data files, {counts['equal']} equal, "
          f"{counts['different']} different{measured}")
    return EXIT_DIFFERENT if counts["different"] else code


def run_all(options, chosen, scenes):
    """Runs the chosen studies and writes their results. Returns the exit code."""
    folder, worker, pages, drawings, files, code = Path(options.output), Worker(), [], {}, {}, 0  # files: {name: are its contents repeatable?}
    skip_notes = []  # sentences on studies that failed on the device
    created_folders = make_folder(folder)
    (folder / records.MANIFEST).unlink(missing_ok=True)  # a manifest describes the files of one complete run
    with tempfile.TemporaryDirectory(prefix="raya-lab-") as cache:
        try:
            bar = tqdm(chosen, disable=options.verbosity < 0 or not sys.stderr.isatty(), unit="study", leave=False)
            for study in bar:
                bar.set_description(f"study {study.name}")
                try:
                    page = worker.run(study.source, scenes, cache, options)
                except raya.DeviceError as error:
                    if len(chosen) == 1:
                        raise
                    skip_notes.append(f"study {study.name} is skipped: {error}")
                    print(f"raya: {skip_notes[-1]}", file=sys.stderr)
                    code = EXIT_DEVICE
                    continue
                page.run = {"command": command_of(study, options), "version": f"raya {raya.__version__}", **page.run}
                decide(page.claims)
                names, drawings[page.name] = write_page(folder, page)
                files.update(dict.fromkeys(names, not study.measures))
                pages.append(page)
                if options.verbosity >= 0:
                    bar.clear()
                    print_page(page, folder)
        finally:
            worker.close()
            for created in created_folders if not pages else []:
                if created.exists() and not any(created.iterdir()):
                    created.rmdir()
    if pages:
        files.update(dict.fromkeys(write_document(folder, pages, drawings, skip_notes), all(files.values())))
        devices = {device for page in pages for device in page.run["device"].split("; ")}
        records.write_manifest(folder, options, files, devices, records.inputs_of(options.study, scenes))
        if options.verbosity >= 0:
            print(folder / "index.html")
    return code


def run(options):
    """Does what the options of `raya study` say. Returns the exit code."""
    options.version, recorded, source = records.program_version(), None, options.check
    warn_as_raya(options)
    if options.missing:
        return print_missing(options)
    if options.merge:
        recorded, source = records.merged_shards(options), options.merge[0]
    elif options.check:
        recorded = records.read_manifest(options.check)
    if recorded:
        options = repeating_options(options, recorded, source)
    else:  # of a record, the hash of the study's file is compared first, because the selection runs that file
        chosen = selected_studies(options)
    try:
        scenes = [raya.load(file, strict=options.strict).renamed(file) for file in options.scenes]
    except ValueError as error:
        raise ValueError(f"{error}; remedy: name the study and its scenes: raya study {options.study} SCENE..." if recorded else error) from None
    if recorded:
        records.check_inputs(records.inputs_of(options.study, scenes), recorded["inputs"], source)
        chosen = selected_studies(options)
    if options.check:
        return check_manifest(options, recorded, chosen, scenes)
    if options.shard:
        return run_shard(options, chosen, scenes)
    return run_all(options, chosen, scenes)
