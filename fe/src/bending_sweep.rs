use crate::{
    BendingPlane, BendingSample, BendingTable, RodCompliance, Run, SolidError, SolidLoad, SolidMesh,
    SolidSolver, SolidState, Specimen, StraightRod, TipCompliance,
};
use actuator::{EndLoad, Free};
use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How a FREE's bending law is computed: the compliances of solids of two lengths, straight, under pressures and loads along the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingSweep {
    /// Pressures.
    pub planes: usize,
    /// Lengths of the two solids over the outer radius.
    pub lengths: [f64; 2],
    /// Stretch, and twist over the free FREE's greatest, that the axial loads give to about.
    pub range: [f64; 2],
}

impl Default for BendingSweep {
    /// Five pressures; 20 and 40 mm of the paper's tube, whose sections agree with those of 40 and 80 mm within 1e-4.
    fn default() -> Self {
        BendingSweep { planes: 5, lengths: [3.6, 7.2], range: [0.04, 0.75] }
    }
}

/// First pressure as a share of the greatest: without any, threads that carry no thrust are neither taut nor slack.
const FIRST: f64 = 0.02;
/// Least twist times the outer radius that the torques are to give.
const LEAST_TWIST: f64 = 0.05;
/// Greatest force and torque over what the greatest pressure does on the outer cross-section, and on threads of 45 degrees.
const GREATEST_LOAD: f64 = 1.5;

/// A tube under axial loads: what it gives way to, and its middle's stretch and twist.
#[derive(Clone, Debug)]
struct Answer {
    rod: StraightRod,
    compliance: TipCompliance,
    strain: [f64; 2],
    /// What it is longer (m) and turned further (rad) than if all of it did so.
    ends: [f64; 2],
}

/// The solids of one length.
struct Tubes {
    length: f64,
    /// What finds the straight states.
    straight: SolidSolver,
    /// The whole, where that is only a sector.
    whole: Option<SolidSolver>,
}

impl Tubes {
    fn new(free: &Free, length: f64) -> Result<Self, SolidError> {
        let mut free = *free;
        free.tube.length = length;
        let (specimen, mesh) = (Specimen::from(&free), SolidMesh::lean(&free));
        let whole = SolidSolver::new(&specimen, mesh)?;
        // Two fibres are the same after half a turn, which does not make their bending the same in all planes; one is not at all.
        Ok(if free.winding.fibres == 1 {
            Tubes { length, straight: whole, whole: None }
        } else {
            Tubes { length, straight: SolidSolver::sector(&specimen, mesh)?, whole: Some(whole) }
        })
    }

    fn answer(&mut self, state: &SolidState, [force, torque]: [f64; 2]) -> Result<Answer, SolidError> {
        let deformation = self.straight.deformation(state);
        let compliance = match &mut self.whole {
            Some(whole) => {
                let state = whole.whole_of(&self.straight, state)?;
                whole.tip_compliance(&state)?
            }
            None => self.straight.tip_compliance(state)?,
        };
        let stretch = deformation.stretch_mid;
        let rod = StraightRod { length: self.length, force, torque, stretch, height: compliance.heights[1] };
        let strain = [stretch, deformation.twist_mid];
        let total = [deformation.stretch_total, deformation.twist_total];
        let ends = [0, 1].map(|i| (total[i] - strain[i]) * self.length);
        Ok(Answer { rod, compliance, strain, ends })
    }

    fn follow(&mut self, from: &SolidState, to: &dyn Fn(f64) -> SolidLoad) -> Result<SolidState, SolidError> {
        self.straight.follow(from, 0.0, &[1.0], to, &mut |_, _| true)
    }
}

/// Axial flexibility per reference length (1/N, 1/(N m), 1/(N m^2)) between two tubes.
fn flexibility([short, long]: [&Answer; 2]) -> Matrix2<f64> {
    let block = |answer: &Answer| {
        let c = &answer.compliance.matrix;
        let mixed = 0.5 * (c[(2, 5)] + c[(5, 2)]);
        Matrix2::new(c[(2, 2)], mixed, mixed, c[(5, 5)])
    };
    (block(long) - block(short)) / (long.rod.length - short.rod.length)
}

fn sample([short, long]: [&Answer; 2]) -> Option<BendingSample> {
    let found = RodCompliance::identified([(&short.rod, &short.compliance), (&long.rod, &long.compliance)])?;
    let compliance = found.folded(long.rod.stretch);
    compliance.is_sound().then_some(BendingSample { strain: long.strain, compliance, ends: long.ends })
}

