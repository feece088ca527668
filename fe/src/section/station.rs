use super::{
    newton::{Converged, Failed, Given, Newton},
    problem::{Problem, State, Step},
};
use nalgebra::Matrix3;

/// Change of log p over that of log V at which the pressure counts as stationary: the pressure is then exact to the square
/// of this.
const FLAT: f64 = 1e-6;
/// Halvings of loads put on without pressure.
const MOST_LOAD_HALVINGS: u32 = 6;

/// An equilibrium with the direction of the path there.
#[derive(Clone, Debug)]
pub(crate) struct Station {
    pub volume: f64,
    pub state: State,
    /// Change of the state per volume.
    pub tangent: Step,
    pub residual: f64,
    /// Phi = W - p V, per length.
    pub enthalpy: f64,
    /// Second derivatives of Phi by lambda, psi and p, the wall following.
    pub schur: Matrix3<f64>,
}

impl Station {
    pub fn pressure(&self) -> f64 {
        self.state.globals[2]
    }
    pub fn slope(&self) -> f64 {
        self.tangent.globals[2]
    }
}

/// Weights of values and slopes (h: length of the interval) at the ends of an interval in a cubic at share `t`.
fn hermite(t: f64, h: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, h * (t3 - 2.0 * t2 + t), 3.0 * t2 - 2.0 * t3, h * (t3 - t2)]
}

/// Volume at which the cubic through two stations takes a pressure.
fn cubic_root(a: &Station, b: &Station, pressure: f64) -> f64 {
    let h = b.volume - a.volume;
    let at = |t: f64| {
        let [wa, da, wb, db] = hermite(t, h);
        wa * a.pressure() + da * a.slope() + wb * b.pressure() + db * b.slope() - pressure
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if at(middle) < 0.0 { low = middle } else { high = middle }
    }
    a.volume + h * 0.5 * (low + high)
}

/// What finds the stations of a path.
pub(crate) struct Walker<'a> {
    pub problem: &'a Problem,
    pub newton: &'a mut Newton,
    /// Force, torque.
    pub loads: [f64; 2],
    /// Whether a state need only be stable at its volume, or at its stretch, twist and pressure.
    pub by_volume: bool,
}

