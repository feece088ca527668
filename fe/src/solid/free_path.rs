//! A FREE's path from rest up to a pressure or to its limit pressure: by rising pressure as long as that is safe, by rising enclosed
//! volume from there on.

use super::{
    SolidError, SolidSolver,
    state::{SolidLoad, SolidState},
};
use actuator::{EndLoad, FreePath, FreeState, Middle, PathEnd};
use nalgebra::Vector3;

/// Share of the section's limit pressure up to which the pressure is prescribed. A tube between caps gives way no earlier than
/// its section by more than that.
const BY_PRESSURE: f64 = 0.9;
/// Step of the enclosed volume beyond, as a share of the present one.
const VOLUME_STEP: f64 = 0.05;
/// Shortest such step before the path is given up.
const SHORTEST_STEP: f64 = 1e-4;
/// A path ends where the bore or the length has grown this often, whether or not it has met a limit point or the pressure.
const RANGE: f64 = 3.0;
/// Change of log p over that of log V at which the pressure counts as stationary. The pressure is then exact to about the square
/// of this.
const FLAT: f64 = 2e-3;
/// Share of a pressure from which its state is sought by prescribing it.
const NEAR: f64 = 1e-4;

/// An equilibrium on the path.
#[derive(Clone)]
struct Station {
    state: SolidState,
    /// Enclosed volume of the whole tube, m^3.
    volume: f64,
    /// dp/dV along the path, Pa/m^3: positive where the pressure rises.
    slope: f64,
    /// Whether the tangent has no negative eigenvalue: stable under prescribed pressure.
    stable: bool,
}

impl Station {
    fn pressure(&self) -> f64 {
        self.state.load().pressure
    }
}

/// Given each state of a path, with the solver that found it and what it comes to; says whether to go on.
type Seen<'a> = dyn FnMut(&SolidSolver, &SolidState, &FreeState) -> bool + 'a;

/// The path so far. A state is handed out when the next one is known, for until then the limit point may take its place.
struct Trail<'a> {
    states: Vec<FreeState>,
    /// The last state, until it is handed out.
    last: Option<SolidState>,
    seen: &'a mut Seen<'a>,
}

impl Trail<'_> {
    fn push(&mut self, solver: &SolidSolver, state: &SolidState) -> Result<(), SolidError> {
        self.hand_out(solver)?;
        self.states.push(solver.report(state));
        self.last = Some(state.clone());
        Ok(())
    }

    fn pop(&mut self) {
        self.states.pop();
        self.last = None;
    }

    fn pressure(&self) -> f64 {
        self.states.last().map_or(0.0, |state| state.pressure)
    }

    fn hand_out(&mut self, solver: &SolidSolver) -> Result<(), SolidError> {
        match (self.last.take(), self.states.last()) {
            (Some(state), Some(report)) if !(self.seen)(solver, &state, report) => Err(SolidError::Stopped),
            _ => Ok(()),
        }
    }

    fn end(mut self, solver: &SolidSolver, end: PathEnd) -> Result<FreePath, SolidError> {
        self.hand_out(solver)?;
        Ok(FreePath::solved(self.states, end))
    }
}

/// Volume between two stations at which the cubic through them takes a pressure that lies between theirs.
fn cubic_root(a: &Station, b: &Station, pressure: f64) -> f64 {
    let h = b.volume - a.volume;
    let off = |t: f64| {
        let (t2, t3) = (t * t, t * t * t);
        let values = (2.0 * t3 - 3.0 * t2 + 1.0) * a.pressure() + (3.0 * t2 - 2.0 * t3) * b.pressure();
        values + h * ((t3 - 2.0 * t2 + t) * a.slope + (t3 - t2) * b.slope) - pressure
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if off(middle) < 0.0 { low = middle } else { high = middle }
    }
    a.volume + h * low
}

