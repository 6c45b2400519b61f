"""The resource budget of kernels: a file of recorded figures, with the versions of the compilers that made them."""
import csv

COLUMNS = ["kernel", "variant", "target", "width", "registers", "spills", "scalar_spills", "stack", "local"]
BOUNDED = ["registers", "spills", "scalar_spills", "stack", "local"]  # may exceed the budget by at most 5 %
VERSION = "# made for "
HEADER = "# GPU resources of kernels: written by `tools/gpu_check --write-budget`, do not edit. docs/porting.md defines the figures.\n"


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

    def applies_to(self, target, version):
        """Returns true if the budget of the target was made with this version of its compilers."""
        return self.versions.get(target) == version

    def faults(self, figures):
        """Yields a text for each figure that exceeds the budget."""
        row = self.rows.get(figures.key)
        if row is None:
            yield "has no budget"
            return
        if figures.width < int(row["width"]):
            yield f"threads of {figures.width} work-items, {row['width']} in the budget"
        for column in BOUNDED:
            figure, budget = getattr(figures, column), int(row[column])
            if figure > 1.05 * budget:
                yield f"{column.replace('_', ' ')}: {figure}, {budget} in the budget"

    def stale(self, found, targets):
        """Returns the names of the rows for these targets whose kernels no longer exist."""
        return sorted(name for name in set(self.rows) - found if name[2] in targets)

    def write(self, all_figures, versions, whole=True):
        """Writes the file with new figures. Keeps the rows of other targets. whole: all kernels were built; otherwise also keeps other kernels."""
        self.versions.update(versions)
        rows = {name: row for name, row in self.rows.items() if not whole or name[2] not in versions}
        rows.update({f.key: {key: getattr(f, key) for key in COLUMNS} for f in all_figures})
        lines = [HEADER, *(f"{VERSION}{target}: {version}\n" for target, version in self.versions.items()), ",".join(COLUMNS) + "\n"]
        lines += [",".join(str(row[key]) for key in COLUMNS) + "\n" for _, row in sorted(rows.items())]
        self.path.write_text("".join(lines))
