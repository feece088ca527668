//! Trajectories are followed within the rate limit, and a log of the inputs gives the same answers again.

mod analytic_module;

use analytic_module::*;
use control::{
    Blend, Preference, Side, Solver, Status, Tolerance, Tracker, Trajectory, Waypoint, solve, track,
};
use std::ops::ControlFlow;

/// A triangle of positions that the module reaches.
fn triangle(model: &AnalyticModule, seconds: f64, whole_pose: bool) -> Vec<Waypoint> {
    let corners = [
        [30e3, 22e3, 20e3, 25e3],
        [25e3, 35e3, 22e3, 20e3],
        [20e3, 22e3, 33e3, 24e3],
        [30e3, 22e3, 20e3, 25e3],
    ];
    let waypoint = |(index, pressures): (usize, &[f64; 4])| {
        let pose = chart_at(model, pressures).to_pose();
        Waypoint {
            time: seconds * index as f64,
            position: pose.position.into(),
            rotation: whole_pose.then(|| pose.wxyz()),
        }
    };
    corners.iter().enumerate().map(waypoint).collect()
}

fn ticks(
    model: &AnalyticModule,
    waypoints: Vec<Waypoint>,
    preference: Preference,
    rate: f64,
    from: Option<Vec<f64>>,
) -> Vec<control::Tick> {
    let trajectory = Trajectory::new(waypoints, 100.0, Blend::RestToRest, LENGTH).unwrap();
    let mut tracker =
        Tracker::new(model, bounds(4, 2e3, 65e3), preference, Tolerance::default(), rate, from).unwrap();
    let mut ticks = Vec::new();
    let count = track(&mut tracker, &trajectory, |tick| {
        ticks.push(tick);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!((count, ticks.len()), (trajectory.len(), trajectory.len()));
    ticks
}

#[test]
fn a_slow_triangle_is_followed_exactly_and_smoothly() {
    for model in [AnalyticModule::alternating(), AnalyticModule::all_right()] {
        for preference in [Preference::LeastPressure, Preference::LeastChange, Preference::Margin] {
            let ticks = ticks(&model, triangle(&model, 0.5, false), preference, 200e3, None);
            for (before, after) in ticks.iter().zip(&ticks[1..]) {
                assert_eq!(
                    after.solution.status,
                    Status::Reached,
                    "{}: {}",
                    after.time,
                    after.solution.reason
                );
                assert!(after.solution.answer.as_ref().unwrap().position_error < 1e-9);
                for (a, b) in before.command.iter().zip(&after.command) {
                    assert!((a - b).abs() <= 2e3, "{preference:?}");
                }
            }
        }
    }
}

#[test]
fn the_rate_limit_is_kept_and_named_where_it_binds() {
    let model = AnalyticModule::alternating();
    // 20 kPa/s are 200 Pa a tick, less than the triangle needs.
    let ticks =
        ticks(&model, triangle(&model, 0.2, false), Preference::LeastPressure, 20e3, Some(vec![10e3; 4]));
    let mut last = vec![10e3; 4];
    let mut limited = 0;
    for tick in &ticks {
        for (a, b) in last.iter().zip(&tick.command) {
            // a + step and a - step are rounded: one unit in the last place of 65 kPa.
            assert!((a - b).abs() <= 200.0 + 1e-11, "{a} to {b}");
        }
        last = tick.command.clone();
        let answer = tick.solution.answer.as_ref().unwrap();
        let by_rate = answer.active_bounds.iter().any(|b| matches!(b.side, Side::RateUp | Side::RateDown));
        if tick.solution.status == Status::Unreachable {
            assert!(
                by_rate,
                "{} {:?} {:?} {:?}",
                tick.solution.reason, tick.input.from, answer, tick.input.target
            );
            assert!(tick.solution.reason.contains("rate_"), "{}", tick.solution.reason);
            limited += 1;
        }
    }
    assert!(limited > 10, "{limited}");
}

#[test]
fn it_catches_up_after_a_limit() {
    let model = AnalyticModule::alternating();
    let mut waypoints = triangle(&model, 0.2, true);
    waypoints.push(Waypoint { time: 2.0, ..waypoints[3] });
    let ticks = ticks(&model, waypoints, Preference::LeastPressure, 50e3, Some(vec![2e3; 4]));
    assert_eq!(ticks[0].solution.status, Status::Unreachable);
    let last = ticks.last().unwrap();
    assert_eq!(last.solution.status, Status::Reached, "{}", last.solution.reason);
}

#[test]
fn a_log_of_the_inputs_gives_the_same_bits_again() {
    let model = AnalyticModule::alternating();
    let ticks = ticks(&model, triangle(&model, 0.1, true), Preference::LeastChange, 200e3, None);
    let mut solver = Solver::new(&model);
    for tick in ticks.iter().rev() {
        assert_eq!(solver.solve(&tick.input), tick.solution);
    }
    assert_eq!(solve(&model, &ticks[7].input), ticks[7].solution);
}

#[test]
fn a_refused_tick_keeps_the_last_pressures_and_a_refused_start_is_an_error() {
    let model = AnalyticModule::alternating();
    let tracker = |from| {
        Tracker::new(&model, bounds(4, 2e3, 65e3), Preference::Margin, Tolerance::default(), 1e5, from)
    };
    let broken = control::Target::at([f64::NAN; 3]);
    let tick = tracker(Some(vec![9e3; 4])).unwrap().tick(0.0, broken.clone(), 0.01).unwrap();
    assert_eq!((tick.solution.status, tick.command), (Status::Refused, vec![9e3; 4]));
    let message = tracker(None).unwrap().tick(0.0, broken, 0.01).unwrap_err().to_string();
    assert!(message.contains("NaN"), "{message}");
    let rate =
        Tracker::new(&model, bounds(4, 2e3, 65e3), Preference::Margin, Tolerance::default(), f64::NAN, None);
    assert!(rate.is_err());
}

#[test]
fn tracking_stops_when_told() {
    let model = AnalyticModule::alternating();
    let trajectory = Trajectory::new(triangle(&model, 0.5, false), 100.0, Blend::Linear, LENGTH).unwrap();
    let mut tracker =
        Tracker::new(&model, bounds(4, 2e3, 65e3), Preference::Margin, Tolerance::default(), 1e5, None)
            .unwrap();
    let mut seen = 0;
    let count = track(&mut tracker, &trajectory, |_| {
        seen += 1;
        if seen == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(count.unwrap(), 3);
}

#[test]
fn a_start_where_no_pressure_moves_the_tip_does_not_hold_the_search() {
    // At rest this module's Jacobian is zero: no step is better than none, and only the table shows the way.
    let model = AnalyticModule::alternating().flat_at_rest();
    let target = control::Target::at(chart_at(&model, &[9e3, 40e3, 20e3, 5e3]).to_pose().position.into());
    let mut tracker = Tracker::new(
        &model,
        bounds(4, 0.0, 65e3),
        Preference::LeastPressure,
        Tolerance::default(),
        100e3,
        Some(vec![0.0; 4]),
    )
    .unwrap();
    let first = tracker.tick(0.0, target.clone(), 0.01).unwrap();
    assert!(first.solution.reason.contains("on the way"), "{}", first.solution.reason);
    assert_eq!(first.command.iter().fold(0.0, |most: f64, p| most.max(*p)), 1e3);
    // The nearest pressures that reach it are at most 65 kPa away: twice the 65 steps of 1 kPa suffice.
    let reached = (1..130).any(|tick| {
        let tick = tracker.tick(0.01 * tick as f64, target.clone(), 0.01).unwrap();
        tick.solution.status == Status::Reached
    });
    assert!(reached);
}
