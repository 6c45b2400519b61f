"""Runs `raya verify` in the CI of TheRock: build_tools/github_actions/test_executable_scripts/test_raya.py. RAYA is the program; a job unpacks the bundle
of a release (tools/bundle) or makes a light build. Its entry in test_matrix of fetch_test_configurations.py:

    "raya": {
        "job_name": "raya",
        "fetch_artifact_args": "--tests",
        "timeout_minutes": 15,
        "test_script": f"python {_get_script_path('test_raya.py')}",
        "platform": ["linux"],
        "total_shards": 2,
    },
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

depth = "--quick" if os.getenv("TEST_TYPE") == "smoke" else "--full"
shard = f"{os.getenv('SHARD_INDEX', '1')}/{os.getenv('TOTAL_SHARDS', '1')}"
expected = Path(__file__).with_name("raya_expect.txt")  # if it exists, checks that are known to fail: ID | reason | link
with tempfile.TemporaryDirectory() as folder:
    results = Path(folder, "results.json")
    command = [os.getenv("RAYA", "raya"), "verify", depth, "--shard", shard, "--timeout", "120", *(["--expect", str(expected)] if expected.exists() else [])]
    code = subprocess.run(command, env={**os.environ, "CL_CONFORMANCE_RESULTS_FILENAME": str(results)}).returncode
    if results.exists():
        failed = [name for name, result in json.loads(results.read_text())["results"].items() if result == "fail"]
        print("failed tests:", " ".join(failed) or "none")
sys.exit(code)
