"""Stores results of renders in files, so that the studies of a run share them, a stopped run continues, and several processes divide the work.

A stored result is a dictionary of numpy arrays and JSON values. Its file has the SHA-256 of the contents in its first 32 bytes and is complete or
absent. Its name is a hash of the request, which must identify the result: scene, settings, and version of raya.
"""
import hashlib
import io
import json
import os
import tempfile
import time
from pathlib import Path

import numpy as np

SUFFIX, JSON_PART = ".result", "json"


def write_atomically(path, content):
    """Writes a file atomically: to a temporary file, which is then renamed."""
    data = content if isinstance(content, bytes) else content.encode()
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".raya-", suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(temporary, 0o666 & ~umask)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def bytes_of(value):
    """Returns {name: numpy array or JSON value} as bytes, the same for equal values."""
    arrays = {name: member for name, member in value.items() if isinstance(member, np.ndarray)}
    rest = json.dumps({name: member for name, member in value.items() if name not in arrays})
    buffer = io.BytesIO()
    np.savez(buffer, **arrays, **{JSON_PART: np.frombuffer(rest.encode(), np.uint8)})
    return hashlib.sha256(buffer.getvalue()).digest() + buffer.getvalue()


def read_bytes(path):
    """Returns the contents of a stored result without the hash; None if the file is absent or damaged."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return None
    return data[32:] if hashlib.sha256(data[32:]).digest() == data[:32] else None


def read_value(path):
    """Returns a stored result; None if the file is absent or damaged."""
    data = read_bytes(path)
    if data is None:
        return None
    with np.load(io.BytesIO(data), allow_pickle=False) as parts:
        return {**{name: parts[name] for name in parts.files if name != JSON_PART}, **json.loads(parts[JSON_PART].tobytes())}


class Store:
    """Results in `folder`. further: folders of which it only reads. version: text that identifies the program. shard: (I, N); get() then computes
    every N-th requested result, from the I-th on, and returns None."""

    def __init__(self, folder, further=(), version="", shard=None):
        self._folder, self._further, self._version, self._shard = Path(folder), [Path(one) for one in further], version, shard
        self._requests = {}  # {name: number of the request, in the order of first requests}
        self.names, self.computed = [], 0  # names of the files of this shard; number of results that get() computed

    def get(self, request, compute):
        """Returns the stored result of the request, or else stores and returns compute(). In a shard returns None."""
        name = hashlib.sha256(repr((self._version, request)).encode()).hexdigest() + SUFFIX
        is_new, number = name not in self._requests, self._requests.setdefault(name, len(self._requests))
        if self._shard is None:
            return self._read(name) or self._compute(name, compute)
        if is_new and number % self._shard[1] == self._shard[0] - 1:
            self.names.append(name)
            if read_bytes(self._folder / name) is None:
                self._compute(name, compute)
        return None

    def _read(self, name):
        values = (read_value(folder / name) for folder in (self._folder, *self._further))
        return next((value for value in values if value is not None), None)

    def _compute(self, name, compute):
        start = time.monotonic()
        value = compute()
        self.computed += 1
        write_atomically(self._folder / name, bytes_of(value))
        if self._shard:
            with open(self._folder / "seconds.csv", "a", encoding="utf-8") as log:
                log.write(f"{name},{time.monotonic() - start:.6f}\n")
        return value
