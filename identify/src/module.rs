use crate::candidate::{Candidate, Tolerances};
use crate::discrepancy::Discrepancy;
use crate::errors_seen::errors;
use crate::intervals::intervals;
use crate::mechanics::{Mechanics, ModuleMechanics, OUTPUTS};
use crate::report::{Outcome, Series};
use crate::rows::{Arena, Rows, Samples, residuals, row_noise};
use crate::setup::Setup;
use crate::structure::{Circumstance, Features, is_white, shares};
use crate::study::{Earned, Phase, Search, Study, discrepancies};
use crate::track::{Drive, Track, median};
use crate::verdict::{Errors, Estimated, Finding, FoundEffect, Residual, Stages, Verdict};
use crate::{IdentifyError, Watch};
use actuator::MapParameter;
use record::{Motion, Recording};
use rom::effect::{Chain, EffectKind};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Settings of an identification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Tolerances of the base model's own numbers.
    pub tolerances: Tolerances,
    /// Samples fitted, about.
    pub fit_samples: usize,
    /// Samples judged on, about.
    pub held_out_samples: usize,
    /// Length of a block, s: at least as long as residuals stay alike.
    pub block: f64,
}

impl Default for Options {
    fn default() -> Self {
        Options { tolerances: Tolerances::default(), fit_samples: 1500, held_out_samples: 1500, block: 5.0 }
    }
}

/// Candidates whose traces are this much alike (cosine, with the calibration free) are not told apart.
const ALIKE: f64 = 0.95;

fn prepare(
    recordings: &[Recording],
    frees: usize,
    findings: &mut Vec<String>,
) -> Result<Vec<Track>, IdentifyError> {
    let mut tracks = Vec::new();
    for recording in recordings {
        if !matches!(recording.motion, Motion::Pose { .. }) {
            let (found, expected) = ("the twist and length of a single FREE", "a module");
            return Err(IdentifyError::WrongKind { recording: recording.name.clone(), found, expected });
        }
        let (track, repairs) = Track::new(recording, frees);
        if track.command.is_none() && track.reading.is_none() {
            return Err(IdentifyError::NoPressure { recording: recording.name.clone(), frees });
        }
        let found = track.seen.iter().flatten().count();
        const LEAST: usize = 100;
        if found < LEAST {
            let recording = recording.name.clone();
            return Err(IdentifyError::NoDeformation { recording, found, least: LEAST });
        }
        if repairs != Default::default() {
            findings.push(format!(
                "{}: {} pressure samples filled, {} spikes of the pose gated, {} poses missing",
                track.name, repairs.pressures, repairs.spikes, repairs.missing
            ));
        }
        tracks.push(track);
    }
    Ok(tracks)
}

/// Noise of what is seen and of readings: the median over the recordings.
fn noises(tracks: &[Track]) -> ([f64; OUTPUTS], f64) {
    let each: Vec<_> = tracks.iter().map(Track::seen_noise).collect();
    let seen = std::array::from_fn(|output| {
        let mut known: Vec<f64> = each.iter().filter_map(|noise| noise[output]).collect();
        // A recording without any noise is a simulation; the floor keeps weights finite: a micrometre, a microradian.
        median(&mut known).max(1e-6)
    });
    let mut readings: Vec<f64> = tracks.iter().filter_map(Track::reading_noise).collect();
    (seen, median(&mut readings).max(1.0))
}

