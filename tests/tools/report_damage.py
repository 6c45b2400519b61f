"""Faults that no report may have, planted at random; for test_reports.py."""
import copy, random, re

# In all reports of the test, and yet no member that every report has.
OPTIONAL = {"tune.json: results[].configuration.local_words", "tune.json: results[].configuration.batch",
            "tune.json: results[].configuration.lanes", "tune.json: results[].configuration.group"}
OPEN = re.compile(r"study\.json: (settings|tables\[\]\.rows\[\])")  # of any members, or of texts and numbers alike
SIGNED = "length_exponent"  # which is 0 in the test


def variant(value):
    """What kind of its kind an object is: other members are its own."""
    words = [value[key] for key in ("kind", "method", "status") if isinstance(value.get(key), str)]
    return f"<{words[0] if words else ''}{' torus' * ('torus' in value)}>"


def spots(value, path):
    """(path, holder, key) of every value in a report; of lists the first and the last."""
    if isinstance(value, dict):
        own = path + variant(value)
        for key in value:
            below = f"{own}.{key}"
            yield below, value, key
            yield from spots(value[key], below)
    if isinstance(value, list) and value:
        for i in {0, len(value) - 1}:
            yield path + "[]", value, i
            yield from spots(value[i], path + "[]")


def plain(path):
    """render.json: load.per_pe[]"""
    return re.sub(r": \.+", ": ", re.sub(r"<[^>]*>", "", path))


class Damage:
    """What every report has is known from the reports, not from the schemas."""

    def __init__(self, made, seed):
        self.random, self.made, self.always, self.negative = random.Random(seed), made, {}, set()
        for form, _, report in made:
            for path, holder, key in spots({"": report}, form + ": "):
                value = holder[key]
                if isinstance(value, dict):
                    own = path + variant(value)
                    self.always[own] = self.always.get(own, set(value)) & set(value)
                if isinstance(value, (int, float)) and value < 0:
                    self.negative.add(path)

    def one(self):
        """(form, what was done, the damaged report); None where the fault drawn cannot be planted there."""
        form, name, report = self.random.choice(self.made)
        root = {"": copy.deepcopy(report)}
        path, holder, key = self.random.choice(list(spots(root, form + ": ")))
        value, said = holder[key], self.random.choice(["drop", "other type", "unknown member", "negative"])
        open_ended = OPEN.match(plain(path))
        if said == "drop" and isinstance(value, dict):
            always = [k for k in self.always[path + variant(value)] if not self.optional(path, k)]
            if open_ended or not always:
                return None
            key = self.random.choice(sorted(always))
            del value[key]
        elif said == "unknown member" and isinstance(value, dict) and not open_ended:
            key = self.random.choice(["x", "Kind", "total ms", "u"])
            value[key] = self.random.choice([1, "text", None])
        elif said == "other type" and not open_ended and value is not None:
            holder[key] = self.other(value)
        elif said == "negative" and type(value) is int and path not in self.negative and not open_ended and key != SIGNED:
            holder[key] = -1 - value
        else:
            return None
        return form, f"{name}: {said} at {plain(path)}, {key!r}", root[""]

    def optional(self, path, key):
        return plain(f"{path}.{key}") in OPTIONAL

    def other(self, value):
        if isinstance(value, (bool, str)):
            return self.random.choice([17, [value], {"": value}])
        if isinstance(value, (int, float)):
            return self.random.choice([str(value), [value], True])
        return self.random.choice(["text", 17, [value]])
