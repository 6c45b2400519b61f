"""Divides the cost images of a study over N processes. The folder of a shard has its results (store.py) and shard.json, which records study,
settings, inputs and, when the shard is complete, the names of its results. seconds.csv logs the time of each render and is never read. A shard may come
from somebody else: it is data, without paths or code, and everything in it is checked before it is used."""
import hashlib
import json
import re
from pathlib import Path

from raya.lab import manifest
from raya.lab.store import read_regular_file, read_value, write_atomically

NAME = "shard.json"
IDENTITY = "study", "settings", "inputs", "version", "shards"  # members that are equal in all shards of a run
TYPES = {"study": str, "shard": int, "shards": int, "version": str, "settings": dict, "inputs": list, "results": (list, type(None)), "sha256": str}
MAX_HEADER_BYTES, MAX_SHARDS = 1 << 26, 100_000


def digest(header):
    return hashlib.sha256(json.dumps({name: member for name, member in header.items() if name != "sha256"}, sort_keys=True).encode()).hexdigest()


def is_valid(header):
    """Returns whether a shard.json has the members that header_of() writes, and no others."""
    return (header.keys() == TYPES.keys() and all(isinstance(header[name], kind) for name, kind in TYPES.items())
            and header["sha256"] == digest(header) and 1 <= header["shard"] <= header["shards"] <= MAX_SHARDS
            and header["settings"].keys() == set(manifest.SETTINGS)
            and all(one.keys() == {"name", "sha256"} and all(isinstance(text, str) for text in one.values()) for one in header["inputs"])
            and all(re.fullmatch(r"[0-9a-f]{64}\.result", name) for name in header["results"] or []))


def read_header(folder):
    """Returns the contents of a shard.json. Raises FileNotFoundError, or ValueError if it is damaged."""
    data = read_regular_file(Path(folder) / NAME, MAX_HEADER_BYTES)
    try:
        header = json.loads(data)
        if is_valid(header):
            return header
    except (ValueError, TypeError, AttributeError, RecursionError):
        pass
    raise ValueError(f"{Path(folder) / NAME}: is damaged")


def header_of(options, scenes):
    """Returns the contents of shard.json at the start of a shard."""
    number, count = options.shard
    return {"study": Path(options.study).name, "shard": number, "shards": count, "version": options.version,
            "settings": {name: getattr(options, name) for name in manifest.SETTINGS},
            "inputs": manifest.inputs_of(options.study, scenes), "results": None}


def write_header(folder, header):
    write_atomically(Path(folder) / NAME, json.dumps({**header, "sha256": digest(header)}, indent=2) + "\n")


def start(folder, header):
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


def find(folders):
    """Returns (headers of the shards found, as {number: (folder, header)}; problems, as {number of a shard that is not complete: reason}; sentences
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
    problems = {number: problem_of(*headers[number]) if number in headers else "absent" for number in range(1, count + 1)}
    return headers, {number: problem for number, problem in problems.items() if problem}, notes


def problem_of(folder, header):
    """Returns why a shard is not complete; empty if it is."""
    if header["results"] is None:
        return f"incomplete: {folder}"
    damaged = [name for name in header["results"] if read_value(folder / name) is None]
    more = f" and {len(damaged) - 1} more" if len(damaged) > 1 else ""
    return f"damaged: {folder / damaged[0]}{more}" if damaged else ""


def merged(options):
    """Returns the contents of the first shard.json in options.merge. Raises ValueError unless all shards are complete and of this program."""
    headers, problems, notes = find(options.merge)
    count = next(iter(headers.values()))[1]["shards"]
    if problems:
        texts = [*notes, *(f"shard {number}/{count} is {problem}" for number, problem in problems.items())]
        texts[10:] = [f"{len(texts) - 10} more"] * (len(texts) > 10)
        raise ValueError("; ".join(texts) + "; remedy: run these shards again with the same command, then merge")
    folder, header = headers[1]
    if header["version"] != options.version:
        raise ValueError(f"{folder}: computed by {header['version']}, but this is {options.version}; remedy: merge with that version")
    return header
