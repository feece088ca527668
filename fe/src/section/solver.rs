use super::{
    PathRequest, SectionError, SectionMesh,
    error::Whereabouts,
    mesh::Grid,
    mesh_error::estimate,
    newton::{Control, Failed, Given, Newton},
    path::Path,
    problem::{Problem, State},
};
use crate::SectionResponse;
use actuator::{ElastomerError, EndLoad, Free, FreePath};
use nalgebra::Matrix3;

/// Shortest share of the way to a wanted state that is tried.
const SHORTEST_SHARE: f64 = 1.0 / 64.0;

/// The cross-section of a FREE far from its caps, solved by finite elements on one fibre pitch.
///
/// A tube with N equal helical fibres is carried into itself by its own screw motion, so that the deformation is
/// x = (r, Theta + psi Z + phi, lambda Z + w) with r, phi, w functions of R and eta = Theta - k Z only, k = cot(angle)/B:
/// a problem on the cross-section, exact in length, with the axial stretch lambda and the twist per reference length psi as two
/// unknowns more. Pressure acts as -p V with V the enclosed volume (closed ends included), force and torque as -F lambda - M psi.
///
/// The solver remembers the state of its last answer and starts the next one from it; answers do not depend on that start
/// beyond the residual allowed (1e-10 relative) unless the section has several stable equilibria; unstable ones are not taken.
#[derive(Clone, Debug)]
pub struct SectionSolver {
    free: Free,
    /// `None` where the grid was given.
    mesh: Option<SectionMesh>,
    pub(super) units: Units,
    pub(super) problem: Problem,
    pub(super) newton: Newton,
    rest: State,
    pub(super) state: State,
}

/// What is given beside stretch and twist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Third {
    /// The pressure.
    Pressure,
    /// The enclosed volume.
    Volume,
}

/// Units of the problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Units {
    /// B, m.
    pub length: f64,
    /// mu, Pa.
    pub stress: f64,
}

impl Units {
    pub fn whereabouts(&self, globals: &[f64; 3]) -> Whereabouts {
        Whereabouts {
            pressure: globals[2] * self.stress,
            axial_stretch: globals[0],
            twist_per_length: globals[1] / self.length,
        }
    }
}

pub(crate) fn check(
    field: &'static str,
    value: f64,
    accepted: bool,
    requirement: &'static str,
) -> Result<(), SectionError> {
    if accepted { Ok(()) } else { Err(SectionError::Invalid { field, value, requirement }) }
}

/// Whether the section can represent the FREE.
fn check_free(free: &Free, mesh: SectionMesh) -> Result<(), SectionError> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let (tube, winding) = (&free.tube, &free.winding);
    check(
        "inner_radius",
        tube.inner_radius,
        positive(tube.inner_radius),
        "it must be a positive length in m",
    )?;
    check("wall", tube.wall, positive(tube.wall), "it must be a positive length in m")?;
    let angle = winding.angle_from_hoop();
    let accepted = (0.02..=std::f64::consts::FRAC_PI_2).contains(&angle);
    check("winding_angle", angle, accepted, "a helix needs 0.02 to pi/2 rad (1.15 to 90 deg) from the hoop")?;
    let fibres = f64::from(winding.fibres);
    check("fibres", fibres, (1.0..=1000.0).contains(&fibres), "there must be 1 to 1000 of them")?;
    let fibre = winding.fibre;
    let stiffness = fibre.axial_stiffness;
    check(
        "axial_stiffness",
        stiffness,
        stiffness.is_finite() && stiffness >= 0.0,
        "EA must be zero or more, in N",
    )?;
    let requirement = "a fibre without width is a line load without an answer; give its diameter in m";
    check("diameter", fibre.diameter, positive(fibre.diameter), requirement)?;
    let of_rubber = |error: ElastomerError| SectionError::Invalid {
        field: error.field,
        value: error.value,
        requirement: error.requirement,
    };
    free.elastomer.check().map_err(of_rubber)?;
    for (field, count) in
        [("radial", mesh.radial), ("under_fibre", mesh.under_fibre), ("between_fibres", mesh.between_fibres)]
    {
        let accepted = (1..=64).contains(&count);
        check(field, count as f64, accepted, "a mesh takes 1 to 64 elements a direction")?;
    }
    Ok(())
}

