"""Every cross-check scene through Mitsuba and through each of Tyndall's integrators that can render it."""

from dataclasses import dataclass

from validation import compare, references
from validation.compare import Effort
from validation.places import CROSSCHECK, OUTPUT
from validation.scene import open_scene

ALL = ("pt", "lt", "bdpt")
EYE = ("pt", "bdpt")
"""Light tracing alone has no finite variance where the camera stands in a medium (a vertex next to the lens counts
1 / distance^2), so no test can hold it to anything; and where the camera sees a smooth dielectric or mirror, no light
walk reaches the lens."""


@dataclass(frozen=True)
class Case:
    """A scene, who can render it, and its samples a pixel relative to the common number (cheap scenes take more)."""

    file: str
    methods: tuple[str, ...] = ALL
    effort: float = 1


CASES = (
    Case("camera_inside_cube.json", EYE),
    Case("cube_in_room.json"),
    Case("five_lights.json", effort=4),
    Case("fog_blend.json", EYE),
    Case("fog_chromatic.json", EYE),
    Case("fog_hg_backward.json", EYE, effort=4),
    Case("fog_hg_forward.xml", EYE, effort=2),
    Case("fog_isotropic.json", EYE),
    Case("fog_rayleigh_single.json", EYE, effort=4),
    Case("fog_schlick_table.json", EYE, effort=4),
    Case("fog_table_coarse.json", EYE, effort=2),
    Case("frosted_cube_of_fog.json", effort=6),
    Case("glass_ball_of_fog.json", EYE),
    Case("lamp_in_fog_ball.json", effort=4),
    Case("lit_albedo_one.json", effort=2),
    Case("mesh_of_smoke.json"),
    Case("mirror_in_fog.json", EYE),
    Case("nested_media.json"),
    Case("room_of_two_fogs.json", EYE),
    Case("rough_metals.json", EYE),
    Case("sky_over_cloud.json", effort=2),
    Case("sphere_chromatic.json"),
    Case("sun_through_smoke.json", effort=4),
    Case("textures_and_meshes.json", EYE),
    Case("thin_pane.json", EYE),
    Case("two_sided_screen.json", EYE),
    Case("vacuum_room.json"),
)


def run(effort: Effort, only: str = "") -> bool:
    """Compares every case whose file name contains `only`, printing as it goes; true if all agree."""
    print(compare.HEADER, flush=True)
    passed = [one for case in CASES if only in case.file for one in run_case(case, effort)]
    print(f"{sum(passed)} of {len(passed)} comparisons agree; pictures are in {OUTPUT}")
    return all(passed)


def run_case(case: Case, effort: Effort) -> list[bool]:
    """All comparisons of one scene: which of them agree."""
    scene = open_scene(CROSSCHECK / case.file)
    scaled = Effort(effort.batches, max(1, round(effort.spp * case.effort)), effort.seed)
    reference = references.cached(scene)
    return [compare.tested(scene, method, scaled, reference, OUTPUT) for method in case.methods]
