use super::{
    SolidError,
    newton::{Control, Lost, SolidSolver},
    state::{Motion, SolidLoad, SolidState, motion_between},
};
use nalgebra::{DMatrix, DVector};

/// Halvings of a step before a path is given up.
const HALVINGS: u32 = 10;

/// A state that a path has passed, for the extrapolation to the next one.
struct Passed {
    /// Parameter of the path.
    at: f64,
    pressure: f64,
    /// Motion to the state after it.
    onwards: Option<Motion>,
    /// Motion per parameter.
    slope: Motion,
    pressure_slope: f64,
}

/// What a path is followed by.
pub enum Parameter<'a> {
    /// Loads as a function of a parameter, linear between the stops.
    Load(&'a dyn Fn(f64) -> SolidLoad),
    /// Enclosed volume, m^3 of the part that is meshed; the other loads stay.
    Volume(SolidLoad),
}

impl Parameter<'_> {
    /// An equilibrium under the path's loads at a parameter.
    pub(super) fn begin(&self, at: f64, state: &SolidState) -> SolidState {
        let load = match self {
            Parameter::Load(load_at) => load_at(at),
            Parameter::Volume(load) => SolidLoad { pressure: state.load.pressure, ..*load },
        };
        SolidState { load, ..state.clone() }
    }
}

/// Weights of the values and of the slopes at `times` in the polynomial through all of them, at time `target`.
fn extrapolation(times: &[f64], target: f64) -> (Vec<f64>, Vec<f64>) {
    let count = times.len();
    let reach = times.iter().fold(0.0f64, |most, time| most.max((target - time).abs()));
    let (mut rows, mut wanted) = (DMatrix::zeros(2 * count, 2 * count), DVector::zeros(2 * count));
    for power in 0..2 * count {
        for (index, time) in times.iter().enumerate() {
            let x = (time - target) / reach;
            rows[(power, index)] = x.powi(power as i32);
            rows[(power, count + index)] =
                if power == 0 { 0.0 } else { power as f64 * x.powi(power as i32 - 1) / reach };
        }
        wanted[power] = if power == 0 { 1.0 } else { 0.0 };
    }
    let weights = rows.lu().solve(&wanted).unwrap_or_else(|| DVector::zeros(2 * count));
    (weights.rows(0, count).iter().copied().collect(), weights.rows(count, count).iter().copied().collect())
}

impl SolidSolver {
    /// Follows equilibria from `start` through the loads `load_at(stop)` for each of `stops`, monotonic; between two stops the loads
    /// are to be linear in the parameter. `found` is told each state at a stop and says whether to go on.
    ///
    /// # Errors
    /// [`SolidError::NotConverged`] where there is no equilibrium near the last one, as beyond a limit pressure; what was found up
    /// to there was told to `found`.
    pub fn follow(
        &mut self,
        start: &SolidState,
        from: f64,
        stops: &[f64],
        load_at: &dyn Fn(f64) -> SolidLoad,
        found: &mut dyn FnMut(f64, &SolidState) -> bool,
    ) -> Result<SolidState, SolidError> {
        let sectors = self.body.grid.sectors;
        let load_at = move |at| load_at(at).on_sectors(sectors);
        self.walk(start, from, stops, &Parameter::Load(&load_at), found)
    }

    /// Follows equilibria from `start` at prescribed enclosed volumes, m^3 of the whole tube: past limit points of the pressure.
    ///
    /// # Errors
    /// As [`SolidSolver::follow`].
    pub fn inflate(
        &mut self,
        start: &SolidState,
        volumes: &[f64],
        found: &mut dyn FnMut(f64, &SolidState) -> bool,
    ) -> Result<SolidState, SolidError> {
        if start.load().open_ends {
            return Err(SolidError::Invalid {
                field: "the number of closed ends",
                value: 0.0,
                requirement: "to prescribe the enclosed volume, both must be closed: follow the pressure",
            });
        }
        let sectors = self.body.grid.sectors as f64;
        let stops: Vec<f64> = volumes.iter().map(|volume| volume / sectors).collect();
        let mut start = start.clone();
        start.load = start.load.on_sectors(self.body.grid.sectors);
        self.assemble(&start, false).map_err(|lost| self.lost(&start, lost, "the start"))?;
        start.volume = self.forces.volume;
        let from = start.volume;
        let load = start.load;
        self.walk(&start, from, &stops, &Parameter::Volume(load), &mut |at, state| found(at * sectors, state))
    }

