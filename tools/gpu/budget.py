"""What kernels may take: a file of the figures that they had, with the versions of the compilers that they are from."""
import csv

HEAD = ["kernel", "variant", "target", "width", "registers", "spills", "scalar_spills", "stack", "local"]
BOUNDED = ["registers", "spills", "scalar_spills", "stack", "local"]  # 5 % more are too much; of nothing, anything
VERSION = "# made for "
SAYS = "# What kernels take of GPUs: made by `tools/gpu_check --write-budget`, do not edit. docs/gpu_resources.md says what the figures are.\n"


class Budget:
    def __init__(self, path):
        self.path, self.versions, self.rows = path, {}, {}
        lines = path.read_text().splitlines() if path.exists() else []
        for line in lines:
            if line.startswith(VERSION):
                target, version = line.removeprefix(VERSION).split(": ", 1)
                self.versions[target] = version
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            self.rows[row["kernel"], row["variant"], row["target"]] = row

    def judges(self, target, version):
        return self.versions.get(target) == version

    def faults(self, figures):
        """What is above the budget, each with figure and budget."""
        row = self.rows.get(figures.name)
        if row is None:
            yield "has no budget"
            return
        if figures.width < int(row["width"]):
            yield f"runs {figures.width} work-items in step, {row['width']} in the budget"
        for what in BOUNDED:
            figure, most = getattr(figures, what), int(row[what])
            if figure > 1.05 * most:
                yield f"{what.replace('_', ' ')}: {figure}, {most} in the budget"

    def stale(self, found, targets):
        """Rows of kernels that are no more."""
        return sorted(name for name in set(self.rows) - found if name[2] in targets)

    def write(self, all_figures, versions, whole=True):
        """With what was found; the rest stays: of targets that were not looked at, and, where not all kernels were, of the others."""
        self.versions.update(versions)
        kept = {name: row for name, row in self.rows.items() if not whole or name[2] not in versions}
        kept.update({f.name: {key: getattr(f, key) for key in HEAD} for f in all_figures})
        lines = [SAYS, *(f"{VERSION}{target}: {version}\n" for target, version in self.versions.items()), ",".join(HEAD) + "\n"]
        lines += [",".join(str(row[key]) for key in HEAD) + "\n" for _, row in sorted(kept.items())]
        self.path.write_text("".join(lines))
