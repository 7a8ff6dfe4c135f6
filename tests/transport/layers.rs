//! What a film can be asked for besides the whole image: windows of it, alpha, layers of the first surface,
//! moments.

use crate::common::{
    self, Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::{
    math::{Spectrum, Vec3, vec3},
    render::Image,
    scene::build::build,
    settings::Overrides,
    transport::Strategies,
};

/// An image with all its layers, of which the scene's integrator tells.
fn image(stage: &Stage, samples_per_pixel: u64, seed: u64) -> Image {
    stage.render_layers(Strategies::PT, samples_per_pixel, seed)
}

/// The channel called `name`.
fn channel<'a>(image: &'a Image, name: &str) -> &'a [f32] {
    let names: Vec<&str> = image.layers.iter().map(|channel| channel.name.as_str()).collect();
    let found = image.layers.iter().find(|channel| channel.name == name);
    &found.unwrap_or_else(|| panic!("no {name} among {names:?}")).values
}

/// The channels `name`.X, Y, Z as vectors.
fn vectors(image: &Image, name: &str) -> Vec<Vec3> {
    let [x, y, z] = ["X", "Y", "Z"].map(|axis| channel(image, &format!("{name}.{axis}")));
    x.iter().zip(y).zip(z).map(|((x, y), z)| vec3(*x, *y, *z)).collect()
}

const ALL: &str = "d:depth,p:position,n:sh_normal,g:geo_normal,uv:uv,u:dp_du,v:dp_dv,x:duv_dx,y:duv_dy,a:albedo,\
                   i:prim_index,s:shape_index";

fn aov(aovs: &str) -> Value {
    json!({"type": "aov", "aovs": aovs, "img": {"type": "path", "max_depth": 2}})
}

const SIZE: u32 = 8;

/// A square of half side 3 that faces a camera 4 m away, both moved by `at`.
fn facing(at: [f64; 3], more: &[(&str, Value)]) -> Value {
    let [x, y, z] = at;
    let wall = json!({
        "type": "rectangle", "bsdf": diffuse(rgb(0.2, 0.5, 0.8)), "to_world": place([3.0; 3], at),
    });
    let mut parts =
        vec![("integrator", aov(ALL)), ("sensor", camera([x, y, z + 4.0], [x, y, z], SIZE)), ("wall", wall)];
    parts.extend(more.iter().cloned());
    scene(&parts)
}

/// Film coordinates of a pixel's corners, as offsets from the axis at distance 1.
fn corners(pixel: usize) -> [(f64, f64); 4] {
    let (x, y) = (pixel % SIZE as usize, pixel / SIZE as usize);
    let scale = 2.0 * (22.5f64).to_radians().tan() / f64::from(SIZE);
    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
        (((x + dx) as f64 - f64::from(SIZE / 2)) * scale, (f64::from(SIZE / 2) - (y + dy) as f64) * scale)
    })
}

/// `found` lies among values at a pixel's corners.
fn assert_within(found: f32, corners: [f64; 4], slack: f64) {
    let (low, high) = corners.iter().fold((f64::MAX, f64::MIN), |(a, b), c| (a.min(*c), b.max(*c)));
    let found = f64::from(found);
    assert!(found > low - slack && found < high + slack, "{found}, not from {low} to {high}");
}

