use crate::{Finding, FindingKind, Findings, Layout, Motion, Quantity, Recording};

/// A step of the clock longer than this many usual steps is a gap.
const GAP_STEPS: f64 = 3.0;
/// Samples on either side that an outlier is compared with.
const HALF_WINDOW: usize = 5;
/// Distance from the neighbours' median, in their standard deviations, beyond which a sample is an outlier.
const OUTLIER_DEVIATIONS: f64 = 10.0;
/// Ratio of a normal distribution's standard deviation to its median absolute deviation.
const DEVIATION_PER_MEDIAN: f64 = 1.482_6;

/// Looks a recording over and reports what is irregular: quantities not recorded, missing samples, gaps, another rate than the
/// nominal one, outliers, numbers whose size suggests another unit, pressures above the limit. Changes nothing.
pub fn examine(recording: &Recording, layout: &Layout) -> Findings {
    let mut findings = Findings::default();
    what_is_missing(recording, layout, &mut findings);
    clock(recording, layout, &mut findings);
    outliers(recording, layout, &mut findings);
    units(recording, layout, &mut findings);
    above_limit(recording, layout, &mut findings);
    findings
}

fn what_is_missing(recording: &Recording, layout: &Layout, findings: &mut Findings) {
    let mut none = |what: &str, consequence: &str| {
        findings.add(FindingKind::NotRecorded, what, recording.len(), format!("not recorded; {consequence}"));
    };
    match (recording.command.is_empty(), recording.pressure.is_empty()) {
        (true, true) => none("pressures", "neither commands nor measured pressures drive a model here"),
        (true, false) => none("commands", "the model can be driven by the measured pressures only"),
        (false, true) => none("pressures", "the model can be driven by the commands only"),
        (false, false) => {}
    }
    let unseen = |quantity: &Quantity| {
        recording.channel(*quantity).is_some_and(|channel| channel.iter().all(|value| value.is_nan()))
    };
    for quantity in recording.quantities() {
        // A FREE is seldom fitted with every instrument; only what a module needs whole is worth a word.
        if unseen(&quantity) && !matches!(recording.motion, Motion::Free { .. }) {
            findings.add(FindingKind::NotRecorded, quantity.column(), recording.len(), "not recorded");
        }
    }
    if layout.single_free && recording.quantities().iter().skip_while(|q| !is_motion(**q)).all(unseen) {
        findings.add(FindingKind::NotRecorded, "twist_rad", recording.len(), "no deformation recorded");
    }
    for quantity in recording.quantities() {
        let Some(channel) = recording.channel(quantity) else { continue };
        let missing = channel.iter().filter(|value| value.is_nan()).count();
        if missing > 0 && missing < channel.len() {
            let percent = 100.0 * missing as f64 / channel.len() as f64;
            let message = format!("{missing} of {} samples not measured ({percent:.1} %)", channel.len());
            findings.add(FindingKind::Missing, quantity.column(), missing, message);
        }
    }
}

fn is_motion(quantity: Quantity) -> bool {
    !matches!(quantity, Quantity::Time | Quantity::Command(_) | Quantity::Pressure(_))
}

fn clock(recording: &Recording, layout: &Layout, findings: &mut Findings) {
    let time = &recording.time;
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() {
        return;
    }
    let usual = median(&mut steps.clone());
    let long: Vec<usize> = (0..steps.len()).filter(|index| steps[*index] > GAP_STEPS * usual).collect();
    if let Some(first) = long.first() {
        let longest = long.iter().map(|index| steps[*index]).fold(0.0, f64::max);
        let message = format!(
            "{} gap{} of more than {GAP_STEPS} usual steps of {usual:.4} s, first after {:.3} s, longest {longest:.3} s",
            long.len(),
            if long.len() == 1 { "" } else { "s" },
            time[*first]
        );
        findings.list.push(Finding {
            kind: FindingKind::Gap,
            channel: "t_s".into(),
            count: long.len(),
            message,
            samples: long.iter().map(|index| index + 1).collect(),
        });
    }
    let Some(rate) = layout.rate else { return };
    let ratio = usual * rate;
    if !(0.02..=50.0).contains(&ratio) {
        let message = format!(
            "a usual step of {usual} s at a nominal {rate} Hz: is the time in another unit? map it as t_ms or t_us"
        );
        findings.add(FindingKind::UnitSlip, "t_s", steps.len(), message);
    } else if !(0.95..=1.05).contains(&ratio) {
        let message = format!("sampled at {:.3} Hz, the rig's file says {rate} Hz", 1.0 / usual);
        findings.add(FindingKind::Rate, "t_s", steps.len(), message);
    }
}

