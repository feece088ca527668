use crate::candidate::{Candidate, Tolerances};
use crate::errors_seen::errors;
use crate::intervals::intervals;
use crate::mechanics::{FreeMechanics, OUTPUTS, Seen};
use crate::objective::{Estimate, Objective, Part};
use crate::report::{Outcome, Series};
use crate::rows::{Arena, Rows, Samples, residuals};
use crate::score::{Gain, block_losses, root_gain};
use crate::setup::Setup;
use crate::track::{Drive, Track};
use crate::verdict::{Errors, Estimated, Finding, FoundEffect, Residual, Stages, Verdict};
use crate::{IdentifyError, Watch};
use record::{Motion, Recording};
use rom::effect::{Chain, EffectKind};
use std::collections::BTreeMap;

/// Parts into which the branches are dealt; each is held out once.
const FOLDS: usize = 4;
/// Fewest points of a segment.
const SEGMENT: usize = 3;
/// A reversal of the pressure by less than this share of its range is no new branch.
const REVERSAL: f64 = 0.15;
/// Resolution of a protractor (rad) and of a dial or rule (m): nothing is known better than that.
const RESOLUTION: [f64; 3] = [0.02, 1e-4, 1e-4];
/// Fewest points with a deformation.
const LEAST: usize = 8;
/// A candidate must take this share of the loss on the points held out...
const SHARE: f64 = 0.15;
/// ... by this many standard errors over the segments: four candidates on six to ten segments.
const SIGNIFICANCE: f64 = 2.0;
/// The base model's own error may be this share of the stroke.
const MODEL_ERROR: f64 = 0.2;
/// Stiffness passes as calibration within this: rubber of a single FREE is seldom measured...
const STIFFNESS: f64 = 0.3;
/// ... and is believed to lie within this (one standard deviation): hardness is given to five Shore, a fifth of the modulus.
const BELIEVED: f64 = 0.1;

/// Cuts a path of pressures into segments: at its turning points, and long branches into pieces of at least [`SEGMENT`] points. Returns the segment of
/// each point, rising.
fn segments(pressures: &[f64]) -> Vec<usize> {
    let (lowest, highest) = pressures.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(*p), h.max(*p)));
    let reversal = REVERSAL * (highest - lowest);
    let mut turns = vec![0];
    let (mut extreme, mut direction) = (0usize, 0.0f64);
    for (k, pressure) in pressures.iter().enumerate() {
        let along = pressure - pressures[extreme];
        if direction == 0.0 {
            if along.abs() > reversal {
                (direction, extreme) = (along.signum(), k);
            }
        } else if along * direction >= 0.0 {
            extreme = k;
        } else if along.abs() > reversal {
            turns.push(extreme + 1);
            (direction, extreme) = (-direction, k);
        }
    }
    turns.push(pressures.len());
    turns.dedup();
    let mut all = Vec::with_capacity(pressures.len());
    let mut next = 0;
    for pair in turns.windows(2) {
        let length = pair[1] - pair[0];
        let pieces = (length / SEGMENT).max(1);
        all.extend((0..length).map(|k| next + k * pieces / length));
        next += pieces;
    }
    all
}

/// The points whose segment is kept.
fn subset<'a>(tracks: &'a [Track], cut: &[Vec<usize>], keep: &dyn Fn(usize) -> bool) -> Samples<'a> {
    let picked: Vec<Vec<usize>> =
        cut.iter().map(|own| (0..own.len()).filter(|k| keep(own[*k])).collect()).collect();
    let blocks = cut.iter().flatten().copied().filter(|segment| keep(*segment)).collect();
    Samples { tracks, picked, blocks }
}

struct FreeStudy<'a> {
    mechanics: &'a FreeMechanics<'a>,
    tracks: &'a [Track],
    cut: Vec<Vec<usize>>,
    sigma: [f64; OUTPUTS],
    arena: Arena,
}

