"""The scenes of `scenes/crosscheck/` and what can be asked of each."""

from dataclasses import dataclass, field

from validation.places import CROSSCHECK
from validation.scene import Scene

ALL = ("pt", "lt", "bdpt")
EYE = ("pt", "bdpt")
"""Light tracing alone has no finite variance where the camera stands in a medium (a vertex next to the lens counts
1 / distance^2), so no test can hold it to anything; and where the camera sees a smooth dielectric or mirror, no light
walk reaches the lens."""
LIGHT = ("lt", "bdpt")
"""Beams of parallel rays (`directionalarea`): no eye path can hit them nor sample a point that shines towards it, so
path tracing alone sees none of their light; Mitsuba renders them by its particle tracer."""


@dataclass(frozen=True)
class Case:
    """A scene, who can render it, and its samples a pixel relative to the common number (cheap scenes take more)."""

    file: str
    methods: tuple[str, ...] = ALL
    effort: float = 1
    parameters: dict[str, str] = field(default_factory=dict)
    """XML's $parameters; their values become part of the name."""
    variant: str = "scalar_rgb"
    """Mitsuba's."""

    def scene(self) -> Scene:
        """The scene under a name of its own."""
        path = CROSSCHECK / self.file
        folder = "" if path.parent == CROSSCHECK else f"{path.parent.name}-"
        name = "-".join([folder + path.stem, *self.parameters.values()])
        return Scene(path, name, self.parameters)


def filters() -> tuple[Case, ...]:
    """One scene by every reconstruction filter and, in passing, every sampler. The picture is smooth: Mitsuba's scalar
    variants look filters up in a table of 31 steps, which at a sharp edge is up to 0.015 of the contrast off. (And
    `ldsampler` appears here only: what it makes of walks through media differs from Mitsuba's other samplers.)"""
    pairs = {
        "box": "independent",
        "tent": "stratified",
        "gaussian": "multijitter",
        "mitchell": "orthogonal",
        "catmullrom": "ldsampler",
        "lanczos": "independent",
    }
    return tuple(
        Case("film_filters.xml", effort=0.7, parameters={"filter": filter, "sampler": sampler})
        for filter, sampler in pairs.items()
    )


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
    Case("sensor_perspective.json"),
    Case("sensor_thinlens.json"),
    Case("sensor_thinlens_in_fog.json", EYE),
    Case("sensor_orthographic.json"),
    Case("sensor_orthographic_in_fog.json"),
    Case("film_crop.json"),
    *filters(),
    Case("shapes_surfaces.json"),
    Case("shapes_meshes.json"),
    Case("shapes_of_smoke.json"),
    Case("shapes_of_light.json"),
    Case("bsdf_plastics.json", EYE),
    Case("bsdf_mask_and_blend.json"),
    Case("bsdf_mask_of_fog.json", EYE),
    Case("bsdf_glass.json", EYE),
    Case("texture_options.json"),
    Case("texture_files.json"),
    Case("emitter_envmap.json"),
    Case("emitter_projector.json"),
    Case("emitter_spot.json", effort=2),
    Case("emitter_textured_area.json", EYE),
    Case("emitter_directional_area.json", LIGHT),
    Case("phase_functions.json"),
    Case("spectra.json"),
    Case("spectra_blackbody.json", variant="scalar_spectral"),
    Case("integrator_path.json"),
    Case("integrator_ptracer.json"),
    Case("integrator_volpathmis.json"),
    Case("integrator_moment.json"),
    Case("integrator_aov.json"),
    Case("files/cellar/scene.xml", EYE, effort=2, parameters={"density": "0.2", "depth": "8"}),
    Case("files/aquarium/scene.xml", EYE),
    Case("files/stage/scene.xml", effort=2, parameters={"g": "-0.3"}),
    Case("files/greenhouse/scene.xml", effort=2, parameters={"alpha": "0.6"}),
    Case("files/observatory/scene.xml", EYE, parameters={"turn": "200"}),
)
