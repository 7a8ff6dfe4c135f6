"""What a study asks of a scene before it renders: which integrator it names, and whether light tracing can render it."""

import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from validation import tyndall
from validation.mitsuba import ROULETTE
from validation.scene import Scene

MEDIA = ("homogeneous", "heterogeneous")
SMOOTH = ("dielectric", "thindielectric", "conductor", "plastic")
"""No light walk that leaves these is joined with the lens."""
INTEGRATORS = ("bdpt", "pt", "lt", "fog", "path", "volpath", "volpathmis", "ptracer")


def tree(scene: Scene) -> dict[str, Any]:
    """The scene as one dictionary, parameters filled in, whichever way it is spelled."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        source, target = tyndall.scene_file(scene, Path(folder)), Path(folder, "converted.json")
        given = tyndall.definitions(scene.parameters)
        tyndall.call([str(tyndall.binary()), "convert", "--fill", *given, str(source), str(target)])
        return json.loads(target.read_text())


def objects(whole: Any) -> Iterator[dict[str, Any]]:
    """Everything in a scene that has a type, outer things first."""
    if isinstance(whole, dict) and "type" in whole:
        yield whole
    for child in whole.values() if isinstance(whole, dict) else whole if isinstance(whole, list) else ():
        yield from objects(child)


def path_integrator(whole: dict[str, Any], kind: str) -> dict[str, Any]:
    """Mitsuba's integrator `kind` with the depths that the scene's own has. Where that is one of ours, which has no
    Russian roulette, Mitsuba's begins late, which makes it less noisy than by its default."""
    own: dict[str, Any] = next((o for o in objects(whole) if o["type"] in INTEGRATORS), {"type": "path"})
    kept: dict[str, Any] = {key: own[key] for key in ("max_depth", "rr_depth", "hide_emitters") if key in own}
    ours: dict[str, Any] = {"rr_depth": ROULETTE[own.get("max_depth", -1) < 0]} if own["type"] in INTEGRATORS[:4] else {}
    return {"type": kind, **ours, **kept}


MITSUBAS_FILM = {"width": 768, "height": 576}
"""What a film has that does not say."""


def film_size(whole: dict[str, Any]) -> tuple[int, int] | None:
    """Width and height of the images of the scene's first sensor; None if there is none."""
    film = next((o for o in objects(whole) if o["type"].endswith("film")), None)
    if film is None:
        return None
    width, height = (int(film.get(f"crop_{side}", film.get(side, MITSUBAS_FILM[side]))) for side in ("width", "height"))
    return width, height


def light_tracing_applies(whole: dict[str, Any]) -> bool:
    """False where light tracing alone has no finite variance (a lens in a medium) or misses paths (smooth surfaces)."""
    named = {name for name, o in whole.items() if isinstance(o, dict) and o.get("type") in MEDIA}
    named |= {o["id"] for o in objects(whole) if o["type"] in MEDIA and "id" in o}
    sensors = [o for o in whole.values() if isinstance(o, dict) and "film" in "".join(o)]
    around = [part for o in sensors for part in o.values() if isinstance(part, dict)]
    within = any(part.get("type") in MEDIA or part.get("type") == "ref" and part.get("id") in named for part in around)
    return not within and not any(o["type"] in SMOOTH for o in objects(whole))
