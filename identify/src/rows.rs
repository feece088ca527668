use crate::mechanics::{Mechanics, OUTPUTS};
use crate::setup::Setup;
use crate::track::{Drive, Track};
use rom::OutOfDomain;
use rom::effect::{Chain, Link};

/// Which residuals are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arena {
    /// Deformation seen, given a drive.
    Seen(Drive),
    /// Pressure read, given the command.
    Supplied,
}

/// Chosen samples of some recordings.
pub struct Samples<'a> {
    /// The recordings.
    pub tracks: &'a [Track],
    /// Chosen samples of each recording, rising.
    pub picked: Vec<Vec<usize>>,
    /// Block of each chosen sample, in the order track by track.
    pub blocks: Vec<usize>,
}

impl<'a> Samples<'a> {
    /// About `count` samples in even strides, cut into blocks of `block` seconds. Blocks never reach over two recordings.
    pub fn evenly(tracks: &'a [Track], count: usize, block: f64) -> Self {
        let total: usize = tracks.iter().map(|track| track.time.len()).sum();
        let stride = total.div_ceil(count.max(1)).max(1);
        let picked = tracks.iter().map(|track| (0..track.time.len()).step_by(stride).collect()).collect();
        let mut samples = Samples { tracks, picked, blocks: Vec::new() };
        samples.cut(block);
        samples
    }

    fn cut(&mut self, block: f64) {
        self.blocks.clear();
        let mut first = 0;
        for (track, picked) in self.tracks.iter().zip(&self.picked) {
            let start = track.time.first().copied().unwrap_or(0.0);
            let index = |sample: &usize| first + ((track.time[*sample] - start) / block) as usize;
            self.blocks.extend(picked.iter().map(index));
            first = self.blocks.last().map_or(first, |last| last + 1);
        }
    }

    /// Number of chosen samples.
    pub fn len(&self) -> usize {
        self.picked.iter().map(Vec::len).sum()
    }

    /// Number of FREEs.
    pub fn frees(&self) -> usize {
        self.tracks.first().map_or(0, |track| track.frees)
    }

    /// Pressures (Pa) that drive the chosen samples, FREEs fastest.
    pub fn drives(&self) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.len() * self.frees());
        for (track, picked) in self.tracks.iter().zip(&self.picked) {
            let Some(flat) = track.reading.as_ref().or(track.command.as_ref()) else { continue };
            for k in picked {
                all.extend_from_slice(&flat[k * track.frees..(k + 1) * track.frees]);
            }
        }
        all
    }
}

/// Residuals in channels (pose: six; FREE: three of six; supply: one a FREE), each over all chosen samples; NaN = not measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// Channel by channel, sample by sample.
    pub channels: Vec<Vec<f64>>,
}

/// Residuals, and their derivatives with respect to each number of a setup.
pub struct Linearisation {
    /// The residuals.
    pub rows: Rows,
    /// Derivatives, number by number.
    pub columns: Vec<Rows>,
}

/// Residuals under a chain.
pub fn residuals(
    mechanics: &dyn Mechanics,
    samples: &Samples,
    arena: Arena,
    chain: &Chain,
) -> Result<Rows, OutOfDomain> {
    let setup = Setup { chain: chain.clone(), numbers: Vec::new() };
    Ok(linearise(mechanics, samples, arena, &setup)?.rows)
}

