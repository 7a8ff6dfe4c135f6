"""What a comparison cannot expect: light that one of its sides has no strategy for, such as a spot's caustic through glass, which
path tracing does not find. What is missing there is no fault."""

import json
from dataclasses import dataclass
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from tyndall.scene import Scene, load

MITSUBA = {"ptracer": "lt"}
"""Which of our methods reaches the light that Mitsuba's integrator does; the others are path tracers with next-event estimation, as
`pt` is."""
SOME = "some"


@dataclass(frozen=True)
class Reach:
    """The light that a method does not reach, in words, and the part of it that `bdpt` does."""

    unreached: dict[str, str]

    @staticmethod
    def of(plan: dict[str, Any]) -> "Reach":
        """By a plan of `tyndall info`."""
        return Reach({entry["light"]: entry["reached_by_bdpt"] for entry in plan["unreached"]})

    def beyond(self, other: "Reach", by_bdpt: bool) -> list[str]:
        """What this does not reach and the other one does; where that is `bdpt`, also what it reaches a part of."""
        partly = {light for light, part in self.unreached.items() if by_bdpt and part == SOME}
        return sorted((self.unreached.keys() - other.unreached.keys()) | partly)


def of(scene: Scene, method: str) -> Reach:
    """What `tyndall info` says of the scene; an error where it cannot be rendered so."""
    integrator, _, tracker = method.partition(":")
    options = program.flags({"integrator": integrator, "tracker": tracker or None})
    return Reach.of(plan(str(scene.source), *options, *program.definitions(scene.parameters)))


def plan(*words: str) -> dict[str, Any]:
    """What `tyndall info` by these words says will be done."""
    told: dict[str, Any] = json.loads(program.call([str(program.binary()), "info", "--json", *words]).stdout)["plan"]
    return told


def mitsubas(scene: Scene) -> str:
    """Our method that reaches what Mitsuba does."""
    types = [child.get("type") for child in load(scene).values() if isinstance(child, dict)]
    return next((MITSUBA[str(kind)] for kind in types if kind in MITSUBA), "pt")


def differences(scene: Scene, methods: list[str]) -> dict[str, list[str]]:
    """By method, what only one of both sides reaches. It asks of every method: whatever is wrong with the scene or a method is
    found here, before anything is rendered."""
    ours = {method: of(scene, method) for method in methods if method != "mitsuba"}
    theirs = of(scene, mitsubas(scene))
    return {method: between(ours[method], theirs, method) if method in ours else [] for method in methods}


def between(ours: Reach, theirs: Reach, method: str) -> list[str]:
    """What one side does not reach and the other does, as sentences."""
    is_bdpt = method.partition(":")[0] == "bdpt"
    mitsuba = [f"Mitsuba does not reach {light}" for light in theirs.beyond(ours, is_bdpt)]
    return mitsuba + [f"{method} does not reach {light}" for light in ours.beyond(theirs, False)]


KNOWN = ("pt", "lt", "bdpt", "mitsuba")


def methods(text: str) -> list[str]:
    """The methods of a command line; an error for what is none."""
    found = text.split(",")
    wrong = next((method for method in found if method.partition(":")[0] not in KNOWN), None)
    if wrong is not None:
        raise Failure(f"--integrators: there is no method {wrong!r}", f"name any of {', '.join(KNOWN)}, with a tracker as in pt:march if need be")
    return found
