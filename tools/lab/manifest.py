"""manifest.json: what identifies the results of `raya study` and where they come from, without times and paths (manifest.schema.json).
`raya study --check` repeats a study and compares the two manifests."""
import hashlib
import json
import subprocess
from functools import lru_cache
from importlib import metadata
from pathlib import Path

import raya
from raya.lab.store import write_atomically

NAME = "manifest.json"
SETTINGS = "size", "views", "seed", "network", "strict"  # options that change results
MODULES = "numpy", "scipy", "pandas", "matplotlib", "Jinja2"
# Debian packages of OpenCL drivers, their compilers, and the loader.
DEBIAN = "*-opencl-icd", "ocl-icd-libopencl1", "libpocl2", "libllvm[0-9]*", "libclang-cpp[0-9]*", "libc6", "python3"


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


def hash_of(file):
    """Returns the SHA-256 of a file; of a study's JSON, that of the contents without `run`, which names the device."""
    content = file.read_bytes()
    if file.suffix == ".json":
        content = json.dumps({name: member for name, member in json.loads(content).items() if name != "run"}, sort_keys=True).encode()
    return hashlib.sha256(content).hexdigest()


def write_manifest(folder, options, files, devices, inputs):
    """Writes the manifest of a run. files: {name: whether its contents are repeatable}; the others contain measured times."""
    options = vars(options)
    manifest = {"study": Path(options["study"]).name, "settings": {name: options[name] for name in SETTINGS}, "version": options["version"],
                "packages": packages(), "devices": sorted(devices), "inputs": inputs,
                "outputs": [{"name": name, "sha256": hash_of(folder / name) if files[name] else None} for name in sorted(files)]}
    write_atomically(folder / NAME, json.dumps(manifest, indent=2, ensure_ascii=False) + "\n")


def read_manifest(path):
    """Returns a manifest. Raises ValueError if the file cannot be read or is not a manifest."""
    try:
        manifest = json.loads(Path(path).read_bytes())
        parts = [manifest[name] for name in ("study", "version", "packages", "devices")], [manifest["settings"][name] for name in SETTINGS]
        parts += ([(one["name"], one["sha256"]) for name in ("inputs", "outputs") for one in manifest[name]],)
        if all(map(isinstance, parts[0], (str, str, dict, list))):
            return manifest
        why = "a member has another type"
    except OSError as error:
        why = error.strerror
    except KeyError as error:
        why = f"it has no member {error}"
    except (ValueError, TypeError) as error:
        why = str(error)
    raise ValueError(f"{path}: is not a manifest of raya study: {why}; remedy: raya study NAME -o DIR writes DIR/{NAME}")


def arguments_of(manifest, study, scenes):
    """Returns the arguments of `raya study` that repeat a manifest's study. study, scenes: as on the command line; if empty, the manifest's file
    names, because it has no paths. Raises ValueError if the manifest is of another study."""
    study = study or manifest["study"]
    if Path(study).name != manifest["study"]:
        raise ValueError(f"it is of study {manifest['study']}, not of {study}; remedy: name that study")
    settings = manifest["settings"]
    arguments = [study, *(scenes or [one["name"] for one in manifest["inputs"] if one["name"] != manifest["study"]])]
    arguments += [f"--{name}={settings[name]}" for name in ("size", "views", "seed") if settings[name] is not None]
    arguments += [f"--network={settings['network'][0] * 1e6:g},{settings['network'][1] * 1e9:g}"] if settings["network"] else []
    return arguments + ["--strict"] * bool(settings["strict"])


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
