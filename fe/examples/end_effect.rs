//! What rigid caps do to a FREE: how far it reaches, whether it is the same at any length and any stiffness, and how well a section with
//! its end effect stands for the whole tube.
//!
//! `cargo run --release -p fe --example end_effect [-- layers|lengths|stiffness|meshes|capped|middle ...]`; all of them without a name.
//!
//! Paper: tube of Buffinton et al. 2020 (130 mm; 175 mm in modules). Michigan: 86.4 mm, bore 9.525 mm, wall 1.5875 mm. Angles from the hoop.

use actuator::{
    Elastomer, EndLoad, Fibre, FibreLaw, Free, FreePath, FreeState, Handedness, OgdenForm, Tube, Winding,
};
use fe::{
    CappedSweep, EndChange, FreeSweep, SectionMesh, SectionSolver, SolidError, SolidMesh, SolidSolver,
    SolidSweep, Specimen,
};

type Outcome = Result<(), Box<dyn std::error::Error>>;
/// Its name and what prints it.
type Study = (&'static str, fn() -> Outcome);

const MM: f64 = 1e-3;
/// Length of the solid that end effects are taken from elsewhere in this file, mm.
const STANDARD: f64 = 60.0;

fn free(angle: f64, length_mm: f64, bore_mm: f64, wall_mm: f64, width_mm: f64) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: width_mm * MM, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: length_mm * MM, inner_radius: 0.5 * bore_mm * MM, wall: wall_mm * MM },
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn paper(angle: f64, length_mm: f64) -> Free {
    free(angle, length_mm, 9.52, 0.8, 0.15)
}

fn michigan(angle: f64, length_mm: f64) -> Free {
    free(angle, length_mm, 9.525, 1.5875, 0.3)
}

/// The section's path with states at the shares of its limit pressure (or of 0.35 mu without one), and the pressures of those.
fn section(free: &Free, shares: &[f64]) -> Result<(FreePath, Vec<f64>), Box<dyn std::error::Error>> {
    let mut solver = SectionSolver::new(free, FreeSweep::default().mesh)?;
    let limit = solver.limit_pressure(EndLoad::NONE)?.unwrap_or(0.35 * free.elastomer.shear_modulus());
    let mut pressures = vec![0.0];
    pressures.extend(shares.iter().map(|share| share * limit));
    Ok((solver.path(&pressures, 0)?, pressures))
}

fn solver(free: &Free, mesh: SolidMesh) -> Result<SolidSolver, SolidError> {
    SolidSolver::sector(&Specimen::from(free), mesh)
}

/// The solid's path through pressures (Pa), where the section's limit is known.
fn solid(
    free: &Free,
    mesh: Option<SolidMesh>,
    pressures: &[f64],
) -> Result<FreePath, Box<dyn std::error::Error>> {
    let mut solver = solver(free, mesh.unwrap_or_else(|| SolidSweep::usual_mesh(free)))?;
    let limit = SectionSolver::new(free, SectionMesh::default())?.limit_pressure(EndLoad::NONE)?;
    Ok(solver.free_path(EndLoad::NONE, pressures, limit, &mut || true)?)
}

fn near(path: &FreePath, pressure: f64) -> Option<&FreeState> {
    path.states.iter().find(|state| (state.pressure - pressure).abs() <= 1e-6 * pressure)
}

fn change(free: &Free, state: &FreeState) -> EndChange {
    EndChange::of(free.tube.length, state, state).unwrap_or_default()
}

/// e/B and t (deg).
fn scaled(free: &Free, change: EndChange) -> (f64, f64) {
    (change.extension / free.tube.outer_radius(), change.turn.to_degrees())
}

