//! Which mesh of the solid gives how many digits: stretch, expansion and twist of FREEs of 20 and 60 degrees at 30 kPa on rising meshes, and how far
//! each is from the last, finest one.
//!
//! `cargo run --release -p fe --example solid_mesh_study [-- LENGTH_MM]`
//!
//! With `reference` in place of the length: states at the pressures of other programs' solid models, on like meshes and on finer ones.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{Deformation, SolidError, SolidLoad, SolidMesh, SolidSolver, Specimen};

/// Fibres of 0.15 mm.
fn specimen(angle: f64, length: f64, stiffness: f64) -> Specimen {
    let fibre = Fibre { axial_stiffness: stiffness, diameter: 0.15e-3, law: FibreLaw::Linear };
    let free = Free {
        tube: Tube { length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    Specimen { bulk_ratio: 1e3, ..Specimen::from(&free) }
}

struct Outcome {
    unknowns: usize,
    cpu: f64,
    states: Vec<(f64, Deformation)>,
}

fn solve(specimen: &Specimen, mesh: SolidMesh, pressures: &[f64]) -> Result<Outcome, SolidError> {
    let mut solver = SolidSolver::sector(specimen, mesh)?;
    let rest = solver.rest();
    let stops: Vec<f64> = pressures.iter().map(|p| 1e3 * p).collect();
    let mut found = vec![];
    solver.follow(&rest, 0.0, &stops, &|p| SolidLoad::pressure(p), &mut |p, state| {
        found.push((1e-3 * p, state.clone()));
        true
    })?;
    let cost = solver.cost();
    Ok(Outcome {
        unknowns: solver.unknowns(),
        cpu: (cost.assembly + cost.factorisation + cost.substitution).as_secs_f64(),
        states: found.iter().map(|(p, state)| (*p, solver.deformation(state))).collect(),
    })
}

fn degrees_per_mm(twist: f64) -> f64 {
    1e-3 * twist.to_degrees()
}

/// Elements: through the wall, around, under half a fibre, along per 40 mm.
const MESHES: [(f64, &[[usize; 4]]); 2] = [
    (
        20.0,
        &[
            [1, 12, 0, 28],
            [1, 12, 0, 40],
            [1, 12, 1, 28],
            [1, 12, 1, 40],
            [2, 12, 1, 28],
            [1, 24, 1, 28],
            [2, 24, 1, 28],
            [2, 24, 1, 40],
            [2, 24, 1, 56],
            [3, 36, 2, 56],
        ],
    ),
    (
        60.0,
        &[
            [1, 12, 0, 18],
            [1, 12, 0, 28],
            [1, 12, 1, 18],
            [2, 12, 0, 18],
            [2, 12, 1, 18],
            [1, 24, 1, 18],
            [2, 24, 1, 18],
            [2, 24, 1, 28],
            [2, 24, 1, 40],
            [3, 36, 2, 56],
        ],
    ),
];

fn study(length: f64) -> Result<(), SolidError> {
    println!(
        "K/mu = 1000, 30 kPa, {} mm, fibres of 0.15 mm; errors in % of stretch - 1, expansion - 1 and twist",
        1e3 * length
    );
    for (angle, meshes) in MESHES {
        println!(
            "\n{angle} deg\nradial x around + under x along  unknowns      s   stretch  (error)  expansion (error)     twist  (error)   total: stretch (error)   twist  (error)"
        );
        let mut rows = vec![];
        for &[radial, around, under_fibre, along] in meshes {
            let along = (along as f64 * length / 0.04).round() as usize;
            let mesh = SolidMesh { radial, under_fibre, ..SolidMesh::new(around, along) };
            let outcome = solve(&specimen(angle, length, 644.0), mesh, &[10.0, 20.0, 30.0])?;
            rows.push((mesh, outcome));
        }
        let Some((_, finest)) = rows.last() else { continue };
        let values = |outcome: &Outcome| {
            let d = outcome.states[outcome.states.len() - 1].1;
            [
                d.stretch_mid,
                d.expansion_mid,
                1.0 + degrees_per_mm(d.twist_mid),
                d.stretch_total,
                1.0 + degrees_per_mm(d.twist_total),
            ]
        };
        let best = values(finest);
        for (mesh, outcome) in &rows {
            let found = values(outcome);
            let error: [f64; 5] = std::array::from_fn(|i| 100.0 * ((found[i] - 1.0) / (best[i] - 1.0) - 1.0));
            let name = format!("{} x {} + {} x {}", mesh.radial, mesh.around, mesh.under_fibre, mesh.along);
            println!(
                "{name:>30} {:>9} {:>6.1}   {:.5} {:>8.2}    {:.5} {:>8.2}   {:.5} {:>8.2}       {:.5} {:>8.2}   {:.5} {:>8.2}",
                outcome.unknowns,
                outcome.cpu,
                found[0],
                error[0],
                found[1],
                error[1],
                found[2] - 1.0,
                error[2],
                found[3],
                error[3],
                found[4] - 1.0,
                error[4]
            );
        }
    }
    Ok(())
}

/// Angle, length, EA, mesh of the other programs and a finer one.
type Case = (f64, f64, f64, [usize; 4], [usize; 4]);

fn reference() -> Result<(), SolidError> {
    let cases: [Case; 5] = [
        (20.0, 0.13, 644.0, [1, 12, 0, 90], [1, 12, 1, 130]),
        (20.0, 0.04, 644.0, [1, 12, 0, 28], [2, 24, 1, 40]),
        (20.0, 0.04, 1288.0, [1, 12, 0, 28], [2, 24, 1, 40]),
        (20.0, 0.04, 322.0, [1, 12, 0, 28], [2, 24, 1, 40]),
        (60.0, 0.04, 644.0, [1, 12, 0, 18], [2, 12, 1, 28]),
    ];
    println!("K/mu = 1000, fibres of 0.15 mm; twist in deg/mm");
    for (angle, length, stiffness, like, finer) in cases {
        let pressures: &[f64] = if angle > 30.0 {
            &[10.0, 20.0, 30.0, 40.0, 50.0]
        } else {
            &[10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 68.9]
        };
        for [radial, around, under_fibre, along] in [like, finer] {
            let mesh = SolidMesh { radial, under_fibre, ..SolidMesh::new(around, along) };
            println!(
                "\n{angle} deg, L {} mm, EA {stiffness} N, {radial} x {around} + {under_fibre} x {along}",
                1e3 * length
            );
            println!("  kPa  stretch: total     mid   a/A mid   b/B mid  twist: total     mid");
            for (p, d) in solve(&specimen(angle, length, stiffness), mesh, pressures)?.states {
                println!(
                    "{p:>5.1}        {:.5} {:.5}   {:.5}   {:.5}       {:.4} {:.4}",
                    d.stretch_total,
                    d.stretch_mid,
                    d.bore_mid,
                    d.expansion_mid,
                    degrees_per_mm(d.twist_total),
                    degrees_per_mm(d.twist_mid)
                );
            }
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    match std::env::args().nth(1).as_deref() {
        Some("reference") => reference()?,
        Some(length) => study(1e-3 * length.parse::<f64>()?)?,
        None => study(0.04)?,
    }
    Ok(())
}
