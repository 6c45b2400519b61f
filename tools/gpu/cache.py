"""Caches the figures of builds, because compilers for GPUs take minutes and most changes affect few kernels.

The key is a hash of everything that the figures depend on: the preprocessed source (without comments and code of other variants), the options, the
versions of the compilers, and the modules of this folder. A build with a fault is not cached.
"""
import dataclasses, hashlib, json, os
from pathlib import Path

from gpu.figures import Figures

CODE = b"".join(path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py")))


class Cache:
    def __init__(self, folder, vendors):
        """A cache in `folder`. Without a folder (None) every build is compiled."""
        self.folder, self.hits = folder, []
        self.versions = {vendor: vendor.version() for vendor in vendors}
        if folder:
            folder.mkdir(parents=True, exist_ok=True)

    def compile(self, vendor, folder, build, targets):
        """Returns (figures, faults): those of the cache, or the result of the vendor's compile(). Several threads call it."""
        source = self.folder and vendor.compiler_input(folder, build, targets)
        if not source:
            return vendor.compile(folder, build, targets)
        settings = json.dumps([self.versions[vendor], targets, {**build, "source": ""}]).encode()
        file = self.folder / (hashlib.sha256(b"\0".join([CODE, settings, source])).hexdigest() + ".json")
        hit = file.exists()
        self.hits.append(hit)
        if hit:
            return [Figures(**figures) for figures in json.loads(file.read_text())], []
        figures, faults = vendor.compile(folder, build, targets)
        figures = list(figures)
        if not faults:
            temporary = file.with_suffix(f".{os.getpid()}")
            temporary.write_text(json.dumps([dataclasses.asdict(f) for f in figures]))
            temporary.replace(file)
        return figures, faults
