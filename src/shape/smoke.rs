//! `smoke`: what may be given to it. It is no shape of its own; the scene composes it of others.

use crate::{
    description::{Table, table},
    volume::{files::sequence::Clock, grid::HOTTEST},
};

/// The name of the plugin.
pub const SMOKE: &str = "smoke";

/// Brightness (1/m): flames look like flames beside lights of about 1.
const EMISSION: f64 = 0.01;

/// What may be given to it.
pub const SMOKE_TABLE: Table = table! {
    "Smoke and fire from a volume file of Blender, Houdini and the like, with a container of its own. Grids are recognised by name.";
    file("filename", "The .vdb, .nvdb or .vol file, or numbered files: `smoke_####.vdb`, `smoke_%04d.vdb`."),
    number("fps", "1/s", within(1e-6, 1e9), Is(Clock::FPS), "Numbered files per second."),
    integer("first_frame", ANY, Said("the first file"), "Number of the file that is shown at time 0."),
    choice("up", &["auto", "y", "z"], "auto", "Axis of the file that points up in the scene: +y there. `auto`: z of OpenVDB files that say that Blender wrote them, unless `to_world` rotates them or the camera has +z up; else y."),
    number("scale", "", within(1e-30, 1e30), Is(1.0), "Scale about the origin of the file's world, before `to_world`."),
    transform("to_world", "Position, orientation and size."),
    number("density_scale", "1/m", within(0.0, MAX), Is(1.0), "Extinction of a density of 1."),
    number("emission_scale", "1/m", within(0.0, MAX), Is(EMISSION), "Emission of a metre of fire relative to a black body; 0: no fire."),
    colour("albedo", "", 1.0, Said("0.75, or 1 with a grid of colours"), "Single-scattering albedo; multiplies a grid of colours."),
    text("density_grid", "the name of a grid", Said("density, voxel_fog_density, or the only one"), "The grid of densities; \"\" takes none."),
    text("temperature_grid", "the name of a grid", Said("flame, flames, burn, heat or temperature"), "The grid of fire; \"\" takes none."),
    text("color_grid", "the name of a grid", Said("Cd, color, or three grids of one component each"), "The grid of colours; \"\" takes none."),
    text("velocity_grid", "the name of a grid", Said("vel, velocity, v, motion or voxel_velocity"), "The grid of velocities (m/s, in the file's world), or what the names of three begin with; \"\" takes none. The smoke moves by it while the camera's shutter is open."),
    number("velocity_scale", "m/s", ANY, Said("1; of Blender's fluids 2.5 voxels, as they note voxels per 0.4 s"), "What a velocity of 1 in the file stands for."),
    number("temperature_scale", "K", within(0.0, HOTTEST), Said("1500 for flames; 1000 for other temperatures, or 1 if they exceed 100"), "Kelvin per unit of the grid."),
    number("temperature_offset", "K", within(0.0, HOTTEST), Said("1500 for flames, else 0"), "Temperature just above a value of 0."),
    text("group", "a name of 1 to 200 ASCII letters, digits and signs", Optional, "The light group of its fire: a layer of `--groups`."),
    boolean("level_set_to_fog", false, "Fills a level set with fog."),
    nested("phase", Optional, "The phase function; default: `isotropic`."),
    object("exterior", "medium", "The medium around it."),
};
