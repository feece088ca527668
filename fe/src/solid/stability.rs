use super::{SolidError, body::Follows, newton::SolidSolver, state::SolidState};
use crate::sparse::lowest_modes;
use nalgebra::Vector3;

/// Weight of an unknown that is held: its mode lies above all others.
pub(crate) const HELD: f64 = 1e-15;

/// A motion to which an equilibrium gives little resistance, or none.
///
/// `K v = value M v` with the tangent K under dead loads and prescribed pressure, held motions of the cap taken out, and the
/// metric `v.M v = integral mu |v|^2/B^2 dV` (mu the rubber's initial shear modulus, B the tube's outer radius, lumped at the points):
/// the value is the stiffness against the motion over that of a block of rubber as large as the radius, 0 where the equilibrium is
/// critical, negative where it is unstable. The frame of a beam's node weighs as a point at the distance of the wall.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidMode {
    /// Eigenvalue.
    pub value: f64,
    /// Bound on its relative error.
    pub error: f64,
    /// Motion of each point of the mesh; the largest is 1.
    pub displacements: Vec<[f64; 3]>,
    /// Motion of the cap's middle and its turn (1/m) in the same scale.
    pub cap: [Vector3<f64>; 2],
    /// The same on the unknowns.
    pub(super) vector: Vec<f64>,
}

/// Signs of the tangent of an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// Negative eigenvalues at prescribed loads: the number of independent unstable motions, 0 for a stable equilibrium.
    pub negative: usize,
    /// Eigenvalues that are zero to working accuracy.
    pub zero: usize,
    /// Negative eigenvalues when the enclosed volume is prescribed instead of the pressure (an incompressible fluid inside).
    pub negative_at_volume: usize,
    /// dV/dp, m^3/Pa, at the other loads; it changes sign through infinity where the pressure has its limit.
    pub compliance: f64,
    /// Modes next to singular at prescribed loads, least |value| first.
    pub modes: Vec<SolidMode>,
}

impl Stability {
    /// The eigenvalue number `index`, ascending from the lowest, if it is among the modes.
    pub(super) fn eigenvalue(&self, index: usize) -> Option<f64> {
        let mut values: Vec<f64> = self.modes.iter().map(|mode| mode.value).collect();
        values.sort_by(f64::total_cmp);
        let first_positive = values.iter().position(|value| *value >= 0.0).unwrap_or(values.len());
        (first_positive + index).checked_sub(self.negative).and_then(|place| values.get(place).copied())
    }
}

impl SolidSolver {
    /// Stability of an equilibrium, with up to `modes` modes next to singular.
    ///
    /// The negative pivots of the tangent are its negative eigenvalues (Sylvester). With the constraint b.v = 0, b = dV/du, the
    /// bordered matrix has one more negative eigenvalue than K where dV/dp = b.K^-1 b > 0 and none more where it is negative; one
    /// of them is the constraint's.
    ///
    /// # Errors
    /// [`SolidError::Singular`] where elimination meets a zero pivot; [`SolidError::NotConverged`] where elements of the state are
    /// turned inside out.
    pub fn stability(&mut self, state: &SolidState, modes: usize) -> Result<Stability, SolidError> {
        let held = state.load.held;
        self.assemble(state, true).map_err(|lost| self.lost(state, lost, "the tangent"))?;
        self.body.take_out_held(held);
        let inertia = self
            .factorisation
            .factorise(&self.body.values)
            .map_err(|error| SolidError::Singular(error.to_string()))?;
        self.inertia = Some(inertia);
        let mut step = self.forces.by_pressure.clone();
        for direction in (0..6).filter(|&direction| held[direction]) {
            step[self.body.cap_unknown + direction] = 0.0;
        }
        self.substitute(&mut step);
        let compliance: f64 = self.forces.by_pressure.iter().zip(&step).map(|(a, b)| a * b).sum();
        let metric = self.metric(state);
        let modes = lowest_modes(&mut self.factorisation, modes, Some(&metric))
            .into_iter()
            .map(|mode| self.mode(state, mode.value, mode.error, mode.vector))
            .collect();
        let unstable = inertia.negative;
        Ok(Stability {
            negative: unstable,
            zero: inertia.zero,
            negative_at_volume: if compliance > 0.0 { unstable } else { unstable.saturating_sub(1) },
            compliance,
            modes,
        })
    }

