use super::{
    SectionError,
    newton::{Converged, Failed, Given, Newton},
    problem::{Problem, State, Step},
    solver::Units,
};
use actuator::{FreePath, FreeState, PathEnd};

/// First step of the enclosed volume, as a share of the volume at rest.
const FIRST_STEP: f64 = 0.01;
/// Longest step, as a share of the present volume: Newton then starts well inside its range.
const LONGEST_STEP: f64 = 0.08;
/// Shortest step before the path is given up.
const SHORTEST_STEP: f64 = 1e-6;
/// A path without a limit point ends where the bore or the length has grown this often.
const RANGE: f64 = 3.0;
/// ... or where the pressure is this many times mu: the chains of a rubber that locks are then drawn out, and the volume of the wall,
/// held by K/mu = 1e5, is no longer that of the incompressible tube. Limit pressures of tubes are far below: 0.1 to 0.4 at the published wall.
const PRESSURE_RANGE: f64 = 8.0;
/// Change of log p over that of log V at which the pressure counts as stationary: the pressure is then exact to the square
/// of this.
const FLAT: f64 = 1e-6;
/// Halvings of loads put on without pressure.
const MOST_LOAD_HALVINGS: u32 = 6;
/// Newton steps that a good step length takes.
const WANTED_STEPS: usize = 4;

/// An equilibrium with the direction of the path there.
#[derive(Clone, Debug)]
struct Station {
    volume: f64,
    state: State,
    /// Change of the state per volume.
    tangent: Step,
    residual: f64,
}

impl Station {
    fn pressure(&self) -> f64 {
        self.state.globals[2]
    }
    fn slope(&self) -> f64 {
        self.tangent.globals[2]
    }
}

/// Equilibria of a section under constant force and torque, by rising enclosed volume, up to the limit point or the range.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    loads: [f64; 2],
    units: Units,
    stations: Vec<Station>,
    end: PathEnd,
}

/// Weights of values and slopes (h: length of the interval) at the ends of an interval in a cubic at share `t`.
fn hermite(t: f64, h: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, h * (t3 - 2.0 * t2 + t), 3.0 * t2 - 2.0 * t3, h * (t3 - t2)]
}

struct Walker<'a> {
    problem: &'a Problem,
    newton: &'a mut Newton,
    loads: [f64; 2],
}

