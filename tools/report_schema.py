"""Reads the schemas of docs/schema and resolves their references. Used by tools/report_doc and tests/tools/test_reports.py."""
import json
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "schema"


class Node:
    """A schema within a file, for example {"type": "integer"} at the JSON pointer /properties/walks of render.json."""

    def __init__(self, schemas, file, value, pointer=""):
        self.schemas, self.file, self.value, self.pointer = schemas, file, value, pointer

    def __getitem__(self, key):
        return Node(self.schemas, self.file, self.value[key], f"{self.pointer}/{key}")

    def get(self, key, default=None):
        return self.value[key] if self.has(key) else default

    def has(self, key):
        return isinstance(self.value, dict) and key in self.value

    def members(self):
        """Returns [(name, node)] of an object's members."""
        nodes = [(name, self["properties"][name]) for name in self.get("properties", {})]
        return [(name, node) for name, node in nodes if set(node.value) != {"required"}]  # a node with only "required" is a condition, not a definition

    def target(self):
        """Returns the node that $ref references; None without $ref."""
        if not self.has("$ref"):
            return None
        file, pointer = self.value["$ref"].split("#")
        node = self.schemas[file or self.file]
        for key in pointer.strip("/").split("/"):
            node = node[key]
        return node

    def walk(self):
        """Yields this node and all nodes below it; does not follow references."""
        yield self
        keys = self.value if isinstance(self.value, dict) else range(len(self.value))
        for key in keys:
            if isinstance(self.value[key], (dict, list)) and key != "examples":
                yield from self[key].walk()


def read_schemas(folder=FOLDER):
    """Returns {file name: root node}."""
    schemas = {}
    for path in sorted(Path(folder).glob("*.json")):
        schemas[path.name] = Node(schemas, path.name, json.loads(path.read_text()))
    return schemas
