"""No plugin goes unchecked: each one that Tyndall and Mitsuba share is in some cross-check scene."""

import json
import subprocess
import tempfile
import xml.etree.ElementTree as xml
from collections.abc import Iterator
from pathlib import Path

import mitsuba as mi

from validation.cases import CASES, Case
from validation.failure import Failure
from validation.tyndall import binary

PLUGIN_FOLDER = Path(mi.__file__).parent / "plugins"
QUESTIONS = (
    {"thing": {"type": "?"}},
    {"sensor": {"type": "perspective", "film": {"type": "hdrfilm", "rfilter": {"type": "?"}}}},
)
"""Scenes that each ask for a plugin that nobody has: what Tyndall answers lists those that it has."""
ELSEWHERE = {"heterogeneous", "constvolume", "gridvolume"}
"""Media that vary in space have scenes of their own once they are read; not of this table."""


def run() -> bool:
    """True if nothing is missing; says what is."""
    missing = sorted(shared() - covered() - ELSEWHERE)
    print(f"plugins that Mitsuba shares and no cross-check scene has: {', '.join(missing) or 'none'}")
    return not missing


def shared() -> set[str]:
    """The plugins that both renderers have."""
    ours = {name for question in QUESTIONS for name in answered(question)}
    return ours & {path.stem for path in PLUGIN_FOLDER.glob("*.*")}


def answered(question: dict) -> Iterator[str]:
    """The names that Tyndall's complaint about an unknown plugin gives."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        path = Path(folder, "question.json")
        path.write_text(json.dumps({"type": "scene", **question}))
        said = subprocess.run([str(binary()), "info", str(path)], capture_output=True, text=True).stderr
    _, found, names = said.partition("known: ")
    if not found:
        raise Failure(f"an unknown plugin was answered with: {said.strip()}", "let the message list what is known")
    return (name.strip() for name in names.split(","))


def covered() -> set[str]:
    """The plugins of all cross-check scenes, those that their files include among them."""
    return {name for case in CASES for name in plugins(case)}


def plugins(case: Case) -> Iterator[str]:
    """The types that one scene names."""
    scene = case.scene()
    return xml_types(scene.source, case.parameters) if scene.is_xml else json_types(scene.dictionary())


def json_types(tree) -> Iterator[str]:
    """Every `type` in a JSON tree."""
    children = tree.values() if isinstance(tree, dict) else tree if isinstance(tree, list) else ()
    if isinstance(tree, dict) and "type" in tree:
        yield tree["type"]
    for child in children:
        yield from json_types(child)


def xml_types(path: Path, parameters: dict[str, str]) -> Iterator[str]:
    """Every `type` in an XML file and in the files it includes."""
    for element in xml.parse(path).iter():
        if element.tag == "include":
            yield from xml_types(path.parent / element.get("filename"), parameters)
        named = element.get("type", "")
        yield parameters.get(named[1:], named) if named.startswith("$") else named
