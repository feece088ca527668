//! Follows one FREE as a solid from rest through given pressures and prints each state and where the time went.
//!
//! `cargo run --release -p fe --example solid_path -- ANGLE_DEG LENGTH_MM AROUND ALONG P_KPA...`

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{SolidLoad, SolidMesh, SolidSolver, Specimen};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let numbers: Vec<f64> = std::env::args().skip(1).map(|text| text.parse()).collect::<Result<_, _>>()?;
    let [angle, length, around, along, pressures @ ..] = &numbers[..] else {
        return Err("usage: ANGLE_DEG LENGTH_MM AROUND ALONG P_KPA...".into());
    };
    let fibres = if *angle > 0.0 { 6 } else { 0 };
    let fibre = Fibre {
        axial_stiffness: std::env::var("EA").map_or(644.0, |t| t.parse().unwrap()),
        diameter: std::env::var("D").map_or(0.0, |t| t.parse().unwrap()),
        law: FibreLaw::Linear,
    };
    let free = Free {
        tube: Tube { length: 1e-3 * length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, fibres, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    let specimen = Specimen { bulk_ratio: 1e3, ..Specimen::from(&free) };
    let start = Instant::now();
    let make = if std::env::var("SECTOR").is_ok() { SolidSolver::sector } else { SolidSolver::new };
    let mut solver = make(
        &specimen,
        SolidMesh {
            radial: std::env::var("RADIAL").map_or(1, |t| t.parse().unwrap()),
            under_fibre: std::env::var("UNDER").map_or(0, |t| t.parse().unwrap()),
            ..SolidMesh::new(*around as usize, *along as usize)
        },
    )?;
    println!("{} unknowns, set up in {:.3} s", solver.unknowns(), start.elapsed().as_secs_f64());
    let rest = solver.rest();
    let stops: Vec<f64> = pressures.iter().map(|p| 1e3 * p).collect();
    let mut states = vec![];
    let end = solver.follow(&rest, 0.0, &stops, &|p| SolidLoad::pressure(p), &mut |p, state| {
        println!("{:.1} kPa at {:.2} s", 1e-3 * p, start.elapsed().as_secs_f64());
        states.push((p, state.clone()));
        true
    });
    for (p, state) in &states {
        let d = solver.deformation(state);
        let (cap, turn) = state.cap();
        println!(
            "   cap {:.3e} {:.3e} axis {:.3e} {:.3e}",
            cap.x,
            cap.y,
            (turn * nalgebra::Vector3::z()).x,
            (turn * nalgebra::Vector3::z()).y
        );
        println!(
            "{:6.1} {:.5} {:.5} {:.5} {:.5} {:.4}..{:.4} {:.4} {:.4}  residual {:.1e}",
            1e-3 * p,
            d.stretch_total,
            d.stretch_mid,
            d.bore_mid,
            d.expansion_mid,
            d.outer_range_mid[0],
            d.outer_range_mid[1],
            d.twist_total.to_degrees() * 1e-3,
            d.twist_mid.to_degrees() * 1e-3,
            state.residual()
        );
    }
    println!("{:.3} s, {:?}", start.elapsed().as_secs_f64(), solver.cost());
    end?;
    Ok(())
}
