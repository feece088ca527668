//! C programs with `freeact.h`: their answers against those of the crate `rom`, and calls that are wrong.

use evaluator::{Content, Image};
use freeact_tests::{build, data, freeact, images, project};
use rom::Model;
use std::{
    ffi::OsString,
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// Libraries that the standard library needs, where they are not in the C library.
const SYSTEM: [&str; 3] = ["-lpthread", "-ldl", "-lm"];

/// A C program, linked to the library; `None` where there is no compiler.
fn compiled(folder: &Path, source: &str, more: &[&str], library: &[OsString]) -> Option<PathBuf> {
    let Some(compiler) = images::c_compiler() else {
        println!("skipped: there is no C compiler (cc, or what CC names)");
        return None;
    };
    let out = folder.join(source.replace(".c", "") + &more.concat());
    let mut compile = Command::new(compiler);
    compile.args(["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O2"]).args(more);
    compile
        .arg(project().join("bindings/c/tests").join(source))
        .arg("-o")
        .arg(&out)
        .args(library)
        .args(SYSTEM);
    let output = compile.output().expect("the compiler runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(out)
}

fn static_library() -> Vec<OsString> {
    vec![build(&["--package", "freeact-c"]).join("libfreeact_c.a").into()]
}

/// Rows of numbers that a program prints for an image and states; the first word of the first row is left out.
fn rows(program: &Path, image: &Path, more: &[&str], states: &str) -> Vec<Vec<f64>> {
    let mut run = Command::new(program);
    run.arg(image).args(more).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = run.spawn().expect("the program starts");
    child.stdin.take().expect("a pipe").write_all(states.as_bytes()).expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("text");
    let number = |word: &str| word.parse().unwrap_or_else(|_| panic!("{word} is no number"));
    let words = text.lines().enumerate();
    words.map(|(line, row)| row.split(' ').skip(usize::from(line == 0)).map(number).collect()).collect()
}

/// A Weyl sequence, the same on every machine: numbers from zero to one.
fn scattered(row: usize, column: usize) -> f64 {
    let root = [2f64, 3.0, 5.0, 7.0, 11.0][column].sqrt();
    (row as f64 * root).fract()
}

fn text(states: &[Vec<f64>]) -> String {
    let line =
        |state: &Vec<f64>| state.iter().map(|number| format!("{number:e} ")).collect::<String>() + "\n";
    states.iter().map(line).collect()
}

/// Pressures that are read, up to so many Pa: some beyond the domain.
const READ: f64 = 66e3;
/// Pressures that are commanded: the supply lags, so that they may be greater.
const COMMANDED: f64 = 80e3;

/// Steps of up to 50 ms and pressures.
fn of_module(greatest: f64) -> Vec<Vec<f64>> {
    let state = |row| (0..5).map(|k| scattered(row, k) * if k == 0 { 0.05 } else { greatest }).collect();
    (1..=400).map(state).collect()
}

/// Steps, pressures, winding angles and shear moduli of a FREE.
fn of_free(model: &Model) -> Vec<Vec<f64>> {
    let free = model.as_free().expect("a FREE");
    let (angles, moduli) = (free.winding_angles(), free.shear_moduli());
    let between = |nodes: &[f64], part: f64| nodes[0] + part * (nodes[nodes.len() - 1] - nodes[0]);
    let state = |row| {
        let angle = between(angles, 1.1 * scattered(row, 2) - 0.1);
        vec![0.05 * scattered(row, 0), 60e3 * scattered(row, 1), angle, between(moduli, scattered(row, 3))]
    };
    (1..=400).map(state).collect()
}

/// What `rom` says of a module at the same states: nothing where it has no answer.
fn answers(model: &Model, states: &[Vec<f64>], commands: bool) -> Vec<Option<Vec<f64>>> {
    let tip = model.as_module().expect("a module").tip_model();
    let chain = model.effects.of(4);
    let mut memory = vec![0.0; chain.memory()];
    let mut answer = |state: &Vec<f64>| {
        let mut pressures = state[1..].to_vec();
        match commands {
            true => chain.supply(&mut memory, state[0], &mut pressures),
            false => chain.unread_pressures(&mut pressures),
        }
        let found = tip.evaluate(&chain, &mut memory, state[0], &pressures).ok()?;
        let mut row = [&found.pose.position[..], &found.pose.rotation].concat();
        row.extend(found.jacobian[..4].as_flattened());
        row.extend(&found.answered[..4]);
        row.push(tip.splines.clearance(&found.answered[..4]));
        row.extend(tip.splines.error_bars(&found.answered[..4]).into_iter().flatten());
        Some(row)
    };
    states.iter().map(&mut answer).collect()
}

/// Compares rows with answers to the last bit; there must be answers, and states without one.
#[track_caller]
fn assert_same(rows: &[Vec<f64>], expected: &[Option<Vec<f64>>]) {
    assert_eq!(rows.len(), expected.len());
    for (row, expected) in rows.iter().zip(expected) {
        match expected {
            Some(numbers) => assert!(row[0] == 0.0 && row[1..] == numbers[..], "{row:?}\n{expected:?}"),
            None => assert!(row.len() == 1 && row[0] >= 20.0, "{row:?}"),
        }
    }
    let answered = expected.iter().flatten().count();
    assert!(answered > 100 && answered < expected.len(), "{answered}");
}

#[test]
fn c_answers_as_rom_to_the_last_bit() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    images::write(folder.path());
    let Some(program) = compiled(folder.path(), "agree.c", &[], &static_library()) else { return };
    let module = images::module();
    for (words, greatest) in [(&["readings"], READ), (&["commands"], COMMANDED)] {
        let states = of_module(greatest);
        let rows = rows(&program, &folder.path().join("module_f64.img"), words, &text(&states));
        let memory = module.effects.of(4).memory() as f64;
        assert_eq!(rows[0][..3], [4.0, memory, 0.0]);
        let domain: Vec<f64> = module.as_module().expect("a module").tip_model().splines.domain()[..]
            .iter()
            .map(|(_, greatest)| *greatest)
            .collect();
        assert_eq!(rows[0][3..11], [&[0.0; 4], &domain[..]].concat());
        assert_same(&rows[1..], &answers(&module, &states, greatest == COMMANDED));
    }

    let free = images::free();
    let states = of_free(&free);
    let rows = rows(&program, &folder.path().join("free_f64.img"), &[], &text(&states));
    let model = free.as_free().expect("a FREE");
    let (angle, modulus) = (model.free().winding.angle_from_hoop(), model.free().elastomer.shear_modulus());
    assert_eq!(rows[0][4..6], [model.greatest_pressure(angle, modulus).expect("inside"), angle]);
    let chain = free.effects.of(1);
    let mut memory = vec![0.0; chain.memory()];
    let mut answer = |given: &Vec<f64>| {
        let [step, pressure, angle, modulus] = given[..] else { panic!("four numbers") };
        let found =
            model.splines().evaluate_after(&chain, &mut memory, step, pressure, angle, modulus).ok()?;
        let mut row = vec![found.axial_stretch, found.expansion, found.twist_per_length];
        row.extend(found.jacobian.as_flattened());
        row.extend(model.greatest_pressure(angle, modulus).ok());
        Some(row)
    };
    let expected: Vec<_> = states.iter().map(&mut answer).collect();
    assert_same(&rows[1..], &expected);
}

#[test]
fn c_answers_in_single_precision_as_the_evaluator() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    images::write(folder.path());
    let Some(program) = compiled(folder.path(), "agree.c", &["-DSINGLE"], &static_library()) else { return };
    let image = folder.path().join("module_f32.img");
    let states: Vec<Vec<f64>> = of_module(READ)
        .iter()
        .map(|state| state.iter().map(|number| f64::from(*number as f32)).collect())
        .collect();
    let rows = rows(&program, &image, &[], &text(&states));
    let bytes = fs::read(&image).expect("an image");
    let words = images::aligned(&bytes);
    let read = Image::<f32>::read(&images::bytes(&words)[..bytes.len()]).expect("an image");
    let Content::Module(tip) = &read.content else { panic!("it is of a module") };
    let chain = read.effects.chain();
    let mut memory = vec![0.0; chain.memory()];
    let mut answer = |state: &Vec<f64>| {
        let mut pressures: Vec<f32> = state[1..].iter().map(|number| *number as f32).collect();
        chain.unread_pressures(&mut pressures);
        let found = tip.evaluate(&chain, &mut memory, state[0] as f32, &pressures).ok()?;
        let mut row = [&found.pose.position[..], &found.pose.rotation].concat();
        row.extend(found.jacobian[..4].as_flattened());
        row.extend(&found.answered[..4]);
        row.push(tip.splines.clearance(&found.answered[..4]));
        Some(row.into_iter().map(f64::from).collect::<Vec<f64>>())
    };
    let expected: Vec<_> = states.iter().map(&mut answer).collect();
    assert_same(&rows[1..], &expected);
}

