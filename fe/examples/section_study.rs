//! How accurate and how dear the finite elements of a FREE's cross-section are.
//!
//! `cargo run --release -p fe --example section_study [-- mesh|fibres|time]`
//!
//! `mesh`: errors of stretch, expansion, twist and limit pressure for each angle on several meshes against one four times as fine as the default,
//! the orders, and the estimate of the error beside the error. `fibres`: discrete threads against a smeared wall of the same stiffness.
//! `time`: of a state and a path against the mesh and along the axes of a map. Without argument: all three.

use actuator::{
    Elastomer, EndLoad, Fibre, FibreLaw, Free, FreePath, FreeState, Handedness, OgdenForm, Tube, Winding,
};
use fe::{PathRequest, SectionError, SectionMesh, SectionSolver, ThickTube};
use std::time::Instant;

const ANGLES: [f64; 8] = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0];
/// Four times as fine as the default every way.
const FINE: SectionMesh = SectionMesh { radial: 8, under_fibre: 8, between_fibres: 16 };
const MESHES: [SectionMesh; 5] = [mesh(1, 1, 2), mesh(2, 1, 4), mesh(2, 2, 4), mesh(3, 3, 6), mesh(4, 4, 8)];

const fn mesh(radial: usize, under_fibre: usize, between_fibres: usize) -> SectionMesh {
    SectionMesh { radial, under_fibre, between_fibres }
}

/// Tube of 4.76 + 0.8 mm, Ogden alpha = 1.2, six linear threads of 644 N and 0.3 mm.
fn free(angle: f64) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.3e-3, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 0.13, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn with_modulus(free: &Free, shear_modulus: f64) -> Free {
    Free { elastomer: free.elastomer.with_shear_modulus(shear_modulus), ..*free }
}

fn path(free: &Free, mesh: SectionMesh, pressures: &[f64], estimate: bool) -> Result<FreePath, SectionError> {
    let request = PathRequest { pressures, estimate_errors: estimate, ..PathRequest::default() };
    SectionSolver::new(free, mesh)?.free_path(&request)
}

/// Stretch - 1, expansion - 1 and twist.
fn changes(state: &FreeState) -> [f64; 3] {
    [state.axial_stretch - 1.0, state.expansion - 1.0, state.twist_per_length]
}

/// The state at a pressure of a path that was asked for it.
fn at(path: &FreePath, pressure: f64) -> Option<[f64; 3]> {
    let same = |state: &&FreeState| (state.pressure - pressure).abs() <= 1e-9 * pressure;
    path.states.iter().find(same).map(changes)
}

fn percent(found: f64, exact: f64) -> f64 {
    100.0 * (found / exact - 1.0)
}

