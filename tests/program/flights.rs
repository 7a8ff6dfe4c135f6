//! `tyndall flights` as a user runs it.

use crate::sandbox::Sandbox;

#[test]
fn methods_are_compared_in_a_table_a_file_and_a_drawing() {
    let sandbox = Sandbox::new();
    let words = "flights hg g=0.75 --sigma-a 0.1 --sigma-s 0.9 --size 2 --photons 20000 --steps 1,0.1 \
                 --report f.json --svg f.svg";
    let run = sandbox.run(words).ends(0);
    for hint in ["truth ", "RDS_t ", "RDS_s ", "forced ", "CDS 1 ", "CDS 0.1 ", "is biased", "mean free path"]
    {
        assert!(run.out().contains(hint), "no {hint} in {}", run.out());
    }
    assert_eq!(sandbox.files(), ["f.json", "f.svg"]);
    let figures = sandbox.json("f.json");
    let methods = figures["methods"].as_array().unwrap();
    let agrees: Vec<bool> = methods.iter().map(|method| method["agrees"].as_bool().unwrap()).collect();
    assert_eq!(agrees[..4], [true, true, true, false], "{}", run.out());
    // van de Hulst's slab of albedo 0.9 and optical thickness 2: 0.09739 is reflected.
    let reflected = &figures["truth"][0];
    let [mean, error] = ["mean", "standard_error"].map(|name| reflected[name].as_f64().unwrap());
    assert!((mean - 0.09739).abs() < 4.0 * error && error < 2e-3, "{reflected}");
    let laws = figures["mean_flights"].as_array().unwrap();
    assert!(laws.len() == 2 && laws.iter().all(|law| law["z"].as_f64().unwrap().abs() < 4.0), "{laws:?}");
    assert!(sandbox.text("f.svg").contains("mean free path for scattering"));
}

#[test]
fn a_cube_has_sides_and_the_defaults_do() {
    let sandbox = Sandbox::new();
    let run = sandbox
        .run("flights --sigma-a 0 --sigma-s 3 --shape cube --angle 30 --photons 5000 --report f.json")
        .ends(0);
    assert!(run.out().contains("cube of 1 m") && run.out().contains("isotropic"), "{}", run.out());
    let figures = sandbox.json("f.json");
    assert!(figures["truth"][2]["mean"].as_f64().unwrap() > 0.1);
    assert_eq!(figures["methods"].as_array().unwrap().len(), 7);
}

/// Layers and cells, and photons until an error is reached.
#[test]
fn a_subdivided_medium_is_sampled_until_its_error_is_small() {
    let sandbox = Sandbox::new();
    let words =
        "flights --sigma-a 0.1,0,0.3 --sigma-s 1,4,0.5 --size 3 --relative-error 0.02 --report f.json";
    let run = sandbox.run(words).ends(0);
    for hint in
        ["sigma_a 0.1,0,0.3, sigma_s 1,4,0.5 /m in 1x1x3 cells", "within 2 % with a confidence of 95 %"]
    {
        assert!(run.out().contains(hint), "no {hint} in {}", run.out());
    }
    assert!(!run.out().contains("mean free flights"), "{}", run.out());
    let figures = sandbox.json("f.json");
    for method in figures["methods"].as_array().unwrap() {
        let scattered = &method["estimates"][3];
        let [mean, error] = ["mean", "standard_error"].map(|name| scattered[name].as_f64().unwrap());
        assert!(1.96 * error < 0.0201 * mean && method["reached"] == true, "{method}");
    }
    // The sum over layers of 1 m: exp(-(1.1 + 4 + 0.8)).
    assert!((figures["truth"][4]["mean"].as_f64().unwrap() / (-5.9f64).exp() - 1.0).abs() < 1e-6);
    let cube = "flights --shape cube --cells 2x1x2 --sigma-a 0,0,0,1 --sigma-s 1 --photons 5000";
    assert!(sandbox.run(cube).ends(0).out().contains("in 2x1x2 cells"));
    let few = sandbox.run("flights --sigma-a 0 --sigma-s 1 --relative-error 1e-6 --photons 2000").ends(0);
    assert!(few.out().contains("RDS_t is less certain than that after 2000 photons"), "{}", few.out());
}

/// Unscattered light that hardly any photon is: e^-20 of all passes the first, all but 1e-7 the second.
#[test]
fn what_no_photon_has_met_is_no_bias() {
    for medium in ["--sigma-a 0 --sigma-s 1 --size 20", "--sigma-a 0 --sigma-s 1e-7"] {
        let sandbox = Sandbox::new();
        let run = sandbox.run(&format!("flights {medium} --photons 2000 --report f.json")).ends(0);
        for method in &sandbox.json("f.json")["methods"].as_array().unwrap()[..3] {
            assert!(method["largest_z"].as_f64().is_some_and(|z| z < 4.0), "{medium}: {}", run.out());
        }
    }
}

#[test]
fn mistakes_are_explained() {
    let sandbox = Sandbox::new();
    sandbox.run("flights --sigma-a 0 --sigma-s 0").refuses(&["both are 0", "remedy"]);
    sandbox.run("flights --sigma-a -1 --sigma-s 1").refuses(&["from 0 to"]);
    sandbox.run("flights --sigma-s 1").refuses(&["--sigma-a"]);
    sandbox.run("flights --sigma-a 1 --sigma-s 1 --steps 1e-6 --size 10").refuses(&["--steps", "at least"]);
    sandbox.run("flights --sigma-a 1 --sigma-s 1 --steps 0").refuses(&["1e-6"]);
    sandbox.run("flights --sigma-a 1 --sigma-s 1 --angle 90").refuses(&["89.9"]);
    sandbox.run("flights hg g=2 --sigma-a 1 --sigma-s 1").refuses(&["phase g=2"]);
    let subdivided = "flights --sigma-a 1,2,3 --sigma-s 1";
    sandbox.run(&format!("{subdivided},2")).refuses(&["--sigma-s", "each of the 3 cells", "2 numbers"]);
    sandbox.run(&format!("{subdivided} --cells 1x3x1")).refuses(&["--cells", "use --shape cube"]);
    sandbox.run(&format!("{subdivided} --cells 3")).refuses(&["such as 2x2x4"]);
    sandbox.run(&format!("{subdivided} --svg f.svg")).refuses(&["a subdivided one"]);
    sandbox.run(&format!("{subdivided} --confidence 0.9")).refuses(&["--relative-error"]);
    sandbox.run(&format!("{subdivided} --relative-error 1")).refuses(&["such as 0.01"]);
    // Refused before so many photons fly, which would take days.
    sandbox
        .run("flights --sigma-a 1 --sigma-s 0 --svg f.svg --photons 100000000000")
        .refuses(&["--svg", "none"]);
    assert_eq!(sandbox.files(), [""; 0]);
}