    /// The equilibrium that the last path reached last, stop or not, and its parameter there (volume of the part that is meshed, for a
    /// path of volumes): what is left when a path fails or is stopped.
    pub fn last_good(&self) -> Option<(f64, &SolidState)> {
        self.last_good.as_ref().map(|(at, state)| (*at, state))
    }

    pub(super) fn lost(&self, last: &SolidState, Lost(residual): Lost, target: &str) -> SolidError {
        SolidError::NotConverged {
            target: target.to_owned(),
            residual,
            last_good: 1e-3 * last.load.pressure,
            advice: "Where the pressure has a limit, follow the enclosed volume instead of the pressure; else use a finer mesh",
        }
    }

    /// First-order motion per parameter at an equilibrium.
    ///
    /// With the slope of the pressure and the motion's step of the unknowns.
    pub(super) fn slope(
        &mut self,
        state: &SolidState,
        at: f64,
        towards: f64,
        parameter: &Parameter<'_>,
    ) -> Result<(Motion, f64, Vec<f64>), Lost> {
        let held = state.load.held;
        let (rates, span) = match parameter {
            Parameter::Load(load_at) => (load_at(towards), towards - at),
            Parameter::Volume(load) => (*load, 1.0),
        };
        let now = match parameter {
            Parameter::Load(load_at) => load_at(at),
            Parameter::Volume(load) => *load,
        };
        let rate = |to: nalgebra::Vector3<f64>, from: nalgebra::Vector3<f64>| (to - from) / span;
        let moving = {
            let (shift, turn) = (rate(rates.displacement, now.displacement), rate(rates.turn, now.turn));
            let all = [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z];
            std::array::from_fn(|direction| if held[direction] { all[direction] } else { 0.0 })
        };
        let mut moved = None;
        // The tangent at the state itself: one from a step before, good for Newton's method, is too rough for an extrapolation.
        self.assemble(state, true)?;
        if moving != [0.0; 6] {
            moved = Some(self.tangent_times_cap(&moving));
        }
        self.factorise(held)?;
        let held_motion = moved.as_ref().map(|forces| (&moving, &forces[..]));
        match parameter {
            Parameter::Load(_) => {
                let by_pressure = (rates.pressure - now.pressure) / span;
                let forces = [rate(rates.force, now.force), rate(rates.moment, now.moment)];
                let gravity = rate(rates.gravity, now.gravity);
                let (motion, step) = self.first_order(state, by_pressure, forces, gravity, held_motion);
                Ok((motion, by_pressure, step))
            }
            Parameter::Volume(_) => {
                let none = nalgebra::Vector3::zeros();
                let (mut motion, step) = self.first_order(state, 1.0, [none; 2], none, None);
                let by_pressure: f64 = self.forces.by_pressure.iter().zip(&step).map(|(a, b)| a * b).sum();
                motion.scale(1.0 / by_pressure);
                Ok((motion, 1.0 / by_pressure, step))
            }
        }
    }

