//! Bending and shear stiffness of FREEs as solids, against 3 mu I and mu A of the bare tube: under pressure, and how they change under axial
//! force and torque at that pressure. The paper's tube, six fibres.
//!
//! `cargo run --release -p fe --example rod_stiffness -- [linear|tension [ANGLE_DEG...]]`
//!
//! EI at no shear force, GA at no moment (ends folded in), the coupling of both over the geometric mean of the compliances, the length by
//! which each cap shortens the bending tube.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{
    RodCompliance, SolidError, SolidLoad, SolidMesh, SolidSolver, Specimen, StraightRod, TipCompliance,
};
use nalgebra::Vector3;
use std::{error::Error, time::Instant};

const MU: f64 = 0.393e6;
const PRESSURES: [f64; 7] = [0.0, 5e3, 10e3, 20e3, 30e3, 40e3, 50e3];
/// N, N m.
const AXIAL: [(f64, f64); 7] =
    [(0.0, 0.0), (-0.5, 0.0), (0.5, 0.0), (2.0, 0.0), (0.0, -2e-3), (0.0, 2e-3), (0.0, 8e-3)];

fn free(angle: f64, law: FibreLaw, length: f64) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.15e-3, law };
    Free {
        tube: Tube { length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: MU, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

type Row = (StraightRod, TipCompliance);

/// States of one tube as far as they are found, first under force and torque, then under pressure.
fn states(free: &Free, (force, torque): (f64, f64), pressures: &[f64]) -> Result<Vec<Row>, SolidError> {
    let mesh = SolidMesh::new(12, (700.0 * free.tube.length).round() as usize);
    let specimen = Specimen::from(free);
    let mut sector = SolidSolver::sector(&specimen, mesh)?;
    let mut whole = SolidSolver::new(&specimen, mesh)?;
    let load = |pressure: f64, part: f64| SolidLoad {
        force: Vector3::z() * (part * force),
        moment: Vector3::z() * (part * torque),
        ..SolidLoad::pressure(pressure)
    };
    let rest = sector.rest();
    let loaded = sector.follow(&rest, 0.0, &[1.0], &|part| load(0.0, part), &mut |_, _| true)?;
    let mut found = vec![];
    // What lies before a limit point is found.
    let _ = sector.follow(&loaded, 0.0, pressures, &|pressure| load(pressure, 1.0), &mut |_, state| {
        found.push(state.clone());
        true
    });
    found
        .iter()
        .map(|state| {
            let all = whole.whole_of(&sector, state)?;
            let stretch = sector.deformation(state).stretch_mid;
            let (length, height) = (free.tube.length, all.cap().0.z);
            let compliance = whole.tip_compliance(&all)?;
            Ok((StraightRod { length, force, torque, stretch, height }, compliance))
        })
        .collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let law = match arguments.first().map(String::as_str) {
        None | Some("linear") => FibreLaw::Linear,
        Some("tension") => FibreLaw::TensionOnly,
        Some(other) => return Err(format!("fibres are linear or tension, not {other}").into()),
    };
    let angles: Vec<f64> = match arguments.get(1..) {
        Some(given) if !given.is_empty() => {
            given.iter().map(|text| text.parse()).collect::<Result<_, _>>()?
        }
        _ => vec![20.0, 30.0, 40.0, 60.0, 70.0],
    };
    println!("angle  N      N mm   kPa    stretch   EI/3muI  GA/muA  coupling  cap mm");
    for angle in angles {
        let start = Instant::now();
        let bare = free(angle, law, 0.0).tube;
        let (bending, shear) = (3.0 * MU * bare.second_moment(), MU * bare.wall_area());
        for (case, axial) in AXIAL.into_iter().enumerate() {
            let pressures: &[f64] = if case == 0 { &PRESSURES } else { &[10e3, 40e3] };
            let [short, long] =
                [20e-3, 40e-3].map(|length| states(&free(angle, law, length), axial, pressures));
            let (short, long) = (short?, long?);
            for ((a, b), pressure) in short.iter().zip(&long).zip(pressures) {
                let Some(found) = RodCompliance::identified([(&a.0, &a.1), (&b.0, &b.1)]) else { continue };
                let rod = found.folded(b.0.stretch);
                println!(
                    "{angle:4.0}  {:5.1}  {:6.1}  {:5.1}  {:.5}  {:8.4}  {:7.4}  {:8.4}  {:7.3}",
                    axial.0,
                    1e3 * axial.1,
                    1e-3 * pressure,
                    b.0.stretch,
                    rod.bending_stiffness() / bending,
                    rod.shear_stiffness() / shear,
                    rod.coupling / (rod.bending * rod.shear).sqrt(),
                    1e3 * rod.stiff_length()
                );
            }
        }
        println!("{:.1} s", start.elapsed().as_secs_f64());
    }
    Ok(())
}