impl Walker<'_> {
    /// The state without pressure, from the unloaded one; the loads are put on by halves where they are too much at once.
    pub fn unpressurised(&mut self, rest: &State) -> Result<Station, Failed> {
        let loads = self.loads;
        if loads == [0.0; 2] {
            // Equilibrium as it stands. Newton's method would only stir the rounding of small elements, times the bulk modulus.
            let failed = Failed { residual: f64::NAN };
            self.problem.linearise(rest, &mut self.newton.system).map_err(|_| failed)?;
            return self.station(rest.clone(), self.newton.system.relative_residual());
        }
        let mut halvings = 0;
        loop {
            let parts = 1 << halvings;
            let mut state = rest.clone();
            let mut last = Err(Failed { residual: f64::NAN });
            for part in 1..=parts {
                self.loads = loads.map(|load| load * f64::from(part) / f64::from(parts));
                last = self.solve_given(state.clone(), Given::Value(0.0));
                match &last {
                    Ok((station, _)) => state.clone_from(&station.state),
                    Err(_) => break,
                }
            }
            self.loads = loads;
            match last {
                Ok((station, _)) => return Ok(station),
                Err(failed) if halvings == MOST_LOAD_HALVINGS => return Err(failed),
                Err(_) => halvings += 1,
            }
        }
    }

    /// The state of an enclosed volume, from `start`.
    fn solve(&mut self, start: State, volume: f64) -> Result<(Station, Converged), Failed> {
        self.solve_given(start, Given::Conjugate(volume))
    }

    fn solve_given(&mut self, mut state: State, pressure: Given) -> Result<(Station, Converged), Failed> {
        let given = [Given::Conjugate(self.loads[0]), Given::Conjugate(self.loads[1]), pressure];
        let converged = self.newton.solve(self.problem, &mut state, &given)?;
        Ok((self.station(state, converged.residual)?, converged))
    }

    /// The station of a state at which the system is linearised.
    fn station(&mut self, state: State, residual: f64) -> Result<Station, Failed> {
        let (volume, enthalpy) = (self.newton.system.volume, self.newton.system.energy);
        let mut tangent = Step::new(self.problem);
        let schur = self.newton.volume_tangent(self.problem, &mut tangent, self.by_volume)?;
        Ok(Station { volume, state, tangent, residual, enthalpy, schur })
    }

    /// The state one step of the volume past `last`, started by its tangent and, where there is a station `before`, its change.
    pub fn onwards(
        &mut self,
        before: Option<&Station>,
        last: &Station,
        step: f64,
    ) -> Result<(Station, Converged), Failed> {
        let mut start = last.state.clone();
        self.problem.advance(&mut start, &last.tangent, step);
        if let Some(before) = before {
            let curvature = 0.5 * step * step / (last.volume - before.volume);
            self.problem.advance(&mut start, &last.tangent, curvature);
            self.problem.advance(&mut start, &before.tangent, -curvature);
        }
        self.solve(start, last.volume + step)
    }

    /// The start for a volume between or near two stations.
    fn interpolate(&self, a: &Station, b: &Station, volume: f64) -> State {
        let h = b.volume - a.volume;
        let [_, from_slope, to, to_slope] = hermite((volume - a.volume) / h, h);
        let mut state = a.state.clone();
        self.problem.advance(&mut state, &a.tangent, from_slope);
        self.problem.advance(&mut state, &b.tangent, to_slope);
        state.add_difference(&a.state, &b.state, to);
        state
    }

    fn between(&mut self, a: &Station, b: &Station, volume: f64) -> Result<Station, Failed> {
        let start = self.interpolate(a, b, volume);
        self.solve(start, volume).map(|(station, _)| station)
    }

    /// The state between `low` and `high` (either side of it in pressure) whose pressure is `pressure`.
    pub fn at_pressure(&mut self, low: &Station, high: &Station, pressure: f64) -> Result<Station, Failed> {
        let (mut a, mut b) = (low.clone(), high.clone());
        // A root of a smooth rising function in a bracket: the cubic's root, then Newton on V, kept inside the bracket.
        let mut volume = cubic_root(&a, &b, pressure);
        let mut best: Option<Station> = None;
        for _ in 0..40 {
            let station = self.between(&a, &b, volume)?;
            let off = pressure - station.pressure();
            let done = off.abs() <= 1e-10 * pressure.max(1e-3);
            let newton = station.volume + off / station.slope();
            if off > 0.0 {
                a = station.clone()
            } else {
                b = station.clone()
            }
            best = Some(station);
            if done || b.volume - a.volume < 1e-13 * b.volume {
                break;
            }
            let inside = newton > a.volume && newton < b.volume;
            volume = if inside { newton } else { 0.5 * (a.volume + b.volume) };
        }
        best.ok_or(Failed { residual: f64::NAN })
    }

    /// The state of greatest pressure between one where it rises and one where it falls.
    pub fn limit(&mut self, rising: &Station, falling: &Station) -> Result<Station, Failed> {
        let (mut a, mut b) = (rising.clone(), falling.clone());
        // False position on the slope, an end that stays twice being halved (Illinois).
        let (mut slope_a, mut slope_b) = (a.slope(), b.slope());
        for _ in 0..60 {
            let volume = (a.volume * slope_b - b.volume * slope_a) / (slope_b - slope_a);
            let station = self.between(&a, &b, volume)?;
            let flat = station.slope().abs() * station.volume <= FLAT * station.pressure();
            if flat || b.volume - a.volume < 1e-12 * b.volume {
                return Ok(station);
            }
            if station.slope() > 0.0 {
                slope_a = station.slope();
                slope_b *= 0.5;
                a = station;
            } else {
                slope_b = station.slope();
                slope_a *= 0.5;
                b = station;
            }
        }
        Err(Failed { residual: f64::NAN })
    }
}