impl FreeStudy<'_> {
    fn estimate(&self, samples: &Samples, setup: &Setup) -> Result<Estimate, IdentifyError> {
        let sigma = Rows { channels: self.sigma.iter().map(|sigma| vec![*sigma; samples.len()]).collect() };
        let parts = vec![Part { arena: self.arena, sigma, discrepancy: None }];
        Ok(Objective { mechanics: self.mechanics, samples, parts }.minimise(setup)?)
    }

    fn all(&self) -> Samples<'_> {
        subset(self.tracks, &self.cut, &|_| true)
    }

    /// Fits on all points from several starts.
    fn whole(&self, starts: &[Setup]) -> Result<Estimate, IdentifyError> {
        self.best(&self.all(), starts)
    }

    fn best(&self, samples: &Samples, starts: &[Setup]) -> Result<Estimate, IdentifyError> {
        let mut best: Option<Estimate> = None;
        for start in starts {
            let estimate = self.estimate(samples, start)?;
            if best.as_ref().is_none_or(|best| estimate.cost < best.cost) {
                best = Some(estimate);
            }
        }
        best.ok_or(IdentifyError::Stopped)
    }

    /// Residuals of every point under the fit that has not seen its part; the memory of effects runs over all points.
    fn held_out(&self, starts: &[Setup]) -> Result<Rows, IdentifyError> {
        let all = self.all();
        let mut rows = Rows { channels: vec![vec![f64::NAN; all.len()]; OUTPUTS] };
        for fold in 0..FOLDS {
            let fit = subset(self.tracks, &self.cut, &|segment| segment % FOLDS != fold);
            let estimate = self.best(&fit, starts)?;
            let own = residuals(self.mechanics, &all, self.arena, &estimate.setup.chain)?;
            for (row, own) in rows.channels.iter_mut().zip(&own.channels) {
                for (k, block) in all.blocks.iter().enumerate() {
                    if block % FOLDS == fold {
                        row[k] = own[k];
                    }
                }
            }
        }
        Ok(rows)
    }

    fn losses(&self, rows: &Rows) -> Vec<Option<f64>> {
        let mut white = rows.clone();
        for (channel, sigma) in white.channels.iter_mut().zip(self.sigma) {
            channel.iter_mut().for_each(|value| *value /= sigma);
        }
        // A channel that is not judged has an infinite sigma: its zeros must not dilute the mean.
        for (channel, sigma) in white.channels.iter_mut().zip(self.sigma) {
            if sigma.is_infinite() {
                channel.fill(f64::NAN);
            }
        }
        block_losses(&[&white], &self.all().blocks)
    }
}

fn root_mean_square(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    (finite.iter().map(|value| value * value).sum::<f64>() / finite.len().max(1) as f64).sqrt()
}

fn prepare(recordings: &[Recording]) -> Result<Vec<Track>, IdentifyError> {
    let mut tracks = Vec::new();
    for recording in recordings {
        if !matches!(recording.motion, Motion::Free { .. }) {
            let (found, expected) = ("poses of a module", "a single FREE");
            return Err(IdentifyError::WrongKind { recording: recording.name.clone(), found, expected });
        }
        let (track, _) = Track::new(recording, 1);
        if track.command.is_none() && track.reading.is_none() {
            return Err(IdentifyError::NoPressure { recording: recording.name.clone(), frees: 1 });
        }
        let found = track.seen.iter().flatten().count();
        if found < LEAST {
            return Err(IdentifyError::NoDeformation {
                recording: recording.name.clone(),
                found,
                least: LEAST,
            });
        }
        tracks.push(track);
    }
    Ok(tracks)
}

