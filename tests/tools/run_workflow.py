#!/usr/bin/env python3
"""Runs a GitHub Actions workflow of docs/ci on this machine, as near to GitHub as possible: every step, in order, in a copy of the sources.

    tests/tools/run_workflow.py WORKFLOW.yml [JOB...]     default: all jobs. VARIABLE=VALUE in the environment of the steps: --set VARIABLE=VALUE

Jobs run one after another, once for each value of their matrix; each starts with an empty folder. Actions are replaced by copies of files: checkout,
cache, upload-artifact, download-artifact. apt-get only prints its arguments, so this machine must have the packages. The folder /tmp of the
workflow is a new one. The environment has no variables of the caller, except PATH. At the end: the text of GITHUB_STEP_SUMMARY.
Exit codes: 0 all steps are right; 1 a step failed; 2 bad options.
"""
import argparse, glob, itertools, os, re, shutil, subprocess, sys, tempfile, time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STUBS = {"apt-get": 'echo "apt-get $*: not run here"', "sudo": 'exec "$@"'}


def copy_sources(target):
    """Copies the files that git does not ignore."""
    listed = subprocess.run(["git", "ls-files", "-coz", "--exclude-standard"], cwd=ROOT, capture_output=True, check=True).stdout
    for name in filter(None, listed.decode().split("\0")):
        if (ROOT / name).exists():
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, target / name, follow_symlinks=False)


class LocalRun:
    def __init__(self, workflow, scratch, variables=None):
        import yaml
        self.work, self.store, self.variables = scratch / "work", scratch / "store", dict(variables or {})
        self.summary, self.steps = scratch / "summary.md", []  # steps: (job, step, exit code, seconds)
        self.data = yaml.safe_load(workflow.replace("/tmp/", f"{scratch}/tmp/"))
        scratch.chmod(0o755)  # some tests run raya as another user
        for folder in ("tmp", "home", "store", "stubs"):
            (scratch / folder).mkdir()
        self.summary.touch()
        for name, text in STUBS.items():
            (scratch / "stubs" / name).write_text(f"#!/bin/sh\n{text}\n")
            (scratch / "stubs" / name).chmod(0o755)
        self.environment = {"PATH": f"{scratch}/stubs:{os.environ['PATH']}", "HOME": f"{scratch}/home", "CI": "true", "GITHUB_ACTIONS": "true",
                            "GITHUB_STEP_SUMMARY": str(self.summary), "GITHUB_WORKSPACE": str(self.work)}

    def run(self, jobs=()):
        """Runs the jobs, by default all. Returns True if all steps are right."""
        for name, job in self.data["jobs"].items():
            if jobs and name not in jobs:
                continue
            matrix = {key: values for key, values in job.get("strategy", {}).get("matrix", {}).items()}
            for values in itertools.product(*matrix.values()):
                self.run_job(name, job, dict(zip(matrix, values)))
        return all(code == 0 for _, _, code, _ in self.steps)

    def run_job(self, name, job, values):
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir()
        title = " ".join([name, *map(str, values.values())])
        failed, caches = False, []
        for step in job["steps"]:
            if failed and step.get("if") != "always()":
                continue
            start = time.monotonic()
            label = step.get("name") or step.get("uses") or step["run"]
            print(f"--- {title}: {label}", flush=True)
            code = self.action(step, values, caches) if "uses" in step else self.script(step, job, values)
            failed = failed or code != 0
            self.steps.append((title, label, code, time.monotonic() - start))
        for path, saved in caches:
            if Path(path).exists():
                shutil.copytree(path, saved, dirs_exist_ok=True)

    @staticmethod
    def expanded(text, values):
        return re.sub(r"\$\{\{ (?:matrix\.(\w+)|github\.sha) \}\}", lambda found: str(values[found[1]]) if found[1] else "0" * 40, text)

    def action(self, step, values, caches):
        name, options = step["uses"].split("@")[0], {key: self.expanded(str(value), values) for key, value in step.get("with", {}).items()}
        if name == "actions/checkout":
            copy_sources(self.work)
            for command in ("init -q", "add -A"):  # tests list the files with git
                subprocess.run(["git", *command.split()], cwd=self.work, check=True)
        elif name == "actions/cache":
            saved = self.store / "cache" / options["restore-keys"]
            if saved.exists():
                shutil.copytree(saved, options["path"], dirs_exist_ok=True)
            caches.append((options["path"], saved))
        elif name == "actions/download-artifact":
            shutil.copytree(self.store / "artifacts" / options["name"], self.work, dirs_exist_ok=True)
        elif name == "actions/upload-artifact":
            folder = self.store / "artifacts" / options["name"]
            folder.mkdir(parents=True, exist_ok=True)
            found = [file for pattern in options["path"].split() for file in glob.glob(str(self.work / pattern))]
            for file in found:
                shutil.copy2(file, folder)
            if not found:
                print(f"warning: no files to upload: {options['path']}")
        else:
            raise ValueError(f"unknown action {name}")
        return 0

    def script(self, step, job, values):
        bash = self.data.get("defaults", {}).get("run", {}).get("shell") == "bash"
        options = ["--noprofile", "--norc", "-eo", "pipefail"] if bash else ["-e"]
        variables = {**self.environment, **self.data.get("env", {}), **job.get("env", {}), **step.get("env", {}), **self.variables}
        command = ["bash", *options, "-c", self.expanded(step["run"], values)]
        return subprocess.run(command, cwd=self.work, env={key: str(value) for key, value in variables.items()}, stdin=subprocess.DEVNULL).returncode


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("workflow", type=Path)
    parser.add_argument("jobs", nargs="*")
    parser.add_argument("--set", action="append", default=[], metavar="VARIABLE=VALUE")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        run = LocalRun(options.workflow.read_text(), Path(scratch), dict(pair.split("=", 1) for pair in options.set))
        is_right = run.run(options.jobs)
        print(run.summary.read_text())
        for job, step, code, seconds in run.steps:
            print(f"{job}: {step}: exit code {code}, {seconds:.0f} s")
    return 0 if is_right else 1


if __name__ == "__main__":
    sys.exit(main())