/// Looks for outliers in each measured pressure, in the position and in the rotation as a whole, and in what a FREE shows.
fn outliers(recording: &Recording, layout: &Layout, findings: &mut Findings) {
    for (free, channel) in recording.pressure.iter().enumerate() {
        let quantity = Quantity::Pressure(free);
        let signal =
            Signal { channels: vec![channel.clone()], least_deviation: 1e-3 * layout.pressure_max[free] };
        signal.report(&recording.time, &quantity.column(), quantity.unit(), findings);
    }
    match &recording.motion {
        Motion::Pose { position, rotation } => {
            let signal = Signal { channels: position.to_vec(), least_deviation: 1e-3 * layout.length };
            signal.report(&recording.time, "position", Quantity::Position(0).unit(), findings);
            let signs = continuous_signs(rotation);
            let signed = |component: &Vec<f64>| {
                component.iter().zip(&signs).map(|(value, sign)| value * sign).collect()
            };
            let signal = Signal { channels: rotation.iter().map(signed).collect(), least_deviation: 1e-3 };
            // Quaternions half an angle apart: twice the chord is about the angle in rad.
            signal.report(&recording.time, "rotation", 0.5, findings);
        }
        Motion::Free { twist, extension, outer_diameter, torque, force } => {
            let reach = [
                (Quantity::Twist, twist, 1.0),
                (Quantity::Extension, extension, layout.length),
                (Quantity::OuterDiameter, outer_diameter, layout.length),
                (Quantity::Torque, torque, 0.1),
                (Quantity::Force, force, 10.0),
            ];
            for (quantity, channel, reach) in reach {
                let signal = Signal { channels: vec![channel.clone()], least_deviation: 1e-3 * reach };
                signal.report(&recording.time, &quantity.column(), quantity.unit(), findings);
            }
        }
    }
}

/// What is looked over for outliers as one: the channels are components of a vector.
struct Signal {
    channels: Vec<Vec<f64>>,
    /// Deviation below which nothing is called an outlier: a thousandth of what the signal can reach, so that a noiseless or
    /// coarsely rounded recording is not full of them.
    least_deviation: f64,
}