/// Finds what a single FREE's base model lacks, from recordings of pressure to twist, length and diameter of few points, loading and unloading.
///
/// There are too few points to hold a whole recording out. The path is cut at its turning points into segments, these are dealt into four
/// parts, and each part is predicted by a fit to the other three (the memory of effects runs over all points in their order). All errors told
/// are of such predictions; the intervals are of the fit to all points. Points are taken as quasi-static: effects of time are not sought.
pub fn identify_free(
    mechanics: &FreeMechanics,
    recordings: &[Recording],
    tolerances: &Tolerances,
    watch: &Watch,
) -> Result<Outcome, IdentifyError> {
    if recordings.is_empty() {
        return Err(IdentifyError::NoRecording { purpose: "fit" });
    }
    let tracks = prepare(recordings)?;
    let drive =
        if tracks.iter().all(|track| track.reading.is_some()) { Drive::Reading } else { Drive::Command };
    let mut cut = Vec::new();
    let mut first = 0;
    let mut greatest = 1e3f64;
    for track in &tracks {
        let Some(pressures) = track.reading.as_ref().or(track.command.as_ref()) else { continue };
        greatest = pressures.iter().copied().fold(greatest, f64::max);
        let own: Vec<usize> = segments(pressures).into_iter().map(|segment| first + segment).collect();
        first = own.last().map_or(first, |last| last + 1);
        cut.push(own);
    }
    let mut findings = vec![format!(
        "{first} segments of {} points, cut at the turning points of the pressure, dealt into {FOLDS} parts; errors held out are of each part \
         predicted by a fit to the others; noise cannot be told from so few points",
        cut.iter().map(Vec::len).sum::<usize>()
    )];
    if recordings.iter().any(|recording| matches!(&recording.motion, Motion::Free { torque, .. } if torque.iter().any(|t| t.abs() > 1e-4))) {
        findings.push("a torque acts on the free end, which the base model of free inflation does not know".into());
    }
    let mut study = FreeStudy {
        mechanics,
        tracks: &tracks,
        cut,
        sigma: [f64::INFINITY; OUTPUTS],
        arena: Arena::Seen(drive),
    };
    let start = Tolerances { stiffness: STIFFNESS, ..*tolerances }.calibration(1, false, false);
    // Quasi-static points tell nothing of a supply.
    let start = match start.calibration(EffectKind::SupplyLag) {
        Some(supply) => start.without_effect(supply),
        None => start,
    };
    let mut start = start;
    start.numbers.iter_mut().for_each(|number| number.prior = Some(BELIEVED));
    study.sigma[..3].copy_from_slice(&RESOLUTION);
    study.leave_out_contradictions(&mut findings)?;
    // The scale of each channel is what the calibrated model leaves of it.
    for _ in 0..2 {
        let calibrated = study.whole(std::slice::from_ref(&start))?;
        let rows = residuals(mechanics, &study.all(), study.arena, &calibrated.setup.chain)?;
        for (k, resolution) in RESOLUTION.into_iter().enumerate() {
            if study.sigma[k].is_finite() {
                study.sigma[k] = root_mean_square(&rows.channels[k]).max(resolution);
            }
        }
    }
    let mut log = Vec::new();
    let found = study.select(&start, greatest, &mut log, watch)?;
    study.outcome(found, findings, log)
}

struct FoundInFree {
    start: Setup,
    starts: Vec<Setup>,
    earned: Vec<(Candidate, Gain)>,
    /// Effects that gained as much as each that was taken.
    alike: Vec<Vec<String>>,
}