fn mesh_study() -> Result<(), SectionError> {
    println!(
        "Errors in % of stretch - 1, expansion - 1, twist and limit pressure against 8 + 8 + 16 elements, at 0.8 of the limit pressure; mesh:\n\
         through the wall, under half a fibre, beside it. Orders between 1 1 2, 2 2 4 and 4 4 8.\n"
    );
    println!("| angle | mesh | stretch | expansion | twist | limit pressure |\n|---|---|---|---|---|---|");
    for angle in ANGLES {
        let free = free(angle);
        let exact = path(&free, FINE, &[], false)?;
        let Some(limit) = exact.limit_pressure() else { continue };
        let pressure = 0.8 * limit;
        let exact = path(&free, FINE, &[pressure], false)?;
        let [stretch, expansion, twist] = at(&exact, pressure).unwrap_or([f64::NAN; 3]);
        let mut found = vec![];
        for mesh in MESHES {
            let path = path(&free, mesh, &[pressure], false)?;
            let [l, e, t] = at(&path, pressure).unwrap_or([f64::NAN; 3]);
            let p = path.limit_pressure().unwrap_or(f64::NAN);
            let errors = [percent(l, stretch), percent(e, expansion), percent(t, twist), percent(p, limit)];
            let cells: Vec<String> = errors.iter().map(|error| format!("{error:.3}")).collect();
            let SectionMesh { radial, under_fibre, between_fibres } = mesh;
            println!("| {angle}° | {radial} {under_fibre} {between_fibres} | {} |", cells.join(" | "));
            found.push([l, e, t, p]);
        }
        let orders = (0..4).map(|q| {
            let ratio = (found[0][q] - found[2][q]) / (found[2][q] - found[4][q]);
            format!("{:.1}", ratio.abs().log2())
        });
        println!("| {angle}° | order | {} |", orders.collect::<Vec<_>>().join(" | "));
    }
    println!(
        "\nEstimate over error at 0.1, 0.2, .. 0.9 and 0.95 of the limit pressure where the error is over 1e-6 of the change: least, median and \n\
         greatest; at the limit state; of the limit pressure; and the greatest estimate in % of the change at the limit.\n"
    );
    println!(
        "| angle | modulus MPa | least | median | greatest | limit state's stretch | expansion | twist | limit pressure | greatest estimate % |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    for angle in ANGLES {
        for modulus in [0.2e6, 0.8e6] {
            let free = with_modulus(&free(angle), modulus);
            let Some(limit) = path(&free, SectionMesh::default(), &[], false)?.limit_pressure() else {
                continue;
            };
            let shares = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95];
            let pressures = shares.map(|share| share * limit);
            let found = path(&free, SectionMesh::default(), &pressures, true)?;
            let exact = path(&free, FINE, &pressures, false)?;
            let (mut ratios, mut at_limit, mut greatest) = (vec![], vec![], 0.0f64);
            let (Some(end), Some(exact_end)) = (found.states.last(), exact.states.last()) else { continue };
            for (state, exact) in found.states.iter().zip(&exact.states).skip(1) {
                let Some(error) = state.mesh_error else { continue };
                let estimate = [error.axial_stretch, error.expansion, error.twist_per_length];
                for (q, estimate) in estimate.into_iter().enumerate() {
                    let error = (changes(state)[q] - changes(exact)[q]).abs();
                    let change = changes(end)[q].abs();
                    greatest = greatest.max(estimate / change);
                    if state.pressure == end.pressure {
                        at_limit.push(format!("{:.1}", estimate / error));
                    } else if error > 1e-6 * change {
                        ratios.push(estimate / error);
                    }
                }
            }
            ratios.sort_by(f64::total_cmp);
            let ratio = |share: f64| {
                let index = (share * ratios.len().saturating_sub(1) as f64) as usize;
                ratios.get(index).copied().unwrap_or(f64::NAN)
            };
            let limit_ratio =
                found.limit_error.unwrap_or(f64::NAN) / (end.pressure - exact_end.pressure).abs();
            println!(
                "| {angle}° | {:.1} | {:.2} | {:.1} | {:.0} | {} | {limit_ratio:.1} | {:.3} |",
                1e-6 * modulus,
                ratio(0.0),
                ratio(0.5),
                ratio(1.0),
                at_limit.join(" | "),
                100.0 * greatest
            );
        }
    }
    Ok(())
}

/// Counts of fibres in which the smeared wall is judged.
const COUNTS: [u32; 12] = [1, 2, 3, 4, 6, 8, 10, 12, 16, 24, 32, 48];

/// The FREE with another number of threads of the same whole stiffness; `share_kept`: and of the same whole width, so that they cover as much.
fn with_fibres(free: &Free, count: u32, share_kept: bool) -> Free {
    let mut free = *free;
    let ratio = f64::from(free.winding.fibres) / f64::from(count);
    free.winding.fibres = count;
    free.winding.fibre.axial_stiffness *= ratio;
    free.winding.fibre.diameter *= if share_kept { ratio } else { 1.0 };
    free
}

/// A mesh whose elements beside a thread are about as wide as the wall's are thick, however far apart the threads are.
fn mesh_for(free: &Free) -> SectionMesh {
    let pitch = std::f64::consts::TAU * free.tube.outer_radius() / f64::from(free.winding.fibres);
    let width = free.winding.fibre.diameter / free.winding.angle_from_hoop().sin();
    let size = 0.5 * free.tube.wall;
    let count = |length: f64, least: usize| ((length / size).ceil() as usize).clamp(least, 24);
    mesh(2, count(0.5 * width.min(pitch), 2), count(0.5 * (pitch - width), 4))
}