/// Finds what a module's base model lacks. `fit` and `held_out` are recordings of the same rig that must not overlap; see the crate's documentation.
pub fn identify_module(
    mechanics: &ModuleMechanics,
    fit: &[Recording],
    held_out: &[Recording],
    options: &Options,
    watch: &Watch,
) -> Result<Outcome, IdentifyError> {
    for (recordings, purpose) in [(fit, "fit"), (held_out, "hold out")] {
        if recordings.is_empty() {
            return Err(IdentifyError::NoRecording { purpose });
        }
    }
    if let Some(both) = held_out.iter().find(|held| fit.iter().any(|fit| fit == *held)) {
        return Err(IdentifyError::Overlap { recording: both.name.clone() });
    }
    let log = Mutex::new(Vec::new());
    let tell = |line: &str| {
        if let Ok(mut log) = log.lock() {
            log.push(line.to_owned());
        }
        watch.tell(line);
    };
    let watch = Watch { tell: &tell, stop: watch.stop };
    let frees = mechanics.frees();
    let mut findings = Vec::new();
    let mut fit_tracks = prepare(fit, frees, &mut findings)?;
    let mut held_tracks = prepare(held_out, frees, &mut findings)?;
    let tracks = || fit_tracks.iter().chain(&held_tracks);
    let has_reading = tracks().all(|track| track.reading.is_some());
    let has_command = tracks().all(|track| track.command.is_some());
    let drive = if has_reading { Drive::Reading } else { Drive::Command };
    if !has_reading && !has_command {
        let recording = fit_tracks[0].name.clone();
        return Err(IdentifyError::NoPressure { recording, frees });
    }
    for track in fit_tracks.iter_mut().chain(&mut held_tracks) {
        track.unwrap_by(mechanics, &Chain::default());
    }
    let (seen_noise, reading_noise) = noises(&fit_tracks);
    let fit = Samples::evenly(&fit_tracks, options.fit_samples, options.block);
    let held = Samples::evenly(&held_tracks, options.held_out_samples, options.block);
    let greatest = fit.drives().into_iter().fold(1e3, f64::max);
    let study = Study {
        mechanics,
        fit: &fit,
        held_out: &held,
        seen_noise,
        reading_noise,
        drive,
        has_supply: has_reading && has_command,
        greatest,
        watch: &watch,
    };
    let found = Found::search(&study, mechanics, &options.tolerances)?;
    let verdict = found.verdict(&study, findings)?;
    let series = series(&study, &found)?;
    let chain = found.setup.chain;
    let log = log.into_inner().unwrap_or_default();
    Ok(Outcome { verdict, chain, series, log })
}

/// What the search came to.
struct Found {
    calibrated: Setup,
    setup: Setup,
    earned: Vec<Earned>,
    /// Names of candidates that could have left the traces of each effect.
    alike: Vec<Vec<String>>,
    /// Numbers with their variances.
    estimates: Vec<(usize, usize, Estimated)>,
}

impl Found {
    fn search(
        study: &Study,
        mechanics: &ModuleMechanics,
        tolerances: &Tolerances,
    ) -> Result<Self, IdentifyError> {
        let frees = mechanics.frees();
        let start = tolerances.calibration(frees, true, mechanics.has(MapParameter::BendingStiffness));
        let supply = Candidate::supply(frees, study.greatest);
        let mut memory = Candidate::memory(frees, study.greatest);
        let still =
            Candidate::still(frees, mechanics.has(MapParameter::Payload), study.drive == Drive::Reading);
        let both = discrepancies(study);
        let constants = [study.fit, study.held_out].map(|samples| Discrepancy::constant(samples.len()));
        let mut setup = start;
        let mut calibrated = setup.clone();
        let mut earned = Vec::new();
        let mut alike = Vec::new();
        let mut estimates = Vec::new();
        let phases: &[Phase] = if study.has_supply {
            &[Phase::Supply, Phase::Memory, Phase::Still]
        } else {
            // Without a reading of the pressure, the supply's memory can only be sought together with the rubber's.
            if study.drive == Drive::Command {
                memory.extend(supply.iter().cloned());
            }
            &[Phase::Memory, Phase::Still]
        };
        for phase in phases {
            let (candidates, beside) = match phase {
                // A constant between command and reading is a zero, of the regulator or of the sensor: no lag.
                Phase::Supply => (&supply, Some(&constants)),
                Phase::Memory => (&memory, Some(&both)),
                Phase::Still => (&still, None),
            };
            let search = Search::new(study, *phase, &setup, beside)?;
            if *phase != Phase::Memory {
                let estimate = search.estimate(&calibrated)?;
                calibrated = Search::settled(&calibrated, &estimate);
            }
            let (selected, new) = search.select(&setup, candidates)?;
            setup = selected;
            let estimate = search.estimate(&setup)?;
            setup = Search::settled(&setup, &estimate);
            // Of the numbers that are estimated in two phases, the last estimate counts.
            for (effect, value, estimated) in intervals(&estimate.setup, &estimate.covariance) {
                let name = |setup: &Setup, effect: usize| setup.chain.effects[effect].clone();
                let known = estimates.iter_mut().find(
                    |(other, at, _): &&mut (rom::effect::Effect, usize, Estimated)| {
                        let own = name(&setup, effect);
                        (other.kind, &other.frees, *at) == (own.kind, &own.frees, value)
                    },
                );
                match known {
                    Some(known) => known.2 = estimated,
                    None => estimates.push((name(&setup, effect), value, estimated)),
                }
            }
            for new in new {
                let like = search.confusions(&setup, &new, candidates, ALIKE)?;
                alike.push(like.into_iter().map(|(title, _)| title).collect());
                earned.push(new);
            }
        }
        let estimates = estimates
            .into_iter()
            .filter_map(|(effect, value, estimated)| {
                let same =
                    |other: &rom::effect::Effect| other.kind == effect.kind && other.frees == effect.frees;
                Some((setup.chain.effects.iter().position(same)?, value, estimated))
            })
            .collect();
        Ok(Found { calibrated, setup, earned, alike, estimates })
    }
}