#[test]
fn a_wall_is_described_as_it_is() {
    // Far from the file's origin positions are still those of the file.
    for at in [[0.0; 3], [4096.0, -2048.0, 8192.0]] {
        let image = image(&Stage::new(&facing(at, &[])), 4, 1);
        let at = Vec3::from_array(at.map(|c| c as f32));
        let (positions, normals) = (vectors(&image, "p"), vectors(&image, "n"));
        let (depths, u, v) = (channel(&image, "d.T"), channel(&image, "uv.U"), channel(&image, "uv.V"));
        for pixel in 0..(SIZE * SIZE) as usize {
            let ends = corners(pixel);
            // The camera's axis pierces pixels at their corners only, so no other point is nearer or farther.
            assert_within(depths[pixel], ends.map(|(x, y)| 3.999 * (1.0 + x * x + y * y).sqrt()), 1e-5);
            let position = positions[pixel] - at;
            assert!(position.z.abs() < 1e-3, "{position}");
            assert_within(position.x, ends.map(|(x, _)| 4.0 * x), 1e-3);
            assert_within(position.y, ends.map(|(_, y)| 4.0 * y), 1e-3);
            assert!((u[pixel] - (position.x / 6.0 + 0.5)).abs() < 2e-4);
            assert!((v[pixel] - (position.y / 6.0 + 0.5)).abs() < 2e-4);
            assert_eq!(normals[pixel], Vec3::Z);
        }
        assert_eq!(vectors(&image, "g"), normals);
        for (name, expected) in [("u", 6.0 * Vec3::X), ("v", 6.0 * Vec3::Y)] {
            assert!(vectors(&image, name).iter().all(|found| (found - expected).length() < 1e-2), "{name}");
        }
        // One pixel, halved for 4 samples.
        let step = (4.0 * 2.0 * (22.5f32).to_radians().tan() / SIZE as f32 / 6.0) / 2.0;
        assert!(channel(&image, "x.U").iter().all(|du| (du - step).abs() < 1e-3 * step));
        assert!(channel(&image, "y.V").iter().all(|dv| (dv + step).abs() < 1e-3 * step));
        assert!(channel(&image, "a.G").iter().all(|g| (g - 0.5).abs() < 1e-6));
        assert!(channel(&image, "i.I").iter().all(|index| *index == 0.0));
        assert!(channel(&image, "s.I").iter().all(|index| *index == 1.0));
    }
}

/// Values of Mitsuba 3.9.1 for a sphere at one point of its surface: the formulas, not an image.
#[test]
fn a_sphere_has_the_partials_of_its_coordinates() {
    for mirror in [1f32, -1.0] {
        let ball = json!({"type": "sphere", "to_world": place([mirror.into(), 1.0, 1.0], [0.0, 0.3, -0.5])});
        let stage = Stage::new(&facing([0.0; 3], &[("ball", ball)]));
        let image = image(&stage, 1, 3);
        let (positions, shapes) = (vectors(&image, "p"), channel(&image, "s.I"));
        let (du, dv) = (vectors(&image, "u"), vectors(&image, "v"));
        let seen: Vec<usize> = (0..shapes.len()).filter(|i| shapes[*i] == 2.0).collect();
        assert!(seen.len() > 4);
        for i in seen {
            let p = positions[i] - vec3(0.0, 0.3, -0.5);
            let (tau, across) = (std::f32::consts::TAU, p.x.hypot(p.y));
            let along_u = vec3(-p.y, p.x, 0.0) * tau * mirror;
            let along_v = vec3(p.z * p.x / across, p.z * p.y / across, -across) * (0.5 * tau);
            assert!((du[i] - along_u).length() < 1e-3, "{mirror}: {} not {along_u}", du[i]);
            assert!((dv[i] - along_v).length() < 1e-3, "{mirror}: {} not {along_v}", dv[i]);
        }
    }
}

/// As in Mitsuba, where a boundary that nothing scatters at is a surface too.
#[test]
fn null_boundaries_are_seen_and_nothing_is_nothing() {
    let fog = null_box([-9.0, -9.0, 1.0], [9.0, 9.0, 2.0], Some(medium(1.0, 0.5, 0.0)));
    let before = image(&Stage::new(&facing([0.0; 3], &[("fog", fog)])), 1, 1);
    assert!(channel(&before, "s.I").iter().all(|index| *index == 2.0));
    assert!(vectors(&before, "p").iter().all(|p| (p.z - 2.0).abs() < 1e-4));
    assert!(channel(&before, "a.R").iter().all(|albedo| *albedo == 0.0));
    let empty = with(facing([0.0; 3], &[]), &[("wall", json!({"type": "sphere", "center": [0, 0, 50]}))]);
    let empty = image(&Stage::new(&empty), 1, 1);
    assert!(empty.layers.iter().all(|channel| channel.values.iter().all(|value| *value == 0.0)));
}

