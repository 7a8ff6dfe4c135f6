"""The six standing scenes: each shows something else, and Mitsuba renders all of them."""

from dataclasses import dataclass, field
from pathlib import Path

from validation.places import CROSSCHECK, SCENES
from validation.scene import Scene, open_scene
from validation.study.rivals import Size


@dataclass(frozen=True)
class Subject:
    """A scene to study and its size."""

    scene: Scene
    size: Size = None


@dataclass(frozen=True)
class Standing:
    """A subject by its file."""

    path: Path
    shows: str
    size: Size = None
    parameters: dict[str, str] = field(default_factory=dict)

    def subject(self) -> Subject:
        """The scene itself."""
        return Subject(open_scene(self.path, self.parameters), self.size)


SQUARE = (96, 96)
STANDING = (
    Standing(SCENES / "lampbox_down.xml", "a closed room of fog, lit directly", parameters={"res": "96"}),
    Standing(SCENES / "lampbox_up.xml", "the same room, all light indirect", parameters={"res": "96"}),
    Standing(CROSSCHECK / "grid_sparse.json", "puffs of smoke on a grid, lamp and sky", SQUARE),
    Standing(CROSSCHECK / "grid_dense_white.json", "a dense cloud that absorbs nothing", SQUARE),
    Standing(CROSSCHECK / "fog_chromatic.json", "extinction 1 : 3 : 10 between red, green and blue", SQUARE),
    Standing(SCENES / "foggy_room.json", "a glass ball and gold in a foggy room, two lamps", (128, 96)),
)


def standing() -> list[Subject]:
    """All of them."""
    return [one.subject() for one in STANDING]
