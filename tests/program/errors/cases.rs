//! The broken scenes, each by its name.

/// A file beside the scene, or the scene itself.
pub(super) struct File {
    pub name: &'static str,
    pub content: Vec<u8>,
}

/// A scene that is not as it should be.
pub(super) struct Case {
    pub name: &'static str,
    /// The scene first.
    pub files: Vec<File>,
    pub definitions: &'static [(&'static str, &'static str)],
    /// It is rendered all the same; something is said.
    pub is_warned: bool,
    /// What to read, where it is not the first file.
    reads: Option<&'static str>,
}

/// A triangle whose corners are coloured in bytes.
const PAINTED: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\n\
    end_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n";

/// A grid of one voxel with six numbers, half of what is to be given.
const VOXEL: &str = "VOL\x03\x01\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\0\0\x06\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0?\0\0\0?\0\0\0?\
    \0\0\0?\0\0\0?\0\0\0?\0\0\0\0\0\0\0\0\0\0\0\0";

const CAMERA: [&str; 2] = ["<sensor type=\"perspective\"/>", "\"camera\": {\"type\": \"perspective\"}"];

impl Case {
    fn of(name: &'static str, file: &'static str, content: impl Into<Vec<u8>>) -> Self {
        let files = vec![File { name: file, content: content.into() }];
        Self { name, files, definitions: &[], is_warned: false, reads: None }
    }

    /// In a scene of XML that has a camera.
    fn xml(name: &'static str, inside: &str) -> Self {
        Self::of(name, "scene.xml", format!("<scene version=\"3.0.0\">\n{inside}\n{}</scene>", CAMERA[0]))
    }

    /// In a scene for Mitsuba 0.6, below its camera or, if it is a medium, in its air.
    fn old(name: &'static str, inside: &str) -> Self {
        let (camera, inside) = match inside.starts_with("<film") {
            true => (CAMERA[0].replace("/>", &format!(">{inside}</sensor>")), String::new()),
            false => (
                CAMERA[0].to_owned(),
                format!(
                    "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"9\"/><bsdf type=\"null\"/>{}</shape>",
                    inside.replace("<medium", "<medium name=\"interior\"")
                ),
            ),
        };
        Self::of(
            name,
            "scene.xml",
            format!("<scene version=\"0.6.0\">\n{camera}{inside}<emitter type=\"constant\"/></scene>"),
        )
    }

    /// In a scene of JSON that has a camera.
    fn json(name: &'static str, inside: &str) -> Self {
        Self::of(name, "scene.json", format!("{{\"type\": \"scene\",\n{inside},\n{}}}", CAMERA[1]))
    }

    /// In a scene of JSON that has a camera, before a sky: a medium of flakes, which has more.
    fn flakes(name: &'static str, kind: &str, more: &str) -> Self {
        let phase = r#""phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "flakes.vol"}}"#;
        let medium = format!("{{\"type\": \"{kind}\", {more}{phase}}}");
        let inside = format!(
            r#""fog": {{"type": "sphere", "interior": {medium}, "bsdf": {{"type": "null"}}}}, "sky": {{"type": "constant"}}"#
        );
        Self::json(name, &inside).beside("flakes.vol", VOXEL)
    }

    fn beside(mut self, name: &'static str, content: &str) -> Self {
        self.files.push(File { name, content: content.into() });
        self
    }

    fn with(mut self, definitions: &'static [(&'static str, &'static str)]) -> Self {
        self.definitions = definitions;
        self
    }

    fn reading(mut self, name: &'static str) -> Self {
        self.reads = Some(name);
        self
    }

    fn warned(mut self) -> Self {
        self.is_warned = true;
        self
    }

    /// The name of the file to read.
    pub(super) fn main(&self) -> &'static str {
        self.reads.unwrap_or(self.files[0].name.split('/').next().unwrap_or_default())
    }

    /// What is broken, on one line.
    pub(super) fn shown(&self) -> String {
        let text = String::from_utf8_lossy(&self.files[0].content).replace('\n', " ");
        let text = CAMERA.iter().fold(text, |text, camera| text.replace(camera, ""));
        let scene = ["<scene version=\"3.0.0\"> ", " </scene>", "{\"type\": \"scene\", ", ", }"];
        let inside = scene.iter().fold(text, |text, part| text.replace(part, ""));
        let short: String = inside.chars().filter(|c| !c.is_control()).take(160).collect();
        let set: String =
            self.definitions.iter().map(|(name, value)| format!(" -D {name}={value}")).collect();
        format!("{}{}{set}", short.trim(), if short.len() < inside.len() { " ..." } else { "" })
    }
}

