"""The scenes of `scenes/crosscheck/` and what can be asked of each."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from tyndall.scene import Scene, derived
from validation.places import CROSSCHECK

ALL = ("pt", "lt", "bdpt")
EYE = ("pt", "bdpt")
"""Light tracing alone has no finite variance where the camera stands in a medium (a vertex next to the lens counts
1 / distance^2), so no test can hold it to anything; and where the camera sees a smooth dielectric or mirror, or a
radiancemeter its one ray, no light walk reaches the lens. Through rough dielectric it has rare fireflies, too rare for batches to know their variance."""
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
    own: str = ""
    """A method of Tyndall's that stands in for Mitsuba, which has nothing like this scene."""
    trackers: tuple[str, ...] = ()
    """Those to force in turn, besides the one that Tyndall chooses; the quick matrix, for what starts at the camera: light tracing
    alone would see little of what they get wrong."""
    deep_trackers: tuple[str, ...] = ()
    """More of them for the deep matrix."""
    twin: str = ""
    """Another scene, whose picture must be the same: Mitsuba renders that one instead."""
    reference: str = ""
    """An integrator for Mitsuba instead of the scene's own; becomes part of the name."""

    def scene(self) -> Scene:
        """The scene under a name of its own."""
        path = CROSSCHECK / self.file
        folder = "" if path.parent == CROSSCHECK else f"{path.parent.name}-"
        name = "-".join([folder + path.stem, *self.parameters.values()])
        return self.with_reference(Scene(path, name, self.parameters))

    def truth(self) -> Scene:
        """What Mitsuba renders."""
        return replace(self, file=self.twin).scene() if self.twin else self.scene()

    def with_reference(self, scene: Scene) -> Scene:
        """The scene with the integrator that the case asks for."""
        if not self.reference:
            return scene
        integrator = lambda o: {**o, "type": self.reference} if o["type"] in ("volpath", "volpathmis") else o
        return replace(derived(scene, integrator), name=f"{scene.name}-{self.reference}")

    def all_methods(self, deep: bool = False) -> Iterator[str]:
        """Integrators, and integrators with each forced tracker."""
        yield from self.methods
        for tracker in (*self.trackers, *(self.deep_trackers if deep else ())):
            forced = [f"{method}:{tracker}" for method in self.methods if method in (ALL if deep else EYE)]
            yield from (method for method in forced if method not in self.methods)


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


OTHERS = ("march", "null_collision", "residual_ratio")
"""The trackers to force: the exact one of a grid, the closed form of a function, are what these get anyway."""


def grids() -> tuple[Case, ...]:
    """Media that vary in space."""
    return (
        Case("grid_albedo.json"),
        Case("grid_albedo_and_extinction.json"),
        Case("grid_albedo_alone.json"),
        Case("grid_blend.json"),
        Case("grid_all_over_the_room.json", EYE, effort=0.5),
        Case("grid_camera_inside.json", EYE, effort=0.5, trackers=OTHERS),
        Case("grid_chromatic.json", trackers=OTHERS),
        Case("grid_chromatic.json", ("bdpt",), reference="volpath"),
        Case("grid_chromatic_in_room.json", effort=0.5),
        Case("grid_constant.json", twin="cube_in_room.json"),
        Case(
            "grid_dense_white.json",
            (*ALL, "pt:march", "pt:null_collision", "bdpt:null_collision", "bdpt:residual_ratio"),
            deep_trackers=OTHERS,
        ),
        Case("grid_envmap.json"),
        Case("grid_in_frosted_cube.json", EYE, effort=2),
        Case("grid_in_glass.json", EYE, effort=0.7),
        Case("grid_lamp_inside.json"),
        Case("grid_nearest.json"),
        Case("grid_own_box.json"),
        Case("grid_point_light.json"),
        Case("grid_sheared.json"),
        Case("grid_sparse.json", trackers=OTHERS),
        Case("grid_sun_depth_4.json"),
        Case("grid_surfaces_inside.json"),
        Case("grid_trilinear.json", trackers=OTHERS),
        Case("grid_trilinear.json", ("bdpt",), reference="volpathmis"),
        Case("grid_two_containers.json"),
        Case("grid_within_fog.json"),
        Case("grid_wrap_modes.json"),
        Case("volume_constant.json", effort=2),
        Case("volume_constant_chromatic.json"),
    )