/// Name and transformation of a calibration number as it is shown: factors instead of changes.
fn calibration_entry(kind: EffectKind, value: usize, estimated: Estimated) -> Option<(String, Estimated)> {
    let factor = |estimated: Estimated| Estimated {
        value: 1.0 + estimated.value,
        ci95: estimated.ci95.map(|end| 1.0 + end),
    };
    match (kind, value) {
        (EffectKind::Stiffness, _) => Some(("stiffness_scale".into(), factor(estimated))),
        (EffectKind::BendingStiffness, _) => Some(("bending_stiffness_scale".into(), factor(estimated))),
        (EffectKind::BendingScale, _) => Some(("bending_scale".into(), factor(estimated))),
        (EffectKind::MarkerFrame, _) => Some((format!("tip_{}", kind.parameters()[value].name), estimated)),
        (EffectKind::SupplyLag, 0) => Some(("supply_time_constant_s".into(), estimated)),
        _ => None,
    }
}

impl Found {
    fn stages(&self, study: &Study, drive: Drive) -> Result<Stages, IdentifyError> {
        let arena = Arena::Seen(drive);
        let of = |chain: &Chain| -> Result<Errors, IdentifyError> {
            Ok(errors(&residuals(study.mechanics, study.held_out, arena, chain)?, true, 1.0))
        };
        let (seen, reading) = (study.seen_noise, study.reading_noise);
        let noise = row_noise(study.mechanics, study.held_out, arena, &self.setup.chain, seen, reading)?;
        Ok(Stages {
            before: of(&Chain::default())?,
            calibrated: of(&self.calibrated.chain)?,
            after: of(&self.setup.chain)?,
            noise: errors(&noise, true, 1.0),
        })
    }

    /// Numbers of the base model that the data drove to the end of their tolerance: their intervals mean nothing.
    fn at_bounds(&self) -> impl Iterator<Item = String> {
        let setup = &self.setup;
        setup.numbers.iter().enumerate().filter_map(|(number, own)| {
            let value = setup.value(number);
            let is_bound = value <= own.lower || value >= own.upper;
            let at_bound = own.is_calibration && is_bound && value != own.parameter.neutral;
            let estimated = Estimated { value: own.parameter.in_unit(value), ci95: [f64::NAN; 2] };
            let kind = setup.chain.effects[own.effect].kind;
            let (name, shown) = calibration_entry(kind, own.values[0], estimated).filter(|_| at_bound)?;
            Some(format!(
                "{name} ended at the bound of its tolerance, {:.3}: the data would take it further, and its interval means nothing",
                shown.value
            ))
        })
    }