/// How far the caps' influence reaches: distance from a cap, in outer radii, beyond which bore, stretch and twist of the planes stay within
/// 10 % and 1 % of the middle's change.
fn layers() -> Outcome {
    println!(
        "\nLayers: distance from the cap (in B) beyond which the deviation from the middle stays under 10 %, 1 %, 0.1 % of the middle's change; 110 mm"
    );
    println!("angle  p/p_limit      bore               stretch            twist");
    for angle in [20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0] {
        let free = paper(angle, 110.0);
        let (_, pressures) = section(&free, &[0.1, 0.5, 0.8, 0.95])?;
        let mut solver = solver(&free, SolidSweep::usual_mesh(&free))?;
        let mut rows = vec![];
        let limit = pressures[1] / 0.1;
        solver.free_path_seen(
            EndLoad::NONE,
            &pressures,
            Some(limit),
            &mut || true,
            &mut |solver, state, report| {
                if report.pressure > 0.0 {
                    rows.push((report.pressure, solver.profile(state)));
                }
                true
            },
        )?;
        for (pressure, profile) in rows {
            if !pressures.iter().any(|p| (p - pressure).abs() < 1e-6 * p) {
                continue;
            }
            // Over whole elements: two planes of nodes.
            let spans: Vec<[f64; 4]> = profile
                .windows(3)
                .step_by(2)
                .map(|planes| {
                    let length = planes[2].height - planes[0].height;
                    [
                        planes[1].height,
                        planes[1].bore - 1.0,
                        (planes[2].raised - planes[0].raised) / length - 1.0,
                        (planes[1].turn + planes[2].turn) / length,
                    ]
                })
                .collect();
            let half = spans.len() / 2;
            let middle = spans[half];
            let mut line = format!("{angle:>5} {:>8.2}   ", pressure / limit);
            for quantity in 1..4 {
                for share in [0.1, 0.01, 0.001] {
                    let off = |span: &[f64; 4]| (span[quantity] / middle[quantity] - 1.0).abs();
                    let last = spans[..half].iter().rev().find(|span| off(span) > share);
                    line += &format!(" {:>5.2}", last.map_or(0.0, |span| span[0]) / free.tube.outer_radius());
                }
                line += "  ";
            }
            println!("{line}");
        }
    }
    Ok(())
}

const LENGTHS: [f64; 7] = [25.0, 40.0, 60.0, 86.0, 100.0, 130.0, 175.0];

fn lengths() -> Outcome {
    println!(
        "\nIndependence of the length: e/B, t (deg) and, of the middle, deviation from the section in % of stretch - 1, expansion - 1, twist"
    );
    for angle in [20.0, 40.0, 60.0, 70.0] {
        let shares = [0.1, 0.5, 0.8, 0.9, 0.95, 0.98, 0.995];
        let (of_section, pressures) = section(&paper(angle, 130.0), &shares)?;
        let mut rows = vec![];
        for length in LENGTHS {
            let free = paper(angle, length);
            rows.push((free, solid(&free, None, &pressures)?));
        }
        for (share, pressure) in shares.iter().zip(&pressures[1..]) {
            println!("{angle} deg, {:.3} kPa = {share} p_limit", 1e-3 * pressure);
            for (free, path) in &rows {
                let (Some(state), Some(theirs)) = (near(path, *pressure), near(&of_section, *pressure))
                else {
                    continue;
                };
                let (e, t) = scaled(free, change(free, state));
                let middle = state.middle.ok_or("no middle")?;
                println!(
                    "   {:>5.0} mm  {e:>9.5} {t:>9.4}   {:>7.3} {:>7.3} {:>7.3}   limit {:.3} kPa",
                    1e3 * free.tube.length,
                    100.0 * ((middle.axial_stretch - 1.0) / (theirs.axial_stretch - 1.0) - 1.0),
                    100.0 * ((state.expansion - 1.0) / (theirs.expansion - 1.0) - 1.0),
                    100.0 * (middle.twist_per_length / theirs.twist_per_length - 1.0),
                    1e-3 * path.limit_pressure().unwrap_or(f64::NAN)
                );
            }
        }
    }
    Ok(())
}

