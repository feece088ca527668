//! How fast the map of a FREE is computed by sections, and what a second thread brings.
//!
//! ```text
//! cargo run --release -p fe --example map_speed [-- ROUNDS]
//! ```
//!
//! The paper's tube at 8 winding angles, 9 shear moduli and 60 pressures, alternately on one thread and on two, so that both see the
//! same machine. Checks are left out: all work is on the nodes.

use actuator::{FreeMap, MapAxis, Rig, units::*};
use fe::{FreeSweep, Run, Shard};
use std::{error::Error, path::Path, sync::atomic::AtomicBool, time::Instant};

/// The paper's FREE.
const PAPER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/actuators/buffinton-2020.toml");

/// The map, and the seconds that it took.
fn computed(jobs: usize) -> Result<(FreeMap, f64), Box<dyn Error>> {
    let sweep = FreeSweep { checks: 0, ..FreeSweep::default() };
    let angles = (1..=8).map(|i| f64::from(10 * i) * DEG).collect();
    let moduli = (2..=10).map(|i| 0.1 * f64::from(i) * MPA).collect();
    let pressures = (0..60).map(|i| f64::from(i) * KPA).collect();
    let axes = MapAxis::of_angles_and_moduli(angles, moduli);
    let mut map = sweep.empty_map(
        Rig::read(Path::new(PAPER))?.frees()[0].into(),
        axes,
        pressures,
        Default::default(),
    )?;
    let run = Run { jobs, progress: &|_, _| {}, stop: &AtomicBool::new(false) };
    let start = Instant::now();
    let report = sweep.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| {})?;
    let seconds = start.elapsed().as_secs_f64();
    assert!(report.failed.is_empty() && map.is_complete(), "not every path was found");
    Ok((map, seconds))
}

fn main() -> Result<(), Box<dyn Error>> {
    let rounds: usize = std::env::args().nth(1).map_or(Ok(5), |text| text.parse())?;
    let mut ratios = Vec::with_capacity(rounds);
    println!("round   1 thread (s)   2 threads (s)   ratio");
    for round in 1..=rounds.max(1) {
        let (one, alone) = computed(1)?;
        let (two, both) = computed(2)?;
        assert!(one == two, "the map depends on the number of threads");
        ratios.push(alone / both);
        println!("{round:5}   {alone:12.3}   {both:13.3}   {:5.3}", alone / both);
        if round == 1 {
            let states = || one.paths.iter().flatten().flat_map(|path| &path.states);
            let asked: usize = one
                .paths
                .iter()
                .flatten()
                .map(|path| {
                    one.pressures
                        .iter()
                        .filter(|p| path.states.iter().any(|s| (s.pressure - **p).abs() < 1.0))
                        .count()
                })
                .sum();
            let worst = states().map(|state| state.residual).fold(0.0, f64::max);
            println!(
                "        {} paths, {} states, {asked} of the {} nodes below their limit; worst residual {worst:.1e}; {:.3} ms a state",
                one.paths.len(),
                states().count(),
                one.paths.len() * one.pressures.len(),
                1e3 * alone / states().count() as f64
            );
        }
    }
    ratios.sort_by(f64::total_cmp);
    println!("median ratio {:.3}", ratios[ratios.len() / 2]);
    Ok(())
}
