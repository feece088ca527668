//! A solve as the log keeps it: every number that went in, every number that came out, and the way back.

use control::{Bounds, Preference, Solution, SolveInput, Status, Target, Tick, Tolerance};
use record::SolveRecord;

/// Names of what the solve depends on beside the fields of the record.
const HAS_ROTATION: &str = "has_rotation";
const STEP_LIMIT: &str = "step_limit_pa";
const STARTS: &str = "starts";
const POSITION_TOLERANCE: &str = "position_tolerance_m";
const ROTATION_TOLERANCE: &str = "rotation_tolerance_rad";
const LOWER: &str = "lower_pa_";
const UPPER: &str = "upper_pa_";
const LIMIT: &str = "limit_pa_";

/// The record of a tick.
pub fn record(tick: &Tick) -> SolveRecord {
    let input = &tick.input;
    let mut settings: Vec<(String, f64)> = vec![
        (HAS_ROTATION.into(), f64::from(u8::from(input.target.rotation.is_some()))),
        (STARTS.into(), input.starts as f64),
        (POSITION_TOLERANCE.into(), input.tolerance.position),
        (ROTATION_TOLERANCE.into(), input.tolerance.rotation),
    ];
    settings.extend(input.step_limit.map(|limit| (STEP_LIMIT.into(), limit)));
    let Bounds { lower, upper, limit } = &input.bounds;
    for (name, list) in [(LOWER, lower), (UPPER, upper), (LIMIT, limit)] {
        settings.extend(list.iter().enumerate().map(|(free, value)| (format!("{name}{}", free + 1), *value)));
    }
    let within_step = |bound: &[f64], sign: f64| -> Vec<f64> {
        let (Some(from), Some(step)) = (&input.from, input.step_limit) else { return bound.to_vec() };
        let nearer = |(bound, now): (&f64, &f64)| sign * (sign * bound).min(sign * now + step);
        bound.iter().zip(from).map(nearer).collect()
    };
    let mut record = SolveRecord {
        time: tick.time,
        target_position: input.target.position,
        target_rotation: input.target.rotation.unwrap_or([1.0, 0.0, 0.0, 0.0]),
        start_pressure: input.from.clone().unwrap_or_default(),
        pressure_min: within_step(lower, -1.0),
        pressure_max: within_step(upper, 1.0),
        position_weight: input.target.position_weight,
        rotation_weight: input.target.rotation_weight,
        preference: preference_name(input.preference).into(),
        // The choice comes after the target: it is never weighed against it.
        preference_weight: 0.0,
        setting_name: settings.iter().map(|(name, _)| name.clone()).collect(),
        setting_value: settings.iter().map(|(_, value)| *value).collect(),
        duration: tick.solve_time.as_secs_f64(),
        ..SolveRecord::default()
    };
    put_solution(&mut record, &tick.solution);
    record
}

/// Puts what came out into a record.
fn put_solution(record: &mut SolveRecord, solution: &Solution) {
    record.status = status_name(solution.status).into();
    record.reason.clone_from(&solution.reason);
    record.iterations = solution.iterations as u32;
    let Some(answer) = &solution.answer else {
        let nothing = f64::NAN;
        (record.pressure, record.active_bound) = (Vec::new(), Vec::new());
        (record.predicted_position, record.predicted_rotation) = ([nothing; 3], [nothing; 4]);
        (record.position_residual, record.rotation_residual) = (nothing, nothing);
        (record.limit_margin, record.objective) = (nothing, nothing);
        return;
    };
    let pose = answer.pose();
    record.pressure.clone_from(&answer.pressures);
    record.active_bound = answer.active_bounds.iter().map(ToString::to_string).collect();
    record.predicted_position = pose.position.into();
    record.predicted_rotation = pose.wxyz();
    record.position_residual = answer.position_error;
    record.rotation_residual = answer.rotation_error.unwrap_or(f64::NAN);
    record.limit_margin = answer.limit_margin;
    let weighed = |weight: f64, error: f64| 0.5 * (weight * error).powi(2);
    record.objective = weighed(record.position_weight, answer.position_error)
        + answer.rotation_error.map_or(0.0, |error| weighed(record.rotation_weight, error));
}

/// What was asked, from its record; in words, what the record lacks.
pub fn input(record: &SolveRecord) -> Result<SolveInput, String> {
    let setting = |name: &str| {
        let place = record.setting_name.iter().position(|known| known == name)?;
        record.setting_value.get(place).copied()
    };
    let needed =
        |name: &str| setting(name).ok_or_else(|| format!("the solve at {} s lacks `{name}`", record.time));
    let frees = record.pressure_min.len();
    let list =
        |name: &str| (1..=frees).map(|free| needed(&format!("{name}{free}"))).collect::<Result<Vec<_>, _>>();
    let preference = match record.preference.as_str() {
        "least-pressure" => Preference::LeastPressure,
        "least-change" => Preference::LeastChange,
        "margin" => Preference::Margin,
        other => {
            return Err(format!("the solve at {} s has the unknown preference \"{other}\"", record.time));
        }
    };
    Ok(SolveInput {
        target: Target {
            position: record.target_position,
            rotation: (needed(HAS_ROTATION)? != 0.0).then_some(record.target_rotation),
            position_weight: record.position_weight,
            rotation_weight: record.rotation_weight,
        },
        bounds: Bounds { lower: list(LOWER)?, upper: list(UPPER)?, limit: list(LIMIT)? },
        preference,
        from: (!record.start_pressure.is_empty()).then(|| record.start_pressure.clone()),
        step_limit: setting(STEP_LIMIT),
        starts: needed(STARTS)? as usize,
        tolerance: Tolerance { position: needed(POSITION_TOLERANCE)?, rotation: needed(ROTATION_TOLERANCE)? },
    })
}