/// Residuals under a setup and their derivatives by forward differences: pressures are run anew for each number, the base model is evaluated
/// once a sample and followed along its exact tangent.
pub fn linearise(
    mechanics: &dyn Mechanics,
    samples: &Samples,
    arena: Arena,
    setup: &Setup,
) -> Result<Linearisation, OutOfDomain> {
    // Forward differences in double precision: the root of the rounding error, in units of a change that matters.
    const STEP: f64 = 1e-5;
    let stepped: Vec<(Chain, f64)> = (0..setup.numbers.len())
        .map(|number| {
            let mut other = setup.clone();
            let step = STEP * setup.numbers[number].parameter.scale;
            let value = setup.value(number);
            // At the upper bound the step goes inward.
            let step = if value + step > setup.numbers[number].upper { -step } else { step };
            other.set(number, value + step);
            (other.chain, step)
        })
        .collect();
    let frees = samples.frees();
    let width = match arena {
        Arena::Seen(_) => OUTPUTS,
        Arena::Supplied => frees,
    };
    let empty = Rows { channels: vec![Vec::new(); width] };
    let mut rows = empty.clone();
    let mut columns = vec![empty; stepped.len()];
    let nothing = |rows: &mut Rows| rows.channels.iter_mut().for_each(|channel| channel.push(f64::NAN));
    for (track, picked) in samples.tracks.iter().zip(&samples.picked) {
        match arena {
            Arena::Seen(drive) => {
                let Some(pressures) = track.deforming(&setup.chain, drive) else {
                    for _ in picked {
                        nothing(&mut rows);
                        columns.iter_mut().for_each(nothing);
                    }
                    continue;
                };
                let runs: Vec<Option<Vec<f64>>> = stepped
                    .iter()
                    .zip(&setup.numbers)
                    .map(|((chain, _), number)| {
                        let kind = setup.chain.effects[number.effect].kind;
                        // A supply does not change what follows from the reading, nor a sensor what follows from the command.
                        let concerned = match drive {
                            Drive::Reading => kind.link() != Link::Supply,
                            Drive::Command => kind.link() != Link::Sensing,
                        };
                        (kind.acts_on_pressure() && concerned)
                            .then(|| track.deforming(chain, drive))
                            .flatten()
                    })
                    .collect();
                let mut response = mechanics.room();
                for &k in picked {
                    let Some(seen) = &track.seen[k] else {
                        nothing(&mut rows);
                        columns.iter_mut().for_each(nothing);
                        continue;
                    };
                    let at = k * frees..(k + 1) * frees;
                    let pressure = &pressures[at.clone()];
                    mechanics.respond(&setup.chain, pressure, &mut response)?;
                    let difference = seen.difference(&mechanics.observe(&setup.chain, &response));
                    push(&mut rows, &difference);
                    let base = response.values;
                    for (((chain, step), run), column) in stepped.iter().zip(&runs).zip(&mut columns) {
                        if let Some(run) = run {
                            for (free, other) in run[at.clone()].iter().enumerate() {
                                let change = other - pressure[free];
                                for (value, slope) in
                                    response.values.iter_mut().zip(&response.by_pressure[free])
                                {
                                    *value += slope * change;
                                }
                            }
                        }
                        let other = seen.difference(&mechanics.observe(chain, &response));
                        response.values = base;
                        push(
                            column,
                            &std::array::from_fn::<f64, OUTPUTS, _>(|c| (other[c] - difference[c]) / step),
                        );
                    }
                }
            }
            Arena::Supplied => {
                let base = track.supplied(&setup.chain);
                let runs: Vec<_> = stepped.iter().map(|(chain, _)| track.supplied(chain)).collect();
                for &k in picked {
                    for free in 0..frees {
                        let at = k * frees + free;
                        let residual = match (&base, &track.reading) {
                            (Some(base), Some(reading)) if track.read[at] => base[at] - reading[at],
                            _ => f64::NAN,
                        };
                        rows.channels[free].push(residual);
                        for ((run, column), (_, step)) in runs.iter().zip(&mut columns).zip(&stepped) {
                            let slope = match (run, &base) {
                                (Some(run), Some(base)) => (run[at] - base[at]) / step,
                                _ => f64::NAN,
                            };
                            column.channels[free].push(slope);
                        }
                    }
                }
            }
        }
    }
    Ok(Linearisation { rows, columns })
}

fn push(rows: &mut Rows, values: &[f64]) {
    for (channel, value) in rows.channels.iter_mut().zip(values) {
        channel.push(*value);
    }
}

