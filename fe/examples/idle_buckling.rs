//! When do idle FREEs buckle? A module without spacers, a diagonal pair of it under pressure and the other two FREEs idle: the pressure at which
//! it buckles, how, where it goes then, and what pressure in the idle FREEs prevents it. Gaps are the least between FREEs: where they are negative,
//! FREEs pass through each other, and what is said is what they would do if they could.
//!
//! `cargo run --release -p fe --example idle_buckling -- [GREATEST_KPA [MODULE.toml ...]]`
//!
//! Without a module, the paper's 60 and 30 degree ones. Forces and moments of the plates beside weights are none; tip and idle FREEs as described
//! in the module's file but for its spacers.

use actuator::{Description, Module, Rig, units::KPA};
use fe::{Equilibrium, IdlePressure, ModuleSweep, RodModule, RodSettings, Run};
use std::{error::Error, path::PathBuf, sync::atomic::AtomicBool, time::Instant};

const MODULES: [&str; 2] = ["data/modules/buffinton-2020-60lr.toml", "data/modules/buffinton-2020-30lr.toml"];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let greatest: f64 = arguments.next().map_or(Ok(45.0), |text| text.parse())?;
    let mut files: Vec<String> = arguments.collect();
    if files.is_empty() {
        files.extend(MODULES.map(str::to_owned));
    }
    for file in files {
        let rig = Rig::read(&PathBuf::from(&file))?;
        let Description::Module(module) = rig.description else { return Err("not a module".into()) };
        println!("{file}, no spacers, FREEs 1 and 3 under pressure");
        study(&Module { spacers: 0, ..module }, greatest * KPA)?;
    }
    Ok(())
}

fn told(rods: &RodModule, name: &str, found: &Equilibrium) {
    let (pose, chart) = (found.state.chart.to_pose(), found.state.chart);
    println!(
        "  {name:28} {:6.2} kPa: tip {:8.3} {:8.3} {:8.3} mm, twist {:8.2}, bend {:6.2} deg, gap {:6.2} mm, energy {:.6e} J, {} negative",
        found.pressures[0] / KPA,
        1e3 * pose.position.x,
        1e3 * pose.position.y,
        1e3 * pose.position.z,
        chart.twist.to_degrees(),
        chart.bend[0].hypot(chart.bend[1]).to_degrees(),
        1e3 * found.state.gap.unwrap_or(f64::NAN),
        found.energy,
        found.state.negative_pivots
    );
    let lines = found.configuration.centrelines(rods);
    let middles = lines.iter().map(|line| line[line.len() / 2]);
    let words: Vec<String> =
        middles.map(|[x, y, z]| format!("({:.2}, {:.2}, {:.2})", 1e3 * x, 1e3 * y, 1e3 * z)).collect();
    println!("    middles of the FREEs, mm: {}", words.join(" "));
}

fn study(module: &Module, greatest: f64) -> Result<(), Box<dyn Error>> {
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let sweep = ModuleSweep::default();
    let axes = vec![vec![0.0, greatest]; module.frees.len()];
    let laws = sweep.rod_laws(module, &axes, &run)?.ok_or("stopped")?;
    let rods = RodModule::new(module, laws, RodSettings::default())?;
    let case = |pressure: f64| -> Vec<f64> {
        (0..module.frees.len()).map(|free| if free % 2 == 0 { pressure } else { 0.0 }).collect()
    };
    let start = Instant::now();
    match rods.first_buckling(&rods.rest()?, &case(greatest), 1.0)? {
        None => {
            told(&rods, "stable all the way", &rods.solve(&case(greatest))?);
            // How far from buckling: with how much less bending stiffness it would be there.
            let stable_with = |factor: f64| -> Result<bool, Box<dyn Error>> {
                let settings = RodSettings { bending_stiffness_scale: factor, ..RodSettings::default() };
                let softer = RodModule::new(module, rods.laws(), settings)?;
                Ok(softer.first_buckling(&softer.rest()?, &case(greatest), 500.0)?.is_none())
            };
            let (mut low, mut high) = (0.02, 1.0);
            while high - low > 0.005 {
                let middle = 0.5 * (low + high);
                if stable_with(middle)? { high = middle } else { low = middle }
            }
            println!("  it would buckle on the way with {low:.2} of the FREEs' bending stiffness");
        }
        Some(buckling) => {
            told(&rods, "last stable", &buckling.below);
            told(&rods, "first unstable", &buckling.above);
            let mode = &buckling.mode;
            println!(
                "  mode: eigenvalue {:.1e} J; greatest shifts of the FREEs {:.3?}; of the tip {:.3?}; twist {:.2} rad/m",
                mode.value,
                mode.shifts(),
                mode.tip_shift,
                mode.chart[0]
            );
            for (free, line) in mode.centrelines.iter().enumerate() {
                let tenths = (0..=10).map(|k| line[k * (line.len() - 1) / 10]);
                let row: Vec<String> = tenths.map(|[x, y, _]| format!("({x:.2},{y:.2})")).collect();
                println!("    FREE {}: {}", free + 1, row.join(" "));
            }
            let critical = buckling.above.pressures[0];
            for part in [1.002, 1.02, 1.1, 1.3] {
                let pressure = critical * part;
                if pressure > greatest {
                    break;
                }
                let straight = rods.solve_from(&buckling.below, &case(pressure))?;
                told(&rods, "from rest", &straight);
                let mode = rods.softest_mode(&straight).ok_or("no mode")?;
                for offset in [1e-4, -1e-4] {
                    match rods.settle(&straight, &mode, offset) {
                        Ok(settled) => told(&rods, &format!("settled from {offset:+.0e} m"), &settled),
                        Err(error) => println!("  settled from {offset:+.0e} m: {error}"),
                    }
                }
            }
        }
    }
    println!("  case kPa   gap mm   least idle kPa");
    for step in 1..=10 {
        let pressure = greatest * f64::from(step) / 10.0;
        let needed = match rods.least_idle_pressure(&case(pressure), pressure, 10.0) {
            Ok(IdlePressure::NotNeeded) => "none".to_owned(),
            Ok(IdlePressure::Least(idle)) => format!("{:.2}", idle / KPA),
            Ok(IdlePressure::NeverEnough) => "unstable with any up to its own".to_owned(),
            Err(error) => error.to_string(),
        };
        let gap = rods.solve(&case(pressure)).ok().and_then(|found| found.state.gap);
        println!("  {:8.2}   {:6.2}   {needed}", pressure / KPA, 1e3 * gap.unwrap_or(f64::NAN));
    }
    println!("  {:.1} s after the laws", start.elapsed().as_secs_f64());
    Ok(())
}
