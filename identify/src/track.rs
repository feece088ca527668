use crate::Mechanics;
use crate::mechanics::{OUTPUTS, Seen};
use record::{Motion, Recording};
use rom::effect::Chain;

/// A recording made ready: gaps of the pressures filled, spikes gated, the measured deformation at every sample.
#[derive(Clone, Debug)]
pub struct Track {
    /// Name of the recording.
    pub name: String,
    /// Times, s.
    pub time: Vec<f64>,
    /// Commands (Pa), sample by sample, FREEs fastest; `None` = not recorded.
    pub command: Option<Vec<f64>>,
    /// Pressures read (Pa), sample by sample, FREEs fastest; `None` = not recorded.
    pub reading: Option<Vec<f64>>,
    /// Whether a pressure reading was measured (not filled), sample by sample, FREEs fastest.
    pub read: Vec<bool>,
    /// What was seen, where it was measured.
    pub seen: Vec<Option<Seen>>,
    /// Number of FREEs.
    pub frees: usize,
}

/// Which pressure drives a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// The measured pressure.
    Reading,
    /// The command.
    Command,
}

/// Share of a channel that may be missing before it counts as not recorded.
const MOST_MISSING: f64 = 0.5;

/// A sample is a spike when it leaves both neighbours by more than this many noises, to the same side, and the neighbours agree.
const SPIKE: f64 = 12.0;

/// Standard deviation of white noise on a channel, from second differences `x[k-1] - 2 x[k] + x[k+1]` (variance 6 sigma^2): what moves smoothly or
/// rests drops out. The median absolute value makes steps and spikes count little; NaN are passed over. `None` with fewer than 20 differences.
pub fn noise(channel: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = channel.collect();
    let mut differences: Vec<f64> = values
        .windows(3)
        .map(|w| (w[0] - 2.0 * w[1] + w[2]).abs())
        .filter(|difference| difference.is_finite())
        .collect();
    if differences.len() < 20 {
        return None;
    }
    Some(1.4826 * median(&mut differences) / 6f64.sqrt())
}

/// Median; zero of nothing.
pub fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Sets spikes to NaN; returns how many.
fn gate(channel: &mut [f64]) -> usize {
    let Some(noise) = noise(channel.iter().copied()) else { return 0 };
    if noise == 0.0 {
        return 0;
    }
    let mut spikes = Vec::new();
    for k in 1..channel.len().saturating_sub(1) {
        let (before, after) = (channel[k] - channel[k - 1], channel[k] - channel[k + 1]);
        let apart = (channel[k + 1] - channel[k - 1]).abs();
        let least = before.abs().min(after.abs());
        if before * after > 0.0 && least > SPIKE * noise && apart < 0.3 * least {
            spikes.push(k);
        }
    }
    for spike in &spikes {
        channel[*spike] = f64::NAN;
    }
    spikes.len()
}

/// Fills NaN linearly, ends by the nearest; `false` when nothing was measured.
fn fill(time: &[f64], channel: &mut [f64]) -> bool {
    let Some(first) = channel.iter().position(|value| value.is_finite()) else { return false };
    let start = channel[first];
    channel[..first].fill(start);
    let mut last = first;
    for k in first + 1..channel.len() {
        if !channel[k].is_finite() {
            continue;
        }
        for gap in last + 1..k {
            let share = (time[gap] - time[last]) / (time[k] - time[last]);
            channel[gap] = channel[last] + share * (channel[k] - channel[last]);
        }
        last = k;
    }
    let end = channel[last];
    channel[last + 1..].fill(end);
    true
}

/// What was repaired, for the findings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Samples of a pressure filled or gated.
    pub pressures: usize,
    /// Samples of the deformation gated as spikes.
    pub spikes: usize,
    /// Samples of the deformation not measured.
    pub missing: usize,
}

