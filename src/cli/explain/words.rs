//! What is no plugin and may be asked for: the language of scenes, and everyday things.

/// A word, or several that mean the same.
pub(super) struct Word {
    /// The first one is the heading.
    pub(super) names: &'static [&'static str],
    /// In lines of at most 100 characters.
    pub(super) about: &'static str,
    /// Entries of a scene, which may be pasted into one.
    pub(super) example: &'static str,
    /// What to ask for next.
    pub(super) next: &'static [&'static str],
}

/// The language first.
pub(super) const WORDS: [Word; 15] = [
    Word {
        names: &["transform", "translate", "rotate", "scale", "lookat", "look_at", "matrix"],
        about: "\
A list of steps. The first step is applied first.
  scale      by \"value\": one number, or three for x, y and z
  rotate     by \"angle\" degrees about \"axis\", counter-clockwise seen against the axis
  translate  by \"value\"
  lookat     places a camera or lamp at \"origin\", its +z towards \"target\", its +y near \"up\"
  matrix     by \"value\": 16 numbers, or 9, row by row
In XML: <transform name=\"to_world\"> <rotate y=\"1\" angle=\"90\"/> ... </transform>",
        example: r#"
"box": {
  "type": "cube",
  "to_world": [
    { "type": "scale", "value": [2, 1, 1] },
    { "type": "rotate", "axis": [0, 1, 0], "angle": 90 },
    { "type": "translate", "value": [0, 1, 0] }
  ]
}"#,
        next: &["keyframes"],
    },
    Word {
        names: &["ref", "reference", "id"],
        about: "\
A reference to an object elsewhere in the file, by its id. A direct child of the scene has its
key as id; any other object may have an \"id\". The order in the file does not matter.
In XML: <ref id=\"fog\"/>",
        example: r#"
"fog": { "type": "homogeneous", "sigma_t": 0.2 },
"bank": { "type": "cube", "bsdf": { "type": "null" }, "interior": { "type": "ref", "id": "fog" } }"#,
        next: &["medium", "bsdf"],
    },
    Word {
        names: &["rgb", "spectrum", "colour", "color"],
        about: "\
A colour is a number (grey), an rgb value, a spectrum, or a plugin of colour. Three numbers are
linear sRGB; \"#ff8000\" is a colour as on a screen. A spectrum has pairs of a wavelength [nm] and
a value. Images have three channels, of linear sRGB.
In XML: <rgb name=\"reflectance\" value=\"0.7, 0.25, 0.1\"/>",
        example: r##"
"red": { "type": "diffuse", "reflectance": { "type": "rgb", "value": [0.7, 0.25, 0.1] } },
"orange": { "type": "diffuse", "reflectance": { "type": "rgb", "value": "#ff8000" } },
"brown": { "type": "diffuse", "reflectance": { "type": "spectrum", "value": [[400, 0.1], [700, 0.6]] } }"##,
        next: &["texture"],
    },
    Word {
        names: &["include", "alias"],
        about: "\
XML only. An include puts the objects of another file in its place; a path names a folder in which
files are looked for; an alias gives an object a second name.
  <include filename=\"parts/camera.xml\"/>
  <path value=\"textures\"/>
  <alias id=\"fog\" as=\"mist\"/>
\"tyndall convert scene.xml scene.json\" writes everything into one file.",
        example: "",
        next: &[],
    },
    Word {
        names: &["defaults", "$defaults", "default", "parameter"],
        about: "\
Parameters of a scene: \"$density\" in place of a value is the value of \"$defaults\", or that of
\"tyndall render fog.json -D density=0.5\".
In XML: <default name=\"density\" value=\"0.15\"/>, before \"$density\".",
        example: r#"
"$defaults": { "density": 0.15 },
"fog": { "type": "homogeneous", "sigma_t": "$density" },
"bank": { "type": "cube", "bsdf": { "type": "null" }, "interior": { "type": "ref", "id": "fog" } }"#,
        next: &["ref"],
    },
    Word {
        names: &["fog", "mist", "haze", "dust"],
        about: "\
A medium in a boundary. The boundary is a closed shape without a surface of its own (\"null\"), the
medium its \"interior\". A camera in the fog names it too: \"medium\": { \"type\": \"ref\", \"id\": \"fog\" }.
Light flies 1 / sigma_t metres between collisions: in a room, sigma_t is 0.05 to 0.5. \"albedo\" is
the part of the collisions that scatter. \"tyndall new fog\" writes a scene.",
        example: r#"
"fog": { "type": "homogeneous", "sigma_t": 0.15, "albedo": 0.95, "phase": { "type": "hg", "g": 0.6 } },
"bank": { "type": "cube", "bsdf": { "type": "null" }, "interior": { "type": "ref", "id": "fog" } }"#,
        next: &["homogeneous", "exponential", "noise", "phase"],
    },
    Word {
        names: &["cloud", "steam"],
        about: "\
A medium that varies and hardly absorbs: a volume file, or functions. \"tyndall new cloud\" writes a
scene. \"tyndall render cloud.vdb\" renders a volume file.",
        example: r#"
"cloud": {
  "type": "cube", "bsdf": { "type": "null" },
  "interior": {
    "type": "heterogeneous", "albedo": 0.99,
    "sigma_t": { "type": "noise", "frequency": 2, "bias": 0.5, "amplitude": 10 }
  }
}"#,
        next: &["smoke", "heterogeneous", "noise"],
    },
    Word {
        names: &["fire", "flame"],
        about: "\
A medium that emits. A volume file with flames or temperatures is the shape \"smoke\", whose
\"emission_scale\" is how bright they are. Any medium emits by \"emission\", \"radiance\" or
\"temperature\".",
        example: r#"
"fire": {
  "type": "sphere", "bsdf": { "type": "null" },
  "interior": { "type": "homogeneous", "sigma_t": 0.5, "albedo": 0.2, "temperature": 1800 }
}"#,
        next: &["smoke", "heterogeneous"],
    },
    Word {
        names: &["sun"],
        about: "\
Parallel light, or a clear sky with the sun in it. Shafts of sunlight need fog with a boundary:
light from infinity does not come through fog without end.",
        example: r#"
"sun": { "type": "directional", "direction": [1, -2, -1], "irradiance": { "type": "rgb", "value": [4, 3.6, 3] } }"#,
        next: &["directional", "sunsky", "sky"],
    },
    Word {
        names: &["sky"],
        about: "\
A constant radiance, an image of the surroundings, or a clear sky with its sun. The model of a sky
has +z up; this turns it to +y.",
        example: r#"
"sky": {
  "type": "sunsky", "sun_direction": [1, 2, 1],
  "to_world": [{ "type": "rotate", "axis": [1, 0, 0], "angle": -90 }]
}"#,
        next: &["constant", "envmap", "sunsky"],
    },
    Word {
        names: &["lamp", "light", "laser"],
        about: "\
A shape with an emitter in it, or a point of light, a spot, a projector, a beam. An \"area\" lamp
emits from the front of its shape: that of a rectangle or disk faces +z.",
        example: r#"
"panel": { "type": "rectangle", "emitter": { "type": "area", "radiance": 10 } },
"spot": {
  "type": "spot", "intensity": 100, "cutoff_angle": 25,
  "to_world": [{ "type": "lookat", "origin": [0, 3, 0], "target": [1, 0, 0] }]
}"#,
        next: &["area", "spot", "point", "projector", "collimated"],
    },
    Word {
        names: &["window", "pane"],
        about: "\
A hole in a wall, or a pane. The wall needs a hole: build it of several shapes around it. Where dust
ends at the hole, a \"null\" rectangle is its boundary. A pane of clear glass is a rectangle of
\"thindielectric\", frosted glass \"roughdielectric\", stained glass \"translucent\" with a texture.
\"tyndall new room\" writes a room with a window.",
        example: r#"
"pane": { "type": "rectangle", "bsdf": { "type": "thindielectric" } }"#,
        next: &["thindielectric", "roughdielectric", "translucent", "null"],
    },
    Word {
        names: &["glass"],
        about: "\
A closed shape of \"dielectric\", smooth, or \"roughdielectric\", frosted. \"int_ior\" is its index of
refraction, or a material. A pane too thin to bend light is a \"thindielectric\". Light of a small
lamp by way of smooth glass is hard to find where it is seen by way of glass again: --soften.",
        example: r#"
"ball": { "type": "sphere", "bsdf": { "type": "dielectric", "int_ior": "bk7" } }"#,
        next: &["dielectric", "roughdielectric", "thindielectric"],
    },
    Word {
        names: &["water", "sea", "milk"],
        about: "\
A closed shape of \"dielectric\" with a medium inside. Clear water absorbs red most; murky water
scatters too. Waves are the shape of a mesh, or a \"bumpmap\".",
        example: r#"
"pool": {
  "type": "cube", "bsdf": { "type": "dielectric", "int_ior": "water" },
  "interior": {
    "type": "homogeneous",
    "sigma_t": { "type": "rgb", "value": [0.45, 0.15, 0.12] },
    "albedo": { "type": "rgb", "value": [0.2, 0.5, 0.6] },
    "phase": { "type": "hg", "g": 0.8 }
  }
}"#,
        next: &["dielectric", "homogeneous", "bumpmap"],
    },
    Word {
        names: &["mirror", "metal", "gold"],
        about: "\
A \"conductor\" is polished, a \"roughconductor\" is not. \"material\" names a metal; \"none\" is a
perfect mirror.",
        example: r#"
"mirror": { "type": "rectangle", "bsdf": { "type": "conductor", "material": "none" } },
"ball": { "type": "sphere", "bsdf": { "type": "roughconductor", "material": "Au", "alpha": 0.2 } }"#,
        next: &["conductor", "roughconductor"],
    },
];

/// What a word means, if it is one.
pub(super) fn word(topic: &str) -> Option<String> {
    let word = WORDS.iter().find(|word| word.names.contains(&topic))?;
    let mut text = format!("{}\n{}\n", word.names.join(", "), word.about);
    if !word.example.is_empty() {
        text += &format!("\nIn a scene:{}\n", word.example.replace('\n', "\n  "));
    }
    if !word.next.is_empty() {
        text += &format!(
            "\nMore: {}\n",
            word.next.iter().map(|next| format!("tyndall explain {next}")).collect::<Vec<_>>().join(", ")
        );
    }
    Some(text)
}

/// All words.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    WORDS.iter().flat_map(|word| word.names.iter().copied())
}

/// A line for the list of all.
pub(super) fn heads() -> String {
    let heads: Vec<_> = WORDS.iter().map(|word| word.names[0]).collect();
    format!("Words: {}", heads.join(", "))
}
