//! The test of samples passes where it must and fails where it must; what is drawn is what is there.

use super::*;
use std::io::BufReader;

const DIVISION: Division = Division { parallels: 33, meridians: 16 };

fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}

fn phase(text: &str) -> Phase {
    let words = words(text);
    described::build(&words[0], &words[1..]).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_kind_of_value_can_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("table.txt");
    std::fs::write(&table, "0.5, 1\n1.5 3").unwrap();
    for text in [
        "isotropic",
        "hg g=0.99",
        "hg",
        "tabphase values=0.5,1,1.5,3",
        &format!("tabphase values=@{}", table.display()),
        "blendphase weight=0.3 a=hg a.g=0.9 b=blendphase b.weight=1e-2 b.x=rayleigh b.y=mie_murky b.y.form=blasi",
        "gaussian gamma=1e4",
        "hg g=-0.9999",
    ] {
        let phase = phase(text);
        let check = check(&phase, &phase, DIVISION, 100_000, 1);
        assert_eq!(check.failures(1e-3), [""; 0], "{text}: {check:?}");
        assert!(check.fit.freedom > 25, "{text}: {check:?}");
    }
}

#[test]
fn mistakes_are_explained_in_words() {
    for (text, hints) in [
        ("henyey", &["isotropic", "\"henyey\""][..]),
        ("hg k=0.5", &["\"k\"", "known here: g"]),
        ("hg g=1.5", &["phase g=1.5", "between -1 and 1"]),
        ("hg g=far", &["write it like g=1.5"]),
        ("hg g=nan", &["g=nan"]),
        ("hg 0.5", &["name=value"]),
        ("hg g=0.5 g=0.6", &["again"]),
        ("blendphase a.g=0.5", &["a=hg"]),
        ("blendphase weight=0.5 a=hg", &["two nested"]),
        ("tabphase values=1,2,x", &["\"x\""]),
        ("tabphase values=@nowhere.txt", &["nowhere.txt"]),
        ("tabphase", &["values"]),
    ] {
        let words = words(text);
        let error = described::build(&words[0], &words[1..]).unwrap_err().to_string();
        for hint in hints {
            assert!(error.contains(hint), "{text}: no {hint} in {error}");
        }
    }
}

/// A g that is off by 0.03 is found, and what has another shape or the other sign.
#[test]
fn samples_of_another_function_fail() {
    for (sampled, pdf) in [("hg g=0.5", "hg g=0.53"), ("rayleigh", "isotropic"), ("hg g=0.9", "hg g=-0.9")] {
        let check = check(&phase(sampled), &phase(pdf), DIVISION, 200_000, 1);
        assert!(check.fit.p_value < 1e-6 && !check.failures(1e-3).is_empty(), "{sampled}: {check:?}");
    }
}

#[test]
fn the_mean_cosine_is_that_of_theory() {
    let check = check(&phase("hg g=0.7"), &phase("hg g=0.7"), DIVISION, 100_000, 2);
    assert!((check.normalisation - 1.0).abs() < 1e-6 && (check.mean_cosine - 0.7).abs() < 1e-6, "{check:?}");
    assert!((check.sampled_mean_cosine - 0.7).abs() < 4.0 * check.standard_error);
    // Variance of the cosine: E[cos^2] is (1 + 2 g^2) / 3.
    let variance: f64 = (1.0 + 2.0 * 0.49) / 3.0 - 0.49;
    assert!((check.standard_error / (variance / 1e5).sqrt() - 1.0).abs() < 0.01);
}