#[test]
fn c_knows_error_bars_through_the_shared_library() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let target = build(&["--package", "freeact-c"]);
    let shared = folder.path().join("shared");
    fs::create_dir(&shared).expect("a folder");
    // Without the static one beside it, which a linker might take.
    let name = format!("{}freeact_c{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    fs::copy(target.join(&name), shared.join(&name)).expect("the shared library");
    let mut run_path = OsString::from("-Wl,-rpath,");
    run_path.push(&shared);
    let library = ["-L".into(), shared.into(), "-lfreeact_c".into(), run_path];
    let Some(program) = compiled(folder.path(), "agree.c", &[], &library) else { return };
    let path = folder.path().join("m.model");
    let map = data("maps/buffinton-2020-30lr.map");
    freeact([OsString::from("fit"), map.into(), "--out".into(), path.clone().into()]).succeeded();
    let model = Model::read(&path).expect("a model");
    let image = folder.path().join("m.img");
    fs::write(&image, model.image::<f64>().expect("an image")).expect("written");
    let states = of_module(READ);
    let rows = rows(&program, &image, &[], &text(&states));
    let expected = answers(&model, &states, false);
    assert_eq!(rows[0][..3], [4.0, 0.0, 1.0]);
    assert!(expected.iter().flatten().all(|row| row.len() == 7 + 24 + 4 + 1 + 2), "with error bars");
    assert_same(&rows[1..], &expected);
}

