"""The records of `raya study`. manifest.json: what identifies the results and where they come from, without times and paths (manifest.schema.json);
`raya study --check` repeats a study and compares the two manifests. shard.json, in the folder of a shard, which computes a part of a study's cost images
(store.py): study, settings, inputs and, when the shard is complete, the names of its results. A shard may come from somebody else: it is data, without
paths or code, and everything in it is checked before it is used. seconds.csv there logs the time of each render and is never read."""
import hashlib
import json
import re
import subprocess
from functools import lru_cache
from importlib import metadata
from pathlib import Path

import raya
from raya.lab.store import read_regular_file, read_value, write_atomically

MANIFEST, SHARD = "manifest.json", "shard.json"
SETTINGS = "size", "views", "seed", "strict"  # options that change results
MODULES = "numpy", "scipy", "pandas", "matplotlib", "Jinja2"
# Debian packages of OpenCL drivers, their compilers, and the loader.
DEBIAN = "*-opencl-icd", "ocl-icd-libopencl1", "libpocl2", "libllvm[0-9]*", "libclang-cpp[0-9]*", "libc6", "python3"
IDENTITY = "study", "settings", "inputs", "version", "shards"  # members that are equal in all shards of a run
TYPES = {"study": str, "shard": int, "shards": int, "version": str, "settings": dict, "inputs": list, "results": (list, type(None)), "sha256": str}
MAX_HEADER_BYTES, MAX_SHARDS = 1 << 26, 100_000