impl SectionSolver {
    /// Prepares the section of `free`. The winding's hand is used by [`SectionSolver::path`] only.
    ///
    /// # Errors
    /// [`SectionError::Invalid`] where a number makes no tube, no helix or no mesh.
    pub fn new(free: &Free, mesh: SectionMesh) -> Result<Self, SectionError> {
        check_free(free, mesh)?;
        let grid = Grid::half_pitch(free, mesh);
        Ok(SectionSolver { mesh: Some(mesh), ..Self::with_grid(free, grid) })
    }

    pub(crate) fn with_grid(free: &Free, grid: Grid) -> Self {
        let problem = Problem::new(free, grid);
        let newton = Newton::new(&problem);
        let rest = problem.rest();
        let units = Units { length: free.tube.outer_radius(), stress: free.elastomer.shear_modulus() };
        SectionSolver { free: *free, mesh: None, units, problem, newton, state: rest.clone(), rest }
    }

    /// Answers as exact as rounding lets them be: what is left of the residual otherwise hinders a solver above this one.
    pub fn to_rounding(mut self) -> Self {
        self.newton.tolerance = 0.0;
        self
    }

    /// The FREE.
    pub fn free(&self) -> &Free {
        &self.free
    }

    /// Share of the circumference that the fibres cover, 0 to 1.
    pub fn covered(&self) -> f64 {
        self.problem.grid.covered()
    }

    /// Response at gauge pressure (Pa), axial stretch and twist per reference length (rad/m), for a right-handed winding.
    ///
    /// # Errors
    /// [`SectionError::NotConverged`] where no equilibrium is found, for instance above the pressure at which the section
    /// balloons at this stretch and twist. The solver stays usable.
    pub fn respond(
        &mut self,
        pressure: f64,
        axial_stretch: f64,
        twist_per_length: f64,
    ) -> Result<SectionResponse, SectionError> {
        self.answer(pressure, axial_stretch, twist_per_length).map(|(response, _)| response)
    }

    /// The response, dN/dp (m^2) and dM/dp (m^3) at constant stretch and twist.
    pub(super) fn answer(
        &mut self,
        pressure: f64,
        axial_stretch: f64,
        twist_per_length: f64,
    ) -> Result<(SectionResponse, [f64; 2]), SectionError> {
        check("pressure", pressure, pressure.is_finite(), "it must be a number, in Pa")?;
        check("axial_stretch", axial_stretch, axial_stretch > 0.0, "a stretch is positive")?;
        check(
            "twist_per_length",
            twist_per_length,
            twist_per_length.is_finite(),
            "it must be a number, in rad/m",
        )?;
        let target = [axial_stretch, twist_per_length * self.units.length, pressure / self.units.stress];
        let schur = self.reach(target, Third::Pressure).map_err(|failed| SectionError::NotConverged {
            target: self.units.whereabouts(&target),
            residual: failed.residual,
            last_good: self.units.whereabouts(&self.state.globals),
        })?;
        let system = &self.newton.system;
        let Units { length: b, stress: mu } = self.units;
        let (line, torque) = (mu * b * b, mu * b * b * b);
        let response = SectionResponse {
            energy: line * system.energy,
            force: line * system.global_residual[0],
            torque: torque * system.global_residual[1],
            stiffness: [
                [line * schur[(0, 0)], torque * schur[(0, 1)]],
                [torque * schur[(1, 0)], torque * b * schur[(1, 1)]],
            ],
        };
        Ok((response, [b * b * schur[(0, 2)], b * b * b * schur[(1, 2)]]))
    }

    /// Expansion b/B (b the outer radius of equal area) of the last state answered.
    pub fn expansion(&self) -> f64 {
        self.problem.expansion(&self.state)
    }

    /// Brings `self.state` to a given stretch, twist and third quantity, from itself or, failing that, from rest. Returns the
    /// stiffness of (stretch, twist, pressure).
    pub(super) fn reach(&mut self, target: [f64; 3], third: Third) -> Result<Matrix3<f64>, Failed> {
        self.walk(target, third).or_else(|_| {
            self.state.clone_from(&self.rest);
            self.walk(target, third)
        })
    }

