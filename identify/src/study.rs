use crate::candidate::Candidate;
use crate::discrepancy::Discrepancy;
use crate::mechanics::{Mechanics, OUTPUTS};
use crate::objective::{Estimate, Objective, Part};
use crate::rows::{Arena, Rows, Samples, row_noise};
use crate::score::{Gain, block_losses, channel_losses, gain};
use crate::setup::Setup;
use crate::track::{Drive, median};
use crate::{IdentifyError, Watch};
use rayon::prelude::*;
use rom::effect::{Effect, EffectKind, Link};

/// The data of an identification and what is known of their noise.
pub struct Study<'a> {
    /// The base model.
    pub mechanics: &'a dyn Mechanics,
    /// Samples that are fitted.
    pub fit: &'a Samples<'a>,
    /// Samples that are judged on and never fitted.
    pub held_out: &'a Samples<'a>,
    /// Noise of what is seen (m, rad).
    pub seen_noise: [f64; OUTPUTS],
    /// Noise of a pressure reading, Pa.
    pub reading_noise: f64,
    /// What drives the model.
    pub drive: Drive,
    /// Whether both command and reading were recorded, so that the supply can be judged on its own.
    pub has_supply: bool,
    /// Greatest pressure (Pa), scale of discrepancies.
    pub greatest: f64,
    /// Progress and stop.
    pub watch: &'a Watch<'a>,
}

/// A family of effects that is searched together, and what it is judged on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Supply effects, on the pressure read given the command.
    Supply,
    /// Effects with memory, on the deformation beside a free smooth function of the pressures.
    Memory,
    /// Effects without memory, on the deformation; what they gain must stand out from the base model's own error.
    Still,
}

/// What a candidate must earn on held-out recordings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// Least share of the loss that must go.
    pub share: f64,
    /// Least mean gain of a block over its standard error.
    pub t: f64,
}

impl Phase {
    /// What a candidate must earn. About 25 candidates are tried: t = 3.5 leaves one chance in a hundred that any of them passes by luck (normal
    /// tail 2.3e-4 each, less by the share). A still effect can be mimicked by the base model's own smooth error, which moves with the
    /// pressures as it does: on the rig `practice-null`, where nothing is missing, none took more than 3 % of the held-out loss of a model
    /// made in another way; a still effect must take
    /// three times that, which leaves less to luck (t = 2.5). Memory and lag cannot be mimicked so.
    pub fn threshold(self) -> Threshold {
        match self {
            Phase::Supply | Phase::Memory => Threshold { share: 0.05, t: 3.5 },
            Phase::Still => Threshold { share: 0.1, t: 2.5 },
        }
    }
}

/// An effect that earned its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Earned {
    /// The effect.
    pub candidate: Candidate,
    /// What it earned on held-out samples.
    pub gain: Gain,
    /// The phase in which it did.
    pub phase: Phase,
}

/// A phase in work: its parts on both sample sets.
pub struct Search<'a> {
    study: &'a Study<'a>,
    phase: Phase,
    fit: Objective<'a>,
    held_out: Objective<'a>,
    discrepancies: Option<&'a [Discrepancy; 2]>,
}

/// The discrepancies of a study: over the fit samples and over the held-out ones.
pub fn discrepancies(study: &Study) -> [Discrepancy; 2] {
    let frees = study.mechanics.frees();
    [study.fit, study.held_out].map(|samples| Discrepancy::new(&samples.drives(), frees, study.greatest))
}

