"""Injects random faults into reports, which the schemas must refuse; for test_reports.py."""
import copy, random, re

# Optional members that are in all reports of this test by chance.
OPTIONAL = {"tune.json: results[].configuration.local_words", "tune.json: results[].configuration.batch",
            "tune.json: results[].configuration.lanes", "tune.json: results[].configuration.group"}
OPEN = re.compile(r"study\.json: (settings|tables\[\]\.rows\[\])")  # objects with any members, or with both strings and numbers
SIGNED = "length_exponent"  # may be negative; it is 0 in the test


def variant(value):
    """Text that identifies the variant of an object; the members of an object depend on its variant."""
    words = [value[key] for key in ("kind", "method", "status") if isinstance(value.get(key), str)]
    return f"<{words[0] if words else ''}{' torus' * ('torus' in value)}>"


def values_of(value, path):
    """Yields (path, container, key) of every value in a report, but only of the first and last item of a list."""
    if isinstance(value, dict):
        own = path + variant(value)
        for key in value:
            below = f"{own}.{key}"
            yield below, value, key
            yield from values_of(value[key], below)
    if isinstance(value, list) and value:
        for i in {0, len(value) - 1}:
            yield path + "[]", value, i
            yield from values_of(value[i], path + "[]")


def plain(path):
    """A path without variants: 'render.json: load.per_pe[]'"""
    return re.sub(r": \.+", ": ", re.sub(r"<[^>]*>", "", path))


class Damage:
    """Makes damaged copies of reports. Required members are found from the reports (those in every report), not from the schemas."""

    def __init__(self, made, seed):
        self.random, self.made, self.always, self.negative = random.Random(seed), made, {}, set()
        for form, _, report in made:
            for path, holder, key in values_of({"": report}, form + ": "):
                value = holder[key]
                if isinstance(value, dict):
                    own = path + variant(value)
                    self.always[own] = self.always.get(own, set(value)) & set(value)
                if isinstance(value, (int, float)) and value < 0:
                    self.negative.add(path)

    def random_damage(self):
        """(schema, description of the fault, damaged report), for a random fault at a random place; None if the fault is not possible there."""
        form, name, report = self.random.choice(self.made)
        root = {"": copy.deepcopy(report)}
        path, holder, key = self.random.choice(list(values_of(root, form + ": ")))
        value, kind = holder[key], self.random.choice(["drop", "other type", "unknown member", "negative"])
        open_ended = OPEN.match(plain(path))
        if kind == "drop" and isinstance(value, dict):
            always = [k for k in self.always[path + variant(value)] if not self.optional(path, k)]
            if open_ended or not always:
                return None
            key = self.random.choice(sorted(always))
            del value[key]
        elif kind == "unknown member" and isinstance(value, dict) and not open_ended:
            key = self.random.choice(["x", "Kind", "total ms", "u"])
            value[key] = self.random.choice([1, "text", None])
        elif kind == "other type" and not open_ended and value is not None:
            holder[key] = self.other(value)
        elif kind == "negative" and type(value) is int and path not in self.negative and not open_ended and key != SIGNED:
            holder[key] = -1 - value
        else:
            return None
        return form, f"{name}: {kind} at {plain(path)}, {key!r}", root[""]

    def optional(self, path, key):
        return plain(f"{path}.{key}") in OPTIONAL

    def other(self, value):
        if isinstance(value, (bool, str)):
            return self.random.choice([17, [value], {"": value}])
        if isinstance(value, (int, float)):
            return self.random.choice([str(value), [value], True])
        return self.random.choice(["text", 17, [value]])