impl Walker<'_> {
    /// The state without pressure, from the unloaded one; the loads are put on by halves where they are too much at once.
    fn unpressurised(&mut self, rest: &State) -> Result<Station, Failed> {
        let loads = self.loads;
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
        let volume = self.newton.system.volume;
        let mut tangent = Step::new(self.problem);
        self.newton.volume_tangent(self.problem, &mut tangent)?;
        Ok((Station { volume, state, tangent, residual: converged.residual }, converged))
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
    fn at_pressure(&mut self, low: &Station, high: &Station, pressure: f64) -> Result<Station, Failed> {
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
    fn limit(&mut self, rising: &Station, falling: &Station) -> Result<Station, Failed> {
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

impl Path {
    /// Follows the equilibria under `loads` (force, torque) from the unloaded state `rest`.
    pub fn follow(
        problem: &Problem,
        newton: &mut Newton,
        rest: &State,
        loads: [f64; 2],
        units: Units,
    ) -> Result<Self, SectionError> {
        let mut walker = Walker { problem, newton, loads };
        let error = |failed: Failed, last: &State, volume_share: f64| {
            let last_good = units.whereabouts(&last.globals);
            let mut target = last_good;
            target.pressure *= 1.0 + volume_share;
            SectionError::NotConverged { target, residual: failed.residual, last_good }
        };
        let bore = problem.grid.radii[0];
        let rest_volume = std::f64::consts::PI * bore * bore;
        let first = walker.unpressurised(rest).map_err(|failed| error(failed, rest, 0.0))?;
        if first.slope() <= 0.0 {
            // Its loads alone have brought the FREE to a limit.
            return Ok(Path { loads, units, stations: vec![first], end: PathEnd::LimitPoint });
        }
        let mut stations = vec![first];
        let mut share = FIRST_STEP;
        loop {
            let last = &stations[stations.len() - 1];
            let step = share * last.volume;
            // Second-order predictor: the tangent and its change over the last step.
            let mut start = last.state.clone();
            problem.advance(&mut start, &last.tangent, step);
            if let [.., before, _] = &stations[..] {
                let curvature = 0.5 * step * step / (last.volume - before.volume);
                problem.advance(&mut start, &last.tangent, curvature);
                problem.advance(&mut start, &before.tangent, -curvature);
            }
            match walker.solve(start, last.volume + step) {
                Ok((station, converged)) => {
                    let ratio = WANTED_STEPS as f64 / converged.steps.max(1) as f64;
                    share = (share * ratio.clamp(0.5, 1.6)).min(LONGEST_STEP);
                    let falling = station.slope() <= 0.0;
                    let grown = station.state.globals[0] > RANGE
                        || station.volume / (rest_volume * station.state.globals[0]) > RANGE * RANGE
                        || station.pressure() > PRESSURE_RANGE;
                    if falling {
                        let limit = walker
                            .limit(last, &station)
                            .map_err(|failed| error(failed, &last.state, share))?;
                        stations.push(limit);
                        return Ok(Path { loads, units, stations, end: PathEnd::LimitPoint });
                    }
                    stations.push(station);
                    if grown {
                        return Ok(Path { loads, units, stations, end: PathEnd::Range });
                    }
                }
                Err(failed) => {
                    share *= 0.5;
                    if share < SHORTEST_STEP {
                        return Err(error(failed, &last.state, share));
                    }
                }
            }
        }
    }

    /// States at `pressures` (Pa) and `extra` more up to the end; see `SectionSolver::path`.
    pub fn states(
        &self,
        problem: &Problem,
        newton: &mut Newton,
        pressures: &[f64],
        extra: usize,
        hand: f64,
    ) -> Result<FreePath, SectionError> {
        let last = &self.stations[self.stations.len() - 1];
        let end_pressure = last.pressure();
        let mut wanted: Vec<f64> = pressures.iter().map(|pressure| pressure / self.units.stress).collect();
        wanted.push(0.0);
        wanted.retain(|pressure| *pressure < end_pressure);
        let all_reached = wanted.len() > pressures.len();
        if self.end == PathEnd::LimitPoint {
            wanted.extend((1..=extra).map(|i| {
                let s = i as f64 / (extra + 1) as f64;
                end_pressure * (1.0 - (1.0 - s) * (1.0 - s))
            }));
        }
        wanted.sort_by(f64::total_cmp);
        // An extra state that falls on a pressure asked for would be the same state again.
        wanted.dedup_by(|b, a| *b - *a < 1e-9 * end_pressure);

        let mut walker = Walker { problem, newton, loads: self.loads };
        let mut states = Vec::with_capacity(wanted.len() + 1);
        for pressure in wanted {
            let after = self.stations.partition_point(|station| station.pressure() <= pressure);
            let (low, high) = (&self.stations[after - 1], &self.stations[after]);
            let station = if low.pressure() == pressure {
                low.clone()
            } else {
                walker.at_pressure(low, high, pressure).map_err(|failed| SectionError::NotConverged {
                    target: self.units.whereabouts(&[low.state.globals[0], low.state.globals[1], pressure]),
                    residual: failed.residual,
                    last_good: self.units.whereabouts(&low.state.globals),
                })?
            };
            states.push(self.report(problem, &station, hand));
        }
        if self.end == PathEnd::LimitPoint || !all_reached {
            states.push(self.report(problem, last, hand));
        }
        Ok(FreePath::solved(states, self.end))
    }

    fn report(&self, problem: &Problem, station: &Station, hand: f64) -> FreeState {
        let at = self.units.whereabouts(&station.state.globals);
        FreeState {
            pressure: at.pressure,
            axial_stretch: at.axial_stretch,
            expansion: problem.expansion(&station.state),
            twist_per_length: hand * at.twist_per_length,
            residual: station.residual,
            middle: None,
            section: None,
            mesh_error: None,
        }
    }
}
