# Writes small volumes with grids as tools name them, with OpenVDB's own Python module (Debian: python3-openvdb); then
#   gzip -9n *.vdb
import numpy as np
import pyopenvdb as vdb

SHAPE = (5, 8, 5)
x, y, z = np.meshgrid(*[(np.arange(n) + 0.5) / n for n in SHAPE], indexing="ij")
puff = np.clip(1.5 - 3 * np.hypot(x - 0.5, z - 0.5) - y, 0, 1)
fire = np.clip(1.2 - 4 * np.hypot(x - 0.5, z - 0.5) - 1.5 * y, 0, 1)


def grid(name, values, low=(0, 0, 0), half=False, fog=True):
    colours = values.ndim == 4
    made = vdb.Vec3SGrid() if colours else vdb.FloatGrid()
    # A few values of few digits pack well.
    made.copyFromArray(np.round(values * 64) / 64, ijk=low)
    made.name = name
    made.transform = vdb.createLinearTransform(voxelSize=0.25)
    made.saveFloatAsHalf = half
    if fog:
        made.gridClass = vdb.GridClass.FOG_VOLUME
    return made


def zeros(name):
    made = grid(name, puff)
    made.mapOn(lambda value: 0.0)
    return made


def colours(*factors):
    return np.stack([factor * (0.5 + 0.5 * y) for factor in factors], -1)


def components(name, ends, **options):
    channels = np.moveaxis(colours(0.9, 0.6, 0.3), -1, 0)
    return [grid(name + end, channel, **options) for end, channel in zip(ends, channels)]


velocity = colours(0.1, 1.0, 0.1)
files = {
    # Houdini 18 to 21: temperature from 0 to 2.
    "houdini": [grid("density", puff), grid("temperature", 2 * fire), grid("burn", fire), grid("Cd", colours(0.9, 0.6, 0.3)), grid("vel", velocity)],
    # Houdini 13 to 17: components of velocities.
    "houdini_old": [grid("density", puff), grid("heat", fire), grid("temperature", 2 * fire), *components("vel", [".x", ".y", ".z"]), *components("Cd", [".x", ".y", ".z"])],
    # Blender 2.8 to 5: half numbers, heat that may be below 0.
    "blender": [grid("density", puff, half=True), grid("flame", fire, half=True), grid("heat", 2 * fire - 0.25 * puff, half=True), *components("color", ["_r", "_g", "_b"], half=True), grid("velocity", velocity, half=True)],
    # Bifrost: no class.
    "bifrost": [grid("voxel_fog_density", puff, fog=False), grid("voxel_velocity", velocity, fog=False)],
    # A simulation of fire in kelvin; the fire reaches below the smoke.
    "kelvin": [grid("density", puff), grid("temperature", 300 + 1500 * fire, low=(0, -3, 0))],
    # Blender 5: what a simulation does not have is there, but empty. The wind blows both ways.
    "blender5": [grid("density", puff), grid("flame", 0 * puff), grid("temperature", 2 * fire), *[grid("color" + end, 0 * puff) for end in ["_r", "_g", "_b"]], grid("velocity", velocity - 0.5)],
    # Smoke that has gone; all of its voxels are active, and 0.
    "burning": [zeros("density"), grid("flame", fire), zeros("heat"), grid("Cd", colours(0.9, 0.6, 0.3))],
    # Two of one name, and one that no name tells.
    "twins": [grid("density", puff), grid("density", 2 * puff)],
    "strange": [grid("soot", puff), grid("tar", puff)],
}
for name, grids in files.items():
    vdb.write(f"{name}.vdb", grids)

# What says that Blender wrote it: +z is up there.
vdb.write("upright.vdb", [grid("density", puff.transpose(0, 2, 1)), grid("flame", fire.transpose(0, 2, 1))], metadata={"creator": "Blender/OpenVDBWriter"})