impl<'a> Search<'a> {
    /// Prepares a phase around a calibrated setup: the scale of each channel is the noise and what the calibrated model leaves of it.
    pub fn new(
        study: &'a Study<'a>,
        phase: Phase,
        setup: &Setup,
        discrepancies: Option<&'a [Discrepancy; 2]>,
    ) -> Result<Self, IdentifyError> {
        let arenas: &[Arena] = match phase {
            Phase::Supply => &[Arena::Supplied],
            Phase::Memory => &[Arena::Seen(study.drive)],
            Phase::Still if study.has_supply => &[Arena::Seen(study.drive), Arena::Supplied],
            Phase::Still => &[Arena::Seen(study.drive)],
        };
        let objective =
            |samples: &'a Samples<'a>, discrepancy: Option<&'a Discrepancy>| -> Result<_, IdentifyError> {
                let mut parts = Vec::new();
                for arena in arenas {
                    let (seen, reading) = (study.seen_noise, study.reading_noise);
                    let sigma = row_noise(study.mechanics, samples, *arena, &setup.chain, seen, reading)?;
                    parts.push(Part { arena: *arena, sigma, discrepancy });
                }
                Ok(Objective { mechanics: study.mechanics, samples, parts })
            };
        let mut search = Search {
            study,
            phase,
            fit: objective(study.fit, discrepancies.map(|both| &both[0]))?,
            held_out: objective(study.held_out, discrepancies.map(|both| &both[1]))?,
            discrepancies,
        };
        search.widen(setup)?;
        Ok(search)
    }

    /// Adds the model's own error to the scales, channel by channel: twice, because the first calibration is done with the wrong scales. The error of a
    /// deformation grows with the deformation: at rest every model is right, and what is wrong there is a load or a frame.
    fn widen(&mut self, setup: &Setup) -> Result<(), IdentifyError> {
        let noise: Vec<Rows> = self.fit.parts.iter().map(|part| part.sigma.clone()).collect();
        let held_noise: Vec<Rows> = self.held_out.parts.iter().map(|part| part.sigma.clone()).collect();
        let (inflated, held_inflated) = (self.inflation(self.study.fit), self.inflation(self.study.held_out));
        let mut setup = self.own(setup);
        for _ in 0..2 {
            setup = self.fit.minimise(&setup)?.setup;
            let whitened = self.fit.whitened(&setup)?;
            for (part, rows) in whitened.rows.iter().enumerate() {
                let grows = self.fit.parts[part].arena != Arena::Supplied;
                for (channel, values) in rows.channels.iter().enumerate() {
                    let sigma = &self.fit.parts[part].sigma.channels[channel];
                    let noises = &noise[part].channels[channel];
                    let growth = |inflated: f64| if grows { inflated } else { 1.0 };
                    // Below a quarter of the range noise hides how the error grows.
                    let (mut sizes, mut own): (Vec<f64>, Vec<f64>) = (0..values.len())
                        .filter(|k| values[*k].is_finite() && growth(inflated[*k]) > 0.25)
                        .map(|k| {
                            let growth = growth(inflated[k]);
                            ((values[k] * sigma[k]).abs() / growth, noises[k] / growth)
                        })
                        .unzip();
                    let error = ((1.4826 * median(&mut sizes)).powi(2) - median(&mut own).powi(2)).max(0.0);
                    let wide = |noise: &Rows, inflated: &[f64], sigma: &mut Rows| {
                        let noise = &noise.channels[channel];
                        for ((sigma, noise), inflated) in
                            sigma.channels[channel].iter_mut().zip(noise).zip(inflated)
                        {
                            *sigma = (noise * noise + error * growth(*inflated).powi(2)).sqrt();
                        }
                    };
                    wide(&noise[part], &inflated, &mut self.fit.parts[part].sigma);
                    wide(&held_noise[part], &held_inflated, &mut self.held_out.parts[part].sigma);
                }
            }
        }
        Ok(())
    }

    /// How far each sample is inflated: root of the summed squares of its pressures over the greatest pressure.
    fn inflation(&self, samples: &Samples) -> Vec<f64> {
        let drives = samples.drives();
        let of =
            |pressures: &[f64]| pressures.iter().map(|p| p * p).sum::<f64>().sqrt() / self.study.greatest;
        drives.chunks(samples.frees().max(1)).map(of).collect()
    }

    /// The setup with only the numbers that this phase estimates.
    pub fn own(&self, setup: &Setup) -> Setup {
        let supply_apart = self.study.has_supply;
        match self.phase {
            Phase::Supply => setup.holding(|effect| effect.kind.link() != Link::Supply),
            Phase::Memory => setup.holding(|effect| supply_apart && effect.kind.link() == Link::Supply),
            Phase::Still => {
                setup.holding(|effect| effect.kind.has_memory() || effect.kind.link() == Link::Supply)
            }
        }
    }

    /// Fits the numbers of this phase.
    pub fn estimate(&self, setup: &Setup) -> Result<Estimate, IdentifyError> {
        Ok(self.fit.minimise(&self.own(setup))?)
    }

    /// The setup with the values of an estimate.
    pub fn settled(setup: &Setup, estimate: &Estimate) -> Setup {
        Setup { chain: estimate.setup.chain.clone(), numbers: setup.numbers.clone() }
    }

    /// Losses of the held-out blocks under a setup that was fitted in this phase; `parts` chooses what is judged on.
    pub fn losses(&self, setup: &Setup, parts: &[usize]) -> Result<Vec<Option<f64>>, IdentifyError> {
        let rows = self.judged(setup, parts)?;
        Ok(block_losses(&rows.iter().collect::<Vec<_>>(), &self.study.held_out.blocks))
    }

    /// Whitened residuals of the held-out samples under a setup that was fitted in this phase.
    fn judged(&self, setup: &Setup, parts: &[usize]) -> Result<Vec<Rows>, IdentifyError> {
        let still = Setup { chain: setup.chain.clone(), numbers: Vec::new() };
        let mut rows = Vec::new();
        let fitted = if self.discrepancies.is_some() { Some(self.fit.whitened(&still)?) } else { None };
        for part in parts {
            let Part { arena, sigma, .. } = &self.held_out.parts[*part];
            let mut own =
                crate::rows::residuals(self.study.mechanics, self.study.held_out, *arena, &still.chain)?;
            for (channel, sigma) in own.channels.iter_mut().zip(&sigma.channels) {
                channel.iter_mut().zip(sigma).for_each(|(value, sigma)| *value /= sigma);
            }
            if let (Some(fitted), Some(both)) = (&fitted, self.discrepancies)
                && let Some(coefficients) = &fitted.discrepancies[*part]
            {
                both[1].apply(coefficients, &mut own);
            }
            rows.push(own);
        }
        Ok(rows)
    }

    /// The gain on the channel that gains most: a weight shows in the height alone where the calibration takes up the rest.
    fn best_channel(&self, before: &Setup, after: &Setup, parts: &[usize]) -> Result<Gain, IdentifyError> {
        let of = |setup| {
            Ok::<_, IdentifyError>(channel_losses(&self.judged(setup, parts)?, &self.study.held_out.blocks))
        };
        let gains = of(before)?
            .iter()
            .zip(&of(after)?)
            .map(|(before, after)| gain(before, after))
            .collect::<Vec<_>>();
        let none = Gain { share: 0.0, loss: 0.0, t: 0.0, blocks: 0 };
        Ok(gains.into_iter().max_by(|a, b| a.share.total_cmp(&b.share)).unwrap_or(none))
    }

    /// What a candidate is judged on: a sensor's bias on both what is seen and what is read, everything else in this phase on what is seen.
    fn judged_on(&self, candidate: &Candidate) -> Vec<usize> {
        match self.phase {
            Phase::Still if candidate.kind != EffectKind::PressureBias => vec![0],
            _ => (0..self.held_out.parts.len()).collect(),
        }
    }

    /// Fits a candidate from each of its starts and keeps the best on the *fit* samples.
    fn join(&self, setup: &Setup, candidate: &Candidate) -> Result<Setup, IdentifyError> {
        let mut best: Option<(f64, Setup)> = None;
        for start in &candidate.starts {
            let joined = candidate.join(setup, start);
            let estimate = self.estimate(&joined)?;
            if best.as_ref().is_none_or(|(cost, _)| estimate.cost < *cost) {
                best = Some((estimate.cost, Self::settled(&joined, &estimate)));
            }
        }
        best.map(|(_, setup)| setup).ok_or(IdentifyError::Stopped)
    }

    /// Adds effects one after the other while any of them earns its place on the held-out samples, then takes away those that no longer do.
    pub fn select(
        &self,
        start: &Setup,
        candidates: &[Candidate],
    ) -> Result<(Setup, Vec<Earned>), IdentifyError> {
        let frees = self.study.mechanics.frees();
        let mut setup = Self::settled(start, &self.estimate(start)?);
        let mut earned: Vec<Earned> = Vec::new();
        // More effects than this at once cannot be told apart in recordings of one actuator.
        const MOST: usize = 5;
        let all: Vec<usize> = (0..self.held_out.parts.len()).collect();
        while earned.len() < MOST {
            self.study.watch.check()?;
            let tried: Vec<(Candidate, Setup, Gain, bool)> = candidates
                .par_iter()
                .filter(|candidate| !candidate.is_in(&setup))
                .map(|candidate| {
                    self.study.watch.check()?;
                    let joined = self.join(&setup, candidate)?;
                    let parts = self.judged_on(candidate);
                    let own = gain(&self.losses(&setup, &parts)?, &self.losses(&joined, &parts)?);
                    // Candidates that are judged on different residuals are ranked by what they take from all of them.
                    let best = self.best_channel(&setup, &joined, &parts)?;
                    let whole = gain(&self.losses(&setup, &all)?, &self.losses(&joined, &all)?);
                    let earns = self.earns(candidate, own, best) && !self.is_noise_filter(candidate, &joined);
                    Ok((candidate.clone(), joined, Gain { loss: whole.loss, ..own }, earns))
                })
                .collect::<Result<_, IdentifyError>>()?;
            for (candidate, _, gain, _) in &tried {
                let line = format!(
                    "{:?}: {} takes away {:.1} % of the held-out loss (t = {:.1})",
                    self.phase,
                    candidate.title(frees),
                    100.0 * gain.share,
                    gain.t
                );
                self.study.watch.tell(&line);
            }
            let best = tried
                .into_iter()
                .filter(|(_, _, _, earns)| *earns)
                .max_by(|a, b| a.2.loss.total_cmp(&b.2.loss));
            let Some((candidate, joined, gain, _)) = best else { break };
            setup = joined;
            earned.push(Earned { candidate, gain, phase: self.phase });
        }
        self.prune(start, setup, earned)
    }

    /// Whether a hysteresis is so narrow that it acts on the noise of the pressure reading: a play of that width smooths the reading, which predicts a
    /// little better and says nothing of the rubber.
    fn is_noise_filter(&self, candidate: &Candidate, setup: &Setup) -> bool {
        // Noise stays within three standard deviations.
        let least = 3.0 * self.study.reading_noise;
        let of_candidate =
            |effect: &&Effect| effect.kind == candidate.kind && effect.frees == candidate.frees;
        self.study.drive == Drive::Reading
            && candidate.kind == EffectKind::Hysteresis
            && setup.chain.effects.iter().find(of_candidate).is_some_and(|effect| effect.values[0] < least)
    }

    /// Whether a candidate earns its place: by what it takes from all channels, or, without memory, by what it takes from the channel that gains most.
    /// A frame must earn it by all channels: its six numbers would take up whatever one channel leaves.
    fn earns(&self, candidate: &Candidate, all: Gain, best: Gain) -> bool {
        // On the rig `practice-null` no candidate took more than 14 % of any channel of a model made in another way.
        const CHANNEL: Threshold = Threshold { share: 0.3, t: 3.5 };
        let passes = |gain: Gain, least: Threshold| gain.share >= least.share && gain.t >= least.t;
        let is_frame = matches!(candidate.kind, EffectKind::BaseFrame | EffectKind::MarkerFrame);
        let channel = self.phase == Phase::Still && !is_frame && passes(best, CHANNEL);
        channel || passes(all, self.phase.threshold())
    }

    fn prune(
        &self,
        start: &Setup,
        mut setup: Setup,
        mut earned: Vec<Earned>,
    ) -> Result<(Setup, Vec<Earned>), IdentifyError> {
        while earned.len() > 1 {
            let mut weakest: Option<(usize, Setup, Gain)> = None;
            for index in 0..earned.len() {
                self.study.watch.check()?;
                let mut without = start.clone();
                for (other, earned) in earned.iter().enumerate() {
                    if other != index {
                        let effect = setup.chain.effects.iter().find(|effect| {
                            effect.kind == earned.candidate.kind && effect.frees == earned.candidate.frees
                        });
                        let start = effect.map_or(&earned.candidate.starts[0], |effect| &effect.values);
                        without = earned.candidate.join(&without, start);
                    }
                }
                let without = Self::settled(&without, &self.estimate(&without)?);
                let parts = self.judged_on(&earned[index].candidate);
                let gain = gain(&self.losses(&without, &parts)?, &self.losses(&setup, &parts)?);
                let best = self.best_channel(&without, &setup, &parts)?;
                let earns = self.earns(&earned[index].candidate, gain, best);
                earned[index].gain = gain;
                if !earns && weakest.as_ref().is_none_or(|(_, _, least)| gain.share < least.share) {
                    weakest = Some((index, without, gain));
                }
            }
            match weakest {
                Some((index, without, _)) => {
                    earned.remove(index);
                    setup = without;
                }
                None => break,
            }
        }
        Ok((setup, earned))
    }

    /// Which candidates could have left the traces of an effect: those whose sensitivities, with the calibration free, reproduce more than
    /// `alike` (a cosine) of what the effect does to the fit samples.
    pub fn confusions(
        &self,
        setup: &Setup,
        earned: &Earned,
        candidates: &[Candidate],
        alike: f64,
    ) -> Result<Vec<(String, f64)>, IdentifyError> {
        let Some(index) = setup.chain.effects.iter().position(|effect| {
            effect.kind == earned.candidate.kind && effect.frees == earned.candidate.frees
        }) else {
            return Ok(Vec::new());
        };
        let mut absent = setup.clone();
        for (value, parameter) in
            absent.chain.effects[index].values.iter_mut().zip(earned.candidate.parameters())
        {
            *value = parameter.neutral;
        }
        let flat = |rows: &[Rows]| -> Vec<f64> {
            let all = rows.iter().flat_map(|rows| rows.channels.iter().flatten());
            all.map(|value| if value.is_finite() { *value } else { 0.0 }).collect()
        };
        let (with, without) = (self.fit.whitened(setup)?, self.fit.whitened(&absent)?);
        let mut trace: Vec<f64> =
            flat(&without.rows).iter().zip(flat(&with.rows)).map(|(without, with)| without - with).collect();
        let rest = absent.without_effect(index);
        let calibration = self.own(&rest);
        let nuisance: Vec<Vec<f64>> = self.columns(&calibration)?;
        let nuisance = orthonormal(nuisance, &[]);
        take_out(&nuisance, &mut trace);
        let size = norm(&trace);
        if size == 0.0 {
            return Ok(Vec::new());
        }
        let frees = self.study.mechanics.frees();
        let mut found = Vec::new();
        for candidate in candidates.iter().filter(|candidate| !candidate.is_in(setup)) {
            self.study.watch.check()?;
            let mut best = 0.0f64;
            for start in &candidate.starts {
                let joined = candidate.join(&rest, start);
                let kind = candidate.kind;
                let only = self
                    .own(&joined.holding(|effect| effect.kind != kind || effect.frees != candidate.frees));
                let mut columns = self.columns(&only)?;
                // What the whole step from absence to its start does belongs to a candidate's span too.
                let there = flat(&self.fit.whitened(&joined)?.rows);
                let here = flat(&self.fit.whitened(&rest)?.rows);
                columns.push(there.iter().zip(here).map(|(there, here)| there - here).collect());
                let span = orthonormal(columns, &nuisance);
                let inside: f64 = span.iter().map(|axis| dot(axis, &trace).powi(2)).sum();
                best = best.max(inside.sqrt() / size);
            }
            if best >= alike {
                found.push((candidate.title(frees), best));
            }
        }
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(found)
    }

    fn columns(&self, setup: &Setup) -> Result<Vec<Vec<f64>>, IdentifyError> {
        let mut flat = vec![Vec::new(); setup.numbers.len()];
        for columns in self.fit.whitened_columns(setup)? {
            for (flat, column) in flat.iter_mut().zip(&columns) {
                let values = column.channels.iter().flatten();
                flat.extend(values.map(|value| if value.is_finite() { *value } else { 0.0 }));
            }
        }
        Ok(flat)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn take_out(axes: &[Vec<f64>], vector: &mut [f64]) {
    for axis in axes {
        let along = dot(axis, vector);
        vector.iter_mut().zip(axis).for_each(|(value, axis)| *value -= along * axis);
    }
}

/// Orthonormal basis of what vectors span beyond given axes (modified Gram-Schmidt, twice for accuracy); directions lost to rounding are dropped.
fn orthonormal(vectors: Vec<Vec<f64>>, beyond: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut axes: Vec<Vec<f64>> = Vec::new();
    for mut vector in vectors {
        let before = norm(&vector);
        for _ in 0..2 {
            take_out(beyond, &mut vector);
            take_out(&axes, &mut vector);
        }
        let after = norm(&vector);
        if after > 1e-6 * before {
            vector.iter_mut().for_each(|value| *value /= after);
            axes.push(vector);
        }
    }
    axes
}