/// All of them.
pub(super) fn all() -> Vec<Case> {
    vec![
        Case::xml("unknown shape", r#"<shape type="shpere"/>"#),
        Case::json("unknown shape in JSON", r#""a": {"type": "shpere"}"#),
        Case::xml("unknown bsdf", r#"<bsdf type="difuse"/>"#),
        Case::xml("unknown bsdf on a shape", r#"<shape type="sphere"><bsdf type="difuse"/></shape>"#),
        Case::xml("unknown emitter", r#"<emitter type="pointlight"/>"#),
        Case::xml("unknown emitter on a shape", r#"<shape type="sphere"><emitter type="aera"/></shape>"#),
        Case::xml("unknown medium", r#"<shape type="sphere"><medium type="homogenous" name="interior"/></shape>"#),
        Case::xml("unknown phase function", r#"<medium type="homogeneous"><phase type="hgg"/></medium>"#),
        Case::json("unknown phase function in JSON", r#""fog": {"type": "homogeneous", "phase": {"type": "henyey"}}"#),
        Case::json("a phase function as a word", r#""fog": {"type": "homogeneous", "phase": "hg"}"#),
        Case::json("a material by its id alone", r#""gold": {"type": "conductor"}, "ball": {"type": "sphere", "bsdf": "gold"}"#),
        Case::xml("a material as a string", r#"<shape type="sphere"><string name="bsdf" value="diffuse"/></shape>"#),
        Case::json("a medium of no known name", r#""ball": {"type": "sphere", "interior": "fog"}"#),
        Case::json("a material by another renderer's word", r#""ball": {"type": "sphere", "material": "gold"}"#),
        Case::json("a film without a type", r#""lens": {"type": "thinlens", "film": {"width": 3}}"#),
        Case::json("a step by its name alone", r#""ball": {"type": "sphere", "to_world": [{"translate": [1, 2, 3]}]}"#),
        Case::json("a filter for a shape", r#""crate": {"type": "box"}"#),
        Case::json("a glow without absorption", r#""fire": {"type": "sphere", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous", "albedo": 1, "temperature": 1800}}"#)
            .warned(),
        Case::xml("unknown volume", r#"<volume type="exponentail"/>"#),
        Case::json("unknown volume in a sum", r#""fog": {"type": "sum", "a": {"type": "cosin"}}"#),
        Case::json("a part of another volume", r#""fog": {"type": "sum", "a": {"type": "term", "powers": [1, 0, 0]}}"#),
        Case::xml("a part alone", r#"<volume type="wave"/>"#),
        Case::json("text for the time", r#""time": "noon""#),
        Case::xml("box inside out", r#"<volume type="exponential"><point name="min" value="0 0 0"/><point name="max" value="1 0 1"/></volume>"#),
        Case::json("negative factor of a volume", r#""fog": {"type": "exponential", "value": -1}"#),
        Case::json("cosine without waves", r#""fog": {"type": "cosine", "constant": 2}"#),
        Case::xml("wave without a vector", r#"<volume type="cosine"><volume type="wave"><float name="phase" value="1"/></volume></volume>"#),
        Case::json("unknown parameter of a wave", r#""fog": {"type": "cosine", "a": {"type": "wave", "vector": [1, 0, 0], "amplitud": 2}}"#),
        Case::json("polynomial without coefficients", r#""fog": {"type": "polynomial"}"#),
        Case::xml("a word among coefficients", r#"<volume type="polynomial"><string name="x" value="0.8, one, 0"/></volume>"#),
        Case::json("too many coefficients", r#""fog": {"type": "polynomial", "x": "1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1"}"#),
        Case::json("half a power", r#""fog": {"type": "polynomial", "a": {"type": "term", "powers": [0.5, 1, 0]}}"#),
        Case::json("no half width", r#""fog": {"type": "polynomial", "x": "1 1", "half_width": 0}"#),
        Case::json("a polynomial beyond f32", r#""fog": {"type": "polynomial", "x": "0 0 0 0 1", "half_width": 1e10}"#),
        Case::json("a wrap that is no choice", r#""fog": {"type": "polynomial", "x": "1", "wrap": "repeatt"}"#),
        Case::json("no c", r#""fog": {"type": "equipotential", "c": 0}"#),
        Case::json("negative d", r#""fog": {"type": "equipotential", "d": -1}"#),
        Case::json("a c too small for its strength", r#""fog": {"type": "equipotential", "c": 1e-20, "strength": 1e15}"#),
        Case::json("a line of one point", r#""fog": {"type": "equipotential", "shape": "line", "p0": [1, 2, 3], "p1": [1, 2, 3]}"#),
        Case::json("a segment of one end", r#""fog": {"type": "equipotential", "shape": "segment", "p0": [1, 2, 3]}"#),
        Case::json("a center of a segment", r#""fog": {"type": "equipotential", "shape": "segment", "p0": [1, 2, 3], "p1": [0, 0, 0], "center": [0, 0, 0]}"#),
        Case::json("no up", r#""fog": {"type": "exponential", "up": [0, 0, 0]}"#),
        Case::json("fog of no height", r#""fog": {"type": "exponential", "scale_height": 0}"#),
        Case::json("no octaves", r#""fog": {"type": "noise", "octaves": 0}"#),
        Case::json("negative seed", r#""fog": {"type": "noise", "seed": -1}"#),
        Case::json("no frequency", r#""fog": {"type": "noise", "frequency": 0}"#),
        Case::json("a style that is no choice", r#""fog": {"type": "noise", "style": "fractl"}"#),
        Case::json("empty sum", r#""fog": {"type": "sum"}"#),
        Case::json("a number in a sum", r#""fog": {"type": "sum", "a": {"type": "exponential"}, "b": 0.5}"#),
        Case::json("a bsdf in a product", r#""fog": {"type": "product", "a": {"type": "diffuse"}}"#),
        Case::json("wind without a velocity", r#""fog": {"type": "wind", "a": {"type": "exponential"}}"#),
        Case::json("wind of two", r#""fog": {"type": "wind", "velocity": [1, 0, 0], "a": {"type": "exponential"}, "b": {"type": "noise"}}"#),
        Case::xml("unknown texture", r#"<bsdf type="diffuse"><texture type="bitmpa" name="reflectance"/></bsdf>"#),
        Case::xml("unknown integrator", r#"<integrator type="volpth"/>"#),
        Case::of("unknown sensor", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspectiv"/></scene>"#),
        Case::of("unknown film", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilms"/></sensor></scene>"#),
        Case::of("unknown sampler", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><sampler type="independant"/></sensor></scene>"#),
        Case::of("unknown reconstruction filter", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilm"><rfilter type="gausian"/></film></sensor></scene>"#),
        Case::xml("a plugin of another kind", r#"<bsdf type="sphere"/>"#),
        Case::xml("nothing like it", r#"<shape type="zzzzzzzz"/>"#),
        Case::xml("unknown parameter", r#"<shape type="sphere"><float name="raduis" value="2"/></shape>"#),
        Case::json("unknown parameter in JSON", r#""ball": {"type": "sphere", "raduis": 2}"#),
        Case::xml("unknown parameter of a bsdf", r#"<bsdf type="dielectric"><float name="intIOR" value="1.5"/></bsdf>"#),
        Case::xml("camel case of old scenes", r#"<shape type="sphere"><transform name="toWorld"/></shape>"#),
        Case::xml("unknown parameter of a definition nothing refers to", r#"<bsdf type="twosided" id="idle"><bsdf type="diffuse"><rgb name="reflectence" value="1"/></bsdf></bsdf>"#),
        Case::xml("unknown parameter of the scene", r#"<float name="exposure" value="2"/>"#),
        Case::xml("unknown unnamed child", r#"<shape type="sphere"><film type="hdrfilm"/></shape>"#),
        Case::xml("wrong kind of child", r#"<bsdf type="diffuse"><bsdf type="diffuse" name="reflectance"/></bsdf>"#),
        Case::json("text for a number", r#""ball": {"type": "sphere", "radius": "big"}"#),
        Case::json("number for a boolean", r#""ball": {"type": "sphere", "flip_normals": 1}"#),
        Case::json("number for a vector", r#""ball": {"type": "sphere", "center": 1}"#),
        Case::json("number for a transform", r#""ball": {"type": "sphere", "to_world": 1}"#),
        Case::json("vector for a colour", r#""lamp": {"type": "point", "intensity": [1, 2, 3]}"#),
        Case::json("text for a colour", r#""lamp": {"type": "point", "intensity": "white"}"#),
        Case::json("colour for a number", r#""ball": {"type": "sphere", "radius": {"type": "rgb", "value": 1}}"#),
        Case::json("number for text", r#""mesh": {"type": "obj", "filename": 3}"#),
        Case::json("number for a child", r#""ball": {"type": "sphere", "interior": 3}"#),
        Case::of("fraction for a whole number", "scene.json", r#"{"type": "scene", "c": {"type": "perspective", "film": {"type": "hdrfilm", "width": 2.5}}}"#),
        Case::json("null", r#""ball": {"type": "sphere", "radius": null}"#),
        Case::xml("text where a float is", r#"<shape type="sphere"><float name="radius" value="2cm"/></shape>"#),
        Case::xml("a word that is no choice", r#"<bsdf type="roughconductor"><string name="distribution" value="phong"/></bsdf>"#),
        Case::xml("negative extinction", r#"<medium type="homogeneous"><float name="sigma_t" value="-1"/></medium>"#),
        Case::xml("emission and temperature", r#"<medium type="homogeneous"><float name="emission" value="1"/><float name="temperature" value="1000"/></medium>"#),
        Case::xml("emission below zero", r#"<medium type="homogeneous"><rgb name="emission" value="1 -1 0"/></medium>"#),
        Case::xml("emission scale without emission", r#"<medium type="homogeneous"><float name="emission_scale" value="2"/></medium>"#),
        Case::json("a coloured temperature", r#""a": {"type": "sphere", "interior": {"type": "homogeneous", "temperature": {"type": "rgb", "value": [1, 2, 3]}}}"#),
        Case::json("more emission than fits", r#""a": {"type": "sphere", "interior": {"type": "homogeneous", "radiance": 1e30, "sigma_t": 10}}"#),
        Case::json("emission without end", r#""fog": {"type": "homogeneous", "emission": 1}, "a": {"type": "sphere", "exterior": {"type": "ref", "id": "fog"}}"#).warned(),
        Case::json("scattering and absorption coefficients", r#""fog": {"type": "homogeneous", "sigma_s": 3, "sigma_a": 1}"#),
        Case::json("a coloured scattering coefficient", r#""fog": {"type": "heterogeneous", "sigma_s": {"type": "rgb", "value": [1, 2, 3]}}"#),
        Case::json("a misspelt extinction after an error of its own", r#""fog": {"type": "heterogeneous", "sigmat": 3}"#),
        Case::xml("albedo above one", r#"<medium type="homogeneous"><rgb name="albedo" value="0.5 1.5 0.5"/></medium>"#),
        Case::xml("g of one", r#"<medium type="homogeneous"><phase type="hg"><float name="g" value="1"/></phase></medium>"#),
        Case::xml("radius of zero", r#"<shape type="sphere"><float name="radius" value="0"/></shape>"#),
        Case::xml("reflectance above one", r#"<bsdf type="diffuse"><rgb name="reflectance" value="2"/></bsdf>"#),
        Case::xml("index of refraction of zero", r#"<bsdf type="dielectric"><float name="int_ior" value="0"/></bsdf>"#),
        Case::xml("unknown material of an index", r#"<bsdf type="dielectric"><string name="int_ior" value="glas"/></bsdf>"#),
        Case::xml("unknown metal", r#"<bsdf type="conductor"><string name="material" value="Agg"/></bsdf>"#),
        Case::of("field of view of 180", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="180"/></sensor></scene>"#),
        Case::of("a shutter that closes before it opens", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><float name="shutter_open" value="1"/><float name="shutter_close" value="0.5"/></sensor></scene>"#),
        Case::of("keyframes of a shutter", "scene.json", r#"{"type": "scene", "camera": {"type": "perspective", "shutter_close": {"type": "keyframes", "value": [[0, 1], [1, 2]]}}}"#),
        Case::of("near clip behind far clip", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><float name="near_clip" value="10"/><float name="far_clip" value="1"/></sensor></scene>"#),
        Case::of("film without width", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilm"><integer name="width" value="0"/></film></sensor></scene>"#),
        Case::of("film of enormous width", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilm"><integer name="width" value="1000000"/></film></sensor></scene>"#),
        Case::of("no samples", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><sampler type="independent"><integer name="sample_count" value="0"/></sampler></sensor></scene>"#),
        Case::xml("depth below minus one", r#"<integrator type="path"><integer name="max_depth" value="-2"/></integrator>"#),
        Case::xml("paths longer than the longest", r#"<integrator type="volpath"><integer name="max_depth" value="3"/><integer name="min_depth" value="4"/></integrator>"#),
        Case::json("single scattering of long paths", r#""integrator": {"type": "single_scattering", "min_depth": 3}"#),
        Case::json("a gathering of long paths", r#""integrator": {"type": "gather", "min_depth": 3}"#),
        Case::xml("spot wider than its cutoff", r#"<emitter type="spot"><float name="cutoff_angle" value="10"/><float name="beam_width" value="20"/></emitter>"#),
        Case::xml("negative sampling weight", r#"<emitter type="point"><float name="sampling_weight" value="-1"/></emitter>"#),
        Case::xml("blend weight above one", r#"<medium type="homogeneous"><phase type="blendphase"><float name="weight" value="2"/><phase type="hg"/><phase type="isotropic"/></phase></medium>"#),
        Case::xml("tabulated phase of one entry", r#"<medium type="homogeneous"><phase type="tabphase"><string name="values" value="1"/></phase></medium>"#),
        Case::xml("tabulated phase with a word in it", r#"<medium type="homogeneous"><phase type="tabphase"><string name="values" value="1, two"/></phase></medium>"#),
        Case::xml("tabulated phase without values", r#"<medium type="homogeneous"><phase type="tabphase"/></medium>"#),
        Case::xml("not a number", r#"<shape type="sphere"><float name="radius" value="nan"/></shape>"#),
        Case::xml("infinite", r#"<shape type="sphere"><float name="radius" value="-inf"/></shape>"#),
        Case::xml("too large for a float", r#"<shape type="sphere"><float name="radius" value="1e999"/></shape>"#),
        Case::json("too large for a float in JSON", r#""ball": {"type": "sphere", "radius": 1e999}"#),
        Case::xml("too large for an integer", r#"<shape type="sphere"><integer name="radius" value="99999999999999999999"/></shape>"#),
        Case::json("too large for single precision", r#""lamp": {"type": "point", "intensity": 1e300}"#),
        Case::json("too large a place", r#""ball": {"type": "sphere", "center": [1e300, 0, 0]}"#),
        Case::json("too large a scale", r#""ball": {"type": "sphere", "to_world": [{"type": "scale", "value": 1e200}, {"type": "scale", "value": 1e200}]}"#),
        Case::xml("missing mesh", r#"<shape type="obj"><string name="filename" value="no.obj"/></shape>"#),
        Case::json("missing image", r#""w": {"type": "diffuse", "reflectance": {"type": "bitmap", "filename": "no.png"}}"#),
        Case::xml("mesh without a file name", r#"<shape type="ply"/>"#),
        Case::xml("smoke without a file name", r#"<shape type="smoke"/>"#),
        Case::json("smoke of no frame", r#""plume": {"type": "smoke", "filename": "plume_####.vdb"}"#),
        Case::json("smoke of one file with a frame rate", r#""plume": {"type": "smoke", "filename": "plume.vdb", "fps": 25}"#),
        Case::json("smoke of no size", r#""plume": {"type": "smoke", "filename": "plume.vdb", "scale": 0}"#).beside("plume.vdb", ""),
        Case::json("smoke whose up is no axis", r#""plume": {"type": "smoke", "filename": "plume.vdb", "up": "x"}"#).beside("plume.vdb", ""),
        Case::json("smoke of a group without a name", r#""plume": {"type": "smoke", "filename": "plume.vdb", "group": ""}"#).beside("plume.vdb", ""),
        Case::json("smoke of something else", r#""plume": {"type": "smoke", "filename": "plume.vdb"}"#).beside("plume.vdb", "this is no volume"),
        Case::xml("smoke in a shape", r#"<shape type="sphere"><shape type="smoke"><string name="filename" value="plume.vdb"/></shape></shape>"#),
        Case::xml("smoke as a medium", r#"<shape type="sphere"><medium type="smoke" name="interior"/></shape>"#),
        Case::xml("garbage for an image", r#"<bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="a.png"/></texture></bsdf>"#).beside("a.png", "this is no image"),
        Case::xml("an image of an unknown format", r#"<bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="a.xyz"/></texture></bsdf>"#).beside("a.xyz", "this is no image"),
        Case::xml("garbage for a mesh", r#"<shape type="ply"><string name="filename" value="a.ply"/></shape>"#).beside("a.ply", "this is no mesh"),
        Case::xml("truncated mesh", r#"<shape type="ply"><string name="filename" value="a.ply"/></shape>"#).beside("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n"),
        Case::xml("a face beyond the vertices", r#"<shape type="obj"><string name="filename" value="a.obj"/></shape>"#).beside("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        Case::xml("a word for a coordinate", r#"<shape type="obj"><string name="filename" value="a.obj"/></shape>"#).beside("a.obj", "v 0 0 zero\n"),
        Case::xml("empty mesh", r#"<shape type="obj"><string name="filename" value="a.obj"/></shape>"#).beside("a.obj", ""),
        Case::xml("missing include", r#"<include filename="parts/no.xml"/>"#),
        Case::xml("include of itself", r#"<include filename="scene.xml"/>"#),
        Case::xml("broken include", r#"<include filename="part.xml"/>"#).beside("part.xml", r#"<scene version="3.0.0">
  <shape type="sphere" radius="1"/>
</scene>"#),
        Case::xml("missing folder", r#"<path value="assets"/>"#),
        Case::xml("missing spectrum file", r#"<emitter type="point"><spectrum name="intensity" filename="no.spd"/></emitter>"#),
        Case::xml("broken spectrum file", r#"<emitter type="point"><spectrum name="intensity" filename="a.spd"/></emitter>"#).beside("a.spd", "400 1\n300 1\n"),
        Case::xml("dangling reference", r#"<shape type="sphere"><ref id="glas"/></shape><bsdf type="dielectric" id="glass"/>"#),
        Case::json("a reference to another kind", r#""ball": {"type": "sphere", "interior": {"type": "ref", "id": "sky"}}, "sky": {"type": "constant"}, "fog": {"type": "homogeneous"}"#),
        Case::json("a reference to another kind, of which there is none", r#""ball": {"type": "sphere", "interior": {"type": "ref", "id": "sky"}}, "sky": {"type": "constant"}"#),
        Case::json("a medium of a shape, within or around", r#""ball": {"type": "sphere", "medium": {"type": "ref", "id": "fog"}}, "fog": {"type": "homogeneous"}"#),
        Case::json("a count that changes in time", r#""eye": {"type": "perspective", "film": {"type": "hdrfilm", "width": {"type": "keyframes", "value": [[0, 16], [1, 32]]}}}"#),
        Case::json("dangling reference in JSON", r#""ball": {"type": "sphere", "bsdf": {"type": "ref", "id": "glas"}}, "glass": {"type": "dielectric"}"#),
        Case::xml("dangling reference among many", &((0..40).map(|i| format!("<bsdf type=\"diffuse\" id=\"wall_{i}\"/>")).collect::<String>() + "<shape type=\"sphere\"><ref id=\"floor\"/></shape>")),
        Case::xml("circular reference", r#"<bsdf type="twosided" id="a"><ref id="b"/></bsdf><bsdf type="twosided" id="b"><ref id="a"/></bsdf>"#),
        Case::xml("id given twice", r#"<bsdf type="diffuse" id="a"/>
<bsdf type="null" id="a"/>"#),
        Case::xml("reference to the wrong kind", r#"<shape type="sphere"><ref id="c"/></shape><integrator type="path" id="c"/>"#),
        Case::xml("alias of nothing", r#"<alias id="b" as="c"/>"#),
        Case::xml("parameter given twice", r#"<shape type="sphere"><float name="radius" value="1"/><float name="radius" value="2"/></shape>"#),
        Case::of("key given twice", "scene.json", r#"{"type": "scene",
 "a": {"type": "sphere"},
 "a": {"type": "cube"}}"#),
        Case::xml("undefined parameter", r#"<shape type="sphere"><float name="radius" value="$r"/></shape>"#),
        Case::xml("undefined parameter that is nearly one", r#"<default name="radius" value="1"/><shape type="sphere"><float name="radius" value="$radus"/></shape>"#),
        Case::json("undefined parameter in JSON", r#""ball": {"type": "sphere", "radius": "$r"}"#),
        Case::xml("unused definition", r#"<default name="r" value="1"/><shape type="sphere"><float name="radius" value="$r"/></shape>"#).with(&[("rr", "2")]),
        Case::xml("definition without parameters", r#"<shape type="sphere"/>"#).with(&[("r", "2")]),
        Case::of("definition of another kind", "scene.json", r#"{"type": "scene", "$defaults": {"r": 1}, "ball": {"type": "sphere", "radius": "$r"}}"#).with(&[("r", "big")]),
        Case::xml("definition that is no number", r#"<default name="r" value="1"/><shape type="sphere"><float name="radius" value="$r"/></shape>"#).with(&[("r", "big")]),
        Case::xml("definition given twice", r#"<shape type="sphere"/>"#).with(&[("r", "1"), ("r", "2")]),
        Case::of("a list as a default", "scene.json", r#"{"type": "scene", "$defaults": {"r": [1, 2]}}"#),
        Case::of("two sensors", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"/><sensor type="perspective"/></scene>"#).warned(),
        Case::of("no sensor", "scene.xml", r#"<scene version="3.0.0"><shape type="sphere"/></scene>"#),
        Case::xml("two integrators", r#"<integrator type="path"/><integrator type="volpath"/>"#),
        Case::of("two films", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilm"/><film type="hdrfilm"/></sensor></scene>"#),
        Case::of("two samplers", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><sampler type="independent"/><sampler type="stratified"/></sensor></scene>"#),
        Case::xml("two environments", r#"<emitter type="constant"/><emitter type="constant"/>"#),
        Case::xml("two emitters on a shape", r#"<shape type="sphere"><emitter type="area"/><emitter type="area"/></shape>"#),
        Case::xml("two bsdfs on a shape", r#"<shape type="sphere"><bsdf type="diffuse"/><bsdf type="null"/></shape>"#),
        Case::xml("an area emitter in the scene", r#"<emitter type="area"/>"#),
        Case::xml("a point emitter on a shape", r#"<shape type="sphere"><emitter type="point"/></shape>"#),
        Case::xml("a film in the scene", r#"<film type="hdrfilm"/>"#),
        Case::xml("a phase function of one", r#"<medium type="homogeneous"><phase type="blendphase"><phase type="hg"/></phase></medium>"#),
        Case::xml("a two-sided bsdf of none", r#"<bsdf type="twosided"/>"#),
        Case::xml("a two-sided bsdf of glass", r#"<bsdf type="twosided"><bsdf type="dielectric"/></bsdf>"#),
        Case::xml("two phase functions", r#"<medium type="homogeneous"><phase type="hg"/><phase type="isotropic"/></medium>"#),
        Case::xml("nesting too deep", &("<bsdf type=\"twosided\">".repeat(101) + &"</bsdf>".repeat(101))),
        Case::of("nesting too deep in JSON", "scene.json", format!("{}1{}", r#"{"a":"#.repeat(130), "}".repeat(130))),
        Case::xml("singular transform", r#"<shape type="sphere"><transform name="to_world"><scale x="0"/></transform></shape>"#),
        Case::xml("rotation about nothing", r#"<shape type="sphere"><transform name="to_world"><rotate value="0 0 0" angle="90"/></transform></shape>"#),
        Case::json("rotation about nothing in JSON", r#""ball": {"type": "sphere", "to_world": [{"type": "rotate", "axis": [0, 0, 0], "angle": 90}]}"#),
        Case::xml("look nowhere", r#"<shape type="sphere"><transform name="to_world"><lookat origin="1 1 1" target="1 1 1"/></transform></shape>"#),
        Case::xml("look along up", r#"<shape type="sphere"><transform name="to_world"><lookat origin="0 0 0" target="0 1 0" up="0 1 0"/></transform></shape>"#),
        Case::xml("a matrix of ten", r#"<shape type="sphere"><transform name="to_world"><matrix value="1 2 3 4 5 6 7 8 9 10"/></transform></shape>"#),
        Case::xml("unknown step", r#"<shape type="sphere"><transform name="to_world"><lookAt origin="0 0 0" target="0 1 0"/></transform></shape>"#),
        Case::json("one step without brackets", r#""ball": {"type": "sphere", "to_world": {"type": "scale", "value": 2}}"#),
        Case::json("a step without its angle", r#""ball": {"type": "sphere", "to_world": [{"type": "rotate", "axis": [0, 1, 0]}]}"#),
        Case::of("malformed XML", "scene.xml", r#"<scene version="3.0.0">
  <shape type="sphere">
</scene>"#),
        Case::of("unclosed attribute", "scene.xml", r#"<scene version="3.0.0>
</scene>"#),
        Case::of("two scenes in a file", "scene.xml", r#"<scene version="3.0.0"/><scene version="3.0.0"/>"#),
        Case::of("malformed JSON", "scene.json", r#"{"type": "scene",
 "a": }"#),
        Case::of("a comma too many", "scene.json", r#"{"type": "scene",
 "a": {"type": "sphere",},
}"#),
        Case::of("a comment in JSON", "scene.json", r#"{"type": "scene", // mine
}"#),
        Case::of("cut off JSON", "scene.json", r#"{"type": "scene", "a": {"#),
        Case::of("two values in a file", "scene.json", r#"{"type": "scene"} {}"#),
        Case::of("a list for a scene", "scene.json", "[1, 2]"),
        Case::of("a shape for a scene", "scene.json", r#"{"type": "sphere"}"#),
        Case::of("an object without a type", "scene.json", r#"{"type": "scene", "a": {"radius": 1}}"#),
        Case::xml("unknown tag", r#"<shap type="sphere"/>"#),
        Case::xml("unknown attribute", r#"<shape type="sphere" radius="2"/>"#),
        Case::xml("a missing type", "<shape/>"),
        Case::xml("a missing value", r#"<shape type="sphere"><float name="radius"/></shape>"#),
        Case::xml("stray text", "hello").warned(),
        Case::of("no version", "scene.xml", "<scene/>"),
        Case::of("a future version", "scene.xml", r#"<scene version="4.0.0"/>"#),
        Case::of("a word for a version", "scene.xml", r#"<scene version="latest"/>"#),
        Case::of("empty XML", "scene.xml", ""),
        Case::of("empty JSON", "scene.json", ""),
        Case::of("unknown ending", "scene.blend", ""),
        Case::of("no ending", "scene", ""),
        Case::of("no file", "other.xml", "").reading("no.xml"),
        Case::of("a folder", "folder.xml/a", ""),
        Case::of("bytes that are no text", "scene.xml", *b"<scene version=\"3.0.0\">\xff</scene>"),
        Case::of("text in UTF-16", "scene.json", *b"\xff\xfe{\x00}\x00"),
        Case::of("a zero byte", "scene.xml", *b"<scene version=\"3.0.0\">\x00</scene>"),
        Case::of("a seed", "scene.xml", r#"<scene version="3.0.0"><sensor type="perspective"><sampler type="independent"><integer name="seed" value="2"/></sampler></sensor></scene>"#).warned(),
        Case::of(
            "a sampler's jitter",
            "scene.xml",
            r#"<scene version="3.0.0"><sensor type="perspective"><sampler type="stratified"><boolean name="jitter" value="true"/></sampler></sensor></scene>"#,
        )
        .warned(),
        Case::xml("a definition that nothing refers to", r#"<bsdf type="diffuse" id="idle"/>"#).warned(),
        Case::xml("a sensor of Mitsuba's", r#"<sensor type="batch"/>"#),
        Case::xml("a bsdf of Mitsuba's", r#"<bsdf type="hair" id="idle"/>"#),
        Case::json("a tag that is none", r#""a": {"type": "blob", "$tag": "shap"}"#),
        Case::json("a tag of another kind", r#""a": {"type": "sphere", "$tag": "bsdf"}"#),
        Case::json("unknown child in JSON", r#""ball": {"type": "sphere", "skin": {"type": "difuse"}}"#),
        Case::json("an environment without a file", r#""sky": {"type": "envmap"}"#),
        Case::json("an environment that is stretched", r#""sky": {"type": "envmap", "filename": "a.ppm", "to_world": [{"type": "scale", "value": 2}]}"#)
            .beside("a.ppm", "P3 2 3 1  1 1 1  1 1 1  1 1 1  1 1 1  1 1 1  1 1 1\n"),
        Case::json("an environment of one pixel", r#""sky": {"type": "envmap", "filename": "a.ppm"}"#)
            .beside("a.ppm", "P3 1 1 1  1 1 1\n"),
        Case::json("a spot that is stretched", r#""lamp": {"type": "spot", "to_world": [{"type": "scale", "value": [1, 2, 1]}]}"#),
        Case::json("a projector that is stretched", r#""beam": {"type": "projector", "irradiance": 1, "to_world": [{"type": "scale", "value": [1, 2, 1]}]}"#),
        Case::json("a weight beyond all measure", r#""lamp": {"type": "point", "sampling_weight": 1e39}"#),
        Case::json("a profile too bright to hold", r#""lamp": {"type": "point", "profile": "0:1e39"}"#),
        Case::json("a metal that is none", r#""a": {"type": "conductor", "eta": 1e20}"#),
        Case::json("plastic beyond all measure", r#""a": {"type": "plastic", "int_ior": 600}"#),
        Case::json("a black body without a range", r#""lamp": {"type": "point", "intensity": {"type": "blackbody", "temperature": 3000, "wavelength_min": 700, "wavelength_max": 500}}"#),
        Case::json("nulls before path", r#""integrator": {"type": "path", "max_depth": 2}, "a": {"type": "sphere", "bsdf": {"type": "null"}}"#).warned(),
        Case::of("an image beyond all memory", "scene.json", r#"{"type": "scene", "camera": {"type": "perspective", "film": {"type": "hdrfilm", "width": 65536, "height": 65536}}}"#),
        Case::json("a projector without an image", r#""beam": {"type": "projector"}"#),
        Case::json("a beam beside the shapes", r#""beam": {"type": "directionalarea"}"#),
        Case::json("a beam of a disk that is stretched", r#""beam": {"type": "collimated", "to_world": [{"type": "scale", "value": [1, 2, 1]}]}"#),
        Case::json("a beam without a width", r#""beam": {"type": "collimated", "radius": 0}"#),
        Case::json("a beam of power and irradiance", r#""beam": {"type": "collimated", "power": 1, "irradiance": 2}"#),
        Case::json("a beam beyond all measure", r#""beam": {"type": "collimated", "power": 1e20, "radius": 1e-12}"#),
        Case::json("a beam on a shape", r#""ball": {"type": "sphere", "beam": {"type": "collimated"}}"#),
        Case::json("a group without a name", r#""lamp": {"type": "point", "group": ""}"#),
        Case::json("a group with a space", r#""lamp": {"type": "point", "group": "key light"}"#),
        Case::json("a group of dark fog", r#""a": {"type": "sphere", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous", "group": "fog"}}"#),
        Case::json("a point light on a shape", r#""ball": {"type": "sphere", "lamp": {"type": "point"}}"#),
        Case::json("a profile that turns back", r#""lamp": {"type": "point", "profile": "0:1 40:0.5 30:0"}"#),
        Case::json("a profile beyond half a turn", r#""lamp": {"type": "point", "profile": "0:1 200:0"}"#),
        Case::json("a dark profile", r#""lamp": {"type": "point", "profile": "0:0"}"#),
        Case::json("a slide wider than a hemisphere", r#""lamp": {"type": "spot", "cutoff_angle": 95, "texture": {"type": "checkerboard"}}"#),
        Case::of("a lens without a radius", "scene.json", r#"{"type": "scene", "camera": {"type": "thinlens"}}"#),
        Case::of("a lens of no radius", "scene.json", r#"{"type": "scene", "camera": {"type": "thinlens", "aperture_radius": 0}}"#),
        Case::of("a focus behind the lens", "scene.json", r#"{"type": "scene", "camera": {"type": "thinlens", "aperture_radius": 0.1, "focus_distance": -1}}"#),
        Case::of("a camera that is stretched", "scene.json", r#"{"type": "scene", "camera": {"type": "perspective", "to_world": [{"type": "scale", "value": [1, 2, 1]}]}}"#),
        Case::of("two fields of view", "scene.json", r#"{"type": "scene", "camera": {"type": "perspective", "fov": 40, "focal_length": "50mm"}}"#),
        Case::of("a field of view of parallel rays", "scene.json", r#"{"type": "scene", "camera": {"type": "orthographic", "fov": 40}}"#),
        Case::of("a window beside the film", "scene.json", r#"{"type": "scene", "camera": {"type": "perspective", "film": {"type": "hdrfilm", "width": 8, "crop_offset_x": 6, "crop_width": 4}}}"#),
        Case::of("an unknown pixel format", "scene.json", r#"{"type": "scene", "camera": {"type": "perspective", "film": {"type": "hdrfilm", "pixel_format": "rgbx"}}}"#),
        Case::of("a filter of no width", "scene.json", r#"{"type": "scene", "camera": {"type": "perspective", "film": {"type": "hdrfilm", "f": {"type": "gaussian", "stddev": 0}}}}"#),
        Case::json("an unknown quantity", r#""integrator": {"type": "aov", "aovs": "d:depht", "inner": {"type": "path"}}"#),
        Case::json("a quantity without a name", r#""integrator": {"type": "aov", "aovs": "depth", "inner": {"type": "path"}}"#),
        Case::json("moments of nothing", r#""integrator": {"type": "moment"}"#),
        Case::json("a threshold of nothing", r#""integrator": {"type": "fog", "threshold": 0}"#),
        Case::json("fog of a negative colour", r#""integrator": {"type": "fog", "fog_color": -1}"#),
        Case::json("a misspelt colour of fog", r#""integrator": {"type": "fog", "fog_colour": 1}"#),
        Case::json("a preview of some depth", r#""integrator": {"type": "fog", "max_depth": 5}"#).warned(),
        Case::json("single scattering without limit", r#""integrator": {"type": "single_scattering", "max_depth": -1}"#),
        Case::json("single scattering of double depth", r#""integrator": {"type": "single_scattering", "max_depth": 3}"#),
        Case::json("single scattering in no steps", r#""integrator": {"type": "single_scattering", "step": 0}"#),
        Case::json("single scattering beyond all precision", r#""integrator": {"type": "single_scattering", "march_error": 0}"#),
        Case::json("a heuristic nobody knows", r#""integrator": {"type": "bdpt", "heuristic": "powre"}"#),
        Case::json("a cutoff of everything", r#""integrator": {"type": "bdpt", "heuristic": "cutoff:1"}"#),
        Case::xml("scattering or not", r#"<integrator type="nonscattering"/>"#),
        Case::json("a cylinder without a length", r#""a": {"type": "cylinder", "p0": [0, 0, 1], "p1": [0, 0, 1]}"#),
        Case::json("a cylinder out of round", r#""a": {"type": "cylinder", "to_world": [{"type": "scale", "value": [1, 2, 1]}]}"#),
        Case::json("a serialized mesh that is none", r#""a": {"type": "serialized", "filename": "a.bin"}"#).beside("a.bin", "hello"),
        Case::json("a mask of too much", r#""a": {"type": "mask", "opacity": 1.5, "b": {"type": "diffuse"}}"#),
        Case::json("a blend of one", r#""a": {"type": "blendbsdf", "weight": 0.5, "b": {"type": "diffuse"}}"#),
        Case::json("a material of two indices", r#""a": {"type": "principled", "eta": 1.5, "specular": 0.5}"#),
        Case::json("a material too rough", r#""a": {"type": "principled", "roughness": 1.5}"#),
        Case::json("a sheet that transmits too much", r#""a": {"type": "principledthin", "diff_trans": 3}"#),
        Case::json("a lobe sampled by a rate", r#""a": {"type": "principled", "clearcoat_sampling_rate": 2}"#).warned(),
        Case::json("a map of no normals", r#""a": {"type": "normalmap", "b": {"type": "diffuse"}}"#),
        Case::json("a map on two surfaces", r#""a": {"type": "normalmap", "normalmap": 0.5, "b": {"type": "diffuse"}, "c": {"type": "diffuse"}}"#),
        Case::json("bumps of squares", r#""a": {"type": "bumpmap", "t": {"type": "checkerboard"}, "b": {"type": "diffuse"}}"#),
        Case::json("bumps of nothing", r#""a": {"type": "bumpmap", "b": {"type": "diffuse"}}"#),
        Case::json("an attribute of nothing", r#""a": {"type": "diffuse", "reflectance": {"type": "mesh_attribute", "name": "color"}}"#),
        Case::json("an attribute of a sphere", r#""a": {"type": "sphere", "b": {"type": "diffuse", "reflectance": {"type": "mesh_attribute", "name": "vertex_color"}}}"#),
        Case::json("an attribute that the mesh has not", r#""a": {"type": "ply", "filename": "a.ply", "b": {"type": "diffuse", "reflectance": {"type": "mesh_attribute", "name": "face_color"}}}"#).beside("a.ply", PAINTED),
        Case::json("bytes as colours", r#""a": {"type": "ply", "filename": "a.ply", "b": {"type": "diffuse", "reflectance": {"type": "mesh_attribute", "name": "vertex_color"}}}"#).beside("a.ply", PAINTED),
        Case::json("a lamp in colours of its mesh", r#""a": {"type": "ply", "filename": "a.ply", "e": {"type": "area", "radiance": {"type": "mesh_attribute", "name": "vertex_color"}}}"#).beside("a.ply", PAINTED),
        Case::json("a volume too bright", r#""a": {"type": "diffuse", "reflectance": {"type": "volume", "volume": {"type": "constvolume", "value": 2.0}}}"#),
        Case::json("a texture of no volume", r#""a": {"type": "diffuse", "reflectance": {"type": "volume"}}"#),
        Case::json("plastic of no depth", r#""a": {"type": "plastic", "int_ior": -1}"#),
        Case::json("a pane that gives light", r#""a": {"type": "translucent", "transmittance": 2}"#),
        Case::json("a phase function stated twice", r#""fog": {"type": "homogeneous", "p": {"type": "cornette_shanks", "g": 0.7, "u": 0.8}}"#),
        Case::json("a lobe without its height", r#""fog": {"type": "homogeneous", "p": {"type": "mie", "n": 16}}"#),
        Case::json("a phase function out of range", r#""fog": {"type": "homogeneous", "p": {"type": "cornette_shanks", "g": 1}}"#),
        Case::json("an unknown form", r#""fog": {"type": "homogeneous", "p": {"type": "mie_murky", "form": "nishita2"}}"#),
        Case::json("a black body of no temperature", r#""lamp": {"type": "point", "intensity": {"type": "blackbody"}}"#),
        Case::json("wavelengths out of order", r#""lamp": {"type": "point", "intensity": {"type": "irregular", "wavelengths": "500, 400", "values": "1, 2"}}"#),
        Case::json("a spectrum out of gamut", r#""a": {"type": "sphere", "bsdf": {"type": "diffuse", "reflectance": {"type": "spectrum", "value": [[400, 0], [520, 1], [540, 0]]}}}"#).warned(),
        Case::json("a mean free path below what positions tell", r#""a": {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous", "sigma_t": 1e7}}"#).warned(),
        Case::json("a white medium in which nothing gets anywhere", r#""a": {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous", "sigma_t": 1e9, "albedo": 1}}"#).warned(),
        Case::json("a glowing medium too dense for positions", r#""a": {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous", "sigma_t": 1e6, "emission": 1}}"#).warned(),
        Case::json("a medium denser than any", r#""a": {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous", "sigma_t": 1e38}}"#),
        Case::json("a medium too large for its densities", r#""a": {"type": "cube", "bsdf": {"type": "null"}, "to_world": [{"type": "scale", "value": 1e12}], "interior": {"type": "homogeneous", "sigma_t": 1e-12}}"#).warned(),
        Case::json("null collisions without end", r#""a": {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "heterogeneous", "sigma_t": 1e9, "tracker": "null_collision"}}"#),
        Case::json("a scene without light", r#""a": {"type": "rectangle"}"#).warned(),
        Case::json("a camera shut in", r#""a": {"type": "sphere"}, "sky": {"type": "constant"}"#).warned(),
        Case::json("a medium shut in", r#""a": {"type": "sphere", "center": [0, 0, 5], "interior": {"type": "homogeneous"}}, "sky": {"type": "constant"}"#).warned(),
        Case::json("a medium in an open boundary", r#""a": {"type": "cylinder", "p0": [3, 0, 5], "p1": [3, 0, 6], "bsdf": {"type": "null"}, "interior": {"type": "homogeneous"}}, "lamp": {"type": "point"}"#).warned(),
        Case::json("keyframes out of order", r#""sky": {"type": "constant", "radiance": {"type": "keyframes", "value": [[0, 1], [2, 3], [1, 2]]}}"#),
        Case::json("keyframes of two kinds", r#""sky": {"type": "constant", "radiance": {"type": "keyframes", "value": [[0, 1], [2, {"type": "rgb", "value": [1, 2, 3]}]]}}"#),
        Case::json("keyframes of other lengths", r#""a": {"type": "polynomial", "x": {"type": "keyframes", "value": [[0, "1, 2"], [2, "1, 2, 3"]]}}"#),
        Case::json("keyframes of what has no numbers", r#""a": {"type": "sphere", "flip_normals": {"type": "keyframes", "value": [[0, true], [2, false]]}}"#),
        Case::json("keyframes without keys", r#""sky": {"type": "constant", "radiance": {"type": "keyframes", "value": []}}"#),
        Case::json("a key that is no pair", r#""sky": {"type": "constant", "radiance": {"type": "keyframes", "value": [1, 2]}}"#),
        Case::json("an unknown interpolation", r#""sky": {"type": "constant", "radiance": {"type": "keyframes", "interpolation": "smoth", "value": [[0, 1]]}}"#),
        Case::json("a time that changes in time", r#""time": {"type": "keyframes", "value": [[0, 1]]}, "sky": {"type": "constant"}"#),
        Case::json("a value between keys that is out of range", r#""time": 1, "sky": {"type": "constant", "radiance": {"type": "keyframes", "value": [[0, 1], [2, -2]]}}"#),
        Case::xml("a key without a time", r#"<emitter type="constant"><keyframes name="radiance"><float value="1"/></keyframes></emitter>"#),
        Case::xml("a key that is no value", r#"<emitter type="constant"><keyframes name="radiance"><ref id="a"/></keyframes></emitter>"#),
        Case::xml("a key with a name", r#"<emitter type="constant"><keyframes name="radiance"><float name="a" time="0" value="1"/></keyframes></emitter>"#),
        Case::json("a medium that nothing refers to", r#""fog": {"type": "homogeneous"}, "sky": {"type": "constant"}"#).warned(),
        Case::json("an instance of what is no group", r#""a": {"type": "sphere", "id": "ball"}, "b": {"type": "instance", "c": {"type": "ref", "id": "ball"}}, "sky": {"type": "constant"}"#),
        Case::json("an instance of nothing", r#""b": {"type": "instance"}, "sky": {"type": "constant"}"#),
        Case::json("a group without shapes", r#""g": {"type": "shapegroup", "id": "g"}, "b": {"type": "instance", "c": {"type": "ref", "id": "g"}}, "sky": {"type": "constant"}"#),
        Case::json("an instance that is flat", r#""g": {"type": "shapegroup", "id": "g", "a": {"type": "sphere"}}, "b": {"type": "instance", "to_world": [{"type": "scale", "value": [1, 0, 1]}], "c": {"type": "ref", "id": "g"}}, "sky": {"type": "constant"}"#),
        Case::json("a lamp that an instance distorts", r#""g": {"type": "shapegroup", "id": "g", "a": {"type": "sphere", "emitter": {"type": "area"}}}, "b": {"type": "instance", "to_world": [{"type": "scale", "value": [1, 2, 1]}], "c": {"type": "ref", "id": "g"}}"#),
        Case::json("a ball of fog that an instance distorts", r#""g": {"type": "shapegroup", "id": "g", "a": {"type": "sphere", "interior": {"type": "homogeneous"}}}, "b": {"type": "instance", "to_world": [{"type": "scale", "value": [1, 2, 1]}], "c": {"type": "ref", "id": "g"}}, "sky": {"type": "constant"}"#),
        Case::json("a group that no instance refers to", r#""g": {"type": "shapegroup", "id": "g", "a": {"type": "sphere"}}, "sky": {"type": "constant"}"#).warned(),
        Case::json("a merge with a transform of its own", r#""m": {"type": "merge", "to_world": [{"type": "scale", "value": 2}], "a": {"type": "sphere"}}, "sky": {"type": "constant"}"#),
        Case::json("flakes without a matrix", r#""fog": {"type": "homogeneous", "phase": {"type": "sggx"}}"#),
        Case::json("flakes by a number", r#""fog": {"type": "homogeneous", "phase": {"type": "sggx", "S": 1}}"#),
        Case::json("flakes by another volume", r#""fog": {"type": "homogeneous", "phase": {"type": "sggx", "S": {"type": "constvolume"}}}"#),
        Case::json("flakes without thickness", r#""fog": {"type": "homogeneous", "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "flat.vol"}}}"#).beside("flat.vol", &VOXEL.replace("?\0\0\0\0\0\0\0\0\0\0\0\0", "\0\0\0\0\0\0\0\0\0\0\0\0\0")),
        Case::json("flakes of which a voxel has no thickness", r#""fog": {"type": "homogeneous", "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "two.vol"}}}"#).beside("two.vol", &(VOXEL.replacen("VOL\x03\x01\0\0\0\x01", "VOL\x03\x01\0\0\0\x02", 1) + &VOXEL[48..].replacen('?', "\0", 1))),
        Case::json("flakes of which there are none", r#""fog": {"type": "homogeneous", "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "none.vol"}}}"#).beside("none.vol", &VOXEL.replace('?', "\0")),
        Case::json("flakes that are far too small", r#""fog": {"type": "homogeneous", "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "small.vol"}}}"#).beside("small.vol", &VOXEL.replace('?', "\x10")),
        Case::json("flakes without end of which a voxel has none", r#""fog": {"type": "homogeneous", "id": "fog", "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "two.vol"}}}, "eye": {"type": "perspective", "medium": {"type": "ref", "id": "fog"}}"#).beside("two.vol", &(VOXEL.replacen("VOL\x03\x01\0\0\0\x01", "VOL\x03\x01\0\0\0\x02", 1) + &VOXEL[48..].replace('?', "\0"))),
        Case::json("flakes by a density", r#""fog": {"type": "homogeneous", "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "one.vol"}}}"#).beside("one.vol", &VOXEL.replace('\x06', "\x01")),
        Case::json("a density of six channels", r#""fog": {"type": "heterogeneous", "sigma_t": {"type": "gridvolume", "filename": "flakes.vol"}}"#).beside("flakes.vol", VOXEL),
        Case::json("flakes that show too much", r#""fog": {"type": "sphere", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous", "sigma_t": 10, "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "wide.vol"}}}}, "sky": {"type": "constant"}"#).beside("wide.vol", &VOXEL.replace('?', "Q")).warned(),
        Case::flakes("flakes that emit", "homogeneous", r#""emission": 1, "#),
        Case::flakes("flakes by steps", "heterogeneous", r#""tracker": "march", "#),
        Case::json("flakes in a blend", r#""fog": {"type": "homogeneous", "phase": {"type": "blendphase", "weight": 0.5, "a": {"type": "hg"}, "b": {"type": "sggx", "S": {"type": "gridvolume", "filename": "flakes.vol"}}}}"#).beside("flakes.vol", VOXEL),
        Case::json("a sky by direction and by time", r#""sky": {"type": "sunsky", "sun_direction": [1, 0, 1], "hour": 9}"#),
        Case::json("a sky at night", r#""sky": {"type": "sunsky", "hour": 23}"#).warned(),
        Case::json("a window that ends before it starts", r#""sky": {"type": "timed_sunsky", "end_year": 2024}"#),
        Case::json("hours across midnight", r#""sky": {"type": "timed_sunsky", "window_start_time": 22, "window_end_time": 4}"#),
        Case::json("an end on no day of its month", r#""sky": {"type": "timed_sunsky", "end_month": 2, "end_day": 30}"#),
        Case::json("a window at night", r#""sky": {"type": "timed_sunsky", "window_start_time": 0, "window_end_time": 3}"#).warned(),
        Case::json("a sky too hazy", r#""sky": {"type": "sunsky", "turbidity": 12}"#),
        Case::json("a sun of no direction", r#""sky": {"type": "sunsky", "sun_direction": [0, 0, 0]}"#),
        Case::xml("an axis that is no unit vector", r#"<shape type="sphere"><transform name="to_world"><rotate value="1 1 0" angle="90"/></transform></shape><emitter type="point"/>"#).warned(),
        Case::old("a film of old", r#"<film type="ldrfilm"><string name="fileFormat" value="png"/><float name="gamma" value="-1"/><boolean name="highQualityEdges" value="true"/></film>"#).warned(),
        Case::old("a material of old", r#"<medium type="homogeneous"><string name="material" value="skin1"/></medium>"#).warned(),
        Case::old("an unknown material of old", r#"<medium type="homogeneous"><string name="material" value="skin"/></medium>"#),
        Case::old("coefficients of two kinds", r#"<medium type="homogeneous"><spectrum name="sigmaS" value="400:1, 700:2"/><float name="sigmaA" value="1"/></medium>"#),
        Case::old("scattering alone", r#"<medium type="homogeneous"><float name="sigmaS" value="1"/></medium>"#),
        Case::old("subsurface scattering of old", r#"<subsurface type="dipole"/>"#),
        Case::json("two comments of one key", r#""//": "a", "//": "b""#),
        Case::of("a comma too few", "scene.json", "{\"type\": \"scene\",\n \"a\": {\"type\": \"sphere\"}\n \"b\": {\"type\": \"cube\"}}"),
        Case::of("a comma too few in a list", "scene.json", r#"{"type": "scene", "a": {"type": "sphere", "center": [1 2, 3]}}"#),
        Case::of("a colon too few", "scene.json", r#"{"type": "scene", "a" {"type": "sphere"}}"#),
        Case::of("single quotes", "scene.json", "{'type': 'scene'}"),
        Case::of("Python's words", "scene.json", r#"{"type": "scene", "a": {"type": "sphere", "flip_normals": True}}"#),
        Case::json("a number in quotes", r#""ball": {"type": "sphere", "radius": "0.5"}"#),
        Case::json("numbers in quotes", r#""ball": {"type": "sphere", "center": ["0", 1, 2]}"#),
        Case::json("a matrix of ragged rows", r#""ball": {"type": "sphere", "to_world": [{"type": "matrix", "value": [[1, 0], [0, 1]]}]}"#),
        Case::of("a film's width on the sensor", "scene.json", r#"{"type": "scene", "camera": {"type": "perspective", "width": 64}}"#),
        Case::json("a sky of another renderer", r#""a": {"type": "sky"}"#),
        Case::xml("a medium of a common word", r#"<shape type="sphere"><medium type="fog" name="interior"/></shape>"#),
        Case::json("a medium called after a preview", r#""a": {"type": "cube", "interior": {"type": "fog", "sigma_t": 1}}"#),
        Case::json("a density in place of the extinction", r#""a": {"type": "cube", "interior": {"type": "heterogeneous", "density": 1}}"#),
        Case::json("a method in place of a tracker", r#""a": {"type": "cube", "interior": {"type": "heterogeneous", "method": "woodcock"}}"#),
        Case::xml("curves", r#"<shape type="bsplinecurve"><string name="filename" value="a.txt"/></shape>"#),
        Case::xml("polarised light", r#"<bsdf type="retarder"/>"#),
        Case::xml("Stokes vectors", r#"<integrator type="stokes"/>"#),
        Case::json("direct light with media", r#""integrator": {"type": "direct", "bsdf_samples": 2}, "a": {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous"}}, "sky": {"type": "constant"}"#).warned(),
        Case::json("an irradiancemeter beside the shapes", r#""m": {"type": "irradiancemeter"}, "ball": {"type": "sphere"}"#),
        Case::json("an irradiancemeter on a shape in a group", r#""a": {"type": "instance", "g": {"type": "shapegroup", "ball": {"type": "sphere", "m": {"type": "irradiancemeter"}}}}"#),
        Case::of("an irradiancemeter before two media", "scene.json", r#"{"type": "scene", "wall": {"type": "rectangle", "m": {"type": "irradiancemeter"}}, "fog": {"type": "cube", "to_world": [{"type": "translate", "value": [1.2, 0, 0]}], "bsdf": {"type": "null"}, "interior": {"type": "homogeneous"}}, "sky": {"type": "constant"}}"#).warned(),
        Case::of("an irradiancemeter placed by itself", "scene.json", r#"{"type": "scene", "ball": {"type": "sphere", "m": {"type": "irradiancemeter", "to_world": []}}}"#),
        Case::of("a radiancemeter with an image", "scene.json", r#"{"type": "scene", "m": {"type": "radiancemeter", "film": {"type": "hdrfilm", "width": 2, "height": 1}}}"#),
        Case::of("a ray without a start", "scene.json", r#"{"type": "scene", "m": {"type": "radiancemeter", "direction": [0, 0, 1]}}"#),
        Case::of("a ray placed twice", "scene.json", r#"{"type": "scene", "m": {"type": "radiancemeter", "origin": [0, 0, 0], "direction": [0, 0, 1], "to_world": []}}"#),
        Case::of("rays of no direction", "scene.json", r#"{"type": "scene", "m": {"type": "distant", "direction": [0, 0, 0]}}"#),
        Case::of("a target of several shapes", "scene.json", r#"{"type": "scene", "m": {"type": "distant", "target": {"type": "merge", "a": {"type": "sphere"}}}}"#),
        Case::of("a target along the rays", "scene.json", r#"{"type": "scene", "m": {"type": "distant", "direction": [1, 0, 0], "target": {"type": "disk"}}}"#),
        Case::of("two targets", "scene.json", r#"{"type": "scene", "m": {"type": "distant", "target": {"type": "disk"}, "other": {"type": "rectangle"}}}"#),
        Case::of("a misspelt parameter of a target", "scene.json", r#"{"type": "scene", "m": {"type": "distant", "target": {"type": "disk", "radius": 2}}}"#),
        Case::of("a batch without sensors", "scene.json", r#"{"type": "scene", "b": {"type": "batch"}, "sky": {"type": "constant"}}"#),
        Case::of("a batch whose film has no equal parts", "scene.json", r#"{"type": "scene", "b": {"type": "batch", "x": {"type": "perspective"}, "y": {"type": "perspective"}, "f": {"type": "hdrfilm", "width": 63}}, "sky": {"type": "constant"}}"#),
    ]
}
