//! Blocked force and torque per pressure of a FREE of 48 degrees from the axis (42 from the hoop) and 5 mm, against the formula of inextensible
//! threads and against measurement (Bruder et al., "Force generation by parallel combinations of fiber-reinforced fluid-driven
//! actuators", 2018: 0.3 to 0.4 N/psi and 0.0042 to 0.0060 N m/psi, signs by their own convention).
//!
//! `cargo run --release -p fe --example blocked_force`
//!
//! Force and torque on the tip's plate; positive pushes it away from the base, and turns it counter-clockwise seen from the tip. The FREE is
//! right-handed.

use actuator::{
    Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding,
    units::{DEG, MM, MPA},
};
use fe::{SectionMesh, SectionSolver};
use std::{error::Error, f64::consts::PI};

const PSI: f64 = 6894.76;
const ANGLE_FROM_AXIS: f64 = 48.0 * DEG;

fn specimen(threads_at: f64, wall: f64, modulus: f64, stiffness: f64) -> Free {
    let fibre = Fibre { axial_stiffness: stiffness, diameter: 0.15 * MM, law: FibreLaw::TensionOnly };
    Free {
        tube: Tube { length: 100.0 * MM, inner_radius: threads_at - wall, wall },
        winding: Winding::from_axis(ANGLE_FROM_AXIS, Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: modulus, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

/// Force (N) and torque (N m) per psi up to a pressure.
fn computed(free: &Free, pressure: f64) -> Result<[f64; 2], Box<dyn Error>> {
    let mut solver = SectionSolver::new(free, SectionMesh::default())?;
    let wrench = solver.blocked(pressure, 1.0, 0.0)?.wrench;
    Ok([wrench.force[2], wrench.moment[2]].map(|value| value * PSI / pressure))
}

fn formula(radius: f64) -> [f64; 2] {
    let cot = 1.0 / ANGLE_FROM_AXIS.tan();
    [PI * radius.powi(2) * (1.0 - 2.0 * cot * cot), -2.0 * PI * radius.powi(3) * cot].map(|value| value * PSI)
}

fn main() -> Result<(), Box<dyn Error>> {
    let ten = 10.0 * PSI;
    println!(
        "Latex (mu = 0.393 MPa, Ogden 1.2), six threads of 644 N, up to 10 psi; formula for the radius of the threads\n"
    );
    println!("5 mm is the     wall mm  threads mm   N/psi  formula     N m/psi  formula");
    for wall in [0.8, 1.2, 1.6].map(|wall| wall * MM) {
        for (name, radius) in [
            ("outer radius", 5.0 * MM),
            ("middle radius", 5.0 * MM + 0.5 * wall),
            ("inner radius", 5.0 * MM + wall),
        ] {
            let [force, torque] = computed(&specimen(radius, wall, 0.393 * MPA, 644.0), ten)?;
            let [ideal_force, ideal_torque] = formula(radius);
            println!(
                "{name:14}  {:7.1}  {:10.2}  {force:6.4}  {ideal_force:7.4}  {torque:10.6}  {ideal_torque:8.6}",
                wall / MM,
                radius / MM
            );
        }
    }
    println!("\nmeasured: 0.3 to 0.4 N/psi, 0.0042 to 0.0060 N m/psi (sizes)");
    let [low, high] = [0.3, 0.4].map(|force: f64| (force / -formula(1.0)[0]).sqrt() / MM);
    let [short, long] = [0.0042, 0.0060].map(|torque: f64| (torque / -formula(1.0)[1]).cbrt() / MM);
    println!("by the formula, of threads at {low:.2} to {high:.2} mm and at {short:.2} to {long:.2} mm\n");
    println!("Towards the formula, threads at 5 mm, wall 1.2 mm: error of force and torque in %");
    println!("mu MPa      EA N   force   torque");
    for (modulus, stiffness) in [
        (0.393, 644.0),
        (0.0393, 644.0),
        (0.00393, 644.0),
        (0.393, 6440.0),
        (0.393, 64400.0),
        (0.0393, 64400.0),
    ] {
        let mut free = specimen(5.0 * MM, 1.2 * MM, modulus * MPA, stiffness);
        // A membrane: threads side by side.
        free.winding.fibre.diameter = 2.0 * PI * free.tube.outer_radius();
        let (found, ideal) = (computed(&free, 0.1 * PSI)?, formula(5.0 * MM));
        let off = [0, 1].map(|k| 100.0 * (found[k] / ideal[k] - 1.0));
        println!("{modulus:<8}  {stiffness:6}  {:6.3}   {:6.3}", off[0], off[1]);
    }
    Ok(())
}