impl Signal {
    /// Reports samples that make the way from the samples before (median b) to those behind (median a) much longer: with x the
    /// sample, `|x - b| + |a - x| - |a - b|` above twice ten standard deviations plus half of `|a - b|`. A step, and a sample
    /// caught on its way through one, is no outlier.
    fn report(&self, time: &[f64], name: &str, unit: f64, findings: &mut Findings) {
        let measured: Vec<usize> = (0..time.len())
            .filter(|index| self.channels.iter().all(|channel| !channel[*index].is_nan()))
            .collect();
        // A few points (a quasi-static test) have no noise to be told from.
        if measured.len() < 10 * HALF_WINDOW {
            return;
        }
        let values: Vec<Vec<f64>> = self
            .channels
            .iter()
            .map(|channel| measured.iter().map(|index| channel[*index]).collect())
            .collect();
        // The second difference of white noise has sqrt(6) times its deviation.
        let noise = values.iter().map(|channel| {
            let mut bends: Vec<f64> = channel.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).collect();
            DEVIATION_PER_MEDIAN * median(&mut bends) / 6f64.sqrt()
        });
        let floor = noise.fold(self.least_deviation, f64::max);
        let mut found = Vec::new();
        let mut worst = 0.0f64;
        for place in 0..measured.len() {
            let before = middle_and_spread(&values, place.saturating_sub(HALF_WINDOW)..place);
            let behind = middle_and_spread(&values, place + 1..measured.len().min(place + 1 + HALF_WINDOW));
            let (Some((b, spread_b)), Some((a, spread_a))) =
                (before.as_ref().or(behind.as_ref()), behind.as_ref().or(before.as_ref()))
            else {
                continue;
            };
            let x: Vec<f64> = values.iter().map(|channel| channel[place]).collect();
            let (to, on, step) = (distance(&x, b), distance(a, &x), distance(a, b));
            let deviation = floor.max(*spread_b).max(*spread_a);
            if to + on - step > 2.0 * OUTLIER_DEVIATIONS * deviation + 0.5 * step {
                found.push(measured[place]);
                worst = worst.max(to.min(on));
            }
        }
        let Some(first) = found.first() else { return };
        let message = format!(
            "{} sample{} far off the neighbours, first at {:.3} s, the worst by {:.3}",
            found.len(),
            if found.len() == 1 { "" } else { "s" },
            time[*first],
            worst / unit
        );
        findings.list.push(Finding {
            kind: FindingKind::Outlier,
            channel: name.to_owned(),
            count: found.len(),
            message,
            samples: found,
        });
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Median of each channel and the largest standard deviation (from the median absolute deviation) over a few samples; `None`
/// of none.
fn middle_and_spread(channels: &[Vec<f64>], samples: std::ops::Range<usize>) -> Option<(Vec<f64>, f64)> {
    if samples.is_empty() {
        return None;
    }
    let mut spread = 0.0f64;
    let middles = channels.iter().map(|channel| {
        let mut values = channel[samples.clone()].to_vec();
        let middle = median(&mut values);
        values.iter_mut().for_each(|value| *value = (*value - middle).abs());
        spread = spread.max(DEVIATION_PER_MEDIAN * median(&mut values));
        middle
    });
    let middles = middles.collect();
    Some((middles, spread))
}

/// A sign for each quaternion that keeps it next to the one before: q and -q are the same rotation.
fn continuous_signs(rotation: &[Vec<f64>; 4]) -> Vec<f64> {
    let mut signs = vec![1.0; rotation[0].len()];
    let mut last: Option<[f64; 4]> = None;
    for (index, sign) in signs.iter_mut().enumerate() {
        let now = rotation.each_ref().map(|component| component[index]);
        if now.iter().any(|value| value.is_nan()) {
            continue;
        }
        if let Some(last) = last {
            let along: f64 = now.iter().zip(last).map(|(a, b)| a * b).sum();
            *sign = if along < 0.0 { -1.0 } else { 1.0 };
        }
        last = Some(now.map(|value| *sign * value));
    }
    signs
}

fn units(recording: &Recording, layout: &Layout, findings: &mut Findings) {
    let greatest = |quantity: Quantity| {
        let channel = recording.channel(quantity)?;
        let measured: Vec<f64> =
            channel.iter().filter(|value| !value.is_nan()).map(|value| value.abs()).collect();
        measured.into_iter().reduce(f64::max)
    };
    let mut slip = |quantity: Quantity, message: String| {
        findings.add(FindingKind::UnitSlip, quantity.column(), recording.len(), message);
    };
    let pressures = (0..layout.frees).flat_map(|free| [Quantity::Command(free), Quantity::Pressure(free)]);
    for quantity in pressures {
        let (Quantity::Command(free) | Quantity::Pressure(free)) = quantity else { continue };
        let Some(high) = greatest(quantity) else { continue };
        let limit = layout.pressure_max[free];
        if high > 20.0 * limit {
            let message = format!(
                "reaches {} kPa where the rig allows {}: are these Pa? map the column as p{}_pa",
                high / 1e3,
                limit / 1e3,
                free + 1
            );
            slip(quantity, message);
        } else if high > 0.0 && high < limit / 200.0 && matches!(quantity, Quantity::Command(_)) {
            let message = format!(
                "never passes {} kPa where the rig allows {}: are these bar, psi or MPa? map the column by its unit",
                high / 1e3,
                limit / 1e3
            );
            slip(quantity, message);
        }
        let channel = recording.channel(quantity).map_or(&[][..], Vec::as_slice);
        let least = channel.iter().copied().filter(|value| !value.is_nan()).fold(f64::INFINITY, f64::min);
        if least.is_finite() && least > 0.8 * layout.ambient && high < layout.ambient + 2.0 * limit {
            slip(
                quantity,
                format!(
                    "never below {} kPa: are these absolute pressures? set pressure = \"absolute\"",
                    least / 1e3
                ),
            );
        }
    }
    let reach = (0..3).filter_map(|axis| greatest(Quantity::Position(axis))).reduce(f64::max);
    if let Some(reach) = reach {
        let mm = reach * 1e3;
        if reach > 20.0 * layout.length {
            slip(
                Quantity::Position(2),
                format!("positions reach {mm} mm on a module of {} mm: are these um?", layout.length * 1e3),
            );
        } else if reach < 0.02 * layout.length {
            let message = format!(
                "positions never pass {mm} mm on a module of {} mm: are these m (map them as x_m), or from the place at the \
                 start (set pose_origin = \"start\")?",
                layout.length * 1e3
            );
            slip(Quantity::Position(2), message);
        }
    }
    if let Some(turn) = greatest(Quantity::Twist).filter(|turn| *turn > 60.0) {
        slip(
            Quantity::Twist,
            format!("reaches {turn} rad, ten turns: are these degrees? map the column as twist_deg"),
        );
    }
}

fn above_limit(recording: &Recording, layout: &Layout, findings: &mut Findings) {
    for (free, channel) in recording.command.iter().enumerate() {
        let limit = layout.pressure_max[free];
        // A thousandth above is the rounding of a file.
        let above = channel.iter().filter(|value| **value > 1.001 * limit).count();
        if above > 0 {
            let high = channel.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let message = format!(
                "{above} commands above the limit of {} kPa, up to {} kPa; check pressure_max_kpa",
                limit / 1e3,
                high / 1e3
            );
            findings.add(FindingKind::AboveLimit, Quantity::Command(free).column(), above, message);
        }
    }
}

/// Median of numbers none of which is NaN; the slice is reordered. Of an even count, the upper of the middle two.
fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig_for_tests;