/// What a denoiser looks at: behind the boundary of a slab of fog, whose albedo is 1, a red wall is seen with the chance
/// that a flight reaches it.
#[test]
fn the_first_interaction_is_that_of_a_free_flight() {
    const SAMPLES: u64 = 1024;
    // Of 64 pixels, one is further off with a probability of 1e-3.
    const LIMIT: f64 = 4.4;
    let fog = null_box([-9.0, -9.0, 1.0], [9.0, 9.0, 2.0], Some(medium(0.7, 1.0, 0.0)));
    let wall = json!({"type": "rectangle", "bsdf": diffuse(rgb(0.5, 0.0, 0.0)), "to_world": place([3.0; 3], [0.0; 3])});
    let layers = aov("a:first_albedo,n:first_normal,g:geo_normal");
    let scene = with(facing([0.0; 3], &[("fog", fog)]), &[("integrator", layers), ("wall", wall)]);
    let image = image(&Stage::new(&scene), SAMPLES, 1);
    let normals = vectors(&image, "n");
    for (pixel, collided) in channel(&image, "a.G").iter().enumerate() {
        let collided = f64::from(*collided);
        let chances = corners(pixel).map(|(x, y)| 1.0 - (-0.7 * (1.0 + x * x + y * y).sqrt()).exp());
        let (least, most) =
            (chances.iter().copied().fold(1.0, f64::min), chances.iter().copied().fold(0.0, f64::max));
        let off = (least - collided).max(collided - most);
        let z = off / (most * (1.0 - most) / SAMPLES as f64).sqrt();
        assert!(z < LIMIT, "pixel {pixel}: {collided}, not within {least} and {most}: z {z}");
        let red = f64::from(channel(&image, "a.R")[pixel]);
        assert!((red - (0.5 + 0.5 * collided)).abs() < 1e-4, "{red}, {collided}");
        // Of collisions towards the camera, of the wall (0, 0, 1).
        let sideways = corners(pixel).map(|(x, y)| -x * collided / (1.0 + x * x + y * y).sqrt());
        assert_within(normals[pixel].x, sideways, 0.02);
        assert!(normals[pixel].length() > 0.9 && normals[pixel].length() <= 1.0 + 1e-5);
    }
}