fn stiffness() -> Outcome {
    println!("\nDependence on EA/(mu B^2) at equal p/p_limit: e/B and t (deg), {STANDARD} mm");
    for angle in [20.0, 40.0, 60.0, 70.0] {
        for modulus in [0.2e6, 0.393e6, 0.6e6, 1.2e6] {
            let mut free = paper(angle, STANDARD);
            free.elastomer = free.elastomer.with_shear_modulus(modulus);
            let (path, pressures) = section(&free, &[0.1, 0.5, 0.8])?;
            let found = solid(&free, None, &pressures)?;
            let mut line = format!(
                "{angle} deg, EA/(mu B^2) = {:>4.0}, p_limit/mu {:.5}: ",
                644.0 / (modulus * free.tube.outer_radius().powi(2)),
                path.limit_pressure().unwrap_or(f64::NAN) / modulus
            );
            for pressure in &pressures[1..] {
                let (e, t) = near(&found, *pressure)
                    .map_or((f64::NAN, f64::NAN), |state| scaled(&free, change(&free, state)));
                line += &format!(" {e:>9.5} {t:>9.4} ");
            }
            println!("{line}");
        }
    }
    Ok(())
}

fn meshes() -> Outcome {
    println!(
        "\nMesh: e/B, t (deg) at 0.1, 0.5, 0.8 p_limit, 40 mm; elements through the wall x around beside fibres + under half a fibre x along"
    );
    for angle in [20.0, 40.0, 60.0] {
        for [radial, around, under_fibre, along] in [
            [1, 12, 0, 28],
            [2, 24, 0, 30],
            [2, 24, 1, 40],
            [2, 24, 1, 56],
            [2, 24, 0, 80],
            [2, 24, 1, 80],
            [3, 36, 2, 80],
        ] {
            let free = paper(angle, 40.0);
            let mesh = SolidMesh { radial, under_fibre, ..SolidMesh::new(around, along) };
            let (_, pressures) = section(&free, &[0.1, 0.5, 0.8])?;
            let found = solid(&free, Some(mesh), &pressures)?;
            let mut line = format!("{angle} deg {radial} x {around} + {under_fibre} x {along:>2} ");
            for pressure in &pressures[1..] {
                let (e, t) = near(&found, *pressure)
                    .map_or((f64::NAN, f64::NAN), |state| scaled(&free, change(&free, state)));
                line += &format!(" {e:>9.5} {t:>9.4} ");
            }
            println!("{line}");
        }
    }
    Ok(())
}

