//! Stretches a FREE without pressure and asks at each stop whether it is stable: the mode that turns unstable first, and where.
//!
//! `cargo run --release -p fe --example solid_extension -- [name=value]...`, with the defaults of [`Settings`]; `fibre` is linear, tension
//! or beam, `cap` held (cannot turn), guided (may turn about z) or free (only its height is prescribed).
//! Writes the mode as a drawing, `svg=PATH`.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{FibreModel, SolidLoad, SolidMesh, SolidMode, SolidPath, SolidSolver, SolidState, Specimen};
use nalgebra::Vector3;
use std::{collections::BTreeMap, error::Error, f64::consts::TAU, fmt::Write, time::Instant};

/// Names, defaults.
const SETTINGS: [(&str, &str); 14] = [
    ("angle", "20"),
    ("length", "130"),
    ("fibres", "6"),
    ("around", "12"),
    ("along", "90"),
    ("radial", "1"),
    ("fibre", "linear"),
    ("cap", "held"),
    ("extension", "2"),
    ("steps", "8"),
    ("ea", "644"),
    ("diameter", "0.3"),
    ("modes", "4"),
    ("svg", ""),
];

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings: BTreeMap<String, String> =
        SETTINGS.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    for argument in std::env::args().skip(1) {
        let (name, value) = argument.split_once('=').ok_or("arguments are name=value")?;
        settings.insert(name.to_owned(), value.to_owned()).ok_or(format!("no setting {name}"))?;
    }
    let number = |name: &str| settings[name].parse::<f64>().map_err(|error| format!("{name}: {error}"));
    let count = |name: &str| settings[name].parse::<usize>().map_err(|error| format!("{name}: {error}"));
    let (law, fibre_model) = match &settings["fibre"][..] {
        "linear" => (FibreLaw::Linear, FibreModel::Truss),
        "tension" => (FibreLaw::TensionOnly, FibreModel::Truss),
        "beam" => (FibreLaw::Linear, FibreModel::Beam),
        other => return Err(format!("fibre: linear, tension or beam, not {other}").into()),
    };
    let held = match &settings["cap"][..] {
        "held" => [true; 6],
        "guided" => [true, true, true, true, true, false],
        "free" => [false, false, true, false, false, false],
        other => return Err(format!("cap: held, guided or free, not {other}").into()),
    };
    // Trusses are lines: their diameter is the width over which they hold the surface, zero as in the paper.
    let diameter = if fibre_model == FibreModel::Beam { 1e-3 * number("diameter")? } else { 0.0 };
    let fibre = Fibre { axial_stiffness: number("ea")?, diameter, law };
    let free = Free {
        tube: Tube { length: 1e-3 * number("length")?, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(
            number("angle")?.to_radians(),
            Handedness::Right,
            count("fibres")? as u32,
            fibre,
        ),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    let specimen = Specimen { fibre_model, ..Specimen::from(&free) };
    let mesh = SolidMesh { radial: count("radial")?, ..SolidMesh::new(count("around")?, count("along")?) };
    let start = Instant::now();
    let mut solver = SolidSolver::new(&specimen, mesh)?;
    println!("{settings:?}\n{} unknowns", solver.unknowns());
    let load_at =
        |mm: f64| SolidLoad { displacement: Vector3::new(0.0, 0.0, 1e-3 * mm), held, ..SolidLoad::default() };
    let (extension, steps) = (number("extension")?, count("steps")?);
    let stops: Vec<f64> = (1..=steps).map(|i| extension * i as f64 / steps as f64).collect();
    let rest = solver.rest();
    println!("extension mm | negative eigenvalues | lowest modes");
    let mut states: Vec<(f64, SolidState)> = vec![];
    let path = SolidPath::Load(&load_at);
    let found = solver.survey(
        &path,
        (0.0, &rest),
        &stops,
        count("modes")?,
        1e-3 * extension.abs(),
        false,
        &mut |at, state, stability| {
            let modes: Vec<String> =
                stability.modes.iter().map(|mode| format!("{:.4e}", mode.value)).collect();
            println!("{at:8.4} | {} | {}", stability.negative, modes.join(" "));
            states.push((at, state.clone()));
            true
        },
    );
    for (at, state) in &states {
        let [force, moment] = solver.reaction(state)?;
        let turn = solver.deformation(state).twist_total.to_degrees() * free.tube.length;
        println!(
            "{at:8.4} mm: force {:.4} N, torque {:.4} N mm, cap turned {turn:.4} deg, sideways {:.2e} mm",
            force.z,
            1e3 * moment.z,
            1e3 * state.cap().0.xy().norm()
        );
    }
    println!("{:.1} s", start.elapsed().as_secs_f64());
    let critical = match found {
        Ok(critical) => critical,
        Err(error) => {
            println!("{error}");
            vec![]
        }
    };
    for point in &critical {
        println!(
            "{:?} at {:.4} mm ({:.3} %): negative eigenvalues {} to {}, path along the modes {:.1e}, {} singular",
            point.kind,
            point.at,
            0.1 * point.at / free.tube.length,
            point.negative[0],
            point.negative[1],
            point.share,
            point.modes.len()
        );
    }
    // The mode pictured: the critical one, or the lowest at the end.
    let (state, modes) = match critical.first() {
        Some(point) => (point.state.clone(), point.modes.clone()),
        None => {
            let state = states.last().ok_or("no state")?.1.clone();
            let modes = solver.stability(&state, count("modes")?)?.modes;
            (state, modes)
        }
    };
    for mode in &modes {
        describe(&solver, &state, mode);
    }
    if let (false, Some(mode)) = (settings["svg"].is_empty(), modes.first()) {
        std::fs::write(&settings["svg"], drawing(&solver, &state, mode))?;
    }
    println!("{:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// Which waves around the tube a mode has on the outer surface: 0 bulges, 1 shifts cross-sections, as many as fibres zigzags them.
fn describe(solver: &SolidSolver, state: &SolidState, mode: &SolidMode) {
    let still = solver.outer_lines(state, None);
    let moved = solver.outer_lines(state, Some((mode, 1.0)));
    let (lines, planes) = (still.len(), still[0].len());
    let mut power = vec![0.0; lines / 2 + 1];
    let (mut changes, mut last) = (0, 0.0);
    let mut directions = [0.0; 3];
    for k in 0..planes {
        for (wave, power) in power.iter_mut().enumerate() {
            let mut sums = [[0.0; 2]; 3];
            for j in 0..lines {
                let [x, y, z] = still[j][k];
                let u: [f64; 3] = std::array::from_fn(|i| moved[j][k][i] - [x, y, z][i]);
                let (sine, cosine) = y.atan2(x).sin_cos();
                let parts = [cosine * u[0] + sine * u[1], cosine * u[1] - sine * u[0], u[2]];
                if wave == 0 {
                    directions.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part * part);
                }
                let (sine, cosine) = (TAU * (wave * j) as f64 / lines as f64).sin_cos();
                for (sum, part) in sums.iter_mut().zip(parts) {
                    sum[0] += part * cosine;
                    sum[1] += part * sine;
                }
            }
            *power += sums.as_flattened().iter().map(|sum| sum * sum).sum::<f64>();
        }
        let [x, y, _] = still[0][k];
        let out = (moved[0][k][0] - x) * x + (moved[0][k][1] - y) * y;
        if out * last < 0.0 {
            changes += 1;
        }
        last = out;
    }
    let all: f64 = power.iter().sum();
    let waves: Vec<String> = power
        .iter()
        .enumerate()
        .filter(|(_, power)| **power > 0.01 * all)
        .map(|(wave, power)| format!("{wave}: {:.0} %", 100.0 * power / all))
        .collect();
    let total: f64 = directions.iter().sum();
    println!(
        "mode {:.4e} (error {:.0e}): waves around {}; outward {:.0} %, around {:.0} %, along {:.0} %; sign changes along a line {changes} in {planes} planes; cap {:.3} {:.3}",
        mode.value,
        mode.error,
        waves.join(", "),
        100.0 * directions[0] / total,
        100.0 * directions[1] / total,
        100.0 * directions[2] / total,
        mode.cap[0].norm(),
        mode.cap[1].norm() * 5.56e-3,
    );
}

/// The lines of the outer surface in the state (grey) and moved along the mode, seen along y (left) and along x.
fn drawing(solver: &SolidSolver, state: &SolidState, mode: &SolidMode) -> String {
    let scale = 6e3;
    let height = state.cap().0.z * scale + 80.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"400\" height=\"{height:.0}\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>"
    );
    for (factor, colour) in [(0.0, "#bbbbbb"), (2e-3, "#b03020")] {
        for line in solver.outer_lines(state, Some((mode, factor))) {
            for (axis, middle) in [(0, 100.0), (1, 300.0)] {
                let points: Vec<String> = line
                    .iter()
                    .map(|at| {
                        format!("{:.1},{:.1}", middle + scale * at[axis], height - 40.0 - scale * at[2])
                    })
                    .collect();
                let _ = write!(
                    svg,
                    "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"0.8\"/>",
                    points.join(" ")
                );
            }
        }
    }
    svg + "</svg>\n"
}
