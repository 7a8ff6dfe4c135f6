"""The test of the test: Mitsuba must agree with itself, and must not with a scene that is 5 % off."""

from tyndall.scene import open_scene
from tyndall import judging
from validation import compare, references
from validation.compare import Effort
from validation.places import CROSSCHECK

SCENES = ("fog_isotropic.json", "fog_hg_backward.json", "camera_inside_cube.json", "fog_table_coarse.json", "grid_trilinear.json")
PERTURBATION = 0.05


def run(effort: Effort) -> bool:
    """True if every scene is accepted as it is and refused when perturbed."""
    print(judging.HEADER, flush=True)
    return all([agrees(name, 0, effort) & (not agrees(name, PERTURBATION, effort)) for name in SCENES])


def agrees(name: str, perturbation: float, effort: Effort) -> bool:
    """Mitsuba with other seeds, and with extinctions too great by this part."""
    scene = open_scene(CROSSCHECK / name)
    candidate = compare.candidate_renderer(compare.perturbed(scene, perturbation) if perturbation else scene, "mitsuba")
    verdict = compare.compare(scene, f"+{100 * perturbation:g} %" if perturbation else "itself", effort, references.cached(scene), candidate)
    print(verdict.row(), flush=True)
    return verdict.passed