/// Section with end effect against whole solids of the FREE's length, and the end-effect lengths.
fn capped() -> Outcome {
    println!(
        "\nCapped section against whole solids: error of total stretch and twist in % of stretch - 1 and twist (not corrected | corrected), \
              difference of total stretch / 1e-5, and delta/B of stretch and twist"
    );
    let sweep = CappedSweep::default();
    let paper_cases = [130.0, 175.0].map(|length| (length, "paper", [20.0, 30.0, 40.0, 60.0, 70.0]));
    let cases = paper_cases.into_iter().chain([
        (86.4, "Michigan", [40.0, 50.0, 70.0, f64::NAN, f64::NAN]),
        (40.0, "paper", [20.0, 60.0, f64::NAN, f64::NAN, f64::NAN]),
    ]);
    for (length, name, angles) in cases {
        for angle in angles.into_iter().filter(|angle| angle.is_finite()) {
            let free = if name == "paper" { paper(angle, length) } else { michigan(angle, length) };
            let shares = [0.1, 0.5, 0.8, 0.95, 0.98, 1.0];
            let (of_section, mut pressures) = section(&free, &shares)?;
            let limit = *pressures.last().ok_or("no pressure")?;
            let effect = sweep.end_effect(&free.into(), 0.35, &mut || true)?;
            pressures.push(3.0 * limit);
            let whole = solid(&free, None, &pressures)?;
            println!(
                "{name}, {length} mm, {angle} deg: limit {:.3} kPa, section's {:.3} kPa",
                1e-3 * whole.limit_pressure().unwrap_or(f64::NAN),
                1e-3 * limit
            );
            for (share, pressure) in shares.iter().zip(&pressures[1..]) {
                let theirs =
                    of_section.states.iter().find(|state| (state.pressure / pressure - 1.0).abs() < 1e-8);
                let (Some(theirs), Some(state)) = (theirs, near(&whole, *pressure)) else { continue };
                let Some(change) = effect.at(effect.unit().coordinate(*pressure)) else { continue };
                let ours = change.cap_to_cap(free.tube.length, theirs);
                let off = |found: &FreeState| {
                    format!(
                        "{:>8.3} {:>7.3}",
                        100.0 * (found.axial_stretch - state.axial_stretch) / (state.axial_stretch - 1.0),
                        100.0 * (found.twist_per_length / state.twist_per_length - 1.0)
                    )
                };
                let middle = ours.middle.ok_or("no middle")?;
                let [stretch, twist] = change.lengths(middle).map(|length| length / free.tube.outer_radius());
                println!(
                    "   {share:>5} p_limit  {} | {}   {:>7.2}   e/B {:>8.5}  t {:>8.3} deg  delta/B {stretch:>7.3} {twist:>7.3}   total {:.5} {:.5} deg/mm, expansion {:.5} {:.5}",
                    off(theirs),
                    off(&ours),
                    1e5 * (ours.axial_stretch - state.axial_stretch),
                    change.extension / free.tube.outer_radius(),
                    change.turn.to_degrees(),
                    state.axial_stretch,
                    1e-3 * state.twist_per_length.to_degrees(),
                    state.expansion,
                    ours.expansion
                );
            }
        }
    }
    Ok(())
}

/// Middle of a long solid against the section.
fn middle() -> Outcome {
    println!(
        "\nMiddle of a solid of 110 mm against the section: difference in % of stretch - 1, expansion - 1 and twist"
    );
    for angle in [20.0, 30.0, 40.0, 50.0, 60.0, 70.0] {
        let free = paper(angle, 110.0);
        let shares = [0.1, 0.5, 0.8];
        let (of_section, pressures) = section(&free, &shares)?;
        let usual = SolidSweep::usual_mesh(&free);
        let fine = SolidMesh { under_fibre: 1, along: 3 * usual.along / 2, ..usual };
        let [found, finer] = [solid(&free, Some(usual), &pressures)?, solid(&free, Some(fine), &pressures)?];
        for (share, pressure) in shares.iter().zip(&pressures[1..]) {
            let Some(theirs) = near(&of_section, *pressure) else { continue };
            let mut line = format!(
                "{angle} deg {share} p_limit: section {:.5} {:.5} {:>8.5} deg/mm; ",
                theirs.axial_stretch,
                theirs.expansion,
                1e-3 * theirs.twist_per_length.to_degrees()
            );
            for state in [near(&found, *pressure), near(&finer, *pressure)].into_iter().flatten() {
                let middle = state.middle.ok_or("no middle")?;
                line += &format!(
                    "   {:>7.3} {:>7.3} {:>7.3} ({:>5.1}e-5)",
                    100.0 * ((middle.axial_stretch - 1.0) / (theirs.axial_stretch - 1.0) - 1.0),
                    100.0 * ((state.expansion - 1.0) / (theirs.expansion - 1.0) - 1.0),
                    100.0 * (middle.twist_per_length / theirs.twist_per_length - 1.0),
                    1e5 * (middle.axial_stretch - theirs.axial_stretch)
                );
            }
            println!("{line}");
        }
    }
    Ok(())
}

fn main() -> Outcome {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let studies: [Study; 6] = [
        ("layers", layers),
        ("lengths", lengths),
        ("stiffness", stiffness),
        ("meshes", meshes),
        ("capped", capped),
        ("middle", middle),
    ];
    for (name, study) in studies {
        if asked.is_empty() || asked.iter().any(|word| word == name) {
            study()?;
        }
    }
    Ok(())
}
