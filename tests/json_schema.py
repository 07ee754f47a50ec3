# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What a JSON value has that its schema does not allow: the part of JSON Schema (draft 2020-12) that docs/schemas uses.

A keyword that is not known here is a problem, so that none is taken for one that is checked.
"""

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}
NOTES = {"$schema", "$id", "$defs", "title", "description"}
KEYWORDS = NOTES | {"$ref", "anyOf", "type", "const", "enum", "minimum", "minItems", "maxItems", "items", "properties",
                    "required", "additionalProperties"}


def is_a(value, name):
    if name in ("number", "integer"):
        return not isinstance(value, bool) and isinstance(value, (int, float)) and (name == "number" or value == int(value))
    return isinstance(value, TYPES[name])


def strange_keywords(schema, at="the schema"):
    """Keywords that are not known here, with their place."""
    if not isinstance(schema, dict):
        return
    for keyword, inner in schema.items():
        if keyword not in KEYWORDS:
            yield f"{at}: the keyword {keyword} is not known"
        if keyword in ("properties", "$defs"):
            for name, one in inner.items():
                yield from strange_keywords(one, f"{at}.{name}")
        elif keyword == "anyOf":
            for one in inner:
                yield from strange_keywords(one, at)
        elif keyword in ("items", "additionalProperties"):
            yield from strange_keywords(inner, f"{at}[]")


def problems(schema, value, at="", root=None):
    """What is wrong with the value, a line each. Keys that the schema does not list are wrong, too: programs are to
    ignore them, and the schema is to list all there are."""
    root = schema if root is None else root
    where = at or "the value"
    if "$ref" in schema:
        yield from problems(root["$defs"][schema["$ref"].removeprefix("#/$defs/")], value, at, root)
    if "anyOf" in schema:
        tried = [list(problems(one, value, at, root)) for one in schema["anyOf"]]
        if all(tried):
            yield from min(tried, key=len)
    if "const" in schema and value != schema["const"]:
        yield f"{where} is {value!r}, not {schema['const']!r}"
    if "enum" in schema and value not in schema["enum"]:
        yield f"{where} is {value!r}, none of {schema['enum']}"
    if "type" in schema:
        names = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        if not any(is_a(value, name) for name in names):
            yield f"{where} is {value!r}, no {' or '.join(names)}"
            return
    if "minimum" in schema and is_a(value, "number") and value < schema["minimum"]:
        yield f"{where} is {value}, below {schema['minimum']}"
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{where} has {len(value)} entries, not {schema.get('minItems')} to {schema.get('maxItems')}"
        for i, inner in enumerate(value):
            yield from problems(schema.get("items", {}), inner, f"{at}[{i}]", root)
    if isinstance(value, dict):
        yield from members(schema, value, at, root)


def members(schema, value, at, root):
    properties, more = schema.get("properties"), schema.get("additionalProperties")
    for name in schema.get("required", ()):
        if name not in value:
            yield f"{at or 'the value'} lacks {name}"
    for name, inner in value.items():
        path = f"{at}.{name}" if at else name
        if properties is not None and name in properties:
            yield from problems(properties[name], inner, path, root)
        elif isinstance(more, dict):
            yield from problems(more, inner, path, root)
        elif properties is not None:
            yield f"{path} is not in the schema"
