"""Stores results of renders in files, so that the studies of a run share them, a stopped run continues, and several processes divide the work.

A stored result is a dictionary of numpy arrays and JSON values. Its file is complete or absent. The name is a hash of the request, which must identify
the result: scene, settings, and version of raya. The first 32 bytes are a hash of name and contents, so that no file passes for another.
"""
import hashlib
import json
import math
import os
import stat
import tempfile
import time
from pathlib import Path

import numpy as np

SUFFIX, MAX_BYTES = ".result", 1 << 30


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


def read_regular_file(path, limit):
    """Returns the bytes of a regular file. Raises FileNotFoundError, or ValueError for another kind of file and for more than `limit` bytes."""
    with open(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb") as file:  # without O_NONBLOCK, a pipe without a writer would wait
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode):
            raise ValueError(f"{path}: is not a regular file")
        if status.st_size > limit:
            raise ValueError(f"{path}: has more than {limit} bytes")
        return file.read(limit)


def bytes_of(name, value):
    """Returns the contents of the file `name` for {member: numpy array or JSON value}, the same for equal values: the SHA-256 of the name and of what
    follows; the length of a JSON, in 8 bytes; the JSON, with type and shape of each array; the numbers of the arrays."""
    arrays = [member for member in value.values() if isinstance(member, np.ndarray)]
    header = json.dumps({key: {"type": one.dtype.str, "shape": one.shape} if isinstance(one, np.ndarray) else {"value": one}
                         for key, one in value.items()}).encode()
    body = len(header).to_bytes(8, "little") + header + b"".join(array.tobytes() for array in arrays)
    return hashlib.sha256(name.encode() + body).digest() + body


def read_value(path):
    """Returns a stored result; None if the file is absent or damaged."""
    try:
        data = read_regular_file(path, MAX_BYTES)
        start = 40 + int.from_bytes(data[32:40], "little")
        if hashlib.sha256(path.name.encode() + data[32:]).digest() != data[:32]:
            return None
        value = {}
        for key, one in json.loads(data[40:start]).items():
            if "value" in one:
                value[key] = one["value"]
                continue
            kind, shape = np.dtype(one["type"]), tuple(one["shape"])
            count = math.prod(shape)
            if kind.kind not in "biuf" or min(shape, default=0) < 0 or start + count * kind.itemsize > len(data):
                return None
            value[key] = np.frombuffer(data, kind, count, start).reshape(shape)
            start += count * kind.itemsize
        return value if start == len(data) else None
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


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
            found = (read_value(folder / name) for folder in (self._folder, *self._further))
            return next((value for value in found if value is not None), None) or self._compute(name, compute)
        if is_new and number % self._shard[1] == self._shard[0] - 1:
            self.names.append(name)
            if read_value(self._folder / name) is None:
                self._compute(name, compute)
        return None

    def _compute(self, name, compute):
        start = time.monotonic()
        value = compute()
        self.computed += 1
        write_atomically(self._folder / name, bytes_of(name, value))
        if self._shard:
            with open(self._folder / "seconds.csv", "a", encoding="utf-8") as log:
                log.write(f"{name},{time.monotonic() - start:.6f}\n")
        return value
