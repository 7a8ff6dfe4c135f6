//! What to write in place of names that other renderers have, or that Mitsuba has and Tyndall has not: told where such a
//! name is refused.

/// Names of plugins of a kind, and what to use.
type Plugins = (&'static str, &'static [&'static str], &'static str);

const POLARISATION: &str = "light is not polarised here: leave it out, or use \"null\" in its place";
const PATHS: &str = "use \"bdpt\", which renders the same image";
const CURVES: &str = "use \"cylinder\"s, or a mesh of tubes (\"ply\", \"obj\")";
const MEASURED: &str =
    "use \"roughconductor\", \"roughplastic\" or \"principled\", fitted to what was measured";

/// Plugins that are refused.
const PLUGINS: &[Plugins] = &[
    (
        "emitter",
        &["sky", "sun", "preetham", "hosek", "nishita", "skylight"],
        "use \"sunsky\", or \"envmap\" with an image of the sky",
    ),
    (
        "emitter",
        &["hdri", "ibl", "environment", "infinite", "dome", "skybox"],
        "use \"envmap\", or \"constant\" without an image",
    ),
    ("emitter", &["diffuse_area", "arealight"], "use \"area\" inside a shape"),
    ("emitter", &["goniometric", "ies"], "use \"point\" with a \"profile\", or \"projector\" with an image"),
    ("emitter", &["distant"], "use \"directional\""),
    ("medium", &["fog", "mist", "haze", "uniform", "participating"], "use \"homogeneous\""),
    (
        "medium",
        &["cloud", "grid", "volume", "vdb", "density", "nanovdb"],
        "use \"heterogeneous\" with a \"gridvolume\" as sigma_t",
    ),
    ("bsdf", &["matte", "lambert", "lambertian"], "use \"diffuse\""),
    ("bsdf", &["glass"], "use \"dielectric\""),
    ("bsdf", &["roughglass"], "use \"roughdielectric\""),
    ("bsdf", &["metal", "mirror"], "use \"conductor\" or \"roughconductor\""),
    (
        "bsdf",
        &["phong", "ward", "glossy", "coating", "roughcoating", "substrate", "pplastic"],
        "use \"plastic\" or \"roughplastic\"",
    ),
    ("bsdf", &["bump"], "use \"bumpmap\""),
    ("bsdf", &["mixturebsdf", "mix"], "use \"blendbsdf\""),
    ("bsdf", &["disney", "uber"], "use \"principled\", or \"principledthin\" for what is thin"),
    ("bsdf", &["hair"], "use \"roughplastic\" or \"principled\""),
    ("bsdf", &["measured", "measured_polarized", "rgl"], MEASURED),
    ("bsdf", &["polarizer", "retarder", "circular"], POLARISATION),
    (
        "bsdf",
        &["subsurface", "dipole"],
        "use \"dielectric\" or \"roughdielectric\" with a medium as the interior of the shape",
    ),
    ("shape", &["bsplinecurve", "linearcurve", "hair", "curve"], CURVES),
    (
        "shape",
        &["sdfgrid", "heightfield", "deformable", "blender", "gltf", "stl", "mesh"],
        "use a mesh: export it as \"ply\" or \"obj\"",
    ),
    ("shape", &["ellipsoids", "ellipsoidsmesh"], "use \"sphere\"s, or a mesh (\"ply\")"),
    ("shape", &["box"], "use \"cube\""),
    ("shape", &["plane", "quad", "square"], "use \"rectangle\""),
    ("shape", &["ball"], "use \"sphere\""),
    ("texture", &["gridtexture"], "use \"checkerboard\" or \"bitmap\""),
    ("texture", &["image", "imagemap"], "use \"bitmap\""),
    ("texture", &["vertexcolors"], "use \"mesh_attribute\""),
    ("texture", &["wireframe", "curvature"], "use \"bitmap\""),
    ("integrator", &["stokes"], "light is not polarised here: use the integrator inside it"),
    ("integrator", &["depth", "ao", "field"], "use \"aov\" with \"dd:depth\""),
    (
        "integrator",
        &[
            "pssmlt",
            "mlt",
            "erpt",
            "photonmapper",
            "ppm",
            "sppm",
            "vpl",
            "irrcache",
            "adaptive",
            "vcm",
            "prb",
            "prb_basic",
            "prb_projective",
            "prbvolpath",
            "direct_projective",
            "emission_reparam",
        ],
        PATHS,
    ),
    ("integrator", &["pt"], "use \"path\""),
    ("integrator", &["lt", "adjoint", "particle"], "use \"ptracer\""),
    ("film", &["ldrfilm", "mfilm", "rgb", "image"], "use \"hdrfilm\""),
    (
        "film",
        &["specfilm"],
        "use \"hdrfilm\": light is represented in linear sRGB, so there are no spectral bands",
    ),
    (
        "sampler",
        &["halton", "hammersley", "zerotwosequence", "paddedsobol", "zsobol", "pmj02bn"],
        "use \"sobol\"",
    ),
    ("sampler", &["random"], "use \"independent\""),
    ("phase", &["microflake", "kkay"], "use \"sggx\""),
    ("phase", &["henyey_greenstein", "henyeygreenstein"], "use \"hg\""),
    ("phase", &["mixturephase"], "use \"blendphase\""),
    ("volume", &["grid", "vdb", "openvdb", "nanovdb", "volcache", "hgridvolume"], "use \"gridvolume\""),
    ("volume", &["constant"], "use \"constvolume\""),
    (
        "sensor",
        &["pinhole", "perspective_rdist", "spherical", "panorama", "realistic"],
        "use \"perspective\" or \"thinlens\"",
    ),
    ("sensor", &["telecentric"], "use \"orthographic\""),
];

/// What to use in place of the plugin `name` of the kind `tag`; of any kind where that is not known.
pub fn of_plugin(name: &str, tag: Option<&str>) -> Option<&'static str> {
    let fits = |row: &&Plugins| tag.is_none_or(|tag| tag == row.0) && row.1.contains(&name);
    PLUGINS.iter().find(fits).map(|row| row.2)
}

