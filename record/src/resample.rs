use crate::{Channel, Motion, RecordError, Recording};
use actuator::TipPose;

/// A distance between measured samples of more than this many usual ones is a gap.
const GAP_STEPS: f64 = 3.0;
/// Samples above which a clock is taken for a mistake in the rate.
const MOST_SAMPLES: f64 = 1e8;

/// Puts a recording on an even clock of `rate` (Hz) that begins at its first sample: commands hold until the next one, pressures,
/// positions and what a FREE shows are interpolated linearly, rotations along the shortest arc. Each quantity is taken at its own
/// samples, so that topics of different clocks are aligned. Nothing is filled in beyond the first and last sample of a quantity
/// nor across a gap (more than three of its usual steps): NaN stands there. A command that was not given again within a gap
/// does not hold through it.
///
/// # Errors
/// A rate that is not positive, or that makes more than 1e8 samples.
pub fn resample(recording: &Recording, rate: f64) -> Result<Recording, RecordError> {
    let (Some(first), Some(last)) = (recording.time.first(), recording.time.last()) else {
        return Ok(recording.clone());
    };
    let steps = (last - first) * rate;
    if !(rate > 0.0 && steps < MOST_SAMPLES) {
        let message = format!(
            "cannot resample {} s at {rate} Hz; give a positive rate below {MOST_SAMPLES:e} samples",
            last - first
        );
        return Err(RecordError::Mismatch(message));
    }
    // A last sample that the clock misses by rounding belongs to it.
    let count = (steps * (1.0 + 1e-12) + 1e-9).floor() as usize + 1;
    let time: Vec<f64> = (0..count).map(|index| (first + index as f64 / rate).min(*last)).collect();
    let on = |channel: &Channel, way: Way| {
        let source = Source::of(&recording.time, |index| !channel[index].is_nan());
        let value = |place: Option<Place>| match place {
            None => f64::NAN,
            Some(Place { before, behind, part }) => match way {
                Way::Hold => channel[if part >= 1.0 { behind } else { before }],
                // Exact at both ends.
                Way::Line if part <= 0.0 => channel[before],
                Way::Line if part >= 1.0 => channel[behind],
                Way::Line => (1.0 - part) * channel[before] + part * channel[behind],
            },
        };
        source.places(&time).map(value).collect::<Channel>()
    };
    let motion = match &recording.motion {
        Motion::Pose { position, rotation } => Motion::Pose {
            position: position.each_ref().map(|channel| on(channel, Way::Line)),
            rotation: rotations(recording, rotation, &time),
        },
        Motion::Free { twist, extension, outer_diameter, torque, force } => Motion::Free {
            twist: on(twist, Way::Line),
            extension: on(extension, Way::Line),
            outer_diameter: on(outer_diameter, Way::Line),
            torque: on(torque, Way::Line),
            force: on(force, Way::Line),
        },
    };
    Ok(Recording {
        name: recording.name.clone(),
        command: recording.command.iter().map(|channel| on(channel, Way::Hold)).collect(),
        pressure: recording.pressure.iter().map(|channel| on(channel, Way::Line)).collect(),
        time,
        motion,
    })
}

#[derive(Clone, Copy)]
enum Way {
    Hold,
    Line,
}

/// Where a time lies among the measured samples: between two, `part` of the way from one to the other.
struct Place {
    before: usize,
    behind: usize,
    part: f64,
}

/// The samples at which a quantity was measured.
struct Source<'a> {
    time: &'a [f64],
    measured: Vec<usize>,
    longest: f64,
}