#[test]
fn alpha_is_the_chance_to_meet_something() {
    let film = |scene: Value| {
        let sensor = with(scene["sensor"].clone(), &[]);
        let film = with(sensor["film"].clone(), &[("pixel_format", json!("rgba"))]);
        with(scene, &[("integrator", json!({"type": "path"})), ("sensor", with(sensor, &[("film", film)]))])
    };
    let gone = ("wall", json!({"type": "sphere", "center": [0, 0, 50]}));
    let alpha = |more: &[(&str, Value)]| {
        let image = image(&Stage::new(&film(with(facing([0.0; 3], &[]), more))), 2, 1);
        assert!(image.layers.is_empty());
        image.alpha
    };
    let all = |alpha: Vec<f32>, expected: f32| alpha.iter().all(|a| *a == expected);
    let hidden = |hide: bool| ("integrator", json!({"type": "path", "hide_emitters": hide}));
    assert!(all(alpha(&[]), 1.0), "a wall");
    assert!(all(alpha(std::slice::from_ref(&gone)), 0.0), "nothing");
    assert!(all(alpha(&[gone.clone(), ("sky", sky(0.0))]), 1.0), "a sky, even a black one");
    // `film` sets the integrator: hidden emitters by hand.
    let bare = |scene: Value| image(&Stage::new(&with(film(scene), &[hidden(true)])), 2, 1).alpha;
    let lamp =
        json!({"type": "rectangle", "to_world": place([3.0; 3], [0.0; 3]), "emitter": {"type": "area"}});
    assert!(all(bare(with(facing([0.0; 3], &[]), &[("wall", lamp.clone())])), 0.0), "a hidden lamp");
    assert!(all(alpha(&[("wall", lamp)]), 1.0), "a lamp");
    assert!(all(bare(with(facing([0.0; 3], &[]), &[gone.clone(), ("sky", sky(1.0))])), 0.0), "a hidden sky");
    // A slab 1 m thick, per channel 0.2, 0.5 and 1 deep: three ways through it.
    let fog = null_box([-9.0, -9.0, 1.0], [9.0, 9.0, 2.0], Some(medium(rgb(0.2, 0.5, 1.0), 0.5, 0.0)));
    let through =
        |length: f64| 1.0 - [0.2f64, 0.5, 1.0].map(|s| (-s * length).exp()).iter().sum::<f64>() / 3.0;
    for (pixel, alpha) in alpha(&[gone, ("fog", fog)]).into_iter().enumerate() {
        let chances = corners(pixel).map(|(x, y)| through((1.0 + x * x + y * y).sqrt()));
        assert_within(alpha, chances, 1e-5);
    }
}

/// Light subpaths fill the pixels as camera subpaths do, at the film's border too, whatever the filter.
#[test]
fn eye_and_light_walks_filter_alike() {
    for filter in ["gaussian", "mitchell", "lanczos"] {
        let stage = Stage::new(&lit_room(&[("rfilter", json!({"type": filter})), ("height", json!(3))]));
        let [eye, light, both] = [Strategies::PT, Strategies::LT, Strategies::BDPT]
            .map(|set| Sample::of(&stage.renders(set, 64, 0..12), stage.width()));
        let mut claims = Claims::new();
        claims.equal(&format!("{filter}: lt against pt"), &light, &eye);
        claims.equal(&format!("{filter}: bdpt against pt"), &both, &eye);
        claims.settle();
    }
}

