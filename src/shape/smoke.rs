//! `smoke`: what may be given to it. It is no shape of its own; the scene composes it of others.

use crate::{
    description::{Table, table},
    volume::{files::sequence::Clock, grid::HOTTEST},
};

/// The name of the plugin.
pub const SMOKE: &str = "smoke";

/// Brightness [1/m]: flames look like flames beside lights of about 1.
const EMISSION: f64 = 0.01;

/// What may be given to it.
pub const SMOKE_TABLE: Table = table! {
    "Smoke and fire out of a file of Blender, Houdini and the like, in a container of its own; grids are known by their names.";
    file("filename", "The .vdb, .nvdb or .vol file, or numbered ones: `smoke_####.vdb`, `smoke_%04d.vdb`."),
    number("fps", "1/s", within(1e-6, 1e9), Is(Clock::FPS), "Frames of numbered files in a second."),
    integer("first_frame", ANY, Said("the first that there is"), "The frame that is shown at the time 0."),
    number("scale", "", within(1e-30, 1e30), Is(1.0), "Size, about the origin of the file's world, before `to_world`."),
    transform("to_world", "Where it is."),
    number("density_scale", "1/m", within(0.0, MAX), Is(1.0), "Extinction of a density of 1."),
    number("emission_scale", "1/m", within(0.0, MAX), Is(EMISSION), "One metre of fire radiates so much of what a black body does; 0: no fire."),
    colour("albedo", "", 1.0, Said("0.75; 1 beside a grid of colours"), "Share of the extinction that is scattering; a factor on a grid of colours."),
    text("density_grid", "the name of a grid", Said("density, voxel_fog_density, or the only one"), "The grid of densities; \"\" takes none."),
    text("temperature_grid", "the name of a grid", Said("flame, flames, burn, heat or temperature"), "The grid of fire; \"\" takes none."),
    text("color_grid", "the name of a grid", Said("Cd, color, or three of a component each"), "The grid of colours; \"\" takes none."),
    number("temperature_scale", "K", within(0.0, HOTTEST), Said("1500 of flames, 1000 of other temperatures, 1 above 100"), "What a value of 1 adds to the temperature."),
    number("temperature_offset", "K", within(0.0, HOTTEST), Said("1500 of flames, else 0"), "Temperature of what barely burns."),
    boolean("level_set_to_fog", false, "Fills surfaces with fog."),
    nested("phase", Optional, "The phase function: `isotropic` where not given."),
    object("exterior", "medium", "The medium around it."),
};
