//! The module of rods against the module of solids, without spacers: tip of the paper's modules under its five cases of pressure.
//!
//! `cargo run --release -p fe --example module_rod_against_solid -- [MODULE.toml ...] [CASE ...]` (default: the paper's 30 LR and 40 LR, all
//! cases; spacers are set to 0)
//!
//! Each module twice: the solids with threads as wide as described, and with threads spread over all of the surface, as the rods' sections
//! always have them. Cases: 1 all FREEs, 2 a diagonal pair, 3 one, 4 two neighbours, 5 three. Each is followed from rest in steps of 10 kPa to 40, as long as both are stable. Errors of the
//! rods: distance of the tips over the module's length, angle between the tip's rotations; pivots are negative eigenvalues of both.

use actuator::{Description, Module, Rig};
use fe::{ModuleSweep, RodModule, RodSettings, Run, SolidModule, SolidModuleSettings};
use std::f64::consts::TAU;
use std::{error::Error, path::Path, sync::atomic::AtomicBool, time::Instant};

const PRESSURES: [f64; 4] = [10e3, 20e3, 30e3, 40e3];
/// Halvings of the interval in which a path ceases to be stable.
const BISECTIONS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let (cases, given): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.parse::<usize>().is_ok());
    let wanted = |case: &str| cases.is_empty() || cases.iter().any(|own| case.starts_with(own.as_str()));
    let usual = ["data/modules/buffinton-2020-30lr.toml", "data/modules/buffinton-2020-40lr.toml"];
    let files = if given.is_empty() { usual.map(str::to_owned).to_vec() } else { given };
    println!(
        "module               case             kPa  solids: x, y, z mm           turn deg  off %    deg  pivots     gap mm  s rod solid"
    );
    let mut worst = [[0.0f64; 2]; 2];
    for file in files {
        let rig = Rig::read(Path::new(&file))?;
        let Description::Module(mut module) = rig.description else {
            return Err(format!("{file}: no module").into());
        };
        module.spacers = 0;
        compare(&rig.name, &module, &wanted, &mut worst[0])?;
        for placed in &mut module.frees {
            placed.free.winding.fibre.diameter = TAU * placed.free.tube.outer_radius();
        }
        compare("  threads spread", &module, &wanted, &mut worst[1])?;
    }
    for (threads, [off, angle]) in ["as described", "spread"].into_iter().zip(worst) {
        println!(
            "threads {threads}: worst of the states stable in both {off:.2} % of the length, {angle:.2} deg"
        );
    }
    Ok(())
}

fn compare(
    name: &str,
    module: &Module,
    wanted: &dyn Fn(&str) -> bool,
    worst: &mut [f64; 2],
) -> Result<(), Box<dyn Error>> {
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let sweep = ModuleSweep::default();
    let axes = vec![vec![0.0, 1.05 * PRESSURES[3]]; module.frees.len()];
    let start = Instant::now();
    let laws = sweep.rod_laws(module, &axes, &run)?.ok_or("stopped")?;
    let rods = RodModule::new(module, laws, RodSettings::default())?;
    let rod_rest = rods.rest()?;
    let laws_time = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let settings = SolidModuleSettings { threads: 2, ..SolidModuleSettings::default() };
    let mut solids = SolidModule::new(module, settings)?;
    let solid_rest = solids.rest()?;
    println!(
        "{name}: laws of the rods in {laws_time:.1} s; solids of {} unknowns, rest in {:.1} s",
        solids.unknowns(),
        start.elapsed().as_secs_f64()
    );
    for driven in actuator::Case::all(module) {
        let case = driven.name.trim_start_matches("case ");
        if !wanted(case) {
            continue;
        }
        let count = module.frees.len();
        let at = |pressure: f64| driven.pressures(&vec![0.0; count], &vec![pressure; count], 1.0);
        let (mut rod, mut solid) = (rod_rest.clone(), solid_rest.clone());
        for pressure in PRESSURES {
            let place = format!("{name:20} {case:16} {:3.0}", 1e-3 * pressure);
            let start = Instant::now();
            let rod_found = rods.solve_from(&rod, &at(pressure));
            let rod_time = start.elapsed().as_secs_f64();
            let start = Instant::now();
            let solid_found = solids.solve_from(&solid.shape, &at(pressure));
            let solid_time = start.elapsed().as_secs_f64();
            if let (Ok(a), Ok(b)) = (&rod_found, &solid_found) {
                let poses = [&a.state, &b.state].map(|state| state.chart.to_pose());
                let off = 100.0 * (poses[0].position - poses[1].position).norm() / module.length();
                let angle = poses[0].rotation_distance(&poses[1]).to_degrees();
                let pivots = [a.state.negative_pivots, b.state.negative_pivots];
                let tip = 1e3 * poses[1].position;
                println!(
                    "{place}  {:8.3} {:8.3} {:8.3}  {:8.2}  {off:5.2}  {angle:5.2}  {:4} {:4}  {:6.2}  {rod_time:5.2} {solid_time:5.1}",
                    tip.x,
                    tip.y,
                    tip.z,
                    b.state.chart.twist.to_degrees(),
                    pivots[0],
                    pivots[1],
                    1e3 * b.state.gap.unwrap_or(f64::NAN)
                );
                if pivots == [0; 2] {
                    *worst = [worst[0].max(off), worst[1].max(angle)];
                }
            }
            // Where one of them is no longer stable, the pressures at which they cease to be say more than two unstable shapes.
            let ends = [
                rod_found.as_ref().map_or(true, |found| found.state.negative_pivots > 0),
                solid_found.as_ref().map_or(true, |found| found.state.negative_pivots > 0),
            ];
            if ends != [false; 2] {
                let from = rod.pressures.iter().fold(0.0f64, |most, p| most.max(*p));
                let of_rods =
                    critical(from, &mut |p| Some(rods.solve_from(&rod, &at(p)).ok()?.state.negative_pivots));
                let of_solids = critical(from, &mut |p| {
                    Some(solids.solve_from(&solid.shape, &at(p)).ok()?.state.negative_pivots)
                });
                println!("{place}  stable up to (kPa): rods {of_rods}, solids {of_solids}");
                break;
            }
            (rod, solid) = (rod_found?, solid_found?);
        }
    }
    Ok(())
}

/// Where the path from a stable state at `from` ceases to be stable, in words, kPa.
fn critical(from: f64, negative: &mut dyn FnMut(f64) -> Option<u32>) -> String {
    let mut stable = from;
    let further = PRESSURES.into_iter().filter(|pressure| *pressure > from);
    let mut beyond = None;
    for pressure in further {
        if negative(pressure) != Some(0) {
            beyond = Some(pressure);
            break;
        }
        stable = pressure;
    }
    let Some(mut beyond) = beyond else { return format!("above {:.0}", 1e-3 * stable) };
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (stable + beyond);
        if negative(middle) == Some(0) { stable = middle } else { beyond = middle }
    }
    format!("{:.1} to {:.1}", 1e-3 * stable, 1e-3 * beyond)
}