    fn walk(&mut self, target: [f64; 3], third: Third) -> Result<Matrix3<f64>, Failed> {
        let mut share = 1.0f64;
        let mut trial = self.state.clone();
        loop {
            let mut from = self.state.globals;
            if third == Third::Volume {
                from[2] = self.problem.volume(&self.state);
            }
            let last = share >= 1.0;
            let goal: [f64; 3] =
                std::array::from_fn(
                    |i| {
                        if last { target[i] } else { from[i] + share * (target[i] - from[i]) }
                    },
                );
            let mut control: Control = goal.map(Given::Value);
            if third == Third::Volume {
                control[2] = Given::Conjugate(goal[2]);
            }
            trial.clone_from(&self.state);
            let found = self.newton.solve(&self.problem, &mut trial, &control).and_then(|_| match third {
                Third::Pressure => self.newton.condense_stable(),
                // A bare wall that is squeezed would rather wrinkle, which the threads about it do not let it.
                Third::Volume => self.newton.condense().map(|(schur, _)| schur),
            });
            match found {
                Ok(schur) => {
                    self.state.clone_from(&trial);
                    if last {
                        return Ok(schur);
                    }
                    // What was a share of the old remainder is a larger share of the new one.
                    share = (2.0 * share / (1.0 - share)).min(1.0);
                }
                Err(failed) => {
                    share *= 0.5;
                    if share < SHORTEST_SHARE {
                        return Err(failed);
                    }
                }
            }
        }
    }

    /// States under free, closed ends: those at the `pressures` (Pa, rising) that exist, and `extra` more, evenly spaced in
    /// s = 1 - sqrt(1 - p/p_limit), up to and including the limit state. Twist has the sign of the FREE's own hand.
    ///
    /// # Errors
    /// As [`SectionSolver::free_path`].
    pub fn path(&mut self, pressures: &[f64], extra: usize) -> Result<FreePath, SectionError> {
        self.free_path(&PathRequest { pressures, extra_states: extra, ..PathRequest::default() })
    }

    /// Limit pressure (Pa), where there is one, with a constant axial force and torque on the closed ends.
    ///
    /// # Errors
    /// As [`SectionSolver::free_path`].
    pub fn limit_pressure(&mut self, load: EndLoad) -> Result<Option<f64>, SectionError> {
        let path = self.free_path(&PathRequest { load, pressures: &[0.0], ..PathRequest::default() })?;
        Ok(path.limit_pressure())
    }

    /// The same as [`SectionSolver::path`] with a constant axial force and torque on the closed ends, present from zero pressure
    /// up.
    ///
    /// # Errors
    /// As [`SectionSolver::free_path`].
    pub fn path_under(
        &mut self,
        load: EndLoad,
        pressures: &[f64],
        extra: usize,
    ) -> Result<FreePath, SectionError> {
        self.free_path(&PathRequest { load, pressures, extra_states: extra, ..PathRequest::default() })
    }

    /// States of the FREE from zero pressure up, with energy, stiffness and what else was asked for. Twist, torque and coupling have
    /// the sign of the FREE's own hand.
    ///
    /// The path is followed by prescribing the enclosed volume, beyond the greatest pressure asked for, until the pressure has
    /// a maximum; a FREE that swells or stretches threefold without one ends with `PathEnd::Range`, and then states beyond the
    /// pressures asked for are left out. Errors are estimated where the mesh can be halved.
    ///
    /// # Errors
    /// [`SectionError::NotConverged`] where the path cannot be followed, also where the FREE does not bear the load without
    /// pressure; [`SectionError::Invalid`] where a number asked for makes no sense.
    pub fn free_path(&mut self, request: &PathRequest<'_>) -> Result<FreePath, SectionError> {
        request.check()?;
        let hand = self.free.winding.handedness.sign();
        let Units { length: b, stress: mu } = self.units;
        let EndLoad { force, torque } = request.load;
        let loads = [force / (mu * b * b), hand * torque / (mu * b * b * b)];
        let path = Path::follow(&self.problem, &mut self.newton, &self.rest, loads, self.units)?;
        let mut path = path.states(&self.problem, &mut self.newton, request, hand)?;
        if let Some([a, b]) = self.mesh.and_then(SectionMesh::coarsened).filter(|_| request.estimate_errors) {
            let pressures: Vec<f64> = path.states.iter().map(|state| state.pressure).collect();
            let on = |mesh| Self::new(&self.free, mesh)?.path_under(request.load, &pressures, 0);
            estimate(&mut path, &[on(a)?, on(b)?]);
        }
        Ok(path)
    }
}
