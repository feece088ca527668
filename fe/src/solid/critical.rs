use super::{
    SolidError,
    newton::SolidSolver,
    path::Parameter,
    stability::{SolidMode, Stability},
    state::SolidState,
};

/// Trials of a search before it takes what it has.
const TRIALS: usize = 60;

/// Share of the path in the singular modes from which the path itself is taken to turn.
const LIMIT: f64 = 1e-3;

/// What happens where a tangent is singular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CriticalKind {
    /// The path itself runs along the singular mode: a greatest or least load.
    Limit,
    /// Another branch of equilibria crosses the path.
    Bifurcation,
}

/// A place on a path where eigenvalues of the tangent change sign.
#[derive(Clone, Debug)]
pub struct CriticalPoint {
    /// Parameter of the path; its error is at most the tolerance of the search.
    pub at: f64,
    /// Equilibrium there.
    pub state: SolidState,
    /// Whether the load or the path turns.
    pub kind: CriticalKind,
    /// Negative eigenvalues before and after.
    pub negative: [usize; 2],
    /// Part of the path's direction, in the modes' metric, that would lie in the singular modes if these were as stiff as at the ends of
    /// the interval: of the order of 1 at a limit point, of rounding errors at a bifurcation.
    pub share: f64,
    /// The singular modes, the least |value| first: two of a tube that may move to any side.
    pub modes: Vec<SolidMode>,
}

/// The greatest pressure of an inflation.
#[derive(Clone, Debug)]
pub struct PressureLimit {
    /// Pa.
    pub pressure: f64,
    /// Enclosed volume there, m^3.
    pub volume: f64,
    /// Equilibrium there.
    pub state: SolidState,
    /// An equilibrium beyond it, at more volume and less pressure.
    pub beyond: SolidState,
}

/// An end of the interval that holds a zero.
#[derive(Clone)]
struct End {
    at: f64,
    state: SolidState,
    value: f64,
}

/// A bracket of a zero, narrowed by the Illinois rule: false position that halves the value of an end which stays.
struct Bracket {
    ends: [End; 2],
    weights: [f64; 2],
    stayed: Option<usize>,
}

impl Bracket {
    fn new(low: End, high: End) -> Self {
        Bracket { ends: [low, high], weights: [1.0; 2], stayed: None }
    }

    fn width(&self) -> f64 {
        (self.ends[1].at - self.ends[0].at).abs()
    }

    /// Where to look next, at least a tenth of the tolerance and a thousandth of the width away from the ends.
    fn next(&self, tolerance: f64) -> f64 {
        let [low, high] = &self.ends;
        let [a, b] = [0, 1].map(|end| self.weights[end] * self.ends[end].value.abs());
        let margin = (0.4 * tolerance / self.width()).clamp(1e-3, 0.5);
        low.at + (high.at - low.at) * (a / (a + b)).clamp(margin, 1.0 - margin)
    }

    fn replace(&mut self, end: usize, by: End) {
        self.weights = if self.stayed == Some(1 - end) {
            let mut weights = self.weights;
            weights[1 - end] *= 0.5;
            weights
        } else {
            [1.0; 2]
        };
        self.weights[end] = 1.0;
        self.stayed = Some(1 - end);
        self.ends[end] = by;
    }

    fn nearest(&self) -> usize {
        usize::from(self.ends[1].value.abs() < self.ends[0].value.abs())
    }
}

