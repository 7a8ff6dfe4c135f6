"""What the program says of the parameters of plugins, in its JSON Schema of scenes."""

import json
from functools import cache
from pathlib import Path
from typing import Any

from tyndall.program import binary, call

COLOUR_OR_VOLUME = {"$ref": "#/definitions/colour%20or%20volume"}


def row(plugin: str, parameter: str) -> dict[str, Any]:
    """How a parameter is described; empty for those that Tyndall has not."""
    return rows(binary(), plugin).get(parameter, {})


@cache
def rows(program: Path, plugin: str) -> dict[str, dict[str, Any]]:
    """The parameters of a plugin, whatever its kind: a `gaussian` is a filter or a phase function."""
    found = (definition["properties"] for key, definition in definitions(program).items() if key.endswith(f" {plugin}") and "properties" in definition)
    return {name: one for properties in found for name, one in properties.items()}


@cache
def definitions(program: Path) -> dict[str, Any]:
    """Those of the schema, by `kind plugin`."""
    found: dict[str, Any] = json.loads(call([str(program), "explain", "--schema"]).stdout)["definitions"]
    return found


def is_real(row: dict[str, Any]) -> bool:
    """True for a number that need not be whole. The schema has an `else` for keyframes, which whole numbers cannot have."""
    return "else" in row


def is_volume(row: dict[str, Any]) -> bool:
    """True for what may be a colour or a volume."""
    return COLOUR_OR_VOLUME in row.get("else", {}).get("allOf", [])
