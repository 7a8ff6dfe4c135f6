"""Where a guide may help: scenes lit through openings, rooms lit indirectly, the Cornell boxes of the founding thesis, a dense cloud; and
what is rendered in them without one."""

import json
from dataclasses import dataclass, field
from pathlib import Path

from tyndall.scene import Scene, load
from validation.places import EFFICIENCY, OUTPUT, SCENES

GALLERY = SCENES / "gallery"


@dataclass(frozen=True)
class Case:
    """A scene, as it is named in the table."""

    name: str
    scene: Path
    parameters: dict[str, str] = field(default_factory=dict)

    @property
    def stem(self) -> str:
        """The name without what explains it."""
        return self.name.split()[0].strip(":")

    def file(self) -> Path:
        """The scene with its parameters filled in."""
        path = OUTPUT / "guide-scenes" / f"{self.stem}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(load(Scene(self.scene, self.name, self.parameters))))
        return path


def cases(*scenes: Path) -> list[Case]:
    """Scenes as they are."""
    return [Case(scene.stem, scene) for scene in scenes]


CASES = {
    "lit through an opening": cases(
        *(EFFICIENCY / f"{name}.xml" for name in ("small_opening", "keyhole", "door_ajar", "skylight", "dusty_window")), GALLERY / "attic.json"
    ),
    "lit indirectly": [
        Case("indirect_room (fig. 5.15)", GALLERY / "indirect_room.json"),
        Case("reflector (fig. 5.14)", GALLERY / "reflector.json"),
        *cases(GALLERY / "three_lights.json", SCENES / "lampbox_up.xml"),
    ],
    "P03T's boxes": [
        Case("A: empty", GALLERY / "cornell_d.json", {"medium": "0"}),
        Case("B: blocks", GALLERY / "cornell_e.json", {"medium": "0"}),
        Case("C: a glossy block", GALLERY / "cornell_e.json", {"medium": "0", "glossy": "1"}),
        Case("D: fog in a half", GALLERY / "cornell_d.json"),
        Case("E: blocks in fog", GALLERY / "cornell_e.json"),
        Case("F: fog that scatters forwards", GALLERY / "cornell_f.json"),
    ],
    "dense cloud": cases(GALLERY / "cumulus.json"),
    "lit openly": [Case("floating_cubes (fig. 5.23)", GALLERY / "floating_cubes.json")],
}
KINDS = {"lit through an opening": 5.0, "lit indirectly": 2.0, "P03T's boxes": 0.9, "dense cloud": 1.5, "lit openly": 0.9}
WANTED = {case.stem: KINDS[kind] for kind, some in CASES.items() for case in some}
"""How many times as efficient as without one `bdpt` shall be with a guide."""
OTHERS = {
    "no guide": "--integrator bdpt --starts emitted --guide never",
    "starts only": "--integrator bdpt --guide never",
    "pt": "--integrator pt",
    "pt guided": "--integrator pt --guide auto",
    "gather": "--integrator gather",
}


def scenes() -> list[Path]:
    """All of them."""
    return [case.file() for some in CASES.values() for case in some]
