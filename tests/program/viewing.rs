//! `tyndall view`: what its server answers, to whom, and what it leaves behind.
#![cfg(unix)]

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};
use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::TcpStream,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

/// A red ball before a sky, seen from +z.
fn ball(origin: [f64; 3], reflectance: Value) -> Value {
    let ball = json!({"type": "sphere", "radius": 0.5, "bsdf": diffuse(reflectance)});
    scene(&[("sensor", camera(origin, [0.0; 3], 64)), ("ball", ball), ("sky", sky(1.0))])
}

const ORIGIN: [f64; 3] = [0.0, 0.0, 3.0];

/// The program at work.
struct Server {
    child: Child,
    port: String,
    token: String,
}

/// What it answered.
struct Answer {
    code: u16,
    head: String,
    body: Vec<u8>,
}

/// A picture as the page gets it.
struct Picture {
    head: Value,
    pixels: Vec<u8>,
}

impl Picture {
    fn number(&self) -> u64 {
        self.head["number"].as_u64().unwrap()
    }

    /// Red, green and blue in the middle.
    fn middle(&self) -> [u32; 3] {
        let [width, height] = self.size();
        self.pixel(height / 2 * width + width / 2)
    }

    /// Red, green and blue of a pixel, wide enough to be added and multiplied.
    fn pixel(&self, index: usize) -> [u32; 3] {
        [0, 1, 2].map(|channel| u32::from(self.pixels[4 * index + channel]))
    }

    fn size(&self) -> [usize; 2] {
        let size = [0, 1].map(|axis| self.head["size"][axis].as_u64().unwrap() as usize);
        assert_eq!(self.pixels.len(), 4 * size[0] * size[1]);
        size
    }

    fn camera(&self) -> &str {
        self.head["caption"]["camera"].as_str().unwrap()
    }

    fn is_whole(&self) -> bool {
        self.head["caption"]["said"].as_str().unwrap().starts_with("4 samples/pixel in")
    }
}

impl Server {
    fn start(sandbox: &Sandbox, words: &str) -> Self {
        // Whatever ignores signals here, it is not to.
        let mut program = Command::new("env");
        program.args(["--default-signal=HUP,INT,TERM", env!("CARGO_BIN_EXE_tyndall"), "view"]);
        program.current_dir(sandbox.path("")).args(words.split_whitespace());
        let mut child = program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim_end().strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{line}"));
        let (port, token) = address.split_once('/').unwrap();
        let token = token.strip_suffix('/').unwrap().to_owned();
        assert!(token.len() == 32, "{line}");
        Self { child, port: port.to_owned(), token }
    }

    /// Its answer to `method` of a whole `path` at `host`.
    fn ask(&self, method: &str, path: &str, host: &str, body: &str) -> Answer {
        let mut socket = TcpStream::connect(format!("127.0.0.1:{}", self.port)).unwrap();
        socket.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let length = body.len();
        write!(socket, "{method} {path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}").unwrap();
        let mut answer = Vec::new();
        socket.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        let code = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { code, head, body: answer[end + 4..].to_vec() }
    }

    fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// The same below the token, under its own name.
    fn get(&self, path: &str) -> Answer {
        self.ask("GET", &format!("/{}/{path}", self.token), &self.host(), "")
    }

    fn wish(&self, wishes: &Value) -> u16 {
        self.ask("POST", &format!("/{}/wishes", self.token), &self.host(), &wishes.to_string()).code
    }

    /// The first picture behind `number` that `is_wanted`.
    fn picture(&self, mut number: u64, is_wanted: impl Fn(&Picture) -> bool) -> Picture {
        let started = Instant::now();
        loop {
            let answer = self.get(&format!("picture?after={number}"));
            assert!(started.elapsed() < Duration::from_secs(60), "no such picture came");
            if answer.code == 204 {
                continue;
            }
            assert_eq!(answer.code, 200, "{}", answer.head);
            let end = answer.body.iter().position(|byte| *byte == b'\n').unwrap();
            let head = serde_json::from_slice(&answer.body[..end]).unwrap();
            let picture = Picture { head, pixels: answer.body[end + 1..].to_vec() };
            if is_wanted(&picture) {
                return picture;
            }
            number = picture.number();
        }
    }