/// Standard deviation of the noise of each row: that of what was seen, and that of the pressure reading carried through the base model.
pub fn row_noise(
    mechanics: &dyn Mechanics,
    samples: &Samples,
    arena: Arena,
    chain: &Chain,
    seen: [f64; OUTPUTS],
    reading: f64,
) -> Result<Rows, OutOfDomain> {
    let count = samples.len();
    let frees = samples.frees();
    let Arena::Seen(drive) = arena else {
        return Ok(Rows { channels: vec![vec![reading; count]; frees] });
    };
    // A step that the reading's noise could make, for a difference along the tangent.
    const STEP: f64 = 1.0;
    let mut rows = Rows { channels: vec![Vec::new(); OUTPUTS] };
    let mut response = mechanics.room();
    for (track, picked) in samples.tracks.iter().zip(&samples.picked) {
        let pressures = track.deforming(chain, drive);
        for &k in picked {
            let Some(pressures) = &pressures else {
                push(&mut rows, &seen);
                continue;
            };
            let mut variance = seen.map(|noise| noise * noise);
            if drive == Drive::Reading {
                mechanics.respond(chain, &pressures[k * frees..(k + 1) * frees], &mut response)?;
                let here = mechanics.observe(chain, &response);
                let base = response.values;
                for free in 0..frees {
                    for (value, slope) in response.values.iter_mut().zip(&response.by_pressure[free]) {
                        *value += slope * STEP;
                    }
                    let change = here.difference(&mechanics.observe(chain, &response));
                    response.values = base;
                    for (variance, change) in variance.iter_mut().zip(change) {
                        if change.is_finite() {
                            *variance += (change / STEP * reading).powi(2);
                        }
                    }
                }
            }
            push(&mut rows, &variance.map(f64::sqrt));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::{Response, Seen};
    use rom::effect::{Effect, EffectKind};

    /// Twist, extension and diameter as smooth functions of one pressure.
    struct Smooth;

    impl Mechanics for Smooth {
        fn frees(&self) -> usize {
            1
        }

        fn room(&self) -> Response {
            Response::new(1, 0)
        }

        fn respond(&self, _: &Chain, pressures: &[f64], into: &mut Response) -> Result<(), OutOfDomain> {
            let x = pressures[0] / 50e3;
            into.values = [x + x * x, x * x * x, (2.0 * x).sin(), 0.0, 0.0, 0.0];
            into.by_pressure[0] =
                [1.0 + 2.0 * x, 3.0 * x * x, 2.0 * (2.0 * x).cos(), 0.0, 0.0, 0.0].map(|slope| slope / 50e3);
            Ok(())
        }

        fn observe(&self, _: &Chain, response: &Response) -> Seen {
            let [a, b, c, ..] = response.values;
            Seen::Free([a, b, c])
        }

        fn length(&self) -> f64 {
            1.0
        }
    }

    fn track() -> Track {
        let time: Vec<f64> = (0..200).map(|k| 0.05 * f64::from(k)).collect();
        let command: Vec<f64> =
            time.iter().map(|t| 20e3 * (1.0 + (1.3 * t).sin()) + 2e3 * (5.0 * t).cos()).collect();
        let count = time.len();
        Track {
            name: "waves".into(),
            time,
            reading: Some(command.clone()),
            command: Some(command),
            read: vec![true; count],
            seen: vec![Some(Seen::Free([0.1; 3])); count],
            frees: 1,
        }
    }

    #[test]
    fn derivatives_are_those_of_the_residuals() {
        let tracks = [track()];
        let samples = Samples::evenly(&tracks, 50, 2.0);
        for (kind, values, arena) in [
            (EffectKind::Stiffness, vec![0.1], Arena::Seen(Drive::Reading)),
            (EffectKind::Hysteresis, vec![1.5e3, 0.6], Arena::Seen(Drive::Reading)),
            (EffectKind::Creep, vec![0.1, 3.0], Arena::Seen(Drive::Reading)),
            (EffectKind::PressureBias, vec![300.0], Arena::Seen(Drive::Reading)),
            (EffectKind::PressureBias, vec![300.0], Arena::Supplied),
            (EffectKind::SupplyLag, vec![0.2, 0.3], Arena::Supplied),
            (EffectKind::SupplyLag, vec![0.2, 0.3], Arena::Seen(Drive::Command)),
        ] {
            let setup = Setup::default().with_effect(Effect { kind, frees: vec![0], values });
            let linearised = linearise(&Smooth, &samples, arena, &setup).unwrap();
            for number in 0..setup.numbers.len() {
                let step = 1e-4 * setup.numbers[number].parameter.scale;
                let moved = |step: f64| {
                    let mut moved = setup.clone();
                    moved.set(number, setup.value(number) + step);
                    residuals(&Smooth, &samples, arena, &moved.chain).unwrap()
                };
                let (up, down) = (moved(step), moved(-step));
                let column = &linearised.columns[number].channels;
                let most =
                    column.iter().flatten().filter(|v| v.is_finite()).fold(0.0f64, |m, v| m.max(v.abs()));
                assert!(most > 0.0, "{kind:?} number {number} is felt");
                for (channel, (up, down)) in column.iter().zip(up.channels.iter().zip(&down.channels)) {
                    for (own, (up, down)) in channel.iter().zip(up.iter().zip(down)) {
                        // Forward differences with 1e-5 of the scale: curvature leaves that share of the slope, times a few.
                        let difference = (up - down) / (2.0 * step);
                        assert!(
                            own.is_nan() || (own - difference).abs() < 1e-3 * most,
                            "{kind:?} {number}: {own} {difference}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn blocks_do_not_reach_over_recordings() {
        let tracks = [track(), track()];
        let samples = Samples::evenly(&tracks, 100, 3.0);
        let first = samples.picked[0].len();
        assert!(samples.blocks[first - 1] < samples.blocks[first]);
        assert_eq!(samples.blocks[0], 0);
        assert!(samples.blocks.windows(2).all(|pair| pair[1] - pair[0] <= 1));
    }
}