impl<'a> Source<'a> {
    fn of(time: &'a [f64], measured: impl Fn(usize) -> bool) -> Self {
        let measured: Vec<usize> = (0..time.len()).filter(|index| measured(*index)).collect();
        let mut steps: Vec<f64> = measured.windows(2).map(|pair| time[pair[1]] - time[pair[0]]).collect();
        let usual = if steps.is_empty() {
            0.0
        } else {
            let middle = steps.len() / 2;
            *steps.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        Source { time, measured, longest: GAP_STEPS * usual }
    }

    /// Places of rising times.
    fn places(&self, times: &[f64]) -> impl Iterator<Item = Option<Place>> {
        let mut next = 0;
        times.iter().map(move |time| {
            while next < self.measured.len() && self.time[self.measured[next]] < *time {
                next += 1;
            }
            let behind = *self.measured.get(next)?;
            if self.time[behind] == *time {
                return Some(Place { before: behind, behind, part: 0.0 });
            }
            let before = *self.measured.get(next.checked_sub(1)?)?;
            let step = self.time[behind] - self.time[before];
            (step <= self.longest).then(|| Place { before, behind, part: (time - self.time[before]) / step })
        })
    }
}

fn rotations(recording: &Recording, rotation: &[Channel; 4], time: &[f64]) -> [Channel; 4] {
    let raw = |index: usize| rotation.each_ref().map(|component| component[index]);
    let source = Source::of(&recording.time, |index| raw(index).iter().all(|value| !value.is_nan()));
    let turn = |index: usize| TipPose::from_parts([0.0; 3], raw(index)).map(|pose| pose.rotation);
    let at = |place: Option<Place>| {
        let Place { before, behind, part } = place?;
        if part <= 0.0 || part >= 1.0 {
            return Some(raw(if part <= 0.0 { before } else { behind }));
        }
        // Half a turn between two samples has no shortest arc.
        let between = turn(before)?.try_slerp(&turn(behind)?, part, 1e-9)?;
        Some([between.w, between.i, between.j, between.k])
    };
    let mut out = [const { Channel::new() }; 4];
    for place in source.places(time) {
        let values = at(place).unwrap_or([f64::NAN; 4]);
        for (channel, value) in out.iter_mut().zip(values) {
            channel.push(value);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, Quantity, rig_for_tests};

    /// Pressure measured at 10 Hz, pose at 5 Hz half a step off, a command once, a pause of two seconds.
    fn two_clocks() -> Recording {
        let mut stamps: Vec<(f64, bool)> = Vec::new();
        for index in 0..20 {
            let t = 0.1 * f64::from(index) + if index >= 10 { 2.0 } else { 0.0 };
            stamps.push((t, false));
            if index % 2 == 0 {
                stamps.push((t + 0.05, true));
            }
        }
        let time = stamps.iter().map(|(t, _)| *t).collect();
        let mut recording = Recording::unmeasured("run", time, &Layout::of(&rig_for_tests(1, "")).unwrap());
        for (index, (t, pose)) in stamps.into_iter().enumerate() {
            if pose {
                let angle = 2.0 * t;
                let values = [(0.5 * angle).cos(), 0.0, 0.0, (0.5 * angle).sin()];
                // Every second quaternion with the other sign.
                let sign = if (t * 10.0) as i64 % 4 == 0 { -1.0 } else { 1.0 };
                for (component, value) in values.into_iter().enumerate() {
                    recording.channel_mut(Quantity::Rotation(component)).unwrap()[index] = sign * value;
                }
                for axis in 0..3 {
                    recording.channel_mut(Quantity::Position(axis)).unwrap()[index] = 0.1 + t;
                }
            } else {
                recording.pressure[0][index] = 1e3 * t;
                recording.command[0][index] = if t < 0.5 { 1e3 } else { 2e3 };
            }
        }
        recording
    }

    #[test]
    fn clocks_are_aligned_and_straight_things_stay_straight() {
        let even = resample(&two_clocks(), 50.0).unwrap();
        assert_eq!(even.len(), 196);
        let mut poses = 0;
        for (index, &t) in even.time.iter().enumerate() {
            assert!((t - 0.02 * index as f64).abs() < 1e-12);
            let gap = t > 0.9 + 1e-9 && t < 3.0 - 1e-9;
            let pressure = even.pressure[0][index];
            assert_eq!(pressure.is_nan(), gap, "at {t}");
            assert!(gap || (pressure - 1e3 * t).abs() < 1e-9);
            let command = even.command[0][index];
            assert!(gap || command == if t < 0.5 - 1e-9 { 1e3 } else { 2e3 }, "{command} at {t}");
            if let Some(pose) = even.pose(index) {
                poses += 1;
                assert!((pose.position.x - 0.1 - t).abs() < 1e-12);
                // The rotation turns evenly about z; the sign of the quaternion does not count.
                let expected = TipPose::from_parts([0.0; 3], [t.cos(), 0.0, 0.0, t.sin()]).unwrap();
                assert!(pose.rotation.angle_to(&expected.rotation) < 1e-7, "at {t}");
            }
        }
        // Poses from 0.05 to 0.85 s and from 3.05 to 3.85 s, none beyond and none between.
        assert_eq!(poses, 80);
    }

    #[test]
    fn the_same_clock_gives_the_same_samples() {
        let mut recording = two_clocks();
        recording.time = (0..recording.len()).map(|index| 0.25 * index as f64).collect();
        recording.pressure[0]
            .iter_mut()
            .enumerate()
            .for_each(|(index, value)| *value = (index as f64).sqrt());
        let again = resample(&recording, 4.0).unwrap();
        assert_eq!((again.time, &again.pressure), (recording.time.clone(), &recording.pressure));
    }

    #[test]
    fn a_rate_that_is_none_is_refused() {
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(resample(&two_clocks(), rate).unwrap_err().to_string().contains("give a positive rate"));
        }
    }
}