#[test]
fn wrong_calls_end_with_their_codes() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    images::write(folder.path());
    let Some(program) = compiled(folder.path(), "misuse.c", &[], &static_library()) else { return };
    let names = ["module_f64.img", "free_f64.img", "module_f32.img"];
    let output = Command::new(program).args(names).current_dir(folder.path()).output().expect("it starts");
    assert!(output.status.success(), "{}{:?}", String::from_utf8_lossy(&output.stdout), output.status);
}

#[test]
fn the_library_for_controllers_is_the_same_without_std() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    images::write(folder.path());
    let target = project().join("target/bare");
    let mut build = Command::new(env!("CARGO"));
    build.args([
        "rustc",
        "--quiet",
        "--release",
        "--locked",
        "--package",
        "freeact-c",
        "--no-default-features",
    ]);
    build.args([
        "--crate-type",
        "staticlib",
        "--config",
        "profile.release.panic=\"abort\"",
        "--config",
        "profile.release.lto=true",
        "--target-dir",
    ]);
    assert!(build.arg(&target).current_dir(project()).status().expect("cargo runs").success());
    let library: OsString = target.join("release/libfreeact_c.a").into();
    let Some(program) = compiled(folder.path(), "agree.c", &["-DBARE"], &[library]) else { return };
    let (module, states) = (images::module(), of_module(COMMANDED));
    let rows = rows(&program, &folder.path().join("module_f64.img"), &["commands"], &text(&states));
    assert_same(&rows[1..], &answers(&module, &states, true));
}