    fn verdict(&self, study: &Study, mut findings: Vec<String>) -> Result<Verdict, IdentifyError> {
        findings.extend(self.at_bounds());
        let frees = study.mechanics.frees();
        let left = Left::of(study, &self.setup)?;
        let mut calibration = BTreeMap::new();
        let effects = self.setup.effects();
        for (effect, value, estimated) in &self.estimates {
            if effects.contains(effect) {
                continue;
            }
            let kind = self.setup.chain.effects[*effect].kind;
            calibration.extend(calibration_entry(kind, *value, *estimated));
        }
        let found: Vec<FoundEffect> = self
            .earned
            .iter()
            .zip(&self.alike)
            .map(|(earned, alike)| {
                let kind = earned.candidate.kind;
                let index = effects.iter().find(|index| {
                    let effect = &self.setup.chain.effects[**index];
                    effect.kind == kind && effect.frees == earned.candidate.frees
                });
                let parameters = self
                    .estimates
                    .iter()
                    .filter(|(effect, ..)| Some(effect) == index)
                    .map(|(_, value, estimated)| (kind.parameters()[*value].name.to_owned(), *estimated))
                    .collect();
                FoundEffect {
                    name: kind.name().to_owned(),
                    link: kind.link(),
                    frees: earned.candidate.frees.iter().map(|free| free + 1).collect(),
                    parameters,
                    indistinguishable_from: alike.clone(),
                    gain_held_out: earned.gain.share,
                }
            })
            .collect();
        let verdict = match (left.is_explained(), found.is_empty()) {
            (false, _) => Finding::Unexplained,
            (true, true) => Finding::NothingMissing,
            (true, false) => Finding::Explained,
        };
        let next_experiment = next_experiment(verdict, &found, study, frees);
        let has = |drive| match drive {
            Drive::Reading => study.drive == Drive::Reading,
            Drive::Command => study.has_supply || study.drive == Drive::Command,
        };
        let stages = |drive| if has(drive) { self.stages(study, drive).map(Some) } else { Ok(None) };
        Ok(Verdict {
            verdict,
            effects: found,
            calibration,
            held_out: stages(Drive::Reading)?,
            held_out_from_command: stages(Drive::Command)?,
            residual_after: Residual { white: left.white, structure: left.in_words() },
            next_experiment,
            findings,
            seconds: 0.0,
        })
    }
}

/// What is left of the held-out residual.
struct Left {
    white: bool,
    /// Root mean square over noise of what is no smooth function of the pressures.
    unsteady: f64,
    /// The same of the pressure read given the command.
    supply: f64,
    /// Smooth function of the pressures: its share of the stroke.
    steady: f64,
    shares: Vec<crate::structure::Share>,
}

/// The base model's own error may be this share of the stroke: rods of finite elements tied by spacers leave 5 % on the rig `practice-null`, and more
/// on a softer module, which goes further.
const MODEL_ERROR: f64 = 0.15;
/// What is no smooth function of the pressures may be this many times the noise without a word.
const UNSTEADY: f64 = 1.5;
/// Above that, it is a sign of something missing when this share of it goes with rate, direction, rest or time...
const ORDERLY: f64 = 0.1;
/// ... or, order or not, when it is this many times the noise.
const WILD: f64 = 4.0;
/// What is read of the pressure given the command may be this many times the noise.
const SUPPLY: f64 = 2.0;