@lru_cache(maxsize=None)
def program_version():
    """Returns 'raya 1.2.3 (commit ..., build)', the version of the program raya."""
    try:
        return subprocess.run([raya.program(), "--version"], capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return f"raya {raya.__version__}"


def packages():
    """Returns {name: version} of the Python modules and, on Debian, of the packages that results may depend on."""
    found = {name: metadata.version(name) for name in MODULES}
    try:
        lines = subprocess.run(["dpkg-query", "-W", "-f", "${db:Status-Status} ${Package} ${Version}\n", *DEBIAN], capture_output=True,
                               text=True).stdout.splitlines()
    except OSError:
        lines = []
    return {**found, **{name: version for status, name, version in (line.split(" ") for line in sorted(lines)) if status == "installed"}}


def inputs_of(study, scenes):
    """Returns a list of {name, sha256} of the study's file, if the study is one, and the scenes."""
    files = [(study, Path(study).read_bytes())] if study.endswith(".py") else []
    return [{"name": Path(name).name, "sha256": hashlib.sha256(content).hexdigest()}
            for name, content in [*files, *((scene.name, scene.nff.encode()) for scene in scenes)]]


def check_inputs(inputs, recorded, source):
    """Raises ValueError if the inputs differ from those that `source` records."""
    for one, other in zip(inputs, recorded):
        if one["sha256"] != other["sha256"]:
            raise ValueError(f"{one['name']}: differs from the file {other['name']} of {source} (SHA-256 {one['sha256'][:12]} instead of "
                             f"{other['sha256'][:12]}); remedy: use the same file")
    if len(inputs) != len(recorded):
        names = " ".join(one["name"] for one in recorded) or "none"
        raise ValueError(f"{source}: records the input files {names}, but {len(inputs)} were given; remedy: name the same files")


def digest(value, without):
    """Returns the SHA-256 of a dictionary's JSON, without one member."""
    return hashlib.sha256(json.dumps({name: member for name, member in value.items() if name != without}, sort_keys=True).encode()).hexdigest()


def hash_of(file):
    """Returns the SHA-256 of a file; of a study's JSON, that of the contents without `run`, which names the device."""
    content = file.read_bytes()
    return digest(json.loads(content), "run") if file.suffix == ".json" else hashlib.sha256(content).hexdigest()


def origin_of(options):
    return {"study": Path(options.study).name, "settings": {name: getattr(options, name) for name in SETTINGS}, "version": options.version}


def write_manifest(folder, options, files, devices, inputs):
    """Writes the manifest of a run. files: {name: whether its contents are repeatable}; the others contain measured times."""
    manifest = {**origin_of(options), "packages": packages(), "devices": sorted(devices), "inputs": inputs,
                "outputs": [{"name": name, "sha256": hash_of(folder / name) if files[name] else None} for name in sorted(files)]}
    write_atomically(folder / MANIFEST, json.dumps(manifest, indent=2, ensure_ascii=False) + "\n")


def read_manifest(path):
    """Returns a manifest. Raises ValueError if the file cannot be read or is not a manifest."""
    try:
        manifest = json.loads(Path(path).read_bytes())
        members = [manifest[name] for name in ("study", "version", "packages", "devices")]
        # a missing member of these raises KeyError or TypeError
        _ = [manifest["settings"][name] for name in SETTINGS], [(one["name"], one["sha256"]) for name in ("inputs", "outputs") for one in manifest[name]]
        if all(map(isinstance, members, (str, str, dict, list))):
            return manifest
        why = "a member has another type"
    except OSError as error:
        why = error.strerror
    except KeyError as error:
        why = f"it has no member {error}"
    except (ValueError, TypeError) as error:
        why = str(error)
    raise ValueError(f"{path}: is not a manifest of raya study: {why}; remedy: raya study NAME -o DIR writes DIR/{MANIFEST}")


def setting_arguments(settings):
    """Returns the arguments of `raya study` with these settings: --NAME=VALUE, and --strict."""
    values = {"size": settings["size"], "views": settings["views"], "seed": settings["seed"]}
    return [f"--{name}={value}" for name, value in values.items() if value is not None and (name, value) != ("seed", 1)] + (
        ["--strict"] if settings["strict"] else [])


def arguments_of(record, study, scenes):
    """Returns the arguments of `raya study` that repeat the study of a manifest or shard. study, scenes: as on the command line; if empty, the record's
    file names, because it has no paths. Raises ValueError if the record is of another study."""
    study = study or record["study"]
    if Path(study).name != record["study"]:
        raise ValueError(f"it is of study {record['study']}, not of {study}; remedy: name that study")
    return [study, *(scenes or [one["name"] for one in record["inputs"] if one["name"] != record["study"]]), *setting_arguments(record["settings"])]


def compare(recorded, current):
    """Returns (lines that describe the differences of two manifests, {outcome: number of data files}). Drawings and documents may differ."""
    lines = [f"{name}: {current[name]} instead of {recorded[name]}" for name in ("version", "devices", "packages") if recorded[name] != current[name]]
    hashes, recorded_hashes = ({one["name"]: one["sha256"] for one in manifest["outputs"]} for manifest in (current, recorded))
    counts = {"equal": 0, "different": 0, "measured": 0}
    for name in sorted({*hashes, *recorded_hashes}):
        both = hashes.get(name, "absent"), recorded_hashes.get(name, "absent")
        outcome = "measured" if None in both else "equal" if both[0] == both[1] else "different"
        counts[outcome] += Path(name).suffix in (".csv", ".json")
        if outcome == "different":
            lines.append(f"{name}: differs" if "absent" not in both else f"{name}: absent" if both[0] == "absent" else f"{name}: not in the manifest")
    return lines, counts


def is_valid(header):
    """Returns whether a shard.json has the members that header_of() writes, and no others."""
    return (header.keys() == TYPES.keys() and all(isinstance(header[name], kind) for name, kind in TYPES.items())
            and header["sha256"] == digest(header, "sha256") and 1 <= header["shard"] <= header["shards"] <= MAX_SHARDS
            and header["settings"].keys() == set(SETTINGS)
            and all(one.keys() == {"name", "sha256"} and all(isinstance(text, str) for text in one.values()) for one in header["inputs"])
            and all(re.fullmatch(r"[0-9a-f]{64}\.result", name) for name in header["results"] or []))


def read_header(folder):
    """Returns the contents of a shard.json. Raises FileNotFoundError, or ValueError if it is damaged."""
    data = read_regular_file(Path(folder) / SHARD, MAX_HEADER_BYTES)
    try:
        header = json.loads(data)
        if is_valid(header):
            return header
    except (ValueError, TypeError, AttributeError, RecursionError):
        pass
    raise ValueError(f"{Path(folder) / SHARD}: is damaged")


def header_of(options, scenes):
    """Returns the contents of shard.json at the start of a shard."""
    number, count = options.shard
    return {**origin_of(options), "shard": number, "shards": count, "inputs": inputs_of(options.study, scenes), "results": None}


def write_header(folder, header):
    write_atomically(Path(folder) / SHARD, json.dumps({**header, "sha256": digest(header, "sha256")}, indent=2) + "\n")


def start_shard(folder, header):
    """Writes shard.json for a shard that starts or continues. Raises ValueError if the folder has another shard."""
    header = json.loads(json.dumps(header))  # tuples become lists, as in the file
    try:
        present = read_header(folder)
    except (FileNotFoundError, ValueError):
        present = header
    for name in (*IDENTITY, "shard"):
        if present[name] != header[name]:
            raise ValueError(f"-o {folder}: contains shard {present['shard']}/{present['shards']} of study {present['study']}; its {name} "
                             "is another than that of this command; remedy: name another folder")
    write_header(folder, header)


def find_shards(folders):
    """Returns (headers of the shards found, as {number: (folder, header)}; problems, as {"I/N" of a shard that is not complete: reason}; sentences
    on folders without a shard). Raises ValueError if there is no shard, or if shards belong to different runs."""
    headers, notes = {}, []
    for folder in folders:
        try:
            header = read_header(folder)
        except (OSError, ValueError) as error:
            notes.append(f"{folder}: contains no shard" if isinstance(error, OSError) else str(error))
            continue
        other_folder, other = next(iter(headers.values()), (folder, header))
        for name in IDENTITY:
            if header[name] != other[name]:
                raise ValueError(f"{folder} and {other_folder}: are shards of different runs: they differ in {name}")
        if header["shard"] in headers:
            raise ValueError(f"{folder} and {headers[header['shard']][0]}: both contain shard {header['shard']}/{header['shards']}")
        headers[header["shard"]] = Path(folder), header
    if not headers:
        raise ValueError("; ".join(notes) + "; remedy: name the folders of `raya study --shard`")
    count = next(iter(headers.values()))[1]["shards"]
    problems = {f"{number}/{count}": problem_of(*headers[number]) if number in headers else "absent" for number in range(1, count + 1)}
    return headers, {shard: problem for shard, problem in problems.items() if problem}, notes


def problem_of(folder, header):
    """Returns why a shard is not complete; empty if it is."""
    if header["results"] is None:
        return f"incomplete: {folder}"
    damaged = [name for name in header["results"] if read_value(folder / name) is None]
    more = f" and {len(damaged) - 1} more" if len(damaged) > 1 else ""
    return f"damaged: {folder / damaged[0]}{more}" if damaged else ""


def merged_shards(options):
    """Returns the contents of the first shard.json in options.merge. Raises ValueError unless all shards are complete and of this program."""
    headers, problems, notes = find_shards(options.merge)
    if problems:
        texts = [*notes, *(f"shard {shard} is {problem}" for shard, problem in problems.items())]
        texts[10:] = [f"{len(texts) - 10} more"] * (len(texts) > 10)
        raise ValueError("; ".join(texts) + "; remedy: run these shards again with the same command, then merge")
    folder, header = headers[1]
    if header["version"] != options.version:
        raise ValueError(f"{folder}: computed by {header['version']}, but this is {options.version}; remedy: merge with that version")
    return header