impl FreeStudy<'_> {
    /// Leaves out what moves against the model from the start: a sign or a zero that nobody wrote down, not an effect.
    fn leave_out_contradictions(&mut self, findings: &mut Vec<String>) -> Result<(), IdentifyError> {
        let all = self.all();
        let rows = residuals(self.mechanics, &all, self.arena, &Chain::default())?;
        let seen: Vec<[f64; 3]> = self
            .tracks
            .iter()
            .flat_map(|track| &track.seen)
            .map(|seen| match seen {
                Some(Seen::Free(values)) => *values,
                _ => [f64::NAN; 3],
            })
            .collect();
        drop(all);
        for (k, name) in ["twist", "change of length", "outer diameter"].into_iter().enumerate() {
            let pairs: Vec<(f64, f64)> = seen
                .iter()
                .zip(&rows.channels[k])
                .map(|(seen, residual)| (seen[k], seen[k] + residual))
                .filter(|(seen, modelled)| seen.is_finite() && modelled.is_finite())
                .collect();
            if pairs.len() < LEAST {
                self.sigma[k] = f64::INFINITY;
                continue;
            }
            let count = pairs.len() as f64;
            let mean = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>() / count;
            let (seen_mean, modelled_mean) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
            if mean(&|pair| (pair.0 - seen_mean) * (pair.1 - modelled_mean)) < 0.0 {
                self.sigma[k] = f64::INFINITY;
                findings.push(format!(
                    "the {name} moves against the model from the start: its sign or zero is in doubt, it is not fitted nor judged on"
                ));
            }
        }
        Ok(())
    }

    fn select(
        &self,
        start: &Setup,
        greatest: f64,
        log: &mut Vec<String>,
        watch: &Watch,
    ) -> Result<FoundInFree, IdentifyError> {
        let mut memory = Candidate::memory(1, greatest);
        memory.retain(|candidate| matches!(candidate.kind, EffectKind::Hysteresis | EffectKind::Mullins));
        let still = [EffectKind::WindingAngle, EffectKind::PressureBias];
        let candidates: Vec<Candidate> =
            memory.into_iter().chain(still.map(|kind| Candidate::alone(kind, &[0]))).collect();
        let mut found = FoundInFree {
            start: start.clone(),
            starts: vec![start.clone()],
            earned: Vec::new(),
            alike: Vec::new(),
        };
        while found.earned.len() < candidates.len() {
            watch.check()?;
            let before = self.losses(&self.held_out(&found.starts)?);
            let mut tried = Vec::new();
            for candidate in &candidates {
                if candidate.is_in(&found.starts[0]) {
                    continue;
                }
                let settled = self.whole(&found.starts)?.setup;
                let joined: Vec<Setup> =
                    candidate.starts.iter().map(|start| candidate.join(&settled, start)).collect();
                let gain = root_gain(&before, &self.losses(&self.held_out(&joined)?));
                let line = format!(
                    "{} takes away {:.1} % of the held-out loss (t = {:.1})",
                    candidate.title(1),
                    100.0 * gain.share,
                    gain.t
                );
                watch.tell(&line);
                log.push(line);
                tried.push((candidate.clone(), joined, gain));
            }
            let earning = |gain: &Gain| gain.share >= SHARE && gain.t >= SIGNIFICANCE;
            let Some(best) = tried
                .iter()
                .filter(|(_, _, gain)| earning(gain))
                .max_by(|a, b| a.2.share.total_cmp(&b.2.share))
                .cloned()
            else {
                break;
            };
            // Few points: what gains nearly as much is not told apart.
            let alike = tried
                .iter()
                .filter(|(candidate, _, gain)| {
                    candidate.kind != best.0.kind && gain.share > 0.8 * best.2.share
                })
                .map(|(candidate, ..)| candidate.title(1))
                .collect();
            found.alike.push(alike);
            found.starts = best.1;
            found.earned.push((best.0, best.2));
        }
        Ok(found)
    }

    fn outcome(
        &self,
        found: FoundInFree,
        mut findings: Vec<String>,
        log: Vec<String>,
    ) -> Result<Outcome, IdentifyError> {
        let all = self.all();
        let diameter = self.mechanics.outer_diameter();
        let untuned = residuals(self.mechanics, &all, self.arena, &Chain::default())?;
        let calibrated = self.held_out(std::slice::from_ref(&found.start))?;
        let after = self.held_out(&found.starts)?;
        let calibration = self.whole(std::slice::from_ref(&found.start))?;
        let whole = self.whole(&found.starts)?;
        let mut numbers = BTreeMap::new();
        let mut effects: Vec<FoundEffect> = found
            .earned
            .iter()
            .zip(&found.alike)
            .map(|((candidate, gain), alike)| FoundEffect {
                name: candidate.kind.name().into(),
                link: candidate.kind.link(),
                frees: vec![1],
                parameters: BTreeMap::new(),
                indistinguishable_from: alike.clone(),
                gain_held_out: gain.share,
            })
            .collect();
        let mut at_a_bound = false;
        for (effect, value, estimated) in intervals(&whole.setup, &whole.covariance) {
            let kind = whole.setup.chain.effects[effect].kind;
            let parameter = kind.parameters()[value];
            if [parameter.lower, parameter.upper].contains(&whole.setup.chain.effects[effect].values[value]) {
                at_a_bound = true;
                findings.push(format!(
                    "{} of {} ended at its bound: it stands for something that the base model has otherwise",
                    parameter.name,
                    kind.name()
                ));
            }
            match effects.iter_mut().find(|found| found.name == kind.name()) {
                Some(found) => {
                    found.parameters.insert(kind.parameters()[value].name.into(), estimated);
                }
                None => {
                    let Estimated { value, ci95 } = estimated;
                    let scale = Estimated { value: 1.0 + value, ci95: ci95.map(|end| 1.0 + end) };
                    numbers.insert("stiffness_scale".to_owned(), scale);
                }
            }
        }
        let (left, words) = self.left(&after);
        // An effect driven to the end of what it can be is a name for something else.
        let verdict = match (left <= MODEL_ERROR && !at_a_bound, effects.is_empty()) {
            (false, _) => Finding::Unexplained,
            (true, true) => Finding::NothingMissing,
            (true, false) => Finding::Explained,
        };
        let stages = Stages {
            before: errors(&untuned, false, diameter),
            calibrated: errors(&calibrated, false, diameter),
            after: errors(&after, false, diameter),
            noise: Errors::default(),
        };
        let by_reading = self.arena == Arena::Seen(Drive::Reading);
        let next = if effects.iter().any(|effect| !effect.indistinguishable_from.is_empty()) {
            "vent to the atmosphere and read the sensor, then run minor loops at two mean pressures: that tells memory from a wrong zero"
        } else {
            "load with two known torques at one pressure: free inflation cannot split modulus, wall, coating and pressure gain"
        };
        let before = residuals(self.mechanics, &all, self.arena, &calibration.setup.chain)?;
        let final_rows = residuals(self.mechanics, &all, self.arena, &whole.setup.chain)?;
        Ok(Outcome {
            verdict: Verdict {
                verdict,
                effects,
                calibration: numbers,
                held_out: by_reading.then_some(stages),
                held_out_from_command: (!by_reading).then_some(stages),
                residual_after: Residual { white: false, structure: words },
                next_experiment: next.into(),
                findings,
                seconds: 0.0,
            },
            chain: whole.setup.chain,
            series: self.series(&before, &final_rows),
            log,
        })
    }

    /// Share of the stroke that is left, the worst channel's, and what it goes with.
    fn left(&self, rows: &Rows) -> (f64, String) {
        let mut worst = 0.0f64;
        let mut words = Vec::new();
        for (k, name) in ["twist", "change of length", "outer diameter"].into_iter().enumerate() {
            if self.sigma[k].is_infinite() {
                continue;
            }
            let seen: Vec<f64> = self
                .tracks
                .iter()
                .flat_map(|track| &track.seen)
                .map(|seen| if let Some(Seen::Free(values)) = seen { values[k] } else { f64::NAN })
                .collect();
            let stroke =
                seen.iter().copied().filter(|v| v.is_finite()).fold(0.0, |most, v| v.abs().max(most));
            let share = root_mean_square(&rows.channels[k]) / stroke.max(f64::MIN_POSITIVE);
            words.push(format!("{:.1} % of the greatest {name}", 100.0 * share));
            worst = worst.max(share);
        }
        (worst, format!("{} is left on points held out", words.join(" and ")))
    }

    fn series(&self, before: &Rows, after: &Rows) -> Vec<Series> {
        let mut first = 0;
        let mut all = Vec::new();
        for track in self.tracks {
            let count = track.time.len();
            let Some(flat) = track.reading.as_ref().or(track.command.as_ref()) else { continue };
            let part = |rows: &Rows| -> Vec<Vec<f64>> {
                rows.channels.iter().take(3).map(|channel| channel[first..first + count].to_vec()).collect()
            };
            let rate = |k: usize| match k {
                0 => 0.0,
                _ => (flat[k] - flat[k - 1]) / (track.time[k] - track.time[k - 1]),
            };
            all.push(Series {
                name: track.name.clone(),
                is_held_out: false,
                time: track.time.clone(),
                pressures: vec![flat.clone()],
                rates: vec![(0..count).map(rate).collect()],
                before: part(before),
                after: part(after),
            });
            first += count;
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_cut_at_its_turning_points_and_small_reversals_are_none() {
        let up: Vec<f64> = (0..7).map(f64::from).collect();
        let path: Vec<f64> = up.iter().copied().chain([5.0, 5.3, 4.0, 3.0, 2.0, 0.0]).collect();
        let cut = segments(&path);
        // Seven up make two pieces, six down two more.
        assert_eq!(cut, [0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3]);
    }

    #[test]
    fn no_point_is_fitted_and_held_out_at_once() {
        let cut = vec![vec![0, 0, 1, 1, 2, 3, 4, 4]];
        let tracks: Vec<Track> = Vec::new();
        let mut times = [0; 8];
        for fold in 0..FOLDS {
            let fit = subset(&tracks, &cut, &|segment| segment % FOLDS != fold);
            let held = subset(&tracks, &cut, &|segment| segment % FOLDS == fold);
            assert!(held.picked[0].iter().all(|k| !fit.picked[0].contains(k)));
            held.picked[0].iter().for_each(|k| times[*k] += 1);
        }
        assert_eq!(times, [1; 8], "each point is held out once");
    }
}