impl SolidSolver {
    /// The critical point next to where the number of negative eigenvalues changes between the equilibrium `start` at parameter `from`
    /// and the one that the path reaches at `to`; `None` where the number does not change. `tolerance` is in the parameter.
    ///
    /// Under prescribed loads there is no equilibrium beyond a limit point: to have one found, follow volumes.
    ///
    /// # Errors
    /// [`SolidError::NotConverged`] where the path cannot be followed; [`SolidError::Jumped`] where the number changes but no
    /// eigenvalue passes zero.
    pub fn critical_point(
        &mut self,
        path: &Parameter<'_>,
        (from, start): (f64, &SolidState),
        to: f64,
        tolerance: f64,
    ) -> Result<Option<CriticalPoint>, SolidError> {
        let start = &path.begin(from, start);
        let reached = self.walk(start, from, &[to], path, &mut |_, _| true)?;
        let negative = [self.stability(start, 0)?.negative, self.stability(&reached, 0)?.negative];
        if negative[0] == negative[1] {
            return Ok(None);
        }
        // The first eigenvalue to pass zero is number `index` from the lowest.
        let index = negative[0].min(negative[1]);
        let wanted = negative[0].max(negative[1]) - index + 2;
        let look = |solver: &mut Self, state: &SolidState| -> Result<(Stability, f64), SolidError> {
            let stability = solver.stability(state, wanted)?;
            // Where it is not among those next to zero, it is farther away than these.
            let farthest = stability.modes.last().map_or(1.0, |mode| mode.value.abs());
            let sign = if stability.negative > index { -1.0 } else { 1.0 };
            let value = stability.eigenvalue(index).unwrap_or(sign * farthest);
            Ok((stability, value))
        };
        let ends = [(from, start.clone()), (to, reached)];
        let [low, high] = ends.map(|(at, state)| (at, look(self, &state), state));
        let [low, high] = [low, high].map(|(at, found, state)| found.map(|f| End { at, state, value: f.1 }));
        let mut bracket = Bracket::new(low?, high?);
        let first = bracket.ends[0].value.abs().max(bracket.ends[1].value.abs());
        for _ in 0..TRIALS {
            if bracket.width() <= tolerance {
                break;
            }
            let at = bracket.next(tolerance);
            let [low, _] = &bracket.ends;
            let state = self.walk(&low.state.clone(), low.at, &[at], path, &mut |_, _| true)?;
            let value = look(self, &state)?.1;
            let end = usize::from((value > 0.0) != (bracket.ends[0].value > 0.0));
            bracket.replace(end, End { at, state, value });
        }
        let End { at, state, value } = bracket.ends[bracket.nearest()].clone();
        if value.abs() > 0.1 * first {
            let [from, to] = [0, 1].map(|end| bracket.ends[end].at);
            return Err(SolidError::Jumped { from, to, before: negative[0], after: negative[1] });
        }
        let towards = if at == to { from } else { to };
        let (.., direction) = self
            .slope(&state, at, towards, path)
            .map_err(|lost| self.lost(&state, lost, "the critical point"))?;
        let modes = self.stability(&state, wanted)?.modes;
        let metric = self.metric(&state);
        let product =
            |a: &[f64], b: &[f64]| -> f64 { metric.iter().zip(a).zip(b).map(|((m, a), b)| m * a * b).sum() };
        let singular: Vec<SolidMode> = modes
            .into_iter()
            .filter(|mode| mode.value.abs() <= (3.0 * value.abs()).max(1e-3 * first))
            .collect();
        let [mut along, mut beside] = [0.0, product(&direction, &direction)];
        for mode in &singular {
            let part = product(&mode.vector, &direction).powi(2) / product(&mode.vector, &mode.vector);
            beside -= part;
            along += part * (mode.value / first).powi(2);
        }
        let share = (along / (along + beside.max(0.0))).sqrt();
        let kind = if share > LIMIT { CriticalKind::Limit } else { CriticalKind::Bifurcation };
        Ok(Some(CriticalPoint { at, state, kind, negative, share, modes: singular }))
    }