fn fibre_study() -> Result<(), SectionError> {
    for share_kept in [true, false] {
        let kept = if share_kept { "covered share" } else { "thread of 0.3 mm" };
        println!(
            "\nThreads of the whole stiffness of six of 644 N, constant {kept}: error in % of the smeared wall's stretch - 1, expansion - 1 and twist \n\
             for 6 and 12 threads, and the least number from which on all is within 1 % (of 48 at most).\n"
        );
        println!(
            "| angle | of the limit | covered | 6: stretch | expansion | twist | 12: stretch | expansion | twist | stretch from | expansion from | twist from |\n\
             |---|---|---|---|---|---|---|---|---|---|---|---|"
        );
        for angle in ANGLES {
            let free = free(angle);
            let closed = ThickTube::new(&free);
            let Some(limit) = closed.limit_state().map(|state| state.pressure) else { continue };
            let pressures = [0.1 * limit, 0.8 * limit];
            let smeared: Vec<[f64; 3]> =
                pressures.iter().filter_map(|p| Some(changes(&closed.free_state(*p).ok()?))).collect();
            let mut table = vec![];
            let mut covered = 0.0;
            for count in COUNTS {
                let free = with_fibres(&free, count, share_kept);
                let solver = SectionSolver::new(&free, mesh_for(&free))?;
                covered = if count == 6 { solver.covered() } else { covered };
                // One thread at 10° carries so much that rounding is all of the residual at rest: no path.
                let Ok(path) = path(&free, mesh_for(&free), &pressures, false) else {
                    table.push((count, vec![[f64::NAN; 3]; 2]));
                    continue;
                };
                // A wall that gives way earlier has no such state.
                let errors: Vec<[f64; 3]> = pressures
                    .iter()
                    .zip(&smeared)
                    .map(|(p, smeared)| {
                        at(&path, *p).map_or([f64::NAN; 3], |found| {
                            std::array::from_fn(|q| percent(smeared[q], found[q]))
                        })
                    })
                    .collect();
                table.push((count, errors));
            }
            for (index, share) in [0.1, 0.8].into_iter().enumerate() {
                let of = |count: u32| {
                    let row = table.iter().find(|(other, _)| *other == count);
                    let errors = row.map_or([f64::NAN; 3], |(_, errors)| errors[index]);
                    errors.map(|error| format!("{error:.2}")).join(" | ")
                };
                let from = (0..3).map(|q| {
                    let wrong = |(_, errors): &&(u32, Vec<[f64; 3]>)| {
                        let error = errors[index][q].abs();
                        error.is_nan() || error >= 1.0
                    };
                    match table.iter().rev().find(wrong) {
                        None => "1".to_owned(),
                        Some((48, _)) => "more".to_owned(),
                        Some((last, _)) => {
                            let next = COUNTS.iter().find(|count| *count > last);
                            next.map_or_else(String::new, u32::to_string)
                        }
                    }
                });
                let from: Vec<String> = from.collect();
                println!(
                    "| {angle}° | {share} | {covered:.2} | {} | {} | {} |",
                    of(6),
                    of(12),
                    from.join(" | ")
                );
            }
        }
    }
    Ok(())
}

/// Seconds of a path with the pressures of a map, the least of three, and its states.
fn seconds(
    free: &Free,
    load: EndLoad,
    mesh: SectionMesh,
    estimate: bool,
) -> Result<(f64, usize), SectionError> {
    let pressures: Vec<f64> = (0..=60).map(|kpa| 1e3 * f64::from(kpa)).collect();
    let tolerance = estimate.then_some(1e-5);
    let request = PathRequest {
        load,
        pressures: &pressures,
        extra_states: 24,
        interpolation_tolerance: tolerance,
        estimate_errors: estimate,
        ..PathRequest::default()
    };
    let mut best = (f64::INFINITY, 0);
    for _ in 0..3 {
        let start = Instant::now();
        let path = SectionSolver::new(free, mesh)?.free_path(&request)?;
        best = (best.0.min(start.elapsed().as_secs_f64()), path.states.len());
    }
    Ok(best)
}