    pub(super) fn walk(
        &mut self,
        start: &SolidState,
        from: f64,
        stops: &[f64],
        parameter: &Parameter<'_>,
        found: &mut dyn FnMut(f64, &SolidState) -> bool,
    ) -> Result<SolidState, SolidError> {
        let mut state = start.clone();
        if let (Parameter::Load(load_at), Some(&stop)) = (parameter, stops.first()) {
            state.load.held = load_at(stop).held;
        }
        let mut at = from;
        self.last_good = Some((at, state.clone()));
        let mut passed: Vec<Passed> = Vec::new();
        let mut stride = f64::INFINITY;
        for &stop in stops {
            let mut halvings = 0;
            while at != stop {
                let remaining = stop - at;
                if passed.last().is_none_or(|last| last.onwards.is_some()) {
                    let (slope, pressure_slope, _) = self
                        .slope(&state, at, stop, parameter)
                        .map_err(|lost| self.lost(&state, lost, "the start"))?;
                    let pressure = state.load.pressure;
                    passed.push(Passed { at, pressure, onwards: None, slope, pressure_slope });
                }
                let pieces = (remaining.abs() / stride).ceil().max(1.0);
                let next = if pieces == 1.0 { stop } else { at + remaining / pieces };
                let (guess, ahead) = self.predicted(&state, &passed, next, parameter);
                let control = match parameter {
                    Parameter::Load(_) => Control::Pressure,
                    Parameter::Volume(_) => Control::Volume(next),
                };
                let before = self.cost().factorisations;
                match self.equilibrate(guess, control) {
                    Ok((reached, correction)) => {
                        let mut motion = ahead;
                        motion.add(1.0, &correction);
                        let motion = motion_between(&self.body.grid, &state, &reached, motion);
                        if let Some(last) = passed.last_mut() {
                            last.onwards = Some(motion);
                        }
                        if passed.len() > 2 {
                            passed.remove(0);
                        }
                        if self.cost().factorisations - before <= 2 {
                            stride = if halvings == 0 { f64::INFINITY } else { 2.0 * (next - at).abs() };
                        }
                        state = reached;
                        at = next;
                        self.last_good = Some((at, state.clone()));
                    }
                    Err(lost) => {
                        halvings += 1;
                        if halvings > HALVINGS {
                            let target = match parameter {
                                Parameter::Load(load_at) => load_at(next).to_string(),
                                Parameter::Volume(_) => format!("an enclosed volume of {:.4} ml", 1e6 * next),
                            };
                            return Err(self.lost(&state, lost, &target));
                        }
                        stride = 0.5 * (next - at).abs();
                    }
                }
            }
            if !found(at, &state) {
                return Err(SolidError::Stopped);
            }
        }
        Ok(state)
    }

    /// The configuration expected at parameter `next`, and the motion to it.
    fn predicted(
        &self,
        state: &SolidState,
        passed: &[Passed],
        next: f64,
        parameter: &Parameter<'_>,
    ) -> (SolidState, Motion) {
        let times: Vec<f64> = passed.iter().map(|passed| passed.at).collect();
        let (values, slopes) = extrapolation(&times, next);
        let mut ahead = Motion::none(state, self.body.grid.lines[2]);
        let mut pressure = 0.0;
        // Values are motions from the present state: of a passed one, minus all the motions since.
        let mut weight = 0.0;
        for (index, passed) in passed.iter().enumerate() {
            weight += values[index];
            if let Some(onwards) = &passed.onwards {
                ahead.add(-weight, onwards);
            }
            ahead.add(slopes[index], &passed.slope);
            pressure += values[index] * passed.pressure + slopes[index] * passed.pressure_slope;
        }
        let mut load = state.load;
        match parameter {
            Parameter::Load(load_at) => {
                load = load_at(next);
                let (shift, turn) =
                    (load.displacement - state.load.displacement, load.turn - state.load.turn);
                for axis in 0..3 {
                    for (half, motion) in [shift, turn].into_iter().enumerate() {
                        if load.held[3 * half + axis] {
                            ahead.cap[half][axis] = motion[axis];
                        }
                    }
                }
            }
            Parameter::Volume(_) => load.pressure = pressure,
        }
        let mut guess = self.moved(state, &ahead);
        guess.load = load;
        (guess, ahead)
    }
}

#[cfg(test)]
mod tests {
    use super::extrapolation;

    #[test]
    fn extrapolation_is_exact_for_polynomials() {
        let times = [1.0, 1.7, 3.0];
        let polynomial = |t: f64| 2.0 - t + 0.3 * t * t - 0.1 * t.powi(4) + 0.01 * t.powi(5);
        let slope = |t: f64| -1.0 + 0.6 * t - 0.4 * t.powi(3) + 0.05 * t.powi(4);
        let (values, slopes) = extrapolation(&times, 4.2);
        let sum: f64 = (0..3).map(|i| values[i] * polynomial(times[i]) + slopes[i] * slope(times[i])).sum();
        assert!((sum - polynomial(4.2)).abs() < 1e-11, "{sum} {}", polynomial(4.2));
    }
}
