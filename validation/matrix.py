"""Every cross-check scene through Mitsuba and through each of Tyndall's integrators that can render it."""

from dataclasses import dataclass

from validation import compare, references
from validation.compare import Effort, Verdict
from validation.places import CROSSCHECK, OUTPUT
from validation.scene import open_scene

ALL = ("pt", "lt", "bdpt")
EYE = ("pt", "bdpt")
"""For scenes where the camera sees a smooth dielectric or mirror: no light walk can reach the lens from there."""


@dataclass(frozen=True)
class Case:
    """A scene, who can render it, and its samples a pixel relative to the common number (cheap scenes take more)."""

    file: str
    methods: tuple[str, ...] = ALL
    effort: float = 1


CASES = (
    Case("camera_inside_cube.json"),
    Case("cube_in_room.json"),
    Case("five_lights.json", effort=4),
    Case("fog_blend.json"),
    Case("fog_chromatic.json"),
    Case("fog_hg_backward.json", effort=4),
    Case("fog_hg_forward.xml", effort=2),
    Case("fog_isotropic.json"),
    Case("fog_rayleigh_single.json", effort=4),
    Case("fog_schlick_table.json", effort=4),
    Case("fog_table_coarse.json", effort=2),
    Case("frosted_cube_of_fog.json"),
    Case("glass_ball_of_fog.json", EYE),
    Case("lamp_in_fog_ball.json", effort=4),
    Case("lit_albedo_one.json", effort=2),
    Case("mesh_of_smoke.json"),
    Case("mirror_in_fog.json", EYE),
    Case("nested_media.json"),
    Case("room_of_two_fogs.json"),
    Case("rough_metals.json"),
    Case("sky_over_cloud.json", effort=2),
    Case("sphere_chromatic.json"),
    Case("sun_through_smoke.json", effort=4),
    Case("textures_and_meshes.json"),
    Case("thin_pane.json", EYE),
    Case("two_sided_screen.json"),
    Case("vacuum_room.json"),
)


def run(effort: Effort, only: str = "") -> list[Verdict]:
    """Compares every case whose file name contains `only`, printing as it goes."""
    print(compare.HEADER, flush=True)
    verdicts = []
    for case in CASES:
        if only in case.file:
            verdicts += run_case(case, effort)
    failed = [v for v in verdicts if not v.passed]
    print(f"{len(verdicts) - len(failed)} of {len(verdicts)} comparisons agree; pictures are in {OUTPUT}")
    return verdicts


def run_case(case: Case, effort: Effort) -> list[Verdict]:
    """All comparisons of one scene."""
    scene = open_scene(CROSSCHECK / case.file)
    scaled = Effort(effort.batches, max(1, round(effort.spp * case.effort)), effort.seed)
    reference = references.cached(scene)
    verdicts = []
    for method in case.methods:
        candidate = compare.candidate_renderer(scene, method)
        verdicts.append(compare.compare(scene, method, scaled, reference, candidate, OUTPUT))
        print(verdicts[-1].row(), flush=True)
    return verdicts