fn time_study() -> Result<(), SectionError> {
    println!(
        "\nA path at 30° with 61 pressures and 24 states more, without estimate of errors, against the mesh.\n"
    );
    println!("| mesh | elements | states | path ms | state ms | exponent |\n|---|---:|---:|---:|---:|---:|");
    let mut before: Option<(usize, f64)> = None;
    for mesh in [mesh(1, 1, 2), mesh(2, 2, 4), mesh(3, 3, 6), mesh(4, 4, 8), mesh(6, 6, 12), mesh(8, 8, 16)] {
        let SectionMesh { radial, under_fibre, between_fibres } = mesh;
        let elements = radial * (under_fibre + between_fibres);
        let (seconds, states) = seconds(&free(30.0), EndLoad::NONE, mesh, false)?;
        let exponent = before.map_or_else(String::new, |(fewer, less)| {
            format!("{:.2}", (seconds / less).ln() / (elements as f64 / fewer as f64).ln())
        });
        println!(
            "| {radial} {under_fibre} {between_fibres} | {elements} | {states} | {:.1} | {:.2} | {exponent} |",
            1e3 * seconds,
            1e3 * seconds / states as f64
        );
        before = Some((elements, seconds));
    }
    println!(
        "\nThe same on the default mesh with estimate of errors and states where cubics miss by 1e-5, along the axes of a map.\n"
    );
    println!("| FREE | states | path ms | state ms |\n|---|---:|---:|---:|");
    let with = |change: &dyn Fn(&mut Free)| {
        let mut free = free(30.0);
        change(&mut free);
        free
    };
    let usual = with(&|_| {});
    let ogden = |alpha| Elastomer::Ogden { shear_modulus: 0.393e6, alpha, form: OgdenForm::InitialModulus };
    let load = |force, torque| EndLoad { force, torque };
    let none = EndLoad::NONE;
    for (what, free, load) in [
        ("30°", usual, none),
        ("10°", free(10.0), none),
        ("80°", free(80.0), none),
        ("mu 0.2 MPa", with_modulus(&usual, 0.2e6), none),
        ("mu 0.8 MPa", with_modulus(&usual, 0.8e6), none),
        ("wall 0.5 mm", with(&|free| free.tube.wall = 0.5e-3), none),
        ("wall 1.5 mm", with(&|free| free.tube.wall = 1.5e-3), none),
        ("inner diameter 6 mm", with(&|free| free.tube.inner_radius = 3e-3), none),
        ("inner diameter 14 mm", with(&|free| free.tube.inner_radius = 7e-3), none),
        ("alpha 0.8", with(&|free| free.elastomer = ogden(0.8)), none),
        ("alpha 3", with(&|free| free.elastomer = ogden(3.0)), none),
        ("3 fibres", with(&|free| free.winding.fibres = 3), none),
        ("24 fibres", with(&|free| free.winding.fibres = 24), none),
        ("EA 100 N", with(&|free| free.winding.fibre.axial_stiffness = 100.0), none),
        ("fibre of 0.1 mm", with(&|free| free.winding.fibre.diameter = 0.1e-3), none),
        ("axial force 3 N", usual, load(3.0, 0.0)),
        ("axial force -2 N", usual, load(-2.0, 0.0)),
        ("torque 10 N mm", usual, load(0.0, 0.01)),
    ] {
        let (seconds, states) = seconds(&free, load, SectionMesh::default(), true)?;
        println!("| {what} | {states} | {:.1} | {:.2} |", 1e3 * seconds, 1e3 * seconds / states as f64);
    }
    Ok(())
}

fn main() -> Result<(), SectionError> {
    let part = std::env::args().nth(1);
    type Study = fn() -> Result<(), SectionError>;
    let studies: [(&str, Study); 3] = [("mesh", mesh_study), ("fibres", fibre_study), ("time", time_study)];
    for (name, study) in studies {
        if part.as_deref().is_none_or(|part| part == name) {
            study()?;
        }
    }
    Ok(())
}