    fn mode(&self, state: &SolidState, value: f64, error: f64, mut vector: Vec<f64>) -> SolidMode {
        let (mut displacements, mut cap) = self.body.displacements(state, &vector);
        let largest = displacements
            .iter()
            .map(|u| Vector3::from(*u))
            .max_by(|a, b| a.norm().total_cmp(&b.norm()))
            .unwrap_or(Vector3::x());
        let scale = largest[largest.iamax()].signum() / largest.norm().max(f64::MIN_POSITIVE);
        vector.iter_mut().chain(displacements.as_flattened_mut()).for_each(|x| *x *= scale);
        cap.iter_mut().for_each(|motion| *motion *= scale);
        SolidMode { value, error, displacements, cap, vector }
    }

    /// Diagonal of M, N/m (N m for turns).
    pub(crate) fn metric(&self, state: &SolidState) -> Vec<f64> {
        let body = &self.body;
        let tube = body.specimen.tube;
        let stiffness = body.specimen.elastomer.initial_shear_modulus() / tube.outer_radius().powi(2);
        let mut metric = vec![0.0; self.unknowns()];
        let volumes = body.point_volumes();
        for ((follows, volume), place) in body.follows.iter().zip(&volumes).zip(&state.positions) {
            let weight = stiffness * volume;
            match *follows {
                Follows::Base => {}
                Follows::Own(block) => {
                    let first = body.pattern.first(block);
                    metric[first..first + 3].iter_mut().for_each(|sum| *sum += weight);
                }
                Follows::Cap => {
                    // A cap that is free in all directions is turned in its own frame.
                    let arm = Vector3::from(*place) - state.cap;
                    let free = state.load.held == [false; 6];
                    let arm = if free { state.cap_rotation.inverse() * arm } else { arm };
                    for axis in 0..3 {
                        metric[body.cap_unknown + axis] += weight;
                        metric[body.cap_unknown + 3 + axis] +=
                            weight * (arm.norm_squared() - arm[axis].powi(2));
                    }
                }
            }
        }
        let mean = stiffness * volumes.iter().sum::<f64>() / volumes.len() as f64;
        for follows in &body.turns {
            if let Follows::Own(block) = *follows {
                let first = body.pattern.first(block);
                metric[first..first + 3].fill(mean * tube.wall.powi(2));
            }
        }
        for direction in (0..6).filter(|&direction| state.load.held[direction]) {
            metric[body.cap_unknown + direction] = HELD;
        }
        metric
    }

    /// `E - p V - F.(displacement of the cap)`, J: least at the stablest of several equilibria under the same loads. For loads without
    /// gravity and moments.
    pub fn potential(&self, state: &SolidState) -> f64 {
        let moved = state.cap - Vector3::z() * self.body.specimen.tube.length;
        let share = 1.0 / self.body.grid.sectors as f64;
        let work = if state.load.pressure == 0.0 { 0.0 } else { state.load.pressure * state.volume };
        state.energy - work - share * state.load.force.dot(&moved)
    }

    /// The lines of points along the outer surface, m, each from base to tip, as they are moved by `factor` times a mode.
    pub fn outer_lines(&self, state: &SolidState, mode: Option<(&SolidMode, f64)>) -> Vec<Vec<[f64; 3]>> {
        let grid = &self.body.grid;
        let place = |point: usize| {
            let mut place = state.positions[point];
            if let Some((mode, factor)) = mode {
                place.iter_mut().zip(mode.displacements[point]).for_each(|(x, u)| *x += factor * u);
            }
            place
        };
        (0..grid.lines[1])
            .map(|j| {
                (0..grid.lines[2]).map(|k| place(grid.point(grid.lines[0] - 1, j, k) as usize)).collect()
            })
            .collect()
    }
}