impl SolidSolver {
    /// States at `pressures` (Pa, rising, the first zero) as far as there are any. A path that meets its limit point ends there, with
    /// further states on the way to it. `load` is on the tip's cap from zero pressure up. `safe_pressure` (Pa) is one well below the limit pressure, if it is known: up to there no
    /// other equilibrium can be taken for the next one. `told` is called after each state and says whether to go on.
    ///
    /// Whether the tube buckles sideways on the way is not asked here.
    ///
    /// # Errors
    /// [`SolidError::NotConverged`] where the path is lost, [`SolidError::Stopped`].
    pub fn free_path(
        &mut self,
        load: EndLoad,
        pressures: &[f64],
        safe_pressure: Option<f64>,
        told: &mut dyn FnMut() -> bool,
    ) -> Result<FreePath, SolidError> {
        self.free_path_seen(load, pressures, safe_pressure, told, &mut |_, _, _| true)
    }

    /// The same path, its states being shown to `seen` as they become certain, that at rest first: with the solver, for fields and
    /// strains, and with what the path says of them. It, too, says whether to go on.
    ///
    /// # Errors
    /// Those of [`SolidSolver::free_path`].
    pub fn free_path_seen<'a>(
        &mut self,
        load: EndLoad,
        pressures: &[f64],
        safe_pressure: Option<f64>,
        told: &mut dyn FnMut() -> bool,
        seen: &'a mut (dyn FnMut(&SolidSolver, &SolidState, &FreeState) -> bool + 'a),
    ) -> Result<FreePath, SolidError> {
        let mut rest = self.rest();
        if load != EndLoad::NONE {
            let part = |share| SolidLoad::axial(0.0, load.times(share));
            rest = self.follow(&rest, 0.0, &[1.0], &part, &mut |_, _| true)?;
        }
        let mut trail = Trail { states: vec![], last: None, seen };
        trail.push(self, &rest)?;
        let safe = safe_pressure.map_or(f64::INFINITY, |limit| BY_PRESSURE * limit);
        let stops: Vec<f64> = pressures.iter().copied().filter(|p| *p > 0.0 && *p <= safe).collect();
        let mut found = Vec::with_capacity(stops.len());
        let followed =
            self.follow(&rest, 0.0, &stops, &|pressure| SolidLoad::axial(pressure, load), &mut |_, state| {
                found.push(state.clone());
                told()
            });
        // Lost or not: what was found is judged below.
        if let Err(SolidError::Stopped) = followed {
            return Err(SolidError::Stopped);
        }
        let mut last = self.station(rest.clone())?;
        if let Some(state) = found.last() {
            let station = self.station(state.clone())?;
            // Where no safe pressure is known, Newton's method may have stepped over the limit point to another equilibrium.
            if station.stable && station.slope > 0.0 && (safe.is_finite() || found.len() == stops.len()) {
                for state in &found {
                    trail.push(self, state)?;
                }
                last = station;
            }
        }
        let mut wanted: Vec<f64> = pressures.iter().copied().filter(|p| *p > last.pressure()).collect();
        let mut share = VOLUME_STEP;
        while !wanted.is_empty() {
            let next = match self.volume_step(&last, last.volume * (1.0 + share)) {
                Err(SolidError::NotConverged { .. }) if share > SHORTEST_STEP => {
                    share *= 0.5;
                    continue;
                }
                other => other?,
            };
            share = (1.5 * share).min(VOLUME_STEP);
            let limit = if next.slope <= 0.0 { Some(self.limit(&last, &next)?) } else { None };
            let upper = limit.as_ref().unwrap_or(&next);
            while let Some(pressure) = wanted.first().copied().filter(|p| *p <= upper.pressure()) {
                wanted.remove(0);
                let state = self.at_pressure(&last, upper, pressure)?;
                trail.push(self, &state)?;
                if !told() {
                    return Err(SolidError::Stopped);
                }
            }
            // A state that falls on a pressure asked for would be the same again.
            let is_new = upper.pressure() > trail.pressure() * (1.0 + 1e-6);
            if let Some(limit) = limit {
                if !is_new {
                    trail.pop();
                }
                trail.push(self, &limit.state)?;
                return trail.end(self, PathEnd::LimitPoint);
            }
            let report = self.report(&next.state);
            let grown = report.axial_stretch > RANGE || self.deformation(&next.state).bore_mid > RANGE;
            if is_new && !wanted.is_empty() {
                trail.push(self, &next.state)?;
            }
            if grown {
                break;
            }
            last = next;
        }
        trail.end(self, PathEnd::Range)
    }

    fn station(&mut self, mut state: SolidState) -> Result<Station, SolidError> {
        let lost = |what: &str| SolidError::Singular(what.to_owned());
        let held = state.load.held;
        self.assemble(&state, true).map_err(|_| lost("an element is inverted"))?;
        self.factorise(held).map_err(|_| lost("a pivot is zero"))?;
        state.volume = self.forces.volume;
        let (_, step) = self.first_order(&state, 1.0, [Vector3::zeros(); 2], Vector3::zeros(), None);
        let by_pressure: f64 = self.forces.by_pressure.iter().zip(&step).map(|(a, b)| a * b).sum();
        let sectors = self.body.grid.sectors as f64;
        let stable = self.inertia.as_ref().is_some_and(|inertia| inertia.negative == 0);
        Ok(Station { volume: sectors * state.volume, slope: 1.0 / (sectors * by_pressure), stable, state })
    }

    fn volume_step(&mut self, from: &Station, volume: f64) -> Result<Station, SolidError> {
        let state = self.inflate(&from.state, &[volume], &mut |_, _| true)?;
        self.station(state)
    }

    /// The state of greatest pressure between one where it rises and one where it falls.
    fn limit(&mut self, rising: &Station, falling: &Station) -> Result<Station, SolidError> {
        let (mut a, mut b) = (rising.clone(), falling.clone());
        // False position on the slope, an end that stays twice being halved (Illinois).
        let (mut slope_a, mut slope_b) = (a.slope, b.slope);
        for _ in 0..40 {
            let volume = (a.volume * slope_b - b.volume * slope_a) / (slope_b - slope_a);
            let nearer = if volume - a.volume < b.volume - volume { &a } else { &b };
            let station = self.volume_step(&nearer.clone(), volume)?;
            if station.slope.abs() * station.volume <= FLAT * station.pressure() {
                return Ok(station);
            }
            if station.slope > 0.0 {
                (slope_a, a) = (station.slope, station);
                slope_b *= 0.5;
            } else {
                (slope_b, b) = (station.slope, station);
                slope_a *= 0.5;
            }
        }
        Err(SolidError::NotConverged {
            target: "the limit pressure".into(),
            residual: f64::NAN,
            last_good: 1e-3 * a.pressure(),
            advice: "Use a finer mesh",
        })
    }

    /// The state at a pressure between those of two stations.
    fn at_pressure(
        &mut self,
        low: &Station,
        high: &Station,
        pressure: f64,
    ) -> Result<SolidState, SolidError> {
        let mut volume = cubic_root(low, high, pressure);
        let mut from = low.clone();
        for _ in 0..12 {
            let station = self.volume_step(&from, volume)?;
            let off = pressure - station.pressure();
            if off.abs() <= NEAR * pressure {
                let start = station.pressure();
                let ends = *station.state.load();
                let at = |pressure| SolidLoad { pressure, ..ends };
                return self.follow(&station.state, start, &[pressure], &at, &mut |_, _| true);
            }
            volume = (station.volume + off / station.slope).clamp(low.volume, high.volume);
            from = station;
        }
        Err(SolidError::NotConverged {
            target: format!("{:.4} kPa", 1e-3 * pressure),
            residual: f64::NAN,
            last_good: 1e-3 * low.pressure(),
            advice: "Use a finer mesh",
        })
    }

    fn report(&self, state: &SolidState) -> FreeState {
        let deformation = self.deformation(state);
        FreeState {
            pressure: state.load().pressure,
            axial_stretch: deformation.stretch_total,
            expansion: deformation.expansion_mid,
            twist_per_length: deformation.twist_total,
            residual: state.residual(),
            middle: Some(Middle {
                axial_stretch: deformation.stretch_mid,
                twist_per_length: deformation.twist_mid,
            }),
            section: None,
            mesh_error: None,
        }
    }
}
