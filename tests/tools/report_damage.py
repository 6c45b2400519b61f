"""Makes reports with random faults, which the schemas must refuse; for test_reports.py."""
import copy, random, re

# Optional members that are in all reports of this test by chance.
OPTIONAL = {"tune.json: results[].configuration.local_words", "tune.json: results[].configuration.batch",
            "tune.json: results[].configuration.lanes", "tune.json: results[].configuration.group"}
# Objects that accept any member, and lists of strings and numbers.
OPEN = re.compile(r"study\.json: (settings|tables\[\]\.rows\[\])|manifest\.json: packages$")
SIGNED = {"length_exponent", "paper", "ours", "ratio"}  # these members may be negative, also if they are not in the test's reports


def object_kind(value):
    """Returns a text that identifies the kind of an object; the members of an object depend on its kind."""
    kinds = [value[key] for key in ("kind", "method", "status") if isinstance(value.get(key), str)]
    return f"<{kinds[0] if kinds else ''}{' torus' * ('torus' in value)}>"


def values_of(value, path):
    """Yields (path, container, key) of every value in a report, but only of the first and last item of a list."""
    if isinstance(value, dict):
        object_path = path + object_kind(value)
        for key in value:
            member_path = f"{object_path}.{key}"
            yield member_path, value, key
            yield from values_of(value[key], member_path)
    if isinstance(value, list) and value:
        for i in {0, len(value) - 1}:
            yield path + "[]", value, i
            yield from values_of(value[i], path + "[]")


def without_kinds(path):
    """Returns the path without the kinds of objects: 'render.json: load.per_pe[]'"""
    return re.sub(r": \.+", ": ", re.sub(r"<[^>]*>", "", path))


class Damage:
    """Makes damaged copies of the reports `made`: [(schema, name, report)]. A member counts as required if every report has it."""

    def __init__(self, made, seed):
        self.random, self.made, self.required, self.negative = random.Random(seed), made, {}, set()
        for schema, _, report in made:
            for path, holder, key in values_of({"": report}, schema + ": "):
                value = holder[key]
                if isinstance(value, dict):
                    object_path = path + object_kind(value)
                    self.required[object_path] = self.required.get(object_path, set(value)) & set(value)
                if isinstance(value, (int, float)) and value < 0:
                    self.negative.add(path)

    def random_damage(self):
        """Returns (schema, description of the fault, damaged report) for a random fault of a random value; None if the value cannot have it."""
        schema, name, report = self.random.choice(self.made)
        root = {"": copy.deepcopy(report)}
        path, holder, key = self.random.choice(list(values_of(root, schema + ": ")))
        value, kind = holder[key], self.random.choice(["drop", "other type", "unknown member", "negative"])
        open_ended = OPEN.match(without_kinds(path))
        if kind == "drop" and isinstance(value, dict):
            required = [k for k in self.required[path + object_kind(value)] if not self.optional(path, k)]
            if open_ended or not required:
                return None
            key = self.random.choice(sorted(required))
            del value[key]
        elif kind == "unknown member" and isinstance(value, dict) and not open_ended:
            key = self.random.choice(["x", "Kind", "total ms", "u"])
            value[key] = self.random.choice([1, "text", None])
        elif kind == "other type" and not open_ended and value is not None:
            holder[key] = self.value_of_other_type(value)
        elif kind == "negative" and type(value) is int and path not in self.negative and not open_ended and key not in SIGNED:
            holder[key] = -1 - value
        else:
            return None
        return schema, f"{name}: {kind} at {without_kinds(path)}, {key!r}", root[""]

    def optional(self, path, key):
        return without_kinds(f"{path}.{key}") in OPTIONAL

    def value_of_other_type(self, value):
        if isinstance(value, (bool, str)):
            return self.random.choice([17, [value], {"": value}])
        if isinstance(value, (int, float)):
            return self.random.choice([str(value), [value], True])
        return self.random.choice(["text", 17, [value]])
