#!/usr/bin/env python3
"""Holds every #include of the project to what CONTRIBUTING.md says ("The house"): a folder includes what its row names, and
no other; headers do not go round in circles; what reports and models machines reaches no OpenCL; what is precompiled is
included all the same by what uses it; a type's name stands in one header, or two files that include one of them each would
link to one another's functions of it.
  test_includes.py [ROOT]"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
root = root if root.is_dir() else root.parents[2]
FOR_ALL = {"host/error.hpp", "host/embedded.hpp", "host/version.hpp"}
BARE = "kernels/number/"  # a folder that others copy: its files name each other without a path
# Headers that targets precompile (raya_precompile in CMake), and by what their use shows.
PRECOMPILED = {
    "CLI/CLI.hpp": r"\bCLI::(?!App\b|ParseError\b)",
    "algorithm": r"\bstd::(sort|stable_sort|find_if|all_of|any_of|none_of|count_if|copy_if|shuffle|is_sorted|min_element|max_element|minmax_element|upper_bound|lower_bound|stable_partition|ranges::\w)",
    "catch2/catch.hpp": r"\b(TEST_CASE|CHECK|REQUIRE|CAPTURE)\(",
    "filesystem": r"\bstd::filesystem\b",
    "fmt/core.h": r"\bfmt::",
    "functional": r"\bstd::function\b",
    "map": r"\bstd::map\b",
}
GIVEN_BY = {"fmt/format.h": "fmt/core.h", "fmt/ranges.h": "fmt/core.h"}
NO_OPENCL = ["host/base/", "host/image/", "host/model/", "host/report/", "host/scene/"]
faults = []


def table_rows(text):
    """(folders of the row, text of "may know") for each row of the table below "The house"."""
    house = text.split("## The house", 1)[1].split("\n## ", 1)[0]
    for line in house.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        names = re.findall(r"`([a-z_/]+/)`", cells[0])
        if len(cells) == 3 and names:
            first = names[0].split("/")[0] + "/"
            yield [name if name.startswith(first) else first + name for name in names], cells[2]


def full_name(name, known):
    """`cl/` in a row of the host's folders is host/cl/."""
    return name if name in known else "host/" + name


def may_know(rows):
    """{folder: the folders that it may include}; a folder may always include itself."""
    allowed, above = {}, []
    known = {folder for folders, _ in rows for folder in folders}
    for folders, text in rows:
        all_above, _, but = text.partition("but ")
        named = [full_name(name, known) for name in re.findall(r"`([a-z_/]+/)`", all_above)]
        for name in named:
            if name not in known and not name.startswith("tests/"):
                faults.append(f"CONTRIBUTING.md: {folders[0]} may know {name}, which has no row")
        may = set(named)
        if "everything" in text:
            may |= known | {"tests/reference/"}
        if "all above" in text:
            may |= set(above)
        may -= {full_name(name, known) for name in re.findall(r"`([a-z_/]+/)`", but)}
        for folder in folders:
            allowed[folder] = may | set(folders)
        above += folders
    return allowed


def includes():
    """{file: the project's files that it includes}, for host/, kernels/ and tests/."""
    found = {}
    for path in sorted(p for top in ("host", "kernels", "tests") for p in (root / top).rglob("*")):
        if path.suffix not in (".cpp", ".hpp", ".h", ".cl", ".clh"):
            continue
        name = path.relative_to(root).as_posix()
        found[name] = set()
        for line in path.read_text().splitlines():
            match = re.match(r'\s*#\s*include\s+"([^"]+)"', line)
            if not match or match[1] == "tests/paths.h":  # the build makes that one
                continue
            bare = name.startswith(BARE) and "/" not in match[1]
            target = f"{path.parent.relative_to(root).as_posix()}/{match[1]}" if bare else match[1]
            if (root / target).is_file():
                found[name].add(target)
            elif not name.startswith(BARE + "example/"):
                faults.append(f'{name}: #include "{match[1]}" is no path from the project\'s root')
    return found


def precompiled():
    """({file: precompiled headers that it uses}, {file: those that it includes itself})."""
    used, given = {}, {}
    for path in sorted(p for top in ("host", "tests") for p in (root / top).rglob("*.?pp")):
        name, text = path.relative_to(root).as_posix(), path.read_text()
        code = re.sub(r'//.*|"(?:[^"\\\n]|\\.)*"', "", re.sub(r"^\s*#.*", "", text, flags=re.M))
        used[name] = {header for header, use in PRECOMPILED.items() if re.search(use, code)}
        given[name] = {GIVEN_BY.get(header, header) for header in re.findall(r"#\s*include\s+<([^>]+)>", text)}
    return used, given


