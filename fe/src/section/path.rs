use super::{
    PathRequest, SectionError,
    newton::{Failed, Newton},
    problem::{Problem, State},
    resolution::resolve,
    solver::Units,
    station::{Station, Walker},
};
use crate::PressureUnit;
use actuator::{FreePath, FreeState, PathEnd, SectionConstants};

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
/// Step between the states past the limit point, as a share of the volume there.
const BEYOND_STEP: f64 = 0.05;
/// Newton steps that a good step length takes.
const WANTED_STEPS: usize = 4;

/// Equilibria of a section under constant force and torque, by rising enclosed volume, up to the limit point or the range.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    loads: [f64; 2],
    units: Units,
    stations: Vec<Station>,
    end: PathEnd,
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
        let mut walker = Walker { problem, newton, loads, by_volume: false };
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
            let before = stations.len().checked_sub(2).map(|index| &stations[index]);
            match walker.onwards(before, last, step) {
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

    /// What was asked for along the path; see `SectionSolver::free_path`.
    pub fn states(
        &self,
        problem: &Problem,
        newton: &mut Newton,
        request: &PathRequest<'_>,
        hand: f64,
    ) -> Result<FreePath, SectionError> {
        let last = &self.stations[self.stations.len() - 1];
        let end_pressure = last.pressure();
        let mut wanted: Vec<f64> =
            request.pressures.iter().map(|pressure| pressure / self.units.stress).collect();
        wanted.push(0.0);
        wanted.retain(|pressure| *pressure < end_pressure);
        let all_reached = wanted.len() > request.pressures.len();
        if self.end == PathEnd::LimitPoint {
            let spaces = (request.extra_states + 1) as f64;
            let at = |i| PressureUnit::Limit(end_pressure).pressure(i as f64 / spaces);
            wanted.extend((1..=request.extra_states).map(at));
        }
        wanted.sort_by(f64::total_cmp);
        // An extra state that falls on a pressure asked for would be the same state again.
        wanted.dedup_by(|b, a| *b - *a < 1e-9 * end_pressure);

        let mut walker = Walker { problem, newton, loads: self.loads, by_volume: false };
        let mut states = Vec::with_capacity(wanted.len() + 1);
        for pressure in wanted {
            states.push(self.state_at(&mut walker, pressure, hand)?);
        }
        if self.end == PathEnd::LimitPoint || !all_reached {
            states.push(self.report(problem, last, hand));
        }
        if let Some(tolerance) = request.interpolation_tolerance {
            resolve(&mut states, self.end, (tolerance, self.units.length), &mut |pressure| {
                self.state_at(&mut walker, pressure / self.units.stress, hand)
            })?;
        }
        let beyond = match request.beyond_limit {
            Some(ratio) if self.end == PathEnd::LimitPoint => self.beyond(problem, newton, ratio, hand),
            _ => vec![],
        };
        Ok(FreePath { beyond, ..FreePath::solved(states, self.end) })
    }

    /// The state at a pressure (in mu) below that of the last station.
    fn state_at(&self, walker: &mut Walker<'_>, pressure: f64, hand: f64) -> Result<FreeState, SectionError> {
        let after = self.stations.partition_point(|station| station.pressure() <= pressure);
        let (low, high) = (&self.stations[after - 1], &self.stations[after]);
        if low.pressure() == pressure {
            return Ok(self.report(walker.problem, low, hand));
        }
        match walker.at_pressure(low, high, pressure) {
            Ok(station) => Ok(self.report(walker.problem, &station, hand)),
            Err(failed) => Err(SectionError::NotConverged {
                target: self.units.whereabouts(&[low.state.globals[0], low.state.globals[1], pressure]),
                residual: failed.residual,
                last_good: self.units.whereabouts(&low.state.globals),
            }),
        }
    }

    /// States past the limit point, evenly spaced in volume up to `ratio` times that of the limit state, as far as the section has
    /// states that are stable at a given volume and Newton's method finds them.
    fn beyond(&self, problem: &Problem, newton: &mut Newton, ratio: f64, hand: f64) -> Vec<FreeState> {
        let mut walker = Walker { problem, newton, loads: self.loads, by_volume: true };
        let limit = &self.stations[self.stations.len() - 1];
        let mut before = self.stations.len().checked_sub(2).map(|index| self.stations[index].clone());
        let mut last = limit.clone();
        // Less than a rounding more is no further step.
        let count = ((ratio - 1.0) / BEYOND_STEP - 1e-6).ceil().max(1.0) as usize;
        let mut states = Vec::with_capacity(count);
        for index in 1..=count {
            let goal = limit.volume * (1.0 + (ratio - 1.0) * index as f64 / count as f64);
            let mut step = goal - last.volume;
            while last.volume < goal * (1.0 - 1e-9) {
                match walker.onwards(before.as_ref(), &last, step.min(goal - last.volume)) {
                    Ok((station, _)) => before = Some(std::mem::replace(&mut last, station)),
                    Err(_) if step > SHORTEST_STEP * last.volume => step *= 0.5,
                    Err(_) => return states,
                }
            }
            states.push(self.report(problem, &last, hand));
        }
        states
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
            section: Some(self.constants(station, hand)),
            mesh_error: None,
        }
    }

    /// Energy and stiffness at a station. The mirror image of a winding has twist, torque and coupling of the other sign.
    fn constants(&self, station: &Station, hand: f64) -> SectionConstants {
        let Units { length: b, stress: mu } = self.units;
        let (line, schur) = (mu * b * b, &station.schur);
        let coupling = hand * line * b * schur[(0, 1)];
        SectionConstants {
            energy: line * (station.enthalpy + station.pressure() * station.volume),
            volume: b * b * station.volume,
            stiffness: [[line * schur[(0, 0)], coupling], [coupling, line * b * b * schur[(1, 1)]]],
            pressure_slopes: [b * b * schur[(0, 2)], hand * b * b * b * schur[(1, 2)]],
        }
    }
}