fn lit_room(film: &[(&str, Value)]) -> Value {
    let sensor = camera([0.0, 0.0, 0.9], [0.1, 0.2, -1.0], 12);
    let film = with(sensor["film"].clone(), film);
    scene(&[
        ("integrator", aov(ALL)),
        ("sensor", with(sensor, &[("film", film)])),
        ("room", room(0.6, Some(medium(0.5, 0.8, 0.3)))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
    ])
}

const CROP: [(&str, u32); 4] =
    [("crop_offset_x", 5), ("crop_offset_y", 1), ("crop_width", 6), ("crop_height", 8)];

/// A window shows what it would show as part of the whole film.
#[test]
fn a_crop_window_is_part_of_the_whole() {
    for filter in ["box", "mitchell"] {
        let filter = ("rfilter", json!({"type": filter}));
        let mut crop: Vec<(&str, Value)> = CROP.map(|(name, value)| (name, json!(value))).to_vec();
        crop.push(filter.clone());
        // Where the filter reaches beyond the window, its border differs unless that is sampled too.
        crop.push(("sample_border", json!(true)));
        let (part, whole) = (Stage::new(&lit_room(&crop)), Stage::new(&lit_room(&[filter])));
        let cut = |whole: &[Spectrum]| -> Vec<Spectrum> {
            (0..48).map(|i| whole[(i / 6 + 1) * 12 + i % 6 + 5]).collect()
        };
        let mut claims = Claims::new();
        for (i, set) in [Strategies::PT, Strategies::LT, Strategies::BDPT].into_iter().enumerate() {
            let first = 100 * i as u64;
            let a = part.renders(set, 32, first..first + 12);
            let b: Vec<_> = whole.renders(set, 32, first + 50..first + 62).iter().map(|w| cut(w)).collect();
            claims.equal(&common::name_of(set), &Sample::of(&a, 6), &Sample::of(&b, 6));
        }
        claims.settle();
    }
    let crop = CROP.map(|(name, value)| (name, json!(value)));
    let (part, whole) =
        (image(&Stage::new(&lit_room(&crop)), 4, 1), image(&Stage::new(&lit_room(&[])), 4, 2));
    let whole = vectors(&whole, "n");
    for (i, normal) in vectors(&part, "n").iter().enumerate() {
        let other = whole[(i / 6 + 1) * 12 + i % 6 + 5];
        // Walls and ball are whole pixels apart nearly everywhere.
        assert!(
            normal.dot(other) > 0.3 || normal.length() < 0.99 || other.length() < 0.99,
            "{normal} {other}"
        );
    }
}

#[test]
fn moments_of_what_does_not_vary() {
    let moment = json!({"type": "moment", "img": {"type": "path"}});
    let sky = ("sky", sky(rgb(0.5, 1.0, 2.0)));
    let behind = ("ball", json!({"type": "sphere", "center": [0, 0, -5]}));
    let parts = [("integrator", moment), ("sensor", camera([0.0; 3], [0.0, 0.0, 1.0], 4)), behind, sky];
    let image = image(&Stage::new(&scene(&parts)), 5, 1);
    // sRGB primaries and D65, to four digits.
    let xyz = vec3(0.92466, 0.965_83, 2.029_31);
    for (mean, square) in vectors(&image, "img").into_iter().zip(vectors(&image, "m2_img")) {
        assert!((mean - xyz).abs().max_element() < 1e-4, "{mean}");
        assert!((square - xyz * xyz).abs().max_element() < 3e-4, "{square}");
    }
    for name in ["variance.R", "variance.G", "variance.B"] {
        assert!(channel(&image, name).iter().all(|variance| *variance < 1e-12), "{name}");
    }
}

/// What the layer tells of one render is how far renders scatter.
#[test]
fn the_variance_is_that_of_the_mean() {
    let moment = json!({"type": "moment", "img": {"type": "path", "max_depth": 4}});
    for filter in ["gaussian", "catmullrom"] {
        let film = lit_room(&[("rfilter", json!({"type": filter}))]);
        let stage = Stage::new(&with(film, &[("integrator", moment.clone())]));
        let images: Vec<Image> = (0..48).map(|seed| image(&stage, 16, seed)).collect();
        let n = images.len() as f64;
        let differences = (0..144).map(|pixel| {
            let green: Vec<f64> = images.iter().map(|i| f64::from(i.pixels[pixel].y)).collect();
            let mean = green.iter().sum::<f64>() / n;
            let seen = green.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let reported = images.iter().map(|i| f64::from(channel(i, "variance.G")[pixel])).sum::<f64>() / n;
            (reported - seen) / reported
        });
        let differences: Vec<f64> = differences.collect();
        let mean = differences.iter().sum::<f64>() / 144.0;
        let spread = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / 143.0;
        let z = mean / (spread / 144.0).sqrt();
        assert!(z.abs() < 3.5 && mean.abs() < 0.1, "{filter}: {mean}, z {z}");
    }
    let single = image(&Stage::new(&with(lit_room(&[]), &[("integrator", moment)])), 1, 0);
    assert!(single.layers.iter().all(|channel| !channel.name.starts_with("variance")));
}

#[test]
fn nested_integrators_name_their_channels_as_mitsuba_does() {
    let inner = json!({"type": "moment", "my": {"type": "volpath", "max_depth": 3}});
    let nested = json!({"type": "aov", "aovs": "dd.y:depth, nn:sh_normal", "m": inner});
    let stage = Stage::new(&with(lit_room(&[]), &[("integrator", nested)]));
    assert_eq!(stage.setup.integrator.options.max_depth, Some(3));
    let names: Vec<String> = image(&stage, 2, 0).layers.into_iter().map(|channel| channel.name).collect();
    let expected = "m.R m.G m.B m.A m.my.X m.my.Y m.my.Z m.m2_my.X m.m2_my.Y m.m2_my.Z m.variance.R \
                    m.variance.G m.variance.B dd.y.T nn.X nn.Y nn.Z";
    assert_eq!(names.join(" "), expected);
    let alone =
        Stage::new(&with(lit_room(&[]), &[("integrator", json!({"type": "aov", "aovs": "d:depth"}))]));
    let alone = image(&alone, 1, 0);
    assert!(alone.pixels.iter().all(|pixel| *pixel == Spectrum::ZERO));
    assert!(channel(&alone, "d.T").iter().all(|depth| *depth > 0.0));
}

#[test]
fn films_and_layers_that_cannot_be_are_refused() {
    let film = |more: Value| {
        let Value::Object(more) = more else { panic!("{more}") };
        let more: Vec<(&str, Value)> =
            more.iter().map(|(name, value)| (name.as_str(), value.clone())).collect();
        lit_room(&more)
    };
    let integrator = |integrator: Value| with(lit_room(&[]), &[("integrator", integrator)]);
    let path = json!({"type": "path"});
    for (scene, hints) in [
        (film(json!({"type": "specfilm"})), &["specfilm", "hdrfilm", "sRGB"][..]),
        (film(json!({"type": "hdrflim"})), &["hdrflim", "hdrfilm"]),
        (film(json!({"pixel_format": "rbg"})), &["pixel_format", "rbg", "luminance_alpha"]),
        (film(json!({"component_format": "float64"})), &["component_format", "float16"]),
        (film(json!({"file_format": "png"})), &["file_format", "openexr"]),
        (film(json!({"crop_offset_x": 5})), &["crop_offset_x", "5 and 12 pixels", "12 pixels"]),
        (film(json!({"crop_height": 13})), &["crop_height", "13"]),
        (film(json!({"crop_width": 0})), &["crop_width", "from 1"]),
        (film(json!({"crop_offset_y": -1})), &["crop_offset_y", "-1"]),
        (film(json!({"rfilter": {"type": "lanczos", "lobes": 0}})), &["lobes", "from 1 to 32"]),
        (film(json!({"rfilter": {"type": "mitchell", "A": 0.2}})), &["\"A\"", "B, C"]),
        (film(json!({"rfilter": {"type": "mitchell", "B": 1.5}})), &["\"B\"", "from 0 to 1"]),
        (film(json!({"rfilter": {"type": "lanzcos"}})), &["lanzcos", "lanczos"]),
        (integrator(json!({"type": "aov", "img": path})), &["aovs", "dd:depth"]),
        (integrator(aov("dd:dpeth")), &["dpeth", "did you mean \"depth\""]),
        (integrator(aov("dd")), &["\"dd\"", "name:quantity"]),
        (integrator(aov("a:boundary_test")), &["boundary_test", "known: albedo"]),
        (integrator(aov("a:uv,a:uv")), &["a.U", "twice"]),
        (integrator(aov("img:albedo")), &["img.R", "twice"]),
        (integrator(aov("n\u{e9}:uv")), &["ASCII"]),
        (integrator(json!({"type": "aov", "aovs": "a:uv", "x": path, "y": path})), &["second integrator"]),
        (integrator(json!({"type": "moment"})), &["integrator", "moment"]),
        (integrator(json!({"type": "moment", "x": aov("a:uv")})), &["aov", "inside the aov"]),
    ] {
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("scene.json");
        std::fs::write(&path, scene.to_string()).unwrap();
        let built = tyndall::format::read(&path, &[]).and_then(|root| build(&root, Overrides::default()));
        let error = built.err().unwrap_or_else(|| panic!("accepted, not {hints:?}")).to_string();
        for hint in hints {
            assert!(error.contains(hint), "no {hint} in: {error}");
        }
    }
}