    /// Follows a path as [`SolidSolver::follow`] and [`SolidSolver::inflate`] do, with the stability (and `modes` modes) at each stop,
    /// and finds the critical points between stops where the number of negative eigenvalues changes, to `tolerance` of the parameter. With `and_back`
    /// every step is also taken back: one that jumped to another branch, be it as stable as the first, does not return to where it came from.
    ///
    /// # Errors
    /// As [`SolidSolver::critical_point`]; what was found up to there was told to `found`, the last equilibrium is
    /// [`SolidSolver::last_good`].
    #[allow(clippy::too_many_arguments)]
    pub fn survey(
        &mut self,
        path: &Parameter<'_>,
        (from, start): (f64, &SolidState),
        stops: &[f64],
        modes: usize,
        tolerance: f64,
        and_back: bool,
        found: &mut dyn FnMut(f64, &SolidState, &Stability) -> bool,
    ) -> Result<Vec<CriticalPoint>, SolidError> {
        let (mut at, mut state) = (from, path.begin(from, start));
        let mut before = self.stability(&state, 0)?.negative;
        let mut critical = vec![];
        for &stop in stops {
            let reached = self.walk(&state, at, &[stop], path, &mut |_, _| true)?;
            let stability = self.stability(&reached, modes)?;
            let after = stability.negative;
            if and_back {
                let returned = self.walk(&reached, stop, &[at], path, &mut |_, _| true)?;
                if distance(&returned, &state) > 1e-3 * distance(&reached, &state) {
                    return Err(SolidError::Jumped { from: at, to: stop, before, after });
                }
            }
            if after != before {
                critical.extend(self.critical_point(path, (at, &state), stop, tolerance)?);
            }
            (at, state, before) = (stop, reached, after);
            self.last_good = Some((at, state.clone()));
            if !found(at, &state, &stability) {
                return Err(SolidError::Stopped);
            }
        }
        Ok(critical)
    }

    /// The greatest pressure on the path of rising `volumes` (m^3 of the whole tube) from `start`, relative error at most `tolerance`;
    /// `None` where the pressure rises to the last volume.
    ///
    /// # Errors
    /// As [`SolidSolver::follow`].
    pub fn pressure_limit(
        &mut self,
        start: &SolidState,
        volumes: &[f64],
        tolerance: f64,
    ) -> Result<Option<PressureLimit>, SolidError> {
        let sectors = self.body.grid.sectors as f64;
        let mut low = start.clone();
        self.assemble(&low, false).map_err(|lost| self.lost(start, lost, "the start"))?;
        low.volume = self.forces.volume;
        let path = Parameter::Volume(low.load);
        // dp/dV has a zero at the limit, where the tangent is singular but the bordered one is not.
        let rise = |solver: &mut Self, state: &SolidState| -> Result<f64, SolidError> {
            Ok(1.0 / solver.stability(state, 0)?.compliance)
        };
        let end = |state: SolidState, value: f64| End { at: state.volume, state, value };
        let value = rise(self, &low)?;
        let mut low = end(low, value);
        for volume in volumes {
            let state = self.walk(&low.state, low.at, &[volume / sectors], &path, &mut |_, _| true)?;
            let value = rise(self, &state)?;
            let high = end(state, value);
            if high.value > 0.0 {
                low = high;
                continue;
            }
            let beyond = high.state.clone();
            let mut bracket = Bracket::new(low, high);
            for _ in 0..TRIALS {
                let near = &bracket.ends[bracket.nearest()];
                // Between the ends the pressure rises by less than its slope times the width.
                if near.value.abs() * bracket.width() <= tolerance * near.state.load.pressure {
                    break;
                }
                let [low, _] = &bracket.ends;
                let at = bracket.next(0.0);
                let state = self.walk(&low.state.clone(), low.at, &[at], &path, &mut |_, _| true)?;
                let value = rise(self, &state)?;
                bracket.replace(usize::from(value <= 0.0), end(state, value));
            }
            let End { at, state, .. } = bracket.ends[bracket.nearest()].clone();
            return Ok(Some(PressureLimit {
                pressure: state.load.pressure,
                volume: sectors * at,
                state,
                beyond,
            }));
        }
        Ok(None)
    }
}

/// Largest distance between the same points of two states, m.
pub(super) fn distance(a: &SolidState, b: &SolidState) -> f64 {
    let apart =
        |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    a.positions.iter().zip(&b.positions).map(|(a, b)| apart(a, b)).fold(0.0, f64::max)
}
