//! A page that draws the paths of the brightest contributions: from above and from the side, as the camera looks.

use super::{Outlier, Outliers, PathVertex, table::digits};
use crate::{
    error::{Error, Result},
    math::{DVec3, Frame, Vec2},
    scene::build::Setup,
};
use askama::Template;

/// Sides of a drawing, and what is left free around it.
const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 260.0;
const MARGIN: f64 = 22.0;
/// How far away what is at infinity is drawn, of the extent of the others.
const FAR: f64 = 0.35;

/// The page of what was `found` in a scene that is called `name`.
pub fn page(setup: &Setup, name: &str, found: &Outliers) -> Result<String> {
    let axes = axes(setup);
    let panels = found.outliers.iter().map(|one| Panel::new(&axes, one)).collect();
    Page { name, found, panels }.render().map_err(|error| {
        Error::new("the page", "paths that a page can show", error.to_string(), "write JSON instead")
    })
}

#[derive(Template)]
#[template(path = "outliers.html", config = "src/analysis/study/page/askama.toml")]
struct Page<'a> {
    name: &'a str,
    found: &'a Outliers,
    panels: Vec<Panel<'a>>,
}

impl Page<'_> {
    fn style(&self) -> &'static str {
        concat!(
            include_str!("../../study/page/curves.css"),
            include_str!("../../study/page/style.css"),
            include_str!("outliers.css")
        )
    }

    fn mean(&self) -> String {
        digits(self.found.mean)
    }
}

/// A contribution with its drawings.
struct Panel<'a> {
    one: &'a Outlier,
    views: [View; 2],
}

impl<'a> Panel<'a> {
    fn new(axes: &[DVec3; 3], one: &'a Outlier) -> Self {
        let places = places(&one.path);
        let [ahead, right, up] = *axes;
        let side = |down: DVec3| places.iter().map(|at| [at.dot(ahead), at.dot(down)]).collect::<Vec<_>>();
        let sides = [side(-up), side(right)];
        let scale = scale(&sides);
        let [from_side, from_above] = sides.map(|points| View::new(&points, scale, one));
        let views =
            [View { title: "from the side", ..from_side }, View { title: "from above", ..from_above }];
        Self { one, views }
    }

    fn density(&self, vertex: &PathVertex) -> String {
        let Some((density, measure)) = vertex.density.zip(vertex.measure) else { return "–".to_owned() };
        let unit = measure.strip_prefix('1').unwrap_or(measure);
        let unit = if unit.is_empty() { String::new() } else { format!(" 1{unit}") };
        format!("{}{unit}", digits(f64::from(density)))
    }

    fn place(&self, vertex: &PathVertex) -> String {
        match (vertex.position, vertex.direction) {
            (Some(position), _) => position.map(digits).join(", "),
            (None, Some(towards)) => format!("towards {}", towards.map(|x| digits(f64::from(x))).join(", ")),
            (None, None) => "–".to_owned(),
        }
    }
}

/// A path from one side.
#[derive(Default)]
struct View {
    title: &'static str,
    vertices: Vec<Mark>,
    edges: Vec<Edge>,
    /// Its length on the page, and what that is.
    bar: (String, String),
}

struct Mark {
    x: String,
    y: String,
    kind: &'static str,
}

struct Edge {
    ends: [String; 4],
    class: &'static str,
}

impl View {
    /// Of `points` of which a metre is `scale` wide.
    fn new(points: &[[f64; 2]], scale: f64, one: &Outlier) -> Self {
        let middle = [0, 1].map(|axis| {
            let (low, high) = range(points, axis);
            0.5 * (low + high)
        });
        let half = [0.5 * WIDTH, 0.5 * HEIGHT];
        let at = |point: &[f64; 2]| {
            [0, 1].map(|axis| format!("{:.1}", half[axis] + scale * (point[axis] - middle[axis])))
        };
        let places: Vec<[String; 2]> = points.iter().map(at).collect();
        let edge = |(index, pair): (usize, &[[String; 2]])| {
            let [[x1, y1], [x2, y2]] = [pair[0].clone(), pair[1].clone()];
            let is_joint = one.s > 0 && index as u32 + 1 == one.t;
            Edge {
                ends: [x1, y1, x2, y2],
                class: if is_joint { "joint" } else { one.path[index + 1].subpath },
            }
        };
        let edges = places.windows(2).enumerate().map(edge).collect();
        let mark = |([x, y], vertex): ([String; 2], &PathVertex)| Mark { x, y, kind: vertex.kind };
        let metres = 10f64.powf((0.3 * WIDTH / scale).log10().floor());
        Self {
            title: "",
            edges,
            vertices: places.into_iter().zip(&one.path).map(mark).collect(),
            bar: (format!("{:.1}", metres * scale), format!("{} m", digits(metres))),
        }
    }
}

/// Where the camera looks to, its right, and up.
fn axes(setup: &Setup) -> [DVec3; 3] {
    let scene = &setup.scene;
    let [film, offset] = [scene.crop.film, scene.crop.offset].map(|n| Vec2::from(n.map(|n| n as f32)));
    let at = |film: Vec2| scene.sensor.ray(film, Vec2::ZERO);
    let centre = 0.5 * film - offset;
    let (here, beside) = (at(centre), at(centre + Vec2::X));
    let ahead = here.ray.direction;
    let across = (beside.position + beside.ray.direction) - (here.position + ahead);
    let Frame { tangent, bitangent, normal } = Frame::along(ahead, across);
    [normal, tangent, -bitangent].map(|axis| axis.as_dvec3())
}

/// Where vertices are drawn, from the first one on; what is at infinity a bit beyond the one before.
fn places(path: &[PathVertex]) -> Vec<DVec3> {
    let known = |vertex: &PathVertex| vertex.position.map(DVec3::from);
    let first = path.iter().find_map(known).unwrap_or_default();
    let distances = path.iter().filter_map(known).map(|at| (at - first).length());
    let extent = distances.fold(0.0, f64::max);
    let far = FAR * if extent > 0.0 { extent } else { 1.0 };
    let mut last = DVec3::ZERO;
    let place = |vertex: &PathVertex| {
        let towards = vertex.direction.map_or(DVec3::ZERO, |towards| DVec3::from(towards.map(f64::from)));
        last = known(vertex).map_or(last + far * towards, |at| at - first);
        last
    };
    path.iter().map(place).collect()
}

fn range(points: &[[f64; 2]], axis: usize) -> (f64, f64) {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    points.iter().fold(ends, |(low, high), point| (low.min(point[axis]), high.max(point[axis])))
}

/// How wide a metre is where all of both views are to be seen.
fn scale(views: &[Vec<[f64; 2]>; 2]) -> f64 {
    let sizes = [WIDTH, HEIGHT].map(|size| size - 2.0 * MARGIN);
    let fits = views.iter().flat_map(|points| {
        [0, 1].map(|axis| {
            let (low, high) = range(points, axis);
            sizes[axis] / (high - low)
        })
    });
    let least = fits.filter(|fit| fit.is_finite() && *fit > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 1.0 }
}
