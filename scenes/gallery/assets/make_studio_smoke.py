"""Simulates the smoke of ../studio_smoke.json in Blender 5.0, one fine frame and a coarse sequence, and shapes its backdrop:

    blender --background --python make_studio_smoke.py
"""

import math
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import openvdb

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from mesh import Mesh  # noqa: E402

DOMAIN = (1.5, 1.5, 2.5)
"""Metres, +z up, on the ground."""
BALL = (0.95, 0.34)
"""The height and radius of the ball that smoke flows around (m)."""


def modifier(shape, kind):
    """The settings of the part that a shape plays in a simulation."""
    fluid = shape.modifiers.new("Fluid", "FLUID")
    fluid.fluid_type = kind
    return getattr(fluid, f"{kind.lower()}_settings")


def domain(resolution, frames, cache):
    """The box of the simulation, open on all sides but the ground."""
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, DOMAIN[2] / 2))
    box = bpy.context.object
    box.scale = DOMAIN
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    settings = modifier(box, "DOMAIN")
    settings.domain_type, settings.resolution_max = "GAS", resolution
    settings.cache_type, settings.cache_directory, settings.cache_data_format = "ALL", cache, "OPENVDB"
    settings.cache_frame_start, settings.cache_frame_end = 1, frames
    settings.alpha, settings.beta, settings.vorticity = 0.6, 2.2, 0.35
    for side in ("left", "right", "front", "back", "top"):
        setattr(settings, f"use_collision_border_{side}", False)
    return box


def sources():
    """Three hot puffs that turn about each other, and the ball."""
    for angle in (0, 2 * math.pi / 3, 4 * math.pi / 3):
        x, y = math.cos(angle), math.sin(angle)
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.07, location=(0.22 * x, 0.22 * y, 0.12))
        flow = modifier(bpy.context.object, "FLOW")
        flow.flow_type, flow.flow_behavior, flow.temperature = "SMOKE", "INFLOW", 1.6
        flow.use_initial_velocity, flow.velocity_coord = True, (-0.5 * y, 0.5 * x, 0.9)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=BALL[1], location=(0, 0, BALL[0]), segments=48, ring_count=24)
    modifier(bpy.context.object, "EFFECTOR")


def bake(resolution, frames):
    """The files of the simulation."""
    cache = tempfile.mkdtemp()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.frame_end = frames
    box = domain(resolution, frames, cache)
    sources()
    with bpy.context.temp_override(object=box, active_object=box, selected_objects=[box]):
        bpy.ops.fluid.bake_all()
    return [Path(cache) / "data" / f"fluid_data_{frame:04}.vdb" for frame in range(1, frames + 1)]


def keep(source, goal, *names):
    """Some grids of a file, in half precision."""
    grids = [openvdb.read(str(source), name) for name in names]
    for grid in grids:
        grid.saveFloatAsHalf = True
    openvdb.write(str(goal), grids=grids, metadata=openvdb.readMetadata(str(source)))
    print(f"{goal}: {goal.stat().st_size} bytes")


def backdrop():
    """Paper that hangs from a wall and turns into the floor."""
    turn = [(-2.2 - 0.8 * math.sin(a), 0.8 - 0.8 * math.cos(a)) for a in np.linspace(0, math.pi / 2, 17)]
    line = [(4.0, 0.0), *turn, (-3.0, 6.0)]
    return Mesh().grid([[(x, y, z) for z, y in line] for x in (-7.0, 7.0)])


if __name__ == "__main__":
    backdrop().write(HERE / "studio_smoke_backdrop.ply")
    keep(bake(resolution=96, frames=34)[-1], HERE / "studio_smoke.vdb", "density")
    for number, source in enumerate(bake(resolution=40, frames=38)[5::2], start=1):
        keep(source, HERE / f"studio_smoke_{number:04}.vdb", "density", "velocity")