    /// Sends it a signal; its code, and what it said on standard error.
    fn end(mut self, signal: &str) -> (Option<i32>, String) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
        let started = Instant::now();
        while self.child.try_wait().unwrap().is_none() {
            assert!(started.elapsed() < Duration::from_secs(20), "it goes on after {signal}");
            std::thread::sleep(Duration::from_millis(20));
        }
        let mut said = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        (self.child.wait().unwrap().code(), said)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn only_who_knows_the_token_and_calls_it_by_its_name_sees_anything() {
    let sandbox = Sandbox::with_scene(&ball(ORIGIN, rgb(0.8, 0.1, 0.1)));
    let server = Server::start(&sandbox, "scene.json");
    let (own, page) = (server.host(), format!("/{}/", server.token));
    let found = server.get("");
    let html = String::from_utf8(found.body).unwrap();
    assert!(
        found.code == 200 && found.head.contains("text/html") && html.contains("<canvas"),
        "{}",
        found.head
    );
    for said in ["Cache-Control: no-store", "default-src 'none'", "no-referrer"] {
        assert!(found.head.contains(said), "{said}: {}", found.head);
    }
    assert!(!html.contains("://") && !html.contains(" src="), "the page asks for something else");
    for path in
        ["/", "/picture?after=0", &page[..page.len() - 1], &format!("{page}x"), &page.replace('/', "/0")]
    {
        assert_eq!(server.ask("GET", path, &own, "").code, 404, "{path}");
    }
    for host in ["evil.example", "127.0.0.1", &format!("evil.example:{}", server.port), ""] {
        assert_eq!(server.ask("GET", &page, host, "").code, 403, "{host}");
    }
    assert_eq!(server.ask("GET", &page, &format!("localhost:{}", server.port), "").code, 200);
    for (wishes, code) in [
        (json!([]), 204),
        (json!([{"orbit": [0.1]}]), 400),
        (json!([{"orbit": [1e9, 0.0]}]), 400),
        (json!([{"view": "sepia"}]), 400),
        (json!(["reload"]), 400),
        (json!({"home": 1}), 400),
        (json!("x".repeat(70_000)), 413),
    ] {
        assert_eq!(server.wish(&wishes), code, "{:.80}", wishes.to_string());
    }
    assert_eq!(server.get("picture").code, 400);
}

#[test]
fn a_picture_comes_refines_and_follows_the_hand() {
    let sandbox = Sandbox::with_scene(&ball(ORIGIN, rgb(0.8, 0.1, 0.1)));
    let server = Server::start(&sandbox, "scene.json --view linear");
    let first = server.picture(0, |_| true);
    assert_eq!(first.head["caption"]["film"], json!([64, 64]));
    let whole = server.picture(0, Picture::is_whole);
    let [red, green, _] = whole.middle();
    assert!(red > 100 && red > 2 * green, "{:?}", whole.middle());
    assert!(whole.camera().contains("\"origin\": [0, 0, 3]"), "{}", whole.camera());
    // An eighth of a turn to the left about the nearest point of the ball, and what is dragged goes right.
    assert_eq!(server.wish(&json!(["grip", {"orbit": [0.25, 0.0]}])), 204);
    let moved = |before: &Picture| {
        server.picture(before.number(), |picture| picture.is_whole() && picture.camera() != before.camera())
    };
    let turned = moved(&whole);
    assert!(turned.camera().contains("\"origin\": [-1.7678, 0, 2.2678]"), "{}", turned.camera());
    assert!(turned.middle()[0] > 100);
    // By half of the image the ball is out of the middle, where the sky is.
    server.wish(&json!([{"pan": [0.45, 0.0]}]));
    let aside = moved(&turned);
    assert!(aside.middle()[1] > 200, "{:?}", aside.middle());
    server.wish(&json!(["home"]));
    let back = moved(&aside);
    assert_eq!((back.camera(), back.middle()[1] > 100), (whole.camera(), false));
    // The look of a picture that is there.
    server.wish(&json!([{"exposure": 6.0}, {"view": "agx"}]));
    let bright = server.picture(back.number(), |picture| picture.head["view"] == "agx");
    assert!(bright.middle()[1] > 150 && bright.head["exposure"] == 6.0, "{:?}", bright.middle());
    server.wish(&json!([{"exposure": null}]));
    server.picture(bright.number(), |picture| picture.head["is_auto"] == true);
    assert_eq!(sandbox.files(), ["scene.json"]);
    let (code, said) = server.end("-INT");
    assert_eq!((code, said.as_str()), (Some(130), ""));
    assert_eq!(sandbox.files(), ["scene.json"]);
}

/// What the page shows is what `render` makes of the scene with the lines that it says.
#[test]
fn the_lines_of_the_camera_are_the_view() {
    let sandbox = Sandbox::with_scene(&ball(ORIGIN, json!(0.5)));
    let server = Server::start(&sandbox, "scene.json --view linear");
    server.wish(&json!(["grip", {"orbit": [0.1, 0.1]}, {"dolly": 0.3}, {"pan": [0.2, 0.1]}]));
    let seen = server.picture(0, |picture| picture.is_whole() && !picture.camera().contains("[0, 0, 3]"));
    let mut scene = sandbox.json("scene.json");
    let placed: Value = serde_json::from_str(&format!("{{{}}}", seen.camera())).unwrap();
    scene["sensor"]["to_world"] = placed["to_world"].clone();
    fs::write(sandbox.path("moved.json"), scene.to_string()).unwrap();
    let render = "render moved.json --view linear --strategies hit,next-event,join,lens --guide never";
    sandbox.run(render).ends(0);
    let rendered = image::open(sandbox.path("moved.png")).unwrap().to_rgb8().into_raw();
    let shown = seen.pixels.chunks_exact(4).flat_map(|pixel| &pixel[..3]);
    let differ = rendered.iter().zip(shown).filter(|(a, b)| a.abs_diff(**b) > 8).count();
    // Rounded lines move edges by less than a pixel.
    assert!(differ < rendered.len() / 20, "{differ} of {}", rendered.len());
}

#[test]
fn a_scene_is_read_again_when_it_is_saved() {
    let sandbox = Sandbox::with_scene(&ball(ORIGIN, rgb(0.8, 0.1, 0.1)));
    let server = Server::start(&sandbox, "scene.json --view linear");
    server.wish(&json!(["grip", {"orbit": [0.25, 0.0]}]));
    let red =
        server.picture(0, |picture| picture.is_whole() && picture.camera().contains("[-1.7678, 0, 2.2678]"));
    let save = |scene: &str| fs::write(sandbox.path("scene.json"), scene).unwrap();
    // The camera stays where it was moved to.
    save(&ball(ORIGIN, rgb(0.1, 0.8, 0.1)).to_string());
    let green = server.picture(red.number(), |picture| picture.is_whole() && picture.middle()[1] > 100);
    assert_eq!(green.camera(), red.camera());
    // A mistake is told, and the picture stays.
    save("{\"type\": \"scene\"}");
    let broken = server.picture(green.number(), |picture| picture.head["error"] != Value::Null);
    let error = broken.head["error"].as_str().unwrap().to_owned();
    assert!(error.contains("expected a sensor in the scene, found none\n  remedy: add"), "{error}");
    assert_eq!(broken.middle(), green.middle());
    // A camera that the file places elsewhere is taken from there.
    save(&ball([0.0, 3.0, 0.0], rgb(0.1, 0.1, 0.8)).to_string());
    let blue = server.picture(broken.number(), |picture| picture.is_whole() && picture.middle()[2] > 100);
    assert_eq!(blue.head["error"], Value::Null);
    assert!(blue.camera().contains("\"origin\": [0, 3, 0]"), "{}", blue.camera());
    let (_, said) = server.end("-TERM");
    assert!(said.contains(&error), "{said}");
}

/// The file that another one includes counts too.
#[test]
fn an_included_file_is_watched_and_xml_is_spelled_as_xml() {
    let film = "<film type=\"hdrfilm\"><integer name=\"width\" value=\"32\"/><integer name=\"height\" value=\"32\"/></film>";
    let scene = format!(
        "<scene version=\"3.0.0\"><include filename=\"lamp.xml\"/><sensor type=\"orthographic\">\
         <sampler type=\"independent\"><integer name=\"sample_count\" value=\"4\"/></sampler>{film}</sensor></scene>"
    );
    let lamp = |radiance: &str| {
        format!(
            "<scene version=\"3.0.0\"><emitter type=\"constant\"><rgb name=\"radiance\" value=\"{radiance}\"/></emitter></scene>"
        )
    };
    let sandbox = Sandbox::with_files(&[("scene.xml", &scene), ("lamp.xml", &lamp("1, 0, 0"))]);
    let server = Server::start(&sandbox, "scene.xml");
    let red = server.picture(0, |picture| picture.is_whole() && picture.middle()[0] > 200);
    let camera = red.camera();
    assert!(
        camera.starts_with("<transform name=\"to_world\">") && camera.contains("<lookat origin="),
        "{camera}"
    );
    fs::write(sandbox.path("lamp.xml"), lamp("0, 1, 0")).unwrap();
    server.picture(red.number(), |picture| picture.middle()[1] > 200);
}

#[test]
fn what_cannot_be_viewed_is_refused_and_what_cannot_be_moved_says_so() {
    let meter = json!({"type": "radiancemeter", "sampler": {"type": "independent", "sample_count": 4}});
    let sandbox = Sandbox::with_scene(&scene(&[("sensor", meter), ("sky", sky(1.0))]));
    sandbox.run("view missing.json").refuses(&["missing.json"]);
    sandbox.run("view scene.json --port 0").refuses(&["--port"]);
    let server = Server::start(&sandbox, "scene.json");
    sandbox.run(&format!("view scene.json --port {}", server.port)).refuses(&["--port", "leave it out"]);
    server.wish(&json!([{"orbit": [0.1, 0.1]}, "home"]));
    let seen = server.picture(0, Picture::is_whole);
    assert_eq!((&seen.head["caption"]["moves"], &seen.head["size"]), (&json!(false), &json!([1, 1])));
    assert!(
        seen.camera().contains("can only be looked at") && seen.camera().contains("radiancemeter"),
        "{}",
        seen.camera()
    );
}

/// A window beside the camera's axis.
#[test]
fn a_window_turns_about_what_is_in_its_middle() {
    let mut sensor = camera(ORIGIN, [0.0; 3], 64);
    sensor["fov"] = json!(90);
    for (name, value) in [("crop_width", 32), ("crop_height", 64), ("crop_offset_x", 0), ("crop_offset_y", 0)]
    {
        sensor["film"][name] = json!(value);
    }
    let at = json!([{"type": "translate", "value": [-1.5, 0, 0]}]);
    let ball = json!({"type": "sphere", "radius": 0.5, "bsdf": diffuse(rgb(0.8, 0.1, 0.1)), "to_world": at});
    let sandbox = Sandbox::with_scene(&scene(&[("sensor", sensor), ("ball", ball), ("sky", sky(1.0))]));
    let server = Server::start(&sandbox, "scene.json --view linear");
    let red = |picture: &Picture| picture.middle()[0] > 2 * picture.middle()[1];
    let before = server.picture(0, |picture| picture.is_whole() && red(picture));
    server.wish(&json!(["grip", {"orbit": [-0.25, 0.0]}]));
    let after =
        server.picture(before.number(), |picture| picture.is_whole() && picture.camera() != before.camera());
    assert!(red(&after), "{:?} {}", after.middle(), after.camera());
}

/// A field of view that is edited in the file is the one by which the hand moves the camera.
#[test]
fn an_edited_field_of_view_is_that_of_the_next_gesture() {
    let scene = ball(ORIGIN, rgb(0.8, 0.1, 0.1));
    let sandbox = Sandbox::with_scene(&scene);
    let server = Server::start(&sandbox, "scene.json --view linear");
    let wide = server.picture(0, Picture::is_whole);
    let mut narrow = scene;
    narrow["sensor"]["fov"] = json!(10);
    fs::write(sandbox.path("scene.json"), narrow.to_string()).unwrap();
    // The ball fills all of it.
    let edge = |picture: &Picture| picture.pixel(0)[0] > 2 * picture.pixel(0)[1];
    let seen = server.picture(wide.number(), |picture| picture.is_whole() && edge(picture));
    server.wish(&json!(["grip", {"pan": [0.1, 0.0]}]));
    let moved = server.picture(seen.number(), |picture| picture.camera() != seen.camera());
    // A tenth of the 0.437 m that it is wide at the ball, 2.5 m away.
    assert!(moved.camera().contains("0.0437"), "{}", moved.camera());
}

#[test]
fn a_file_that_was_missed_is_waited_for() {
    let textured = ball(ORIGIN, json!({"type": "bitmap", "filename": "green.png"})).to_string();
    let sandbox = Sandbox::with_scene(&ball(ORIGIN, rgb(0.8, 0.1, 0.1)));
    let server = Server::start(&sandbox, "scene.json --view linear");
    let red = server.picture(0, Picture::is_whole);
    fs::write(sandbox.path("scene.json"), textured).unwrap();
    let missed = server.picture(red.number(), |picture| picture.head["error"] != Value::Null);
    assert!(missed.head["error"].as_str().unwrap().contains("green.png"), "{}", missed.head);
    image::RgbImage::from_pixel(2, 2, image::Rgb([20, 220, 20])).save(sandbox.path("green.png")).unwrap();
    let green = server.picture(missed.number(), |picture| picture.is_whole() && picture.middle()[1] > 100);
    assert_eq!(green.head["error"], Value::Null);
}

/// A `.vol` file of 2 x 2 x 2 voxels in a cube of such a `side` (m).
fn cube_of_fog(side: f32) -> Vec<u8> {
    let counts = [1i32, 2, 2, 2, 1].iter().flat_map(|count| count.to_le_bytes());
    let corners = [0.0, 0.0, 0.0, side, side, side];
    let numbers = corners.iter().chain(&[1.0f32; 8]).flat_map(|x| x.to_le_bytes());
    b"VOL\x03".iter().copied().chain(counts).chain(numbers).collect()
}

#[test]
fn a_volume_file_is_framed_again_when_it_is_written() {
    let sandbox = Sandbox::with_files(&[]);
    let write = |side: f32| fs::write(sandbox.path("fog.vol"), cube_of_fog(side)).unwrap();
    write(1.0);
    let server = Server::start(&sandbox, "fog.vol --size 24x24");
    let small = server.picture(0, |_| true);
    write(4.0);
    server.picture(small.number(), |picture| picture.camera() != small.camera());
}

#[test]
fn nobody_waits_for_a_reader_who_fell_silent() {
    let sandbox = Sandbox::with_scene(&ball(ORIGIN, rgb(0.8, 0.1, 0.1)));
    // More than what a system keeps for a reader.
    let server = Server::start(&sandbox, "scene.json --size 2400x2400 --integrator fog");
    let size = br#""size":[2400,2400]"#;
    let started = Instant::now();
    while !server.get("picture?after=0").body.windows(size.len()).take(2000).any(|text| text == size) {
        assert!(started.elapsed() < Duration::from_secs(180), "no picture came");
    }
    let mut silent = TcpStream::connect(server.host()).unwrap();
    let path = format!("/{}/picture?after=0", server.token);
    write!(silent, "GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", server.host()).unwrap();
    silent.read_exact(&mut [0]).unwrap();
    assert_eq!(server.end("-INT").0, Some(130));
}