impl BendingSweep {
    /// The bending law of a FREE up to a pressure (Pa), as if right-handed and whatever its length; pressures at which it has no equilibrium
    /// are left out. `None` where the run was stopped.
    ///
    /// # Errors
    /// [`SolidError`] where there is no such solid, or no pressure has an answer.
    pub fn tabulate(
        &self,
        free: &Free,
        pressure_max: f64,
        run: &Run<'_>,
    ) -> Result<Option<BendingTable>, SolidError> {
        let mut free = *free;
        free.winding.handedness = actuator::Handedness::Right;
        let count = self.planes.max(1);
        // Denser towards the top, where a FREE may be near its limit pressure.
        let pressures: Vec<f64> = (0..count)
            .map(|i| pressure_max * (FRAC_PI_2 * i as f64 / (count - 1).max(1) as f64).sin())
            .map(|pressure| pressure.max(FIRST * pressure_max))
            .collect();
        let lengths = self.lengths.map(|length| length * free.tube.outer_radius());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(run.jobs.max(1)).build();
        let apart = |work: &(dyn Fn(usize) -> Result<Option<Vec<Option<Answer>>>, SolidError> + Sync),
                     tasks| {
            let all = || (0..tasks).into_par_iter().map(work).collect::<Result<Vec<_>, _>>();
            match &pool {
                Ok(pool) => pool.install(all),
                Err(_) => (0..tasks).map(work).collect(),
            }
        };
        // First the free states, one path for each length: they say how much force and torque to put on.
        let free_states = apart(
            &|index| {
                let mut tubes = Tubes::new(&free, lengths[index])?;
                let mut states = vec![];
                let rest = tubes.straight.rest();
                let path = |pressure| SolidLoad::axial(pressure, EndLoad::NONE);
                let ended = tubes.straight.follow(&rest, 0.0, &pressures, &path, &mut |_, state| {
                    states.push(state.clone());
                    !run.is_stopped()
                });
                if let Err(SolidError::Stopped) = ended {
                    return Ok(None);
                }
                let answers = states.iter().map(|state| tubes.answer(state, [0.0; 2]).ok());
                Ok(Some(answers.collect()))
            },
            2,
        )?;
        let Some(free_states) = free_states.into_iter().collect::<Option<Vec<_>>>() else { return Ok(None) };
        let middles: Vec<(f64, [&Answer; 2])> = pressures
            .iter()
            .zip(free_states[0].iter().zip(&free_states[1]))
            .filter_map(|(pressure, (short, long))| Some((*pressure, [short.as_ref()?, long.as_ref()?])))
            .filter(|(_, pair)| sample(*pair).is_some() && flexibility(*pair).try_inverse().is_some())
            .collect();
        let greatest = middles.iter().map(|(_, pair)| pair[1].strain[1].abs()).fold(0.0, f64::max);
        let twist = self.range[1] * greatest.max(LEAST_TWIST / free.tube.outer_radius());
        // FREEs whose threads run along them are so stiff that nothing in a module stretches them so far: what others put on is of the
        // size of what pressure does to the ends.
        let (radius, most) = (free.tube.outer_radius(), GREATEST_LOAD * pressure_max);
        let greatest_loads = [most * PI * radius.powi(2), most * TAU * radius.powi(3)];
        let sizes: Vec<[f64; 2]> = middles
            .iter()
            .map(|(_, pair)| {
                let flexible = flexibility(*pair);
                let wanted = [self.range[0] / flexible[(0, 0)], twist / flexible[(1, 1)]];
                [wanted[0].min(greatest_loads[0]), wanted[1].min(greatest_loads[1])]
            })
            .collect();
        let loaded = apart(
            &|task| {
                let (plane, index) = (task / 2, task % 2);
                let (pressure, size) = (middles[plane].0, sizes[plane]);
                let mut tubes = Tubes::new(&free, lengths[index])?;
                let rest = tubes.straight.rest();
                let middle = tubes.follow(&rest, &|part| SolidLoad::axial(part * pressure, EndLoad::NONE))?;
                let mut answers = vec![];
                for (force, torque) in POINTS {
                    if run.is_stopped() {
                        return Ok(None);
                    }
                    let loads = [force * size[0], torque * size[1]];
                    let ends = EndLoad { force: loads[0], torque: loads[1] };
                    let to = |part: f64| SolidLoad::axial(pressure, ends.times(part));
                    let state = tubes.follow(&middle, &to);
                    answers.push(state.and_then(|state| tubes.answer(&state, loads)).ok());
                }
                Ok(Some(answers))
            },
            2 * middles.len(),
        )?;
        let Some(loaded) = loaded.into_iter().collect::<Option<Vec<_>>>() else { return Ok(None) };
        let planes: Vec<BendingPlane> = middles
            .iter()
            .zip(&sizes)
            .zip(loaded.chunks_exact(2))
            .filter_map(|(((pressure, pair), size), tubes)| {
                let stiffness = flexibility(*pair).try_inverse()?;
                let pairs = tubes[0].iter().zip(&tubes[1]);
                let loaded = pairs.filter_map(|(short, long)| sample([short.as_ref()?, long.as_ref()?]));
                Some(BendingPlane {
                    pressure: *pressure,
                    free: sample(*pair)?,
                    coordinates: Matrix2::from_diagonal(&Vector2::from(*size).map(f64::recip)) * stiffness,
                    loaded: loaded.collect(),
                })
            })
            .collect();
        BendingTable::new(&planes).map(Some).ok_or(SolidError::NotConverged {
            target: format!("the bending law up to {:.3} kPa", 1e-3 * pressure_max),
            residual: f64::NAN,
            last_good: 0.0,
            advice: "Lower the greatest pressure",
        })
    }
}

/// Force and torque of the samples, in units of their sizes.
const POINTS: [(f64, f64); 6] = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-0.7, 0.7), (0.7, 0.7)];
