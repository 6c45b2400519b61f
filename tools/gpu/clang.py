"""clang and libclc, used instead of the OpenCL compilers of NVIDIA and AMD."""
import hashlib, re, shutil, subprocess
from pathlib import Path

SETUP = Path(__file__).resolve().parents[1] / "setup"
LLVM = subprocess.run([SETUP, "--llvm"], capture_output=True, text=True, check=True).stdout.strip()  # version of this system's LLVM: "15"

INLINE_OPTIONS = ["-mllvm", "-inline-threshold=1000000"]  # inline all calls that can be inlined, as the drivers' compilers do


class Clang:
    def __init__(self, program, libclc):
        self.program, self.libclc = program, libclc

    def missing(self, library):
        """Returns the programs and libraries that are not installed, with their Debian packages."""
        found = []
        if not shutil.which(self.program):
            found.append(f"{self.program} (Debian: clang-{LLVM})")
        if not (self.libclc / library).exists():
            found.append(f"{self.libclc / library} (Debian: libclc-{LLVM})")
        return found

    def version(self, library):
        output = subprocess.run([self.program, "--version"], capture_output=True, text=True).stdout
        number = re.search(r"version (\d+[.\d]*)", output)
        digest = hashlib.sha256((self.libclc / library).read_bytes()).hexdigest()[:8]
        return f"clang {number[1] if number else output.split(chr(10))[0]}; libclc {digest}"

    def preprocessed(self, folder, build, options):
        """Returns the build's preprocessed source, without blank lines; empty if the preprocessor fails."""
        done = subprocess.run([self.program, "-x", "cl", "-nogpulib", *options, *build["options"], "-E", "-P", str(folder / build["source"])],
                              capture_output=True)
        return b"" if done.returncode else b"\n".join(filter(None, map(bytes.strip, done.stdout.splitlines())))

    def assembly(self, folder, build, library, options):
        """Returns (assembly, None), or (None, the compiler's first error)."""
        output_file = folder / f"{build['source']}.{library}.s"
        done = subprocess.run([self.program, "-x", "cl", "-O3", *INLINE_OPTIONS, "-nogpulib", "-Wno-linker-warnings", *options, *build["options"],
                               "-Xclang", "-mlink-builtin-bitcode", "-Xclang", str(self.libclc / library), "-S", "-o", str(output_file),
                               str(folder / build["source"])], capture_output=True, text=True)
        if done.returncode:
            return None, first_error(done.stderr)
        return output_file.read_text(), None


def first_error(text):
    return next((line for line in text.splitlines() if "error" in line or "fatal" in line), text.strip()[-300:] or "without a message")
