//! How the cost of a solid grows with its mesh: one FREE of 60 degrees, L 130, to 5 kPa on finer and finer meshes of the whole tube.
//!
//! `cargo run --release -p fe --example solid_growth [-- LARGEST_UNKNOWNS]` (default 110,000; 400,000 takes minutes and 6 GB)
//!
//! Times are wall seconds of one thread, per assembly of the tangent with its residuals, per factorisation, per substitution; the exponent is the slope of
//! log time against log unknowns between neighbouring rows.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{SolidLoad, SolidMesh, SolidSolver, Specimen};
use std::time::Instant;

/// Elements through the wall, around, along.
const MESHES: [[usize; 3]; 7] =
    [[1, 12, 12], [1, 12, 28], [1, 12, 58], [1, 12, 120], [1, 24, 124], [1, 24, 248], [2, 24, 276]];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let largest: usize = std::env::args().nth(1).map_or(Ok(110_000), |text| text.parse())?;
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.15e-3, law: FibreLaw::Linear };
    let free = Free {
        tube: Tube { length: 0.13, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(60f64.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    println!(
        "mesh          unknowns    GFlop  stored MB  set-up s  steps  assembly s  factor s  solve s  one step s  exponent"
    );
    let mut before: Option<(f64, f64)> = None;
    for [radial, around, along] in MESHES {
        let start = Instant::now();
        let mesh = SolidMesh { radial, ..SolidMesh::new(around, along) };
        let mut solver = SolidSolver::new(&Specimen::from(&free), mesh)?;
        let set_up = start.elapsed().as_secs_f64();
        let unknowns = solver.unknowns() as f64;
        if unknowns > largest as f64 {
            break;
        }
        let rest = solver.rest();
        solver.follow(&rest, 0.0, &[5e3], &SolidLoad::pressure, &mut |_, _| true)?;
        let cost = solver.cost();
        let assembly = cost.assembly.as_secs_f64() / cost.factorisations as f64;
        let factor = cost.factorisation.as_secs_f64() / cost.factorisations as f64;
        let solve = cost.substitution.as_secs_f64() / cost.iterations as f64;
        let step = assembly + factor + solve;
        let exponent = before.map_or(String::new(), |(n, t): (f64, f64)| {
            format!("{:.2}", (step / t).ln() / (unknowns / n).ln())
        });
        let (flops, stored) = solver.factorisation_size();
        println!(
            "{:12}  {unknowns:8}  {:7.2}  {:9.0}  {set_up:8.3}  {:5}  {assembly:10.3}  {factor:8.3}  {solve:7.3}  {step:10.3}  {exponent:>8}",
            format!("{radial}x{around}x{along}"),
            1e-9 * flops,
            8e-6 * stored as f64,
            cost.iterations
        );
        before = Some((unknowns, step));
    }
    Ok(())
}