/// A parameter of the plugins that are meant, other names for what they have, and what to do.
const PARAMETERS: &[(&str, &[&str], &str)] = &[
    ("sigma_t", &["density", "extinction"], "write \"sigma_t\": the extinction [1/m], a number or a volume"),
    ("sigma_t", &["method"], "leave it out, or choose a \"tracker\" of the heterogeneous"),
    ("sigma_t", &["g", "anisotropy"], "give the medium a phase function \"hg\", which has \"g\""),
    ("sigma_t", &["color", "colour"], "write \"albedo\""),
    (
        "film",
        &[
            "width",
            "height",
            "resolution",
            "size",
            "crop_width",
            "crop_height",
            "crop_offset_x",
            "crop_offset_y",
            "pixel_format",
            "file_format",
            "component_format",
            "rfilter",
        ],
        "move it into the film of the sensor, an \"hdrfilm\" (width and height in pixels)",
    ),
    (
        "film",
        &["sample_count", "samples", "samples_per_pixel", "spp"],
        "give the sensor a sampler with \"sample_count\"",
    ),
    ("film", &["origin", "target", "up", "position", "lookat"], "write a \"to_world\" with a \"lookat\""),
    ("film", &["focal_distance"], "write \"focus_distance\""),
    ("interior", &["medium"], "write \"interior\": the medium within; \"exterior\" is the one around"),
    ("interior", &["material", "shader", "brdf"], "write \"bsdf\": the material of the surface"),
    ("sample_count", &["samples", "samples_per_pixel", "spp"], "write \"sample_count\""),
    (
        "max_depth",
        &["samples", "samples_per_pixel", "spp", "sample_count"],
        "give the sensor a sampler with \"sample_count\"",
    ),
    (
        "fog_color",
        &["sigma_t", "albedo", "phase", "density"],
        "\"fog\" is a preview, an integrator; a medium of fog is a \"homogeneous\"",
    ),
    ("reflectance", &["color", "colour", "albedo", "diffuse", "kd"], "write \"reflectance\""),
    ("radiance", &["color", "colour", "intensity", "power", "strength"], "write \"radiance\" [W/(m^2 sr)]"),
    ("intensity", &["color", "colour", "radiance", "power", "strength"], "write \"intensity\" [W/sr]"),
    ("int_ior", &["ior", "eta", "n"], "write \"int_ior\""),
    ("alpha", &["roughness"], "write \"alpha\": the square of a roughness from 0 to 1"),
    ("filename", &["file", "path"], "write \"filename\""),
    ("center", &["position", "origin"], "write \"center\""),
    (
        "time",
        &["width", "height", "resolution", "film"],
        "move it into the film of the sensor, an \"hdrfilm\"",
    ),
    (
        "time",
        &["max_depth", "sample_count", "spp"],
        "move it into the integrator (\"max_depth\") or the sampler of the sensor (\"sample_count\")",
    ),
];

/// What to do about `name`, which is no parameter of a plugin; `has` tells which are.
pub fn of_parameter(name: &str, has: impl Fn(&str) -> bool) -> Option<&'static str> {
    PARAMETERS.iter().find(|(row, names, _)| has(row) && names.contains(&name)).map(|(.., remedy)| *remedy)
}
