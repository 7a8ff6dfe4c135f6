"""The test of the test: Mitsuba must agree with itself, and must not with a scene that is 5 % off."""

from tyndall.scene import open_scene
from validation import compare, references
from validation.compare import Effort
from validation.places import CROSSCHECK

SCENES = ("fog_isotropic.json", "fog_hg_backward.json", "camera_inside_cube.json", "fog_table_coarse.json", "grid_trilinear.json")
PERTURBATION = 0.05


def run(effort: Effort) -> bool:
    """True if every scene is accepted as it is and refused when perturbed."""
    print(compare.HEADER, flush=True)
    return all([accepts(name, effort) & refuses(name, effort) for name in SCENES])


def accepts(name: str, effort: Effort) -> bool:
    """Mitsuba with other seeds."""
    scene = open_scene(CROSSCHECK / name)
    candidate = compare.candidate_renderer(scene, "mitsuba")
    verdict = compare.compare(scene, "itself", effort, references.cached(scene), candidate)
    print(verdict.row(), flush=True)
    return verdict.passed


def refuses(name: str, effort: Effort) -> bool:
    """Mitsuba with extinctions too great."""
    scene = open_scene(CROSSCHECK / name)
    candidate = compare.candidate_renderer(compare.perturbed(scene, PERTURBATION), "mitsuba")
    verdict = compare.compare(scene, "+5 %", effort, references.cached(scene), candidate)
    print(verdict.row(), flush=True)
    return not verdict.passed
