use crate::{
    CapEffect, CapSample, CapTable, Run, SectionLaw, SolidError, SolidLoad, SolidMesh, SolidSolver,
    SolidState, Specimen,
};
use actuator::{EndLoad, Free};
use nalgebra::Matrix2;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How it is found what caps do to a FREE in a module: a solid straight between them, under pressures and loads along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapSweep {
    /// Pressures.
    pub planes: usize,
    /// Length of the solid over its outer radius.
    pub length: f64,
    /// Stretch, and twist over the free FREE's greatest, that the axial loads give to about.
    pub range: [f64; 2],
}

impl Default for CapSweep {
    /// 60 mm of the paper's tube, whose ends do not feel each other: from 60 and from 120 mm end extension and end turn are the same to
    /// 1e-3 mm and 1e-3 rad at 30 and 60 degrees up to 45 kPa. Modules turn their FREEs back to where they began.
    fn default() -> Self {
        CapSweep { planes: 7, length: 10.8, range: [0.04, 1.0] }
    }
}

/// Least twist times the outer radius that the torques are to give.
const LEAST_TWIST: f64 = 0.05;
/// Greatest force and torque over what the greatest pressure does on the outer cross-section, and on threads of 45 degrees.
const GREATEST_LOAD: f64 = 1.5;
/// Near a limit point a small load gives any stretch: compliances count up to so many times the least.
const SOFTEST: f64 = 2.0;
/// Greatest loads, in units of their sizes, the torque against the sense in which the FREE turns itself; each is followed through its half.
/// Wound further in its own sense, a FREE that is not under pressure gives way soon, and nothing in a module winds it far.
const LOADS: [[f64; 2]; 8] =
    [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -0.5], [0.7, 0.7], [-0.7, 0.7], [0.7, -0.35], [-0.5, -0.35]];

/// What a solid's ends do, and stretch and twist of its middle.
fn ends(solver: &SolidSolver, state: &SolidState, length: f64) -> ([f64; 2], [f64; 2]) {
    let seen = solver.deformation(state);
    let middle = [seen.stretch_mid, seen.twist_mid];
    ([(seen.stretch_total - middle[0]) * length, (seen.twist_total - middle[1]) * length], middle)
}

impl CapSweep {
    fn solver(&self, free: &Free) -> Result<(SolidSolver, f64), SolidError> {
        let mut free = *free;
        free.tube.length = self.length * free.tube.outer_radius();
        let mesh = SolidMesh::lean(&free);
        let specimen = Specimen::from(&free);
        let solver = if free.winding.fibres == 1 {
            SolidSolver::new(&specimen, mesh)?
        } else {
            SolidSolver::sector(&specimen, mesh)?
        };
        Ok((solver, free.tube.length))
    }

    /// What the caps do up to a pressure (Pa) to a FREE whose section law is `section`, as if right-handed and whatever its length;
    /// pressures at which the solid has no equilibrium are left out. `None` where the run was stopped.
    ///
    /// # Errors
    /// [`SolidError`] where there is no such solid, or no pressure has an answer.
    pub fn tabulate(
        &self,
        free: &Free,
        section: &dyn SectionLaw,
        pressure_max: f64,
        run: &Run<'_>,
    ) -> Result<Option<CapTable>, SolidError> {
        let count = self.planes.max(2);
        let pressures: Vec<f64> =
            (0..count).map(|i| pressure_max * (FRAC_PI_2 * i as f64 / (count - 1) as f64).sin()).collect();
        let mut free = *free;
        free.winding.handedness = actuator::Handedness::Right;
        let radius = free.tube.outer_radius();
        let (mut solver, length) = self.solver(&free)?;
        let rest = solver.rest();
        let mut states = vec![];
        let path = |pressure| SolidLoad::axial(pressure, EndLoad::NONE);
        let ended = solver.follow(&rest, 0.0, &pressures, &path, &mut |_, state| {
            states.push(state.clone());
            !run.is_stopped()
        });
        if run.is_stopped() {
            return Ok(None);
        }
        if let (Err(error), true) = (ended, states.is_empty()) {
            return Err(error);
        }
        let unloaded: Vec<_> = states.iter().map(|state| ends(&solver, state, length)).collect();
        let compliances: Vec<[f64; 2]> = unloaded
            .iter()
            .zip(&pressures)
            .map(|((_, [stretch, twist]), pressure)| {
                let [[a, b], [c, d]] = section.respond(*pressure, *stretch, *twist).stiffness;
                let flexible = Matrix2::new(a, b, c, d).try_inverse().unwrap_or_default();
                [flexible[(0, 0)], flexible[(1, 1)]]
            })
            .collect();
        let least = [0, 1].map(|i| {
            let positive = compliances.iter().map(|own| own[i]).filter(|value| *value > 0.0);
            positive.fold(f64::INFINITY, f64::min)
        });
        let greatest =
            unloaded.iter().map(|(_, middle)| middle[1].abs()).fold(LEAST_TWIST / radius, f64::max);
        let against = -unloaded.last().map_or(1.0, |(_, middle)| middle[1].signum());
        let wanted = [self.range[0], self.range[1] * greatest];
        let most = GREATEST_LOAD * pressure_max;
        let most = [most * PI * radius.powi(2), most * TAU * radius.powi(3)];
        let sizes = |own: &[f64; 2]| -> [f64; 2] {
            std::array::from_fn(|i| {
                let softest = SOFTEST * least[i];
                let compliance = if own[i] > 0.0 { own[i].min(softest) } else { softest };
                (wanted[i] / compliance).min(most[i])
            })
        };
        let effect = |plane: usize| -> Result<Option<CapEffect>, SolidError> {
            let (mut solver, length) = self.solver(&free)?;
            let sizes = sizes(&compliances[plane]);
            let mut samples = vec![];
            for [pulled, turned] in LOADS {
                let [force, torque] = [pulled * sizes[0], against * turned * sizes[1]];
                let load = |part: f64| EndLoad { force, torque }.times(part);
                let at = |part: f64| SolidLoad::axial(pressures[plane], load(part));
                let mut found = vec![];
                // What gives way is left out, and what lies behind it.
                let _ = solver.follow(&states[plane], 0.0, &[0.5, 1.0], &at, &mut |part, state| {
                    found.push((part, state.clone()));
                    !run.is_stopped()
                });
                if run.is_stopped() {
                    return Ok(None);
                }
                let sample = |(part, state): &(f64, SolidState)| CapSample {
                    load: load(*part),
                    ends: ends(&solver, state, length).0,
                };
                samples.extend(found.iter().map(sample));
            }
            Ok(Some(CapEffect::new(unloaded[plane].0, &samples, sizes, radius)))
        };
        let all = || (0..states.len()).into_par_iter().map(effect).collect::<Result<Option<Vec<_>>, _>>();
        let found = match rayon::ThreadPoolBuilder::new().num_threads(run.jobs.max(1)).build() {
            Ok(pool) => pool.install(all),
            Err(_) => (0..states.len()).map(effect).collect(),
        };
        let Some(found) = found? else { return Ok(None) };
        let planes: Vec<(f64, CapEffect)> = pressures.into_iter().zip(found).collect();
        CapTable::new(&planes).map(Some).ok_or(SolidError::NotConverged {
            target: format!("the caps' effect up to {:.3} kPa", 1e-3 * pressure_max),
            residual: f64::NAN,
            last_good: 0.0,
            advice: "Lower the greatest pressure",
        })
    }
}
