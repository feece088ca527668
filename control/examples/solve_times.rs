//! How long a solve takes: cold (a new solver each time, its table of the workspace included), from the table, and warm along a
//! path with a rate limit. Run with `cargo run --release -p control --example solve_times`.

#[path = "../tests/analytic_module/mod.rs"]
mod analytic_module;

use analytic_module::{AnalyticModule, LENGTH, Numbers, bounds, chart_at};
use control::{SolveInput, Solver, Target};
use std::time::{Duration, Instant};

fn timed<T>(times: &mut Vec<Duration>, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    times.push(start.elapsed());
    result
}

fn print(name: &str, mut times: Vec<Duration>) {
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e6;
    println!("{name:<42} median {:>9.1} us   99 % {:>9.1} us   of {}", at(0.5), at(0.99), times.len());
}

fn main() {
    let model = AnalyticModule::alternating();
    let bounds = bounds(4, 2e3, 65e3);
    for (what, whole_pose) in [("position", false), ("whole pose", true)] {
        let target = |pressures: &[f64]| {
            let pose = chart_at(&model, pressures).to_pose();
            if whole_pose { Target::pose(&pose, LENGTH) } else { Target::at(pose.position.into()) }
        };
        let mut numbers = Numbers(1);
        let (mut cold, mut table, mut warm, mut iterations) = (vec![], vec![], vec![], 0);
        let mut kept = Solver::new(&model);
        for case in 0..300 {
            let input = SolveInput::new(target(&numbers.pressures(&bounds)), bounds.clone());
            if case < 50 {
                timed(&mut cold, || Solver::new(&model).solve(&input));
            }
            iterations += timed(&mut table, || kept.solve(&input)).iterations;
        }
        // A slow wave through all FREEs, 100 solves a second.
        let wave = |tick: usize| {
            let phase = tick as f64 * 0.01;
            [0.0, 1.6, 3.1, 4.7].map(|shift: f64| 30e3 + 15e3 * (phase + shift).sin())
        };
        let mut from = wave(0).to_vec();
        for tick in 1..1000 {
            let mut input = SolveInput::new(target(&wave(tick)), bounds.clone());
            (input.from, input.step_limit, input.starts) = (Some(from.clone()), Some(2e3), 0);
            let solution = timed(&mut warm, || kept.solve(&input));
            if let Some(answer) = solution.answer {
                from = answer.pressures;
            }
        }
        print(&format!("{what}, cold with a new table"), cold);
        print(&format!("{what}, starts from the kept table"), table);
        print(&format!("{what}, warm with a rate limit"), warm);
        println!("{what}, programs and Newton steps a cold solve: {}", iterations / 300);
    }
}