impl Track {
    /// Makes a recording ready for an actuator of `frees` FREEs.
    pub fn new(recording: &Recording, frees: usize) -> (Self, Repairs) {
        let samples = recording.time.len();
        let mut repairs = Repairs::default();
        let mut read = vec![true; samples * frees];
        let mut flatten = |channels: &[Vec<f64>], is_reading: bool| -> Option<Vec<f64>> {
            if channels.len() != frees {
                return None;
            }
            let mut flat = vec![0.0; samples * frees];
            for (free, channel) in channels.iter().enumerate() {
                let mut channel = channel.clone();
                if is_reading {
                    gate(&mut channel);
                }
                let missing = channel.iter().filter(|value| !value.is_finite()).count();
                if missing as f64 > MOST_MISSING * samples as f64 {
                    return None;
                }
                repairs.pressures += missing;
                for (k, value) in channel.iter().enumerate() {
                    read[k * frees + free] &= !is_reading || value.is_finite();
                }
                fill(&recording.time, &mut channel);
                for (k, value) in channel.into_iter().enumerate() {
                    flat[k * frees + free] = value;
                }
            }
            Some(flat)
        };
        let command = flatten(&recording.command, false);
        let reading = flatten(&recording.pressure, true);
        let mut twist = 0.0;
        let mut gated = recording.motion.clone();
        repairs.spikes = match &mut gated {
            Motion::Pose { position, .. } => position.iter_mut().map(|channel| gate(channel)).sum(),
            Motion::Free { twist, extension, outer_diameter, .. } => {
                [twist, extension, outer_diameter].into_iter().map(|channel| gate(channel)).sum()
            }
        };
        let gated = Recording { motion: gated, ..recording.clone() };
        let seen: Vec<Option<Seen>> = (0..samples)
            .map(|k| match &gated.motion {
                Motion::Pose { .. } => gated.pose(k).map(|pose| {
                    twist = actuator::PoseChart::from_pose(&pose, twist).twist;
                    Seen::Pose(pose, twist)
                }),
                Motion::Free { twist, extension, outer_diameter, .. } => {
                    let values = [twist[k], extension[k], outer_diameter[k]];
                    values.iter().any(|value| value.is_finite()).then_some(Seen::Free(values))
                }
            })
            .collect();
        repairs.missing = seen.iter().filter(|seen| seen.is_none()).count();
        (
            Track {
                name: recording.name.clone(),
                time: recording.time.clone(),
                command,
                reading,
                read,
                seen,
                frees,
            },
            repairs,
        )
    }

    /// Seconds from the sample before; zero at the first.
    pub fn step(&self, sample: usize) -> f64 {
        if sample == 0 { 0.0 } else { self.time[sample] - self.time[sample - 1] }
    }

    /// Puts the twists of measured poses on the branch nearest to the base model's.
    pub fn unwrap_by(&mut self, mechanics: &dyn Mechanics, chain: &Chain) {
        let mut response = mechanics.room();
        let drive = if self.reading.is_some() { Drive::Reading } else { Drive::Command };
        let Some(pressures) = self.deforming(chain, drive) else { return };
        for (k, seen) in self.seen.iter_mut().enumerate() {
            if let Some(Seen::Pose(pose, twist)) = seen {
                let at = &pressures[k * self.frees..(k + 1) * self.frees];
                if mechanics.respond(chain, at, &mut response).is_ok() {
                    *twist = actuator::PoseChart::from_pose(pose, response.values[0]).twist;
                }
            }
        }
    }

    /// Pressures (Pa) that the base model is to answer, at every sample, under a chain; `None` when the drive was not recorded.
    pub fn deforming(&self, chain: &Chain, drive: Drive) -> Option<Vec<f64>> {
        let mut state = chain.at_rest(self.frees);
        let mut flat = match drive {
            Drive::Reading => self.reading.clone()?,
            Drive::Command => self.command.clone()?,
        };
        for (k, pressures) in flat.chunks_exact_mut(self.frees).enumerate() {
            let step = self.step(k);
            match drive {
                Drive::Reading => chain.unread_pressures(pressures),
                Drive::Command => chain.supply(&mut state, step, pressures),
            }
            chain.deform(&mut state, step, pressures);
        }
        Some(flat)
    }

    /// Pressure readings (Pa) that the commands lead to under a chain; `None` when commands were not recorded.
    pub fn supplied(&self, chain: &Chain) -> Option<Vec<f64>> {
        let mut state = chain.at_rest(self.frees);
        let mut flat = self.command.clone()?;
        for (k, pressures) in flat.chunks_exact_mut(self.frees).enumerate() {
            chain.supply(&mut state, self.step(k), pressures);
            chain.read_pressures(pressures);
        }
        Some(flat)
    }

    /// Noise of what was seen, in the order of [`Seen::difference`]; `None` where there are too few samples to tell.
    pub fn seen_noise(&self) -> [Option<f64>; OUTPUTS] {
        // Differences to the neighbour turn poses into smooth numbers near zero: x[k-1] - 2 x[k] + x[k+1] is the sum of both differences.
        let apart = |from: usize, to: usize| match (&self.seen[from], &self.seen[to]) {
            (Some(from), Some(to)) => from.difference(to),
            _ => [f64::NAN; OUTPUTS],
        };
        std::array::from_fn(|output| {
            let mut second: Vec<f64> = (1..self.seen.len().saturating_sub(1))
                .map(|k| (apart(k, k - 1)[output] + apart(k, k + 1)[output]).abs())
                .filter(|difference| difference.is_finite())
                .collect();
            (second.len() >= 20).then(|| 1.4826 * median(&mut second) / 6f64.sqrt())
        })
    }

    /// Noise (Pa) of the pressure readings, the mean over the FREEs.
    pub fn reading_noise(&self) -> Option<f64> {
        let reading = self.reading.as_ref()?;
        let each: Vec<f64> = (0..self.frees)
            .filter_map(|free| noise(reading.iter().skip(free).step_by(self.frees).copied()))
            .collect();
        (!each.is_empty()).then(|| each.iter().sum::<f64>() / each.len() as f64)
    }
}