    /// Ten seconds at 20 Hz of one FREE: a pressure step at 5 s, a pose with a small rough noise.
    fn healthy() -> Recording {
        let layout = Layout::of(&rig_for_tests(1, "")).unwrap();
        let time: Vec<f64> = (0..200).map(|index| 0.05 * f64::from(index)).collect();
        let mut recording = Recording::unmeasured("run", time.clone(), &layout);
        // A fixed irregular sequence in (-1, 1).
        let noise =
            |index: usize, salt: usize| ((index * 7919 + salt * 104_729) % 2003) as f64 / 1001.5 - 1.0;
        for index in 0..time.len() {
            let step = if index < 100 { 10e3 } else { 30e3 };
            recording.command[0][index] = step;
            recording.pressure[0][index] = step + 80.0 * noise(index, 1);
            if let Motion::Pose { position, rotation } = &mut recording.motion {
                for (axis, rest) in [0.0, 0.0, 0.175].into_iter().enumerate() {
                    position[axis][index] = rest + 1e-7 * step + 1.5e-4 * noise(index, 2 + axis);
                }
                for (component, value) in [1.0, 0.0, 0.0, 0.0].into_iter().enumerate() {
                    rotation[component][index] = value;
                }
            }
        }
        recording
    }

    fn found(recording: &Recording, table: &str) -> Findings {
        examine(recording, &Layout::of(&rig_for_tests(1, table)).unwrap())
    }

