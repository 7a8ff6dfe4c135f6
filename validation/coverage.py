"""No plugin goes unchecked: each one that Tyndall and Mitsuba share is in some cross-check scene."""

import json
import subprocess
import tempfile
import xml.etree.ElementTree as xml
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tyndall.failure import Failure
from tyndall.program import binary
from validation import mitsuba
from validation.cases import CASES, Case
from validation.contender import objects

PLACES = (
    lambda plugin: {"thing": plugin},
    lambda plugin: {"sensor": {"type": "perspective", "film": {"type": "hdrfilm", "rfilter": plugin}}},
    lambda plugin: {"sensor": {"type": "perspective", "film": {"type": "hdrfilm"}, "sampler": plugin}},
)
"""Scenes that hold a plugin, of whatever kind it is, where it may stand."""
UNKNOWN = "unicorn"


def run() -> bool:
    """True if nothing is missing; says what is."""
    missing = sorted(shared() - covered())
    print(f"plugins that Mitsuba shares and no cross-check scene has: {', '.join(missing) or 'none'}")
    return not missing


def shared() -> set[str]:
    """The plugins that both renderers have."""
    if any(known(UNKNOWN, place) for place in PLACES):
        raise Failure("tyndall info does not refuse a plugin that nobody has", "see how it words that now, and adapt `known`")
    theirs = {path.stem for path in Path(mitsuba.package().__file__).parent.glob("plugins/*.*")}
    return {name for name in theirs if any(known(name, place) for place in PLACES)}


def known(name: str, place: Callable[[dict[str, Any]], dict[str, Any]]) -> bool:
    """True unless Tyndall complains of this very name, or of the plugin out of place. Whatever else it says of so poor a
    scene, it knows the plugin."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        path = Path(folder, "question.json")
        path.write_text(json.dumps({"type": "scene", **place({"type": name})}))
        said = subprocess.run([str(binary()), "info", str(path)], capture_output=True, text=True).stderr
    return not any(complaint in said for complaint in (f'found "{name}"', f'the plugin "{name}"'))


def covered() -> set[str]:
    """The plugins of all cross-check scenes, those that their files include among them."""
    return {name for case in CASES for name in plugins(case)}


def plugins(case: Case) -> Iterator[str]:
    """The types that one scene names."""
    scene = case.scene()
    if isinstance(scene.source, Path) and scene.is_xml:
        return xml_types(scene.source, case.parameters)
    return (o["type"] for o in objects(scene.dictionary()))


def xml_types(path: Path, parameters: dict[str, str]) -> Iterator[str]:
    """Every `type` in an XML file and in the files it includes."""
    for element in xml.parse(path).iter():
        if element.tag == "include":
            yield from xml_types(path.parent / element.get("filename", ""), parameters)
        named = element.get("type", "")
        yield parameters.get(named[1:], named) if named.startswith("$") else named
