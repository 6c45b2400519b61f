"""clang and libclc, which stand in for the OpenCL compilers of NVIDIA and AMD."""
import hashlib, re, shutil, subprocess

INLINES = ["-mllvm", "-inline-threshold=1000000"]  # whatever it can, as compilers inside drivers do; what is left cannot be


class Clang:
    def __init__(self, program, libclc):
        self.program, self.libclc = program, libclc

    def lacking(self, library):
        """What is not there, with Debian's packages."""
        found = []
        if not shutil.which(self.program):
            found.append(f"{self.program} (Debian: clang-15)")
        if not (self.libclc / library).exists():
            found.append(f"{self.libclc / library} (Debian: libclc-15)")
        return found

    def version(self, library):
        said = subprocess.run([self.program, "--version"], capture_output=True, text=True).stdout
        number = re.search(r"version (\d+[.\d]*)", said)
        digest = hashlib.sha256((self.libclc / library).read_bytes()).hexdigest()[:8]
        return f"clang {number[1] if number else said.split(chr(10))[0]}; libclc {digest}"

    def preprocessed(self, folder, build, options):
        """The build's text as the compiler itself gets it; empty where it does not come so far."""
        done = subprocess.run([self.program, "-x", "cl", "-nogpulib", *options, *build["options"], "-E", "-P", str(folder / build["source"])], capture_output=True)
        return b"" if done.returncode else b"\n".join(filter(None, map(bytes.strip, done.stdout.splitlines())))

    def assembly(self, folder, build, library, options):
        """The text, and None; or None, and the compiler's first error."""
        to = folder / f"{build['source']}.{library}.s"
        done = subprocess.run([self.program, "-x", "cl", "-O3", *INLINES, "-nogpulib", "-Wno-linker-warnings", *options, *build["options"], "-Xclang",
                               "-mlink-builtin-bitcode", "-Xclang", str(self.libclc / library), "-S", "-o", str(to),
                               str(folder / build["source"])], capture_output=True, text=True)
        if done.returncode:
            return None, first_error(done.stderr)
        return to.read_text(), None


def first_error(text):
    return next((line for line in text.splitlines() if "error" in line or "fatal" in line), text.strip()[-300:] or "no word why")