impl Left {
    fn of(study: &Study, setup: &Setup) -> Result<Self, IdentifyError> {
        let arena = Arena::Seen(study.drive);
        let whitened = |samples: &Samples| -> Result<(Rows, Rows), IdentifyError> {
            let rows = residuals(study.mechanics, samples, arena, &setup.chain)?;
            let (seen, reading) = (study.seen_noise, study.reading_noise);
            let noise = row_noise(study.mechanics, samples, arena, &setup.chain, seen, reading)?;
            let mut white = rows.clone();
            for (channel, noise) in white.channels.iter_mut().zip(&noise.channels) {
                channel.iter_mut().zip(noise).for_each(|(value, noise)| *value /= noise);
            }
            Ok((rows, white))
        };
        let (_, mut fit) = whitened(study.fit)?;
        let (raw, mut held) = whitened(study.held_out)?;
        let white = is_white(&held, &study.held_out.blocks);
        let [here, there] = discrepancies(study);
        let fitted = here.project(&mut fit, &mut []);
        let before: Vec<Vec<f64>> = held.channels.clone();
        there.apply(&fitted, &mut held);
        // A robust size: outliers are no sign of a missing effect.
        let robust = |rows: &Rows| {
            let mut sizes: Vec<f64> =
                rows.channels.iter().flatten().filter(|v| v.is_finite()).map(|v| v.abs()).collect();
            1.4826 * median(&mut sizes)
        };
        let unsteady = robust(&held);
        // The smooth part, in metres, against the stroke.
        let (mut smooth, mut count) = (0.0, 0usize);
        for (channel, (before, after)) in raw.channels.iter().zip(before.iter().zip(&held.channels)).take(3) {
            for ((value, before), after) in channel.iter().zip(before).zip(after) {
                if value.is_finite() && *before != 0.0 {
                    smooth += (value * (before - after) / before).powi(2);
                    count += 1;
                }
            }
        }
        let stroke = stroke(study.held_out);
        let steady = (3.0 * smooth / count.max(1) as f64).sqrt() / stroke.max(f64::MIN_POSITIVE);
        let supply = if study.has_supply {
            let mut rows = residuals(study.mechanics, study.held_out, Arena::Supplied, &setup.chain)?;
            rows.channels.iter_mut().flatten().for_each(|value| *value /= study.reading_noise);
            robust(&rows)
        } else {
            1.0
        };
        let features = |samples: &Samples| features(samples, study.greatest);
        let shares = shares((&fit, &features(study.fit)), (&held, &features(study.held_out)));
        Ok(Left { white, unsteady, supply, steady, shares })
    }

    fn is_explained(&self) -> bool {
        let orderly = self.shares.iter().any(|share| share.share > ORDERLY);
        let unsteady = self.unsteady > WILD || (self.unsteady > UNSTEADY && orderly);
        !unsteady && self.supply <= SUPPLY && self.steady <= MODEL_ERROR
    }

    fn in_words(&self) -> String {
        let mut words = vec![format!(
            "a smooth function of the pressures of {:.1} % of the stroke (the base model's own error may be {:.0} %); beside it {:.2} times the noise",
            100.0 * self.steady,
            100.0 * MODEL_ERROR,
            self.unsteady
        )];
        if self.supply > SUPPLY {
            words.push(format!("pressure read against command: {:.1} times the noise", self.supply));
        }
        // Less than a twentieth of the mean square is nothing to point at.
        for share in self.shares.iter().filter(|share| share.share > 0.05) {
            words.push(format!("{:.0} % of what is beside it goes with {}", 100.0 * share.share, share.with));
        }
        words.join("; ")
    }
}

/// Root mean square of the positions about their mean, m.
fn stroke(samples: &Samples) -> f64 {
    let mut positions = Vec::new();
    for (track, picked) in samples.tracks.iter().zip(&samples.picked) {
        for k in picked {
            if let Some(crate::Seen::Pose(pose, _)) = &track.seen[*k] {
                positions.push(pose.position);
            }
        }
    }
    let count = positions.len().max(1) as f64;
    let mean = positions.iter().sum::<nalgebra::Vector3<f64>>() / count;
    (positions.iter().map(|position| (position - mean).norm_squared()).sum::<f64>() / count).sqrt()
}

/// Rate (Pa/s) of a track's drive at a sample, FREE by FREE: the slope over half a second around it.
fn rate(track: &Track, flat: &[f64], sample: usize, free: usize) -> f64 {
    const REACH: f64 = 0.25;
    let at = track.time[sample];
    let first = track.time.partition_point(|time| *time < at - REACH);
    let last = track.time.partition_point(|time| *time <= at + REACH).max(1) - 1;
    let span = track.time[last] - track.time[first];
    if span <= 0.0 {
        0.0
    } else {
        (flat[last * track.frees + free] - flat[first * track.frees + free]) / span
    }
}

