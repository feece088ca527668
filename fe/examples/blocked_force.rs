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

fn specimen(threads_at: f64, wall: f64, modulus: f64, stiffness: f64, diameter: f64) -> Free {
    let fibre = Fibre { axial_stiffness: stiffness, diameter, law: FibreLaw::TensionOnly };
    Free {
        tube: Tube { length: 100.0 * MM, inner_radius: threads_at - wall, wall },
        winding: Winding::from_axis(ANGLE_FROM_AXIS, Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: modulus, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

/// Force (N) and torque (N m) per psi up to a pressure; `None` where the section has no answer.
fn computed(free: &Free, psi: f64) -> Result<Option<[f64; 2]>, Box<dyn Error>> {
    let mut solver = SectionSolver::new(free, SectionMesh::default())?;
    // From pressure to pressure, as it is inflated.
    let steps = (4.0 * psi).ceil();
    let mut last = None;
    for step in 1..=steps as usize {
        let Ok(found) = solver.blocked(psi * PSI * step as f64 / steps, 1.0, 0.0) else { return Ok(None) };
        last = Some([found.wrench.force[2], found.wrench.moment[2]].map(|value| value / psi));
    }
    Ok(last)
}

fn formula(radius: f64) -> [f64; 2] {
    let cot = 1.0 / ANGLE_FROM_AXIS.tan();
    [PI * radius.powi(2) * (1.0 - 2.0 * cot * cot), -2.0 * PI * radius.powi(3) * cot].map(|value| value * PSI)
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "Latex (mu = 0.393 MPa, Ogden 1.2), six threads of 644 N; -: the wall has given way between the threads.\n\
         N/psi and N m/psi up to 1 and 10 psi: threads 0.15 mm wide, and spread over all of the surface\n"
    );
    println!(
        "                 wall  threads at  0.15 mm, 1 psi      0.15 mm, 10 psi     spread, 1 psi       spread, 10 psi      formula"
    );
    for wall in [0.8, 1.2, 1.6].map(|wall| wall * MM) {
        for (name, radius) in [
            ("outer is 5 mm", 5.0 * MM),
            ("middle is 5 mm", 5.0 * MM + 0.5 * wall),
            ("inner is 5 mm", 5.0 * MM + wall),
        ] {
            print!("{name:14}  {:3.1} mm  {:7.1} mm", wall / MM, radius / MM);
            for diameter in [0.15 * MM, 2.0 * PI * radius] {
                for psi in [1.0, 10.0] {
                    match computed(&specimen(radius, wall, 0.393 * MPA, 644.0, diameter), psi)? {
                        Some([force, torque]) => print!("  {force:7.4} {torque:9.6} "),
                        None => print!("        -         - "),
                    }
                }
            }
            let [force, torque] = formula(radius);
            println!("  {force:7.4} {torque:9.6}");
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
        // A membrane: threads side by side.
        let free = specimen(5.0 * MM, 1.2 * MM, modulus * MPA, stiffness, 10.0 * PI * MM);
        let found = computed(&free, 0.1)?.ok_or("no answer")?;
        let ideal = formula(5.0 * MM);
        let off = [0, 1].map(|k| 100.0 * (found[k] / ideal[k] - 1.0));
        println!("{modulus:<8}  {stiffness:6}  {:6.3}   {:6.3}", off[0], off[1]);
    }
    Ok(())
}
