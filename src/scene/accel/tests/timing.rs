//! Nanoseconds per ray: `cargo test --release accel::tests::timing -- --ignored --nocapture`.

use super::{meshes::sphere_mesh, *};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::builder::build_bvh2,
    cwbvh::builder::build_cwbvh,
    ray::{Ray as PlainRay, RayHit},
};
use std::{hint::black_box, time::Instant};

const RAYS: usize = 1 << 16;
const CHUNK: usize = 1 << 10;
const ROUNDS: usize = 20;

/// In ns per ray: all rays in every round, but of each chunk its best round, as other programs come and go.
fn time(rays: &[Ray], mut shoot: impl FnMut(&Ray) -> bool) -> (f64, usize) {
    let mut best = vec![f64::INFINITY; rays.len() / CHUNK];
    let mut hits = 0;
    for _ in 0..ROUNDS {
        hits = 0;
        for (chunk, best) in rays.chunks(CHUNK).zip(&mut best) {
            let start = Instant::now();
            hits += chunk.iter().filter(|ray| black_box(shoot(ray))).count();
            *best = best.min(start.elapsed().as_secs_f64());
        }
    }
    (best.iter().sum::<f64>() * 1e9 / rays.len() as f64, hits)
}

fn lampbox() -> Vec<Shape> {
    let one = [1.0, 0.0, 0.0];
    let two = [0.0, 1.0, 0.0];
    vec![
        placed("rectangle", vec![turn(one, -90.0)]),
        placed("rectangle", vec![turn(one, 90.0), shift(0.0, 2.0, 0.0)]),
        placed("rectangle", vec![shift(0.0, 1.0, -1.0)]),
        placed("rectangle", vec![turn(two, 180.0), shift(0.0, 1.0, 1.0)]),
        placed("rectangle", vec![turn(two, 90.0), shift(-1.0, 1.0, 0.0)]),
        placed("rectangle", vec![turn(two, -90.0), shift(1.0, 1.0, 0.0)]),
        placed("rectangle", vec![scale(0.1, 0.1, 0.1), turn(one, 90.0), shift(0.0, 1.9, -0.3)]),
    ]
}

/// From anywhere in the box of half width `half` around `center`, in any direction.
fn incoherent(center: Vec3, half: f64, t_max: f32) -> Vec<Ray> {
    let mut stream = stream(9);
    let mut one = || {
        let origin = center + within(&mut stream, half).as_vec3();
        Ray { origin, direction: warp::to_sphere(stream.square()), t_max }
    };
    (0..RAYS).map(|_| one()).collect()
}

fn report(name: &str, rays: &[Ray], geometry: &Geometry) {
    let (closest, hits) = time(rays, |ray| geometry.closest(ray).is_some());
    let (occluded, blocked) = time(rays, |ray| geometry.occluded(ray));
    let (surface, _) = time(rays, |ray| match geometry.closest(ray) {
        Some(hit) => black_box(geometry.surface(ray, &hit)).normal.x > 0.0,
        None => false,
    });
    eprintln!(
        "{name}: closest {closest:.1} ns ({hits} hits), occluded {occluded:.1} ns ({blocked}), with surface {surface:.1} ns"
    );
}

/// The same primitives one by one in obvhs's own hierarchies.
fn report_obvhs(name: &str, rays: &[Ray], geometry: &Geometry) {
    let primitives: Vec<Primitive> = geometry
        .shapes()
        .iter()
        .flat_map(|shape| (0..shape.primitive_count()).map(|i| shape.primitive(i)))
        .collect();
    let flats: Vec<shape::Flat> = primitives
        .iter()
        .map(|p| match p {
            Primitive::Flat(flat) => *flat,
            _ => unreachable!("timed scenes are flat"),
        })
        .collect();
    let boxes: Vec<Aabb> = primitives.iter().map(tree::bound).collect();
    let bvh = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Default::default());
    let wide = build_cwbvh(&boxes, BvhBuildParams::medium_build(), &mut Default::default());
    let in_order =
        |indices: &[u32]| indices.iter().map(|i| Plain::new(&flats[*i as usize])).collect::<Vec<_>>();
    let (of_bvh, of_wide) = (in_order(&bvh.primitive_indices), in_order(&wide.primitive_indices));
    let plain = |ray: &Ray| PlainRay::new(ray.origin.into(), ray.direction.into(), 0.0, ray.t_max);
    let (a, hits) = time(rays, |ray| {
        bvh.ray_traverse(plain(ray), &mut RayHit::none(), |r, i| of_bvh[i].hit(ray, r.tmax))
    });
    let (b, _) = time(rays, |ray| !bvh.ray_traverse_miss(plain(ray), |r, i| of_bvh[i].hit(ray, r.tmax)));
    let (c, wide_hits) = time(rays, |ray| {
        wide.ray_traverse(plain(ray), &mut RayHit::none(), |r, i| of_wide[i].hit(ray, r.tmax))
    });
    let (d, _) = time(rays, |ray| !wide.ray_traverse_miss(plain(ray), |r, i| of_wide[i].hit(ray, r.tmax)));
    eprintln!(
        "{name}, obvhs: Bvh2 closest {a:.1} ns ({hits}), occluded {b:.1} ns; CwBvh closest {c:.1} ns ({wide_hits}), occluded {d:.1} ns"
    );
    let (e, _) = time(rays, |ray| {
        let mut t = ray.t_max;
        of_bvh.iter().take(64).for_each(|p| t = t.min(p.hit(ray, t)));
        t < ray.t_max
    });
    eprintln!("{name}, one by one (at most 64): {e:.1} ns");
}