    #[test]
    fn a_healthy_recording_with_a_step_gives_no_finding() {
        let findings = found(&healthy(), "[recordings]\nrate_hz = 20\n");
        assert!(findings.is_empty(), "{findings}");
    }

    #[test]
    fn spikes_are_outliers_and_steps_are_not() {
        let mut recording = healthy();
        recording.channel_mut(Quantity::Position(2)).unwrap()[60] -= 0.05;
        recording.channel_mut(Quantity::Position(2)).unwrap()[61] -= 0.05;
        let findings = found(&recording, "");
        assert_eq!(findings.list.len(), 1, "{findings}");
        assert_eq!(
            (findings.list[0].kind, findings.list[0].samples.as_slice()),
            (FindingKind::Outlier, [60, 61].as_slice())
        );
    }

    #[test]
    fn a_change_of_sign_of_the_quaternion_and_a_sample_on_its_way_are_no_outliers() {
        let mut recording = healthy();
        recording.pressure[0][100] = 17e3;
        if let Motion::Pose { position, rotation } = &mut recording.motion {
            // Half-way through the step of 2 mm along each axis, and 3.5 mm aside: a curved way, not a lost marker.
            for (channel, aside) in position.iter_mut().zip([2.45e-3, -2.45e-3, 0.0]) {
                channel[100] = 0.5 * (channel[99] + channel[101]) + aside;
            }
            for component in rotation {
                component[80..83].iter_mut().for_each(|value| *value = -*value);
            }
        }
        let findings = found(&recording, "");
        assert!(findings.is_empty(), "{findings}");
    }

    #[test]
    fn gaps_missing_samples_and_rates_are_counted() {
        let mut recording = healthy();
        recording.time.iter_mut().skip(50).for_each(|time| *time += 1.0);
        recording.pressure[0][3] = f64::NAN;
        let findings = found(&recording, "[recordings]\nrate_hz = 25\n");
        let gap = findings.of_kind(FindingKind::Gap).next().unwrap();
        assert_eq!((gap.count, gap.samples.as_slice()), (1, [50].as_slice()));
        assert_eq!(
            findings.of_kind(FindingKind::Missing).map(|finding| finding.count).collect::<Vec<_>>(),
            [1]
        );
        assert!(findings.of_kind(FindingKind::Rate).next().unwrap().message.contains("25 Hz"));
        assert_eq!(findings.list.len(), 3, "{findings}");
    }

    #[test]
    fn slips_of_units_are_suspected() {
        let scaled = |quantity: Quantity, factor: f64| {
            let mut recording = healthy();
            recording.channel_mut(quantity).unwrap().iter_mut().for_each(|value| *value *= factor);
            found(&recording, "[recordings]\nrate_hz = 20\n")
                .of_kind(FindingKind::UnitSlip)
                .map(|finding| finding.message.clone())
                .collect::<String>()
        };
        assert!(scaled(Quantity::Pressure(0), 1e3).contains("are these Pa?"));
        assert!(scaled(Quantity::Command(0), 1e-3).contains("bar, psi or MPa"));
        assert!(scaled(Quantity::Position(2), 1e3).contains("are these um?"));
        assert!(scaled(Quantity::Position(2), 1e-3).contains("are these m "));
        assert!(scaled(Quantity::Time, 1e3).contains("t_ms"));
        let mut absolute = healthy();
        absolute.pressure[0].iter_mut().for_each(|value| *value += 101_325.0);
        assert!(found(&absolute, "").to_string().contains("pressure = \"absolute\""));
        let mut high = healthy();
        high.command[0][150] = 60e3;
        assert!(found(&high, "").to_string().contains("1 commands above the limit of 50 kPa, up to 60 kPa"));
    }
}
