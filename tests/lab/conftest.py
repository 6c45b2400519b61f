"""Adds the package `raya` of the build folder to the path. RAYA_BUILD names the build folder; default: build/."""
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(os.environ.get("RAYA_BUILD", Path(__file__).parents[2] / "build")) / "python"))