/// Whether a solution is the recorded one in every bit.
pub fn is_same(record: &SolveRecord, solution: &Solution) -> bool {
    let mut again = record.clone();
    put_solution(&mut again, solution);
    let numbers = |record: &SolveRecord| -> Vec<u64> {
        let single =
            [record.objective, record.position_residual, record.rotation_residual, record.limit_margin];
        let all = record.pressure.iter().chain(&record.predicted_position).chain(&record.predicted_rotation);
        all.chain(&single).map(|value| value.to_bits()).collect()
    };
    let words = |record: &SolveRecord| {
        (record.status.clone(), record.reason.clone(), record.active_bound.clone(), record.iterations)
    };
    numbers(&again) == numbers(record) && words(&again) == words(record)
}

/// The preference as files and flags write it.
pub fn preference_name(preference: Preference) -> &'static str {
    match preference {
        Preference::LeastPressure => "least-pressure",
        Preference::LeastChange => "least-change",
        Preference::Margin => "margin",
    }
}

fn status_name(status: Status) -> &'static str {
    match status {
        Status::Reached => "reached",
        Status::Unreachable => "unreachable",
        Status::Refused => "refused",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use actuator::PoseChart;
    use control::{ActiveBound, Answer, Side};

    fn tick(rotation: Option<[f64; 4]>, from: Option<Vec<f64>>) -> Tick {
        let bounds = Bounds { lower: vec![0.0, 1e3], upper: vec![5e4, 4e4], limit: vec![6e4, 5e4] };
        let target =
            Target { position: [0.01, 0.1, 0.17], rotation, position_weight: 1.0, rotation_weight: 0.175 };
        let step_limit = from.as_ref().map(|_| 2e3);
        let input = SolveInput {
            from,
            step_limit,
            preference: Preference::Margin,
            ..SolveInput::new(target, bounds)
        };
        let answer = Answer {
            pressures: vec![3e3, 4e4],
            chart: PoseChart { twist: 0.1, bend: [0.2, 0.3], position: [0.01, 0.02, 0.17] },
            position_error: 1e-7,
            rotation_error: rotation.map(|_| 1e-5),
            active_bounds: vec![ActiveBound { free: 1, side: Side::Max }],
            limit_margin: 1e4,
            stationarity: 1e-12,
        };
        let solution =
            Solution { status: Status::Reached, answer: Some(answer), iterations: 7, reason: String::new() };
        Tick {
            time: 0.25,
            input,
            solution,
            command: vec![3e3, 4e4],
            solve_time: std::time::Duration::from_micros(80),
        }
    }

    #[test]
    fn what_was_asked_comes_back_whole() {
        for tick in [tick(None, None), tick(Some([0.8, 0.0, 0.6, 0.0]), Some(vec![1e3, 39e3]))] {
            let record = record(&tick);
            assert_eq!(input(&record).unwrap(), tick.input);
            assert!(is_same(&record, &tick.solution));
        }
    }

    #[test]
    fn the_box_of_a_step_is_recorded() {
        let record = record(&tick(None, Some(vec![1e3, 39e3])));
        assert_eq!((record.pressure_min, record.pressure_max), (vec![0.0, 37e3], vec![3e3, 4e4]));
    }

    #[test]
    fn one_bit_is_a_difference() {
        let tick = tick(None, None);
        let record = record(&tick);
        let mut other = tick.solution.clone();
        let answer = other.answer.as_mut().unwrap();
        answer.pressures[0] = f64::from_bits(answer.pressures[0].to_bits() + 1);
        assert!(!is_same(&record, &other));
        let refused = Solution { status: Status::Refused, answer: None, iterations: 7, reason: "no".into() };
        assert!(!is_same(&record, &refused));
        let mut refusal = record.clone();
        put_solution(&mut refusal, &refused);
        assert!(is_same(&refusal, &refused));
    }

    #[test]
    fn a_record_without_a_setting_says_which() {
        let mut record = record(&tick(None, None));
        let place = record.setting_name.iter().position(|name| name == "upper_pa_2").unwrap();
        record.setting_name[place] = "other".into();
        assert!(input(&record).unwrap_err().contains("lacks `upper_pa_2`"));
    }
}