/// One flat primitive, tested without lanes: the same arithmetic as a pack.
struct Plain {
    corner: Vec3,
    normal: Vec3,
    axis_u: Vec3,
    axis_v: Vec3,
    fold: f32,
}

impl Plain {
    fn new(flat: &shape::Flat) -> Self {
        let (u, v) = (flat.edge_u.as_dvec3(), flat.edge_v.as_dvec3());
        let cross = u.cross(v);
        let square = cross.length_squared();
        Self {
            corner: flat.corner,
            normal: flat.normal,
            axis_u: (v.cross(cross) / square).as_vec3(),
            axis_v: (cross.cross(u) / square).as_vec3(),
            fold: if flat.triangle { 1.0 } else { 0.0 },
        }
    }

    #[inline(always)]
    fn hit(&self, ray: &Ray, t_max: f32) -> f32 {
        let from = ray.origin - self.corner;
        let t = -self.normal.dot(from) / self.normal.dot(ray.direction);
        let at = from + t * ray.direction;
        let (u, v) = (self.axis_u.dot(at), self.axis_v.dot(at));
        let (low, high) = (u.min(v), u.max(v));
        if t > 0.0 && t < t_max && low >= 0.0 && high + self.fold * low <= 1.0 { t } else { f32::INFINITY }
    }
}

fn report_sampling(geometry: &Geometry, rays: &[Ray]) {
    let mut draws = stream(1);
    let (toward, _) = time(rays, |ray| geometry.sample_toward(6, ray.origin, &mut draws).is_some());
    let (area, _) = time(rays, |ray| geometry.sample_area(6, &mut draws).position.x > ray.origin.x);
    let point = geometry.sample_area(6, &mut draws);
    let (pdf, _) = time(rays, |ray| geometry.pdf_area_toward(6, ray.origin, &point) > 0.0);
    eprintln!(
        "a rectangle: sample_toward {toward:.1} ns, density_toward {pdf:.1} ns, sample_area {area:.1} ns"
    );
}

#[test]
#[ignore = "measures, checks nothing"]
fn nanoseconds_per_ray() {
    let rays = incoherent(Vec3::Y, 0.95, f32::INFINITY);
    let box_of_seven = Geometry::build(lampbox());
    report("box of 7, as a list", &rays, &box_of_seven);
    report(
        "box of 7, as a tree",
        &rays,
        &Geometry { tree: Tree::build_nodes(&primitives(&box_of_seven)), ..box_of_seven.clone() },
    );
    report_obvhs("box of 7", &rays, &box_of_seven);
    report_sampling(&box_of_seven, &rays);
    let mut stream = stream(12);
    for count in [8, 16, 32, 48, 64] {
        let many = Geometry::build(
            (0..count)
                .map(|_| {
                    let at = within(&mut stream, 1.0);
                    let stretch = within(&mut stream, 0.2) + 0.3;
                    placed(
                        "rectangle",
                        vec![
                            scale(stretch.x, stretch.y, 1.0),
                            turn([1.0, 2.0, 0.5], at.x * 180.0),
                            TransformStep::Translate(at.into()),
                        ],
                    )
                })
                .collect(),
        );
        let rays = incoherent(Vec3::ZERO, 1.0, f32::INFINITY);
        let tree = |tree| Geometry { tree, ..many.clone() };
        report(&format!("{count} rectangles, as a list"), &rays, &tree(Tree::build_list(&primitives(&many))));
        report(
            &format!("{count} rectangles, as a tree"),
            &rays,
            &tree(Tree::build_nodes(&primitives(&many))),
        );
    }
    let start = Instant::now();
    let mesh = sphere_mesh(158, 317, 1.0, DVec3::ZERO);
    eprintln!("{} triangles read and built in {:?}", mesh.shapes()[0].primitive_count(), start.elapsed());
    for (name, center, half) in [("inside", Vec3::ZERO, 0.5), ("around", Vec3::ZERO, 2.0)] {
        let rays = incoherent(center, half, f32::INFINITY);
        report(&format!("mesh from {name}"), &rays, &mesh);
        report_obvhs(&format!("mesh from {name}"), &rays, &mesh);
    }
}

fn primitives(geometry: &Geometry) -> Vec<Primitive> {
    geometry.shapes().iter().flat_map(|s| (0..s.primitive_count()).map(|i| s.primitive(i))).collect()
}

/// Nanoseconds per ray of those in a file, six 32-bit floats each, against a PLY mesh: for `python3 -m validation rays`.
#[test]
#[ignore = "measures, checks nothing"]
fn nanoseconds_per_ray_of_files() {
    let Some(folder) = std::env::var_os("TYNDALL_RAYS").map(std::path::PathBuf::from) else { return };
    let mesh = folder.join("mesh.ply").display().to_string();
    let geometry =
        Geometry::build(vec![shape_of("ply", &[("filename", Value::String(mesh))], DVec3::ZERO).unwrap()]);
    let bytes = std::fs::read(folder.join("rays.f32")).unwrap();
    let numbers: Vec<f32> =
        bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect();
    let of = |six: &[f32]| ray(Vec3::from_slice(six), Vec3::from_slice(&six[3..]));
    let rays: Vec<Ray> = numbers.chunks_exact(6).map(of).collect();
    let (closest, hits) = time(&rays, |ray| geometry.closest(ray).is_some());
    let (occluded, _) = time(&rays, |ray| geometry.occluded(ray));
    eprintln!("\nnanoseconds {closest:.2} {occluded:.2} hits {hits}");
}