fn features(samples: &Samples, greatest: f64) -> Features {
    let frees = samples.frees();
    let mut rates = Vec::new();
    let mut circumstances = Vec::new();
    for (track, picked) in samples.tracks.iter().zip(&samples.picked) {
        let Some(flat) = track.reading.as_ref().or(track.command.as_ref()) else { continue };
        let start = track.time.first().copied().unwrap_or(0.0);
        let mut moved = start;
        let mut last = flat[..frees].to_vec();
        let mut next = picked.iter().peekable();
        for k in 0..track.time.len() {
            // One per cent of the greatest pressure is above any noise worth speaking of.
            let now = &flat[k * frees..(k + 1) * frees];
            if now.iter().zip(&last).any(|(now, last)| (now - last).abs() > 0.01 * greatest) {
                moved = track.time[k];
                last.copy_from_slice(now);
            }
            if next.peek() == Some(&&k) {
                next.next();
                rates.extend((0..frees).map(|free| rate(track, flat, k, free)));
                circumstances.push(Circumstance { time: track.time[k] - start, rest: track.time[k] - moved });
            }
        }
    }
    Features::new(&samples.drives(), &rates, &circumstances, frees, greatest)
}

fn next_experiment(verdict: Finding, found: &[FoundEffect], study: &Study, frees: usize) -> String {
    if !study.has_supply {
        return "record the command and the pressure at the module together: only then are the supply's lag and dead band told from the rubber's memory".into();
    }
    let stands = |name: &str| found.iter().any(|effect| effect.name == name);
    let confused = found.iter().find(|effect| !effect.indistinguishable_from.is_empty());
    if let Some(effect) = confused {
        let other = &effect.indistinguishable_from[0];
        return format!(
            "{} and {other} leave the same traces here; {}",
            effect.name,
            separating(&effect.name, other)
        );
    }
    if stands("stiffness") {
        return "measure the force of the module held at fixed length and pressure, or weigh and calliper the tubes: free inflation cannot split modulus, wall, coating, temperature and pressure gain".into();
    }
    if verdict == Finding::Unexplained {
        return format!(
            "repeat one pressure pattern at three rates, with a hold of 200 s and a vent of 200 s, then each of the {frees} FREEs alone: that shows whether what is left goes with rate, time or pattern"
        );
    }
    "none is needed; a recording with a known mass at the plate would narrow the stiffness further".into()
}

/// The experiment that tells two effects apart.
fn separating(one: &str, other: &str) -> String {
    let pair = [one, other];
    let has = |name: &str| pair.iter().any(|own| own.starts_with(name));
    let words = if has("payload") || has("base_frame") {
        "turn the base plate by 90 and 180 degrees: a weight stays in the world's frame, a tilted base turns with it"
    } else if has("creep") || has("mullins") || has("hysteresis") {
        "hold one pressure for 200 s and vent for 200 s, then run minor loops at three rates"
    } else if has("pressure_bias") {
        "vent the FREEs to the atmosphere and read the sensors"
    } else if has("supply_lag") || has("delay") || has("valve_backlash") {
        "record a step and a triangle of small amplitude with the pressure measured at the module"
    } else if has("mismatch") {
        "inflate each FREE alone and opposite pairs together"
    } else {
        "inflate all FREEs, opposite pairs and single FREEs, with and without a known mass"
    };
    words.to_owned()
}

fn series(study: &Study, found: &Found) -> Result<Vec<Series>, IdentifyError> {
    let mut all = Vec::new();
    for (samples, is_held_out) in [(study.fit, false), (study.held_out, true)] {
        let arena = Arena::Seen(study.drive);
        let before = residuals(study.mechanics, samples, arena, &found.calibrated.chain)?;
        let after = residuals(study.mechanics, samples, arena, &found.setup.chain)?;
        let mut first = 0;
        for (track, picked) in samples.tracks.iter().zip(&samples.picked) {
            let Some(flat) = track.reading.as_ref().or(track.command.as_ref()) else { continue };
            let part = |rows: &Rows| -> Vec<Vec<f64>> {
                rows.channels.iter().map(|channel| channel[first..first + picked.len()].to_vec()).collect()
            };
            let each = |value: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
                (0..track.frees).map(|free| picked.iter().map(|k| value(*k, free)).collect()).collect()
            };
            all.push(Series {
                name: track.name.clone(),
                is_held_out,
                time: picked.iter().map(|k| track.time[*k]).collect(),
                pressures: each(&|k, free| flat[k * track.frees + free]),
                rates: each(&|k, free| rate(track, flat, k, free)),
                before: part(&before),
                after: part(&after),
            });
            first += picked.len();
        }
    }
    Ok(all)
}