def functions() -> tuple[Case, ...]:
    """Media of density functions; Mitsuba renders them baked to grids, but for noise: numpy has no such table of
    gradients, so that one tracker is held against the others."""
    return (
        Case("function_cosine.json", trackers=OTHERS),
        Case("function_cosine_chromatic.json"),
        Case("function_equipotential.json"),
        Case("function_equipotential_sphere.json"),
        Case("function_exponential.json", trackers=OTHERS),
        Case("function_noise.json", ("pt:march", "lt:march", "bdpt"), own="pt:null_collision"),
        Case("function_polynomial.json"),
        Case("function_polynomial_zero.json"),
        Case("function_product.json", trackers=("march",)),
        Case("function_sum.json"),
        Case("function_wind.json"),
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
    Case("frosted_cube_of_fog.json", effort=2),
    Case("glass_ball_of_fog.json", EYE),
    Case("lamp_in_fog_ball.json", effort=2),
    Case("lit_albedo_one.json", effort=2),
    Case("mesh_of_smoke.json"),
    Case("mirror_in_fog.json", EYE),
    Case("nested_media.json"),
    Case("opening_lamps_outside.json", EYE, effort=2),
    Case("opening_sun.json", EYE, effort=2),
    Case("opening_lamp_inside.json", effort=2),
    Case("lantern_in_fog.json", EYE, effort=2),
    Case("fog_behind_walls.json", EYE),
    Case("lamp_without_exterior.json"),
    Case("room_of_two_fogs.json", EYE),
    Case("rough_metals.json", EYE),
    Case("sky_over_cloud.json", effort=2),
    Case("sphere_chromatic.json"),
    Case("sun_through_smoke.json", effort=2),
    Case("textures_and_meshes.json", EYE),
    Case("thin_pane.json", EYE),
    Case("two_sided_screen.json", EYE),
    Case("vacuum_room.json"),
    Case("sensor_batch.json"),
    Case("sensor_perspective.json"),
    Case("sensor_thinlens.json"),
    Case("sensor_thinlens_in_fog.json", EYE),
    Case("sensor_orthographic.json"),
    Case("sensor_orthographic_in_fog.json"),
    Case("sensor_radiancemeter.json", EYE, effort=100),
    Case("sensor_irradiancemeter.json", effort=100),
    Case("sensor_distant.json", effort=100),
    Case("sensor_distant_target.json", effort=100),
    Case("sensor_distant_ball.json", EYE, effort=100),
    Case("film_crop.json"),
    *filters(),
    Case("shapes_surfaces.json"),
    Case("shapes_instances.json"),
    Case("shapes_meshes.json"),
    Case("shapes_of_smoke.json"),
    Case("shapes_of_light.json"),
    Case("bsdf_plastics.json", EYE),
    Case("bsdf_mask_and_blend.json"),
    Case("bsdf_principled.json", EYE),
    Case("bsdf_normalmap.json", EYE),
    Case("bsdf_bumpmap.json"),
    Case("texture_mesh_attribute.json"),
    Case("texture_volume.json"),
    Case("bsdf_mask_of_fog.json", EYE),
    Case("bsdf_glass.json", EYE),
    Case("texture_options.json"),
    Case("texture_files.json"),
    Case("emitter_envmap.json"),
    Case("emitter_projector.json"),
    Case("emitter_spot.json", effort=2),
    Case("emitter_sunsky.json"),
    Case("emitter_timed_sunsky.json"),
    Case("emitter_on_null.json"),
    Case("emitter_textured_area.json", EYE),
    Case("emitter_directional_area.json", LIGHT),
    *grids(),
    *functions(),
    Case("phase_functions.json", effort=2),
    Case("phase_functions_tabulated.json", effort=2),
    Case("phase_microflakes.xml", effort=4, parameters={"depth": "2"}, trackers=("null_collision", "residual_ratio")),
    Case("phase_microflakes.xml", ("lt", "bdpt"), parameters={"depth": "6"}, own="pt"),
    Case("phase_felt.xml", effort=4, parameters={"depth": "2"}, trackers=("null_collision", "residual_ratio")),
    Case("phase_felt.xml", ("lt", "bdpt"), parameters={"depth": "6"}, own="pt"),
    Case("spectra.json"),
    Case("spectra_blackbody.json", variant="scalar_spectral"),
    Case("integrator_path.json"),
    Case("integrator_direct.json"),
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
