//! What turns a rod by a torque: its section with threads spread or of their width, on meshes of the section, against solids of two lengths on
//! meshes of the solid; and the length that two caps add to a tube or take from it.
//!
//! `cargo run --release -p fe --example rod_torsion -- [ANGLE_DEG]`
//!
//! Told are compliances per reference length at four pressures without axial load: stretch by force (1/N), either by the other (1/(N m)),
//! twist by torque (1/(N m^2)). Of solids from the difference of 20 and 40 mm; what is left is that of the caps, as a length.

use actuator::{Elastomer, EndLoad, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{SectionMesh, SectionSolver, SolidLoad, SolidMesh, SolidSolver, Specimen};
use nalgebra::Matrix2;
use std::{error::Error, f64::consts::TAU};

const PRESSURES: [f64; 4] = [0.0, 15e3, 30e3, 45e3];
/// Through the wall, around, under half a fibre, and along, per mm.
const MESHES: [(usize, usize, usize, f64); 6] =
    [(1, 12, 0, 0.7), (1, 12, 0, 1.4), (1, 24, 0, 1.4), (1, 12, 1, 0.7), (2, 12, 1, 1.0), (2, 24, 1, 1.4)];
const WIDTH: f64 = 0.15e-3;

fn free(angle_deg: f64, length: f64, width: f64) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: width, law: FibreLaw::Linear };
    Free {
        tube: Tube { length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle_deg.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn sections(angle: f64) -> Result<(), Box<dyn Error>> {
    let spread = TAU * free(angle, 1.0, WIDTH).tube.outer_radius();
    for (name, width, [radial, under_fibre, between_fibres]) in [
        ("spread", spread, [2, 1, 2]),
        ("0.15 mm", WIDTH, [2, 1, 2]),
        ("0.15 mm", WIDTH, [2, 2, 4]),
        ("0.15 mm", WIDTH, [4, 4, 8]),
    ] {
        let mesh = SectionMesh { radial, under_fibre, between_fibres };
        let mut solver = SectionSolver::new(&free(angle, 1.0, width), mesh)?;
        for state in solver.path(&PRESSURES, 0)?.states.iter().take(PRESSURES.len()) {
            let (stretch, twist) = (state.axial_stretch, state.twist_per_length);
            let [[a, b], [c, d]] = solver.respond(state.pressure, stretch, twist)?.stiffness;
            let flexible = Matrix2::new(a, b, c, d).try_inverse().ok_or("at a limit point")?;
            println!(
                "section, {name}, {radial} {under_fibre} {between_fibres}: {:4.1} kPa, stretch {stretch:.5}, twist {twist:8.4} rad/m, {:.5} {:7.3} {:9.3}",
                1e-3 * state.pressure,
                flexible[(0, 0)],
                flexible[(0, 1)],
                flexible[(1, 1)]
            );
        }
    }
    Ok(())
}

/// Compliances of the tip of a tube at the four pressures, by differences.
fn solid(angle: f64, length: f64, mesh: SolidMesh) -> Result<Vec<[f64; 3]>, Box<dyn Error>> {
    let mut sector = SolidSolver::sector(&Specimen::from(&free(angle, length, WIDTH)), mesh)?;
    let rest = sector.rest();
    let mut states = vec![];
    let path = |pressure| SolidLoad::axial(pressure, EndLoad::NONE);
    sector.follow(&rest, 0.0, &PRESSURES, &path, &mut |_, state| {
        states.push(state.clone());
        true
    })?;
    let mut found = vec![];
    for (pressure, state) in PRESSURES.iter().zip(&states) {
        let mut tip = |force: f64, torque: f64| -> Result<[f64; 2], fe::SolidError> {
            let to = |part: f64| SolidLoad::axial(*pressure, EndLoad { force, torque }.times(part));
            let loaded = sector.follow(state, 0.0, &[1.0], &to, &mut |_, _| true)?;
            let deformation = sector.deformation(&loaded);
            Ok([deformation.stretch_total * length, deformation.twist_total * length])
        };
        let (force, torque) = (0.02, 1e-4);
        let (pulled, pushed) = (tip(force, 0.0)?, tip(-force, 0.0)?);
        let (wound, unwound) = (tip(0.0, torque)?, tip(0.0, -torque)?);
        found.push([
            (pulled[0] - pushed[0]) / (2.0 * force),
            (wound[0] - unwound[0]) / (2.0 * torque),
            (wound[1] - unwound[1]) / (2.0 * torque),
        ]);
    }
    Ok(found)
}

fn main() -> Result<(), Box<dyn Error>> {
    let angle = std::env::args().nth(1).map_or(Ok(30.0), |text| text.parse::<f64>())?;
    sections(angle)?;
    for (radial, around, under_fibre, per_mm) in MESHES {
        let of = |length: f64| {
            let along = (1e3 * per_mm * length).round() as usize;
            solid(angle, length, SolidMesh { radial, under_fibre, ..SolidMesh::new(around, along) })
        };
        let (short, long) = (of(0.02)?, of(0.04)?);
        for ((pressure, short), long) in PRESSURES.iter().zip(short).zip(long) {
            let inside: [f64; 3] = std::array::from_fn(|k| (long[k] - short[k]) / 0.02);
            let ends: [f64; 3] = std::array::from_fn(|k| 1e3 * (2.0 * short[k] - long[k]) / inside[k]);
            println!(
                "solid, {radial} x {around} + {under_fibre} x {per_mm}/mm: {:4.1} kPa, {:.5} {:7.3} {:9.3}; caps: {:6.3} mm of stretch, {:6.3} mm of twist",
                1e-3 * pressure,
                inside[0],
                inside[1],
                inside[2],
                ends[0],
                ends[2]
            );
        }
    }
    Ok(())
}
