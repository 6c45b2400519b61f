"""The OpenCL implementations that tools/portability knows: how programs are started under each, and what those lack that are not here."""
import os, resource, shutil, subprocess, tempfile
from pathlib import Path

VENDORS = Path("/etc/OpenCL/vendors")
FETCHED = "implementations"  # folder of the build folder: what tools/portability --setup brings (tools/portability_setup.py)


class Implementation:
    """How programs are started under one implementation. `slow`: fewer cases. `lacking`: why it cannot run, and the remedy. `of_device`: its
    driver may be installed where its device is not. `budget`: seconds that one kernel may take to compile.

    `watches`: it looks for faults itself and tells them on stderr alone, its exit code is 0 all the same. raya writes nothing there as long
    as all is right, so any line there counts. (Not Oclgrind's --log: each OpenCL context empties that file.)
    """

    def __init__(self, name, variables=None, prefix=(), slow=False, lacking=None, watches=False, of_device=False, budget=60):
        self.name, self.prefix, self.slow, self.lacking, self.watches = name, list(prefix), slow, lacking, watches
        self.variables, self.of_device, self.budget = dict(variables or {}), of_device, budget

    def run(self, command, scratch, limit, more=None):
        """Exit code, None where it ran past `limit` seconds; stdout and stderr together; stdout; what `watches` found, or nothing."""
        # What the caller chose for himself, a CI job's pin to one implementation for instance, chooses nothing here.
        chosen = ("RAYA_", "POCL_", "OCL_ICD_", "OCLGRIND_", "RUSTICL_", "CL_CONFIG_")
        inherited = {k: v for k, v in os.environ.items() if not k.startswith(chosen)}
        caches = {"POCL_CACHE_DIR": str(scratch), "MESA_SHADER_CACHE_DIR": str(scratch)}
        variables = {**inherited, **caches, **self.variables, **(more or {})}
        try:
            done = subprocess.run(self.prefix + command, env=variables, capture_output=True, text=True, timeout=limit,
                                  errors="replace", stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired as late:
            return None, f"not done after {limit} s", "", self.found_by_itself((late.stderr or b"").decode(errors="replace"))
        return done.returncode, done.stdout + done.stderr, done.stdout, self.found_by_itself(done.stderr)

    def found_by_itself(self, stderr):
        """The first line, and how many more there are."""
        lines = [line.strip() for line in stderr.splitlines() if line.strip()] if self.watches else []
        return "" if not lines else lines[0] + (f" (and {len(lines) - 1} more lines)" if len(lines) > 1 else "")


def processor_seconds():
    """Of all programs that were run so far, and those that they started: what else the machine does is not in it."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def icd(name):
    return VENDORS / f"{name}.icd"


def variants_of(name, driver, lacking, variants):
    """`driver`: the .icd file; `variants`: what is added to the name, and the variables that make it."""
    return [Implementation(name + more, {"OCL_ICD_VENDORS": str(driver), **variables}, lacking=lacking) for more, variables in variants]


def known_implementations(build):
    """All that could run here, first those that are fast; `build`: the build folder."""
    unoptimised = (" -cl-opt-disable", {"RAYA_BUILD_OPTIONS": "-cl-opt-disable"})
    no_pocl = None if icd("pocl").exists() else "not installed (Debian: pocl-opencl-icd)"
    found = variants_of("PoCL", icd("pocl"), no_pocl, [
        ("", {}), (" loopvec", {"POCL_WORK_GROUP_METHOD": "loopvec"}), (" loops", {"POCL_WORK_GROUP_METHOD": "loops"}), unoptimised,
        (" basic", {"POCL_DEVICES": "basic"})])
    for name, file, variants in [("PoCL 3.0 (PyPI)", "pocl-3.0", [("", {})]), ("Intel CPU", "intel-cpu", [("", {}), unoptimised])]:
        driver = (build / FETCHED / f"{file}.icd").absolute()
        found += variants_of(name, driver, None if driver.exists() else "not set up (tools/portability --setup fetches it)", variants)
    # Unoptimised: Oclgrind 21.10 does not know all that the optimiser makes. Its build options are its own argument.
    found.append(Implementation("Oclgrind", prefix=["oclgrind", "--build-options", "-cl-opt-disable"], slow=True, watches=True,
                                lacking=None if shutil.which("oclgrind") else "not installed (Debian: oclgrind)"))
    # One lane: its compiler takes a minute for a kernel of 16.
    rusticl = {"OCL_ICD_VENDORS": str(icd("rusticl")), "RUSTICL_ENABLE": "llvmpipe", "RAYA_NUMBER_LANES": "1"}
    found.append(Implementation("rusticl llvmpipe", rusticl, slow=True, budget=300,
                                lacking=None if icd("rusticl").exists() else "not installed (Debian: mesa-opencl-icd)"))
    others = sorted(p for p in VENDORS.glob("*.icd") if p.stem not in ("pocl", "rusticl", "mesa"))
    found += [Implementation(p.stem, {"OCL_ICD_VENDORS": str(p)}, of_device=True) for p in others]
    if not any(word in p.stem.lower() for p in others for word in ("nvidia", "amd", "rocm", "intel", "gpu")):
        found.append(Implementation("GPU", lacking="no GPU's driver is installed"))
    return found


def note_missing_devices(implementations, raya):
    """A driver for a device that is not here, a GPU's for instance, is no fault."""
    for implementation in implementations:
        if implementation.of_device and implementation.run([raya, "devices"], tempfile.gettempdir(), 120)[0] == 3:
            implementation.lacking = "its driver is installed, and shows no device"