/// Volume by the divergence theorem: of a sphere of radius 1 / (4 pi) for the isotropic function.
#[test]
fn the_mesh_is_closed_and_points_outward() {
    let lobe = mesh::Mesh::of_density(&phase("isotropic"), Division { parallels: 129, meridians: 128 });
    let triangles: Vec<[u32; 3]> = lobe.faces.iter().map(|face| face[..].try_into().unwrap()).collect();
    let volume: f64 = triangles
        .iter()
        .map(|t| t.map(|i| lobe.corners[i as usize]))
        .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
        .sum();
    let sphere = 4.0 / 3.0 * PI * (2.0 * TAU).powi(-3);
    assert!((volume / sphere - 1.0).abs() < 0.01, "{volume} for {sphere}");
    let mut edges = std::collections::HashMap::new();
    for [a, b, c] in &triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            *edges.entry(edge).or_insert(0) += 1;
        }
    }
    assert!(edges.iter().all(|((a, b), n)| *n == 1 && edges.contains_key(&(*b, *a))));
}

#[test]
fn the_mesh_is_read_back() {
    let lobe = mesh::Mesh::of_density(&phase("hg g=0.8"), DIVISION);
    let mut bytes = Vec::new();
    lobe.write(&mut bytes).unwrap();
    let parser = ply_rs_bw::parser::Parser::<ply_rs_bw::ply::DefaultElement>::new();
    let ply = parser.read_ply(&mut BufReader::new(&bytes[..])).unwrap();
    assert_eq!(ply.payload["vertex"].len(), 2 + 31 * 16);
    assert_eq!(ply.payload["face"].len(), 2 * 31 * 16);
    // The density straight on: (1 - g^2) / (4 pi (1 - g)^3).
    let peak = 0.36 / (2.0 * TAU * 0.008);
    assert!((lobe.corners[0].z / peak - 1.0).abs() < 1e-5 && lobe.corners[0].x == 0.0);
}

/// The faces of samples: what a cell holds over its solid angle, outward, in a plane, and all together every sample.
#[test]
fn faces_of_samples_hold_every_sample() {
    let (hg, n) = (phase("hg g=0.4"), 50_000);
    for division in
        [DIVISION, Division { parallels: 3, meridians: 3 }, Division { parallels: 4, meridians: 5 }]
    {
        let check = check(&hg, &hg, division, n, 3);
        let mesh = mesh::Mesh::of_samples(&check.cells, division);
        assert_eq!(mesh.faces.len(), check.cells.iter().filter(|count| **count > 0).count());
        let held = |face: &Vec<u32>| {
            let corners: Vec<_> = face.iter().map(|i| mesh.corners[*i as usize]).collect();
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(a) > 0.0, "{division:?}: {corners:?} faces inward");
            let flat = corners.last().is_some_and(|d| (*d - a).dot(normal.normalize()).abs() < 1e-9);
            assert!(flat, "{division:?}: {corners:?} is no plane");
            // Archimedes: the solid angle is the height of the slice times its angle.
            let heights = || corners.iter().map(|corner| corner.normalize().z);
            let height = heights().fold(f64::MIN, f64::max) - heights().fold(f64::MAX, f64::min);
            a.length() * TAU / division.meridians as f64 * height
        };
        let all: f64 = mesh.faces.iter().map(held).sum();
        assert!((all - 1.0).abs() < 1e-9, "{division:?}: {all}");
    }
    let none = mesh::Mesh::of_samples(&[0, 0, 0, 0, 0, 4], Division { parallels: 3, meridians: 3 });
    let distance = |corner: &crate::math::DVec3| corner.length();
    assert_eq!((none.faces.len(), none.corners.len()), (1, 3));
    assert!(none.corners.iter().map(distance).all(|d| (d - 1.5 / PI).abs() < 1e-12), "{none:?}");
}

#[test]
fn the_drawing_is_a_picture_without_broken_numbers() {
    for text in ["isotropic", "hg g=0.99", "tabphase values=0,0,1"] {
        let phase = phase(text);
        let svg = drawing::svg(text, &phase, &check(&phase, &phase, DIVISION, 10_000, 1)).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.contains(text));
        assert!(svg.matches("<polygon").count() == 2 * 2 * HISTOGRAM && !svg.contains("NaN"));
    }
}
