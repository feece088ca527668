//! The evaluator without std, allocator and C library: `evaluator/bare` is linked to a program that has none, which is run.

use evaluator::{Content, Image, Real};
use freeact_tests::{images, project};
use std::process::Command;

/// Numbers of an answer, see `evaluator/bare`.
const ANSWER: usize = 31;
/// What the program evaluates, kPa.
const OF_MODULE: [[f64; 4]; 3] = [[10.0, 30.0, 2.0, 9.0], [42.0, 8.0, 12.0, 0.0], [20.0, 22.0, 31.0, 7.0]];
const OF_FREE: [f64; 3] = [2.0, 9.0, 5.0];

/// The same here, with std and everything else.
fn answer<T: Real + bytemuck::Pod>(bytes: &[u8]) -> Vec<T> {
    let words = images::aligned(bytes);
    let image = Image::<T>::read(&bytemuck::cast_slice(&words)[..bytes.len()]).expect("an image");
    let chain = image.effects.chain();
    let mut memory = vec![T::ZERO; chain.memory()];
    assert!(chain.memory() > 0, "the effects are to be tried too");
    let (step, pascal) = (T::constant(0.01), |kpa: f64| T::constant(kpa * 1e3));
    let mut answer: Vec<T> = match &image.content {
        Content::Module(tip) => {
            let answers = OF_MODULE.map(|kpa| tip.evaluate(&chain, &mut memory, step, &kpa.map(pascal)));
            let last = answers[2].expect("inside");
            [&last.pose.position[..], &last.pose.rotation, last.jacobian[..4].as_flattened()].concat()
        }
        Content::Free { splines, winding_angle: angle, shear_modulus: modulus } => {
            let answers = OF_FREE
                .map(|kpa| splines.evaluate_after(&chain, &mut memory, step, pascal(kpa), *angle, *modulus));
            let last = answers[2].expect("inside");
            let own = [last.axial_stretch, last.expansion, last.twist_per_length];
            [&own[..], last.jacobian.as_flattened()].concat()
        }
    };
    answer.resize(ANSWER, T::ZERO);
    answer
}

#[test]
fn the_evaluator_answers_without_std_allocator_and_c_library() {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        println!("skipped: the program without a C library is for x86-64 Linux");
        return;
    }
    let Some(compiler) = images::c_compiler() else {
        println!("skipped: there is no C compiler (cc, or what CC names)");
        return;
    };
    let (bare, target) = (project().join("evaluator/bare"), project().join("target/bare"));
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "--release", "--locked", "--target-dir"]).arg(&target);
    assert!(
        build.current_dir(&bare).status().expect("cargo runs").success(),
        "evaluator/bare does not build"
    );
    let folder = tempfile::tempdir().expect("a scratch folder");
    images::write(folder.path());
    let mut link = Command::new(compiler);
    link.args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-O1", "-ffreestanding", "-fno-builtin"])
        .args(["-nostdlib", "-static", "-Wl,--gc-sections", "-o", "bare"])
        .arg(bare.join("start.c"))
        .arg(target.join("release/libbare.a"));
    let linked = link.current_dir(folder.path()).output().expect("the compiler runs");
    assert!(linked.status.success(), "{}", String::from_utf8_lossy(&linked.stderr));
    let run = Command::new(folder.path().join("bare")).output().expect("the program starts");
    assert!(run.status.success(), "{run:?}");
    let image = |name: &str| std::fs::read(folder.path().join(name)).expect("an image");
    let bytes = |numbers: &[f64]| -> Vec<u8> { bytemuck::cast_slice(numbers).to_vec() };
    let short_bytes = |numbers: &[f32]| -> Vec<u8> { bytemuck::cast_slice(numbers).to_vec() };
    let expected = [
        bytes(&answer(&image("module_f64.img"))),
        bytes(&answer(&image("free_f64.img"))),
        short_bytes(&answer(&image("module_f32.img"))),
        short_bytes(&answer(&image("free_f32.img"))),
    ]
    .concat();
    assert_eq!(run.stdout, expected, "the same bits");
}
