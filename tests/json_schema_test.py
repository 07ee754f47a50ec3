#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""json_schema.py: a value with one mistake each, and one without; and the schemas themselves."""

import json
import pathlib
import unittest

import json_schema

SCHEMAS = pathlib.Path(__file__).resolve().parent.parent / "docs" / "schemas"
SCHEMA = {
    "type": "object",
    "properties": {
        "schema": {"const": "a/1"},
        "count": {"type": "integer", "minimum": 0},
        "ratio": {"type": ["number", "null"]},
        "state": {"enum": ["good", "bad", None]},
        "axis": {"$ref": "#/$defs/axis"},
        "times": {"type": "object", "additionalProperties": {"type": "number"}},
        "either": {"anyOf": [{"type": "string"}, {"$ref": "#/$defs/axis"}]},
    },
    "required": ["schema", "count"],
    "$defs": {"axis": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}},
}
SOUND = {"schema": "a/1", "count": 3, "ratio": None, "state": "good", "axis": [0, 0.5, 1], "times": {"read": 1.5}, "either": "x"}


class JsonSchema(unittest.TestCase):
    def expect(self, change, message):
        value = {key: inner for key, inner in {**SOUND, **change}.items() if inner != "gone"}
        found = list(json_schema.problems(SCHEMA, value))
        self.assertEqual(len(found), 1, found)
        self.assertIn(message, found[0])

    def test_a_sound_value_has_no_problem(self):
        self.assertEqual(list(json_schema.problems(SCHEMA, SOUND)), [])
        self.assertEqual(list(json_schema.problems(SCHEMA, {"schema": "a/1", "count": 0})), [])

    def test_each_mistake_is_named(self):
        self.expect({"schema": "a/2"}, "schema is 'a/2', not 'a/1'")
        self.expect({"count": "gone"}, "lacks count")
        self.expect({"count": -1}, "below 0")
        self.expect({"count": 1.5}, "count is 1.5, no integer")
        self.expect({"count": True}, "no integer")
        self.expect({"ratio": "1"}, "ratio is '1', no number or null")
        self.expect({"state": "ugly"}, "none of")
        self.expect({"axis": [0, 1]}, "axis has 2 entries")
        self.expect({"axis": [0, 1, "2"]}, "axis[2] is '2', no number")
        self.expect({"times": {"read": None}}, "times.read is None")
        self.expect({"either": 3}, "either is 3")
        self.expect({"new": 3}, "new is not in the schema")

    def test_an_unknown_keyword_is_named(self):
        self.assertEqual(list(json_schema.strange_keywords({"properties": {"a": {"items": {"pattern": "x"}}}})),
                         ["the schema.a[]: the keyword pattern is not known"])

    def test_the_schemas_are_named_after_what_they_describe(self):
        files = sorted(SCHEMAS.glob("*.json"))
        self.assertGreaterEqual(len(files), 9)
        for file in files:
            schema = json.loads(file.read_text())
            name = file.name.removesuffix(".schema.json")
            self.assertEqual(list(json_schema.strange_keywords(schema)), [], name)
            self.assertEqual(schema["$schema"], "https://json-schema.org/draft/2020-12/schema")
            version = schema["$id"].rsplit(":", 1)[1]
            self.assertEqual(schema["$id"], f"urn:adit:schema:{name}:{version}")
            whole = [schema] if "properties" in schema else [
                schema["$defs"][one["$ref"].removeprefix("#/$defs/")] for one in schema["anyOf"]]
            for one in whole:
                self.assertEqual(one["properties"]["schema"]["const"], f"{name}/{version}")
                self.assertIn("schema", one["required"])


if __name__ == "__main__":
    unittest.main()
