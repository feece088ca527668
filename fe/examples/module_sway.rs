//! Do the FREEs of a module sway and buckle? Equilibria of a module under equal pressures, a diagonal pair, and one FREE, with and without
//! spacers, with the bending law from solids and with that of the bare tubes.
//!
//! `cargo run --release -p fe --example module_sway -- [data/modules/buffinton-2020-30lr.toml [GREATEST_KPA]]`
//!
//! Told are the height of the tip, its shift sideways and twist, and the number of negative pivots: 0 where the equilibrium is stable.

use actuator::{Description, Module, Rig, units::KPA};
use fe::{BendingLaw, ConstantBending, ModuleSweep, RodLaw, RodModule, RodSettings, Run};
use std::{
    error::Error,
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
    time::Instant,
};

/// Part of the pressure that a FREE is given, by its index.
type Share = fn(usize) -> f64;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().unwrap_or("data/modules/buffinton-2020-30lr.toml".into());
    let greatest: f64 = arguments.next().map_or(Ok(50.0), |text| text.parse())?;
    let rig = Rig::read(&PathBuf::from(path))?;
    let Description::Module(module) = rig.description else { return Err("not a module".into()) };
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let sweep = ModuleSweep::default();
    let count = module.frees.len();
    let axes = vec![vec![0.0, greatest * KPA]; count];
    let start = Instant::now();
    let tables = sweep.section_laws(&module, &axes, &run)?.ok_or("stopped")?;
    let sections = sweep.capped_laws(&module, tables, &axes, &run)?.ok_or("stopped")?;
    let tabulated = start.elapsed().as_secs_f64();
    let solids = sweep.bending_laws(&module, &axes, &run)?.ok_or("stopped")?;
    println!(
        "section laws {tabulated:.1} s, bending laws {:.1} s",
        start.elapsed().as_secs_f64() - tabulated
    );
    let bare: Vec<Arc<dyn BendingLaw>> = module
        .frees
        .iter()
        .map(|placed| Arc::new(ConstantBending::of_bare_tube(&placed.free)) as Arc<dyn BendingLaw>)
        .collect();
    let patterns: [(&str, Share); 4] = [
        ("all", |_| 1.0),
        ("diagonal", |free| if free % 2 == 0 { 1.0 } else { 0.0 }),
        ("one", |free| if free == 0 { 1.0 } else { 0.0 }),
        ("adjacent", |free| if free < 2 { 1.0 } else { 0.0 }),
    ];
    println!("spacers  law     pattern    kPa   z mm      sideways mm  twist deg  negative");
    for spacers in [module.spacers, 0] {
        for (name, bending) in [("3 mu I", &bare), ("solids", &solids)] {
            let module = Module { spacers, ..module.clone() };
            let laws = sections.iter().zip(bending);
            let laws =
                laws.map(|(section, bending)| RodLaw { section: section.clone(), bending: bending.clone() });
            let rods = RodModule::new(&module, laws.collect(), RodSettings::default())?;
            for (pattern, part) in patterns {
                let mut last = rods.rest()?;
                for step in 1..=10 {
                    let pressure = greatest * KPA * f64::from(step) / 10.0;
                    let pressures: Vec<f64> = (0..count).map(|free| pressure * part(free)).collect();
                    match rods.solve_from(&last, &pressures) {
                        Ok(found) => {
                            let (pose, chart) = (found.state.chart.to_pose(), found.state.chart);
                            println!(
                                "{spacers:7}  {name}  {pattern:9}  {:4.1}  {:8.3}  {:11.3}  {:9.2}  {}",
                                pressure / KPA,
                                1e3 * pose.position.z,
                                1e3 * pose.position.xy().norm(),
                                chart.twist.to_degrees(),
                                found.state.negative_pivots
                            );
                            last = found;
                        }
                        Err(error) => {
                            println!("{spacers:7}  {name}  {pattern:9}  {:4.1}  {error}", pressure / KPA);
                            break;
                        }
                    }
                }
            }
        }
    }
    Ok(())
}