def missing(used, given, graph):
    found = []
    for name, headers in used.items():
        reached = set().union(*(given.get(file, set()) for file in reaches(graph, name) | {name}))
        found += [f"{name} uses <{header}> and does not include it" for header in sorted(headers - reached)]
    return found


def folder_of(name, folders):
    """The longest folder with a row that `name` lies in."""
    return max((folder for folder in folders if name.startswith(folder)), key=len, default=None)


def reaches(graph, start):
    seen, waiting = set(), [start]
    while waiting:
        for target in graph.get(waiting.pop(), ()):
            if target not in seen:
                seen.add(target)
                waiting.append(target)
    return seen


def faults_of(graph, allowed):
    found = []
    for name, targets in graph.items():
        folder = folder_of(name, allowed)
        if folder is None:
            if name.startswith(("host/", "kernels/")) and name not in FOR_ALL | {"host/main.cpp"}:
                found.append(f"{name}: its folder has no row in CONTRIBUTING.md")
            continue
        for target in sorted(targets - FOR_ALL):
            other = folder_of(target, allowed) or "/".join(target.split("/")[:2]) + "/"
            if not name.startswith("tests/") and other not in allowed[folder]:
                found.append(f"{name} includes {target}: {folder} may not know {other}")
    for name in graph:
        reached = reaches(graph, name)
        if name in reached:
            found.append(f"{name} includes itself on a way round")
        if name.startswith(tuple(NO_OPENCL)) and "host/cl/opencl.hpp" in reached:
            found.append(f"{name} reaches OpenCL's headers")
    return found


def types_of_headers():
    """(header, type) of all types that headers define in namespace raya itself."""
    found = []
    for folder in ("host", "tests"):
        for path in sorted((root / folder).rglob("*.hpp")):
            text = path.read_text()
            if re.search(r"^namespace raya \{", text, re.MULTILINE):
                names = re.findall(r"^(?:struct|class|enum class|enum) (\w+)\b[^;\n]*\{", text, re.MULTILINE)
                found += [(str(path.relative_to(root)), name) for name in names]
    return found


def named_twice(types):
    first = {}
    return [f"{header}: {name} is a type of {first[name]} too" for header, name in types if first.setdefault(name, header) != header]


# Includes that must be found: up the table, between neighbours that do not know each other, in a circle, OpenCL in a report.
PLANTED = [
    ("host/scene/scene.hpp", "host/ring/mapping.hpp", "may not know host/ring/"),
    ("host/torus/node_transfers.cpp", "host/ring/mapping.hpp", "may not know host/ring/"),
    ("kernels/number/lanes.clh", "kernels/number/number.clh", "on a way round"),
    ("host/report/table.hpp", "host/cl/opencl.hpp", "reaches OpenCL's headers"),
]


def main():
    rows = list(table_rows((root / "CONTRIBUTING.md").read_text()))
    allowed, graph = may_know(rows), includes()
    faults.extend(faults_of(graph, allowed))
    used, given = precompiled()
    faults.extend(missing(used, given, graph))
    if len(missing(used, {**given, "tests/cli/test_commands.cpp": set()}, graph)) == len(missing(used, given, graph)):
        faults.append("tests/cli/test_commands.cpp without its includes, and nobody says so")
    types = types_of_headers()
    faults.extend(named_twice(types))
    if not named_twice([*types, ("host/image/pixels.hpp", types[0][1])]):
        faults.append(f"two headers may define {types[0][1]}, and nobody says so")
    for name, target, fault in PLANTED:
        if name not in graph or target not in graph:
            faults.append(f"test_includes.py: {name} or {target} is gone; plant another fault")
        elif not any(fault in text for text in faults_of({**graph, name: graph[name] | {target}}, allowed)):
            faults.append(f"{name} may include {target}, and nobody says '{fault}'")
    print("\n".join(faults))
    arrows = sum(len(targets) for targets in graph.values())
    print(f"{len(graph)} files, {arrows} includes, {len(types)} types, {len(rows)} rows of folders: {len(faults)} faults; {len(PLANTED)} planted ones seen")
    return 1 if faults or len(graph) < 100 or len(rows) < 10 else 0


sys.exit(main())
