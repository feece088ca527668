//! One FREE as a solid through rising pressures: what it costs and what it finds, one JSON line as `benches/peers` reads it.
//!
//! `cargo run --release -p fe --example solid_speed -- --case 20deg-L130 [--to-kpa 68.9] [--mesh RADIAL,AROUND,ALONG[,UNDER]] [--whole]
//! [--fibre-diameter-mm 0.15] [--bulk-ratio 1000]`
//!
//! Cases: 20deg-L40, 20deg-L130, 20deg-L40-finer, 60deg-L40, bare-L40. Without `--whole` one of the six equal sectors is solved, which gives
//! the same states (the load is the same in each). The linear algebra is on one thread whatever the machine has.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{Deformation, SolidLoad, SolidMesh, SolidSolver, Specimen};
use std::{error::Error, time::Instant};

struct Case {
    angle: f64,
    length: f64,
    around: usize,
    along: usize,
    fibres: u32,
    pressures: &'static [f64],
}

const TO_LIMIT: &[f64] = &[10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 68.9];

fn case(name: &str) -> Option<Case> {
    let case = |angle, length, around, along, fibres, pressures| {
        Some(Case { angle, length, around, along, fibres, pressures })
    };
    match name {
        "20deg-L40" => case(20.0, 40.0, 12, 28, 6, TO_LIMIT),
        "20deg-L130" => case(20.0, 130.0, 12, 90, 6, TO_LIMIT),
        "20deg-L40-finer" => case(20.0, 40.0, 24, 56, 6, TO_LIMIT),
        "60deg-L40" => case(60.0, 40.0, 12, 18, 6, &TO_LIMIT[..5]),
        "bare-L40" => case(90.0, 40.0, 12, 28, 0, &[4.0, 12.0, 20.0, 24.0]),
        _ => None,
    }
}

/// CPU seconds of this process and its greatest resident memory in MB, where the system tells (Linux).
fn spent() -> Option<(f64, f64)> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some((ticks / 100.0, peak.split_whitespace().next()?.parse::<f64>().ok()? / 1024.0))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |name: &str| {
        let place = arguments.iter().position(|argument| argument == name)?;
        arguments.get(place + 1).map(String::as_str)
    };
    let number = |name: &str, default: f64| value(name).map_or(Ok(default), str::parse);
    let name = value("--case").unwrap_or("20deg-L130");
    let case =
        case(name).ok_or("--case: one of 20deg-L40, 20deg-L130, 20deg-L40-finer, 60deg-L40, bare-L40")?;
    let mut mesh = SolidMesh::new(case.around, case.along);
    if let Some(text) = value("--mesh") {
        let counts: Vec<usize> = text.split(',').map(str::parse).collect::<Result<_, _>>()?;
        let (radial, around, along, under_fibre) = match counts[..] {
            [radial, around, along] => (radial, around, along, 0),
            [radial, around, along, under] => (radial, around, along, under),
            _ => return Err("--mesh RADIAL,AROUND,ALONG[,UNDER]".into()),
        };
        mesh = SolidMesh { radial, under_fibre, ..SolidMesh::new(around, along) };
    }
    let diameter = 1e-3 * number("--fibre-diameter-mm", 0.15)?;
    let fibre = Fibre { axial_stiffness: 644.0, diameter, law: FibreLaw::Linear };
    let free = Free {
        tube: Tube { length: 1e-3 * case.length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(case.angle.to_radians(), Handedness::Right, case.fibres, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    let specimen = Specimen { bulk_ratio: number("--bulk-ratio", 1e3)?, ..Specimen::from(&free) };
    let whole = case.fibres == 0 || arguments.iter().any(|argument| argument == "--whole");
    let highest = number("--to-kpa", f64::INFINITY)?;
    let stops: Vec<f64> = case.pressures.iter().filter(|p| **p <= highest).map(|p| 1e3 * p).collect();

    let start = Instant::now();
    let before = spent();
    let make = if whole { SolidSolver::new } else { SolidSolver::sector };
    let mut solver = make(&specimen, mesh)?;
    let rest = solver.rest();
    let mut states = vec![];
    solver.follow(&rest, 0.0, &stops, &SolidLoad::pressure, &mut |pressure, state| {
        states.push((pressure, state.clone()));
        true
    })?;
    let wall = start.elapsed().as_secs_f64();
    let (cpu, peak) = match (before, spent()) {
        (Some((from, _)), Some((to, peak))) => (to - from, peak),
        _ => (wall, f64::NAN),
    };
    let cost = solver.cost();
    let states: Vec<String> = states
        .iter()
        .map(|(pressure, state)| {
            let Deformation {
                stretch_total, stretch_mid, bore_mid, expansion_mid, twist_total, twist_mid, ..
            } = solver.deformation(state);
            let [total, mid] = [twist_total, twist_mid].map(|twist| 1e-3 * twist.to_degrees());
            format!(
                "{{\"pressure_kpa\": {:.1}, \"stretch_total\": {stretch_total:.6}, \"stretch_mid\": {stretch_mid:.6}, \
                 \"inner_mid\": {bore_mid:.6}, \"expansion_mid\": {expansion_mid:.6}, \
                 \"twist_total_deg_per_mm\": {total:.5}, \"twist_mid_deg_per_mm\": {mid:.5}, \"residual\": {:.1e}}}",
                1e-3 * pressure,
                state.residual()
            )
        })
        .collect();
    println!(
        "{{\"program\": \"freeact\", \"case\": \"{name}\", \"mesh\": \"hex27 {}x{}x{}{}{}\", \"unknowns\": {}, \
         \"iterations\": {}, \"factorisations\": {}, \"wall_s\": {wall:.3}, \"cpu_s\": {cpu:.3}, \"peak_mb\": {peak:.0}, \
         \"assembly_s\": {:.3}, \"factor_s\": {:.3}, \"solve_s\": {:.3}, \"states\": [{}]}}",
        mesh.around,
        mesh.along,
        mesh.radial,
        if mesh.under_fibre > 0 {
            format!(" and {} under each half fibre", mesh.under_fibre)
        } else {
            String::new()
        },
        if whole { "" } else { " one sector of 6" },
        solver.unknowns(),
        cost.iterations,
        cost.factorisations,
        cost.assembly.as_secs_f64(),
        cost.factorisation.as_secs_f64(),
        cost.substitution.as_secs_f64(),
        states.join(", ")
    );
    Ok(())
}
