"""Adds the package `raya` of the build folder to the path. The build folder is RAYA_BUILD, by default build/ of this checkout."""
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(os.environ.get("RAYA_BUILD", Path(__file__).parents[2] / "build")) / "python"))
