use super::{
    SolidModuleError, equations::Loads, equilibrium::SolidShape, module::SolidModule, path::no_equilibrium,
};
use crate::{
    Bulge, HELD, Lost,
    sparse::{Inverse, lowest_modes},
};
use nalgebra::{Matrix6, Vector3, Vector6};

/// A motion of a module of solids to which an equilibrium gives little resistance, or none: an eigenvector of the tangent of all FREEs and the
/// plate at once, in the metric of [`crate::SolidMode`] (of the plate's coordinates what their motion of the FREEs' caps weighs).
#[derive(Clone, Debug, PartialEq)]
pub struct SolidModuleMode {
    /// Eigenvalue: the stiffness against the motion over that of a block of rubber as large as a FREE's radius; 0 where the module buckles.
    pub value: f64,
    /// Bound on its relative error.
    pub error: f64,
    /// Motion of each point of each FREE's mesh, base frame; the longest is 1.
    pub displacements: Vec<Vec<[f64; 3]>>,
    /// Motion of the plate's centre, base frame, in the same scale.
    pub tip_shift: [f64; 3],
}

/// First of the springs that are tried, as a share of the stiffness of a block of rubber as large as a FREE's radius: a module sways at 1e-4.
const SOFTEST_SPRING: f64 = 1e-3;
/// A spring beyond which something else is wrong.
const STIFFEST_SPRING: f64 = 1e3;

/// The tangent factorised last, of all unknowns: the insides of the FREEs one after the other, and the six coordinates of the plate.
struct Joined<'a> {
    module: &'a mut SolidModule,
    /// Motions of the caps for motions of the plate's coordinates.
    levers: Vec<Matrix6<f64>>,
    inverse: Matrix6<f64>,
    /// First unknown of each FREE, and of the plate.
    firsts: Vec<usize>,
}

impl Joined<'_> {
    fn plate(&self) -> usize {
        self.firsts[self.firsts.len() - 1]
    }
}

impl Inverse for Joined<'_> {
    fn dimension(&self) -> usize {
        self.plate() + 6
    }

    /// K_ii x_i + K_ic T q = f_i of every FREE, and H q = f_q - sum T^T K_ci K_ii^-1 f_i with H the plate's tangent, the insides eliminated.
    fn solve(&mut self, columns: &mut [f64]) {
        let (dimension, plate) = (self.dimension(), self.plate());
        let (firsts, levers, inverse) = (&self.firsts, &self.levers, self.inverse);
        let given = &*columns;
        let answers = self.module.each(|index, free| {
            let inside = firsts[index]..firsts[index + 1];
            let mut own = Vec::with_capacity((inside.len() + 6) * given.len() / dimension);
            for column in given.chunks_exact(dimension) {
                own.extend_from_slice(&column[inside.clone()]);
                own.extend([0.0; 6]);
            }
            let on_cap = free.response.as_ref().map(|response| free.solver.inside_answer(response, &mut own));
            (own, on_cap.unwrap_or_default())
        });
        let plates: Vec<Vector6<f64>> = columns
            .chunks_exact(dimension)
            .enumerate()
            .map(|(place, column)| {
                let felt = answers
                    .iter()
                    .zip(levers)
                    .filter_map(|((_, on_cap), lever)| Some(lever.transpose() * on_cap.get(place)?));
                inverse * (Vector6::from_column_slice(&column[plate..]) - felt.sum::<Vector6<f64>>())
            })
            .collect();
        for (index, (own, _)) in answers.into_iter().enumerate() {
            let inside = firsts[index]..firsts[index + 1];
            let (free, lever) = (&self.module.frees[index], &levers[index]);
            let Some(response) = &free.response else { continue };
            let parts = own.chunks_exact(inside.len() + 6).zip(columns.chunks_exact_mut(dimension));
            for ((part, column), plate) in parts.zip(&plates) {
                let moved = response.following(part.to_vec(), &(lever * plate));
                column[inside.clone()].copy_from_slice(&moved[..inside.len()]);
            }
        }
        for (column, found) in columns.chunks_exact_mut(dimension).zip(&plates) {
            column[plate..].copy_from_slice(found.as_slice());
        }
    }
}

impl SolidModule {
    /// The `count` motions that an equilibrium withstands least, those of the lowest eigenvalues, the lowest first.
    ///
    /// Where some are negative, springs on all unknowns (a multiple of the metric) lift all above zero, so that the lowest are next to singular.
    ///
    /// # Errors
    /// [`SolidModuleError::NoEquilibrium`] where the tangent has no factors.
    pub fn softest_modes(
        &mut self,
        shape: &SolidShape,
        count: usize,
    ) -> Result<Vec<SolidModuleMode>, SolidModuleError> {
        let loads = self.loads_from(shape);
        let first = shape.plate.vary().first;
        let levers: Vec<Matrix6<f64>> =
            self.frees.iter().map(|free| free.lever(loads.part) * first).collect();
        let insides = self.frees.iter().map(|free| free.solver.unknowns() - 6);
        let mut firsts = vec![0];
        firsts.extend(insides.scan(0, |sum, inside| {
            *sum += inside;
            Some(*sum)
        }));
        let lost = |lost: Lost| no_equilibrium(&loads, shape, lost);
        self.linearise(shape, &loads).map_err(lost)?;
        let metric = self.metric(shape, &levers, loads.free);
        let spring = self.lift(shape, &loads, &metric, &firsts).map_err(lost)?;
        let inverse = self.tangent.as_ref().map(|tangent| tangent.inverse);
        let inverse = inverse.ok_or_else(|| lost(Lost(f64::INFINITY)))?;
        // Coordinates that are held stay where they are.
        let free = Matrix6::from_diagonal(&self.guided(&loads).free_part(Vector6::repeat(1.0)));
        let inverse = free * inverse * free;
        let mut joined = Joined { module: self, levers, inverse, firsts };
        let found = lowest_modes(&mut joined, count, Some(&metric));
        let Joined { levers, firsts, .. } = joined;
        if spring > 0.0 {
            self.tangent = None;
        }
        let told = found.into_iter().map(|mode| {
            let plate = Vector6::from_column_slice(&mode.vector[firsts[levers.len()]..]);
            let each = self.frees.iter().zip(&shape.frees).zip(&levers).enumerate();
            let mut displacements: Vec<Vec<[f64; 3]>> = each
                .map(|(index, ((free, state), lever))| {
                    let mut own = mode.vector[firsts[index]..firsts[index + 1]].to_vec();
                    own.extend((lever * plate).iter());
                    free.solver.displacements(state, &own)
                })
                .collect();
            let vectors = displacements.iter().flatten().map(|place| Vector3::from(*place));
            let longest = vectors.max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or_default();
            let scale = longest[longest.iamax()].signum() / longest.norm().max(f64::MIN_POSITIVE);
            displacements.iter_mut().flatten().flatten().for_each(|value| *value *= scale);
            let shift: Vector3<f64> = plate.fixed_rows::<3>(0).into();
            let value = mode.value - spring;
            SolidModuleMode {
                value,
                error: (mode.error * mode.value / value).abs(),
                displacements,
                tip_shift: (shift * scale).into(),
            }
        });
        Ok(told.collect())
    }

    /// Factorises the tangent with the weakest of springs 0, s, 4 s, ... that leave no negative eigenvalues; the spring.
    fn lift(
        &mut self,
        shape: &SolidShape,
        loads: &Loads,
        metric: &[f64],
        firsts: &[usize],
    ) -> Result<f64, Lost> {
        let mut spring: f64 = 0.0;
        while self.tangent.as_ref().is_none_or(|tangent| tangent.negative > 0) {
            spring = (4.0 * spring).max(SOFTEST_SPRING);
            if spring > STIFFEST_SPRING {
                return Err(Lost(f64::INFINITY));
            }
            let sums = self.assemble(shape, loads, true)?;
            self.each(|index, free| {
                free.solver.add_springs(spring, &metric[firsts[index]..firsts[index + 1]])
            });
            let plate = Vector6::from_column_slice(&metric[metric.len() - 6..]) * spring;
            self.factorise_with(shape, loads, &sums, &Matrix6::from_diagonal(&plate))?;
        }
        Ok(spring)
    }

    /// Diagonal of the metric: of the insides of the FREEs, one after the other, and of the plate's coordinates, of which those not `free` are held.
    pub(super) fn metric(&self, shape: &SolidShape, levers: &[Matrix6<f64>], free: [bool; 6]) -> Vec<f64> {
        let mut metric = vec![];
        let mut on_plate = Vector6::zeros();
        for ((free, state), lever) in self.frees.iter().zip(&shape.frees).zip(levers) {
            let mut own = free.solver.metric(state);
            let cap = Vector6::from_column_slice(&own.split_off(own.len() - 6));
            on_plate += (lever.transpose() * Matrix6::from_diagonal(&cap) * lever).diagonal();
            metric.extend(own);
        }
        let weights = on_plate.iter().zip(free);
        metric.extend(weights.map(|(weight, free)| if free { *weight } else { HELD }));
        metric
    }

    /// How far outwards a mode moves the outer surface of a FREE, by lines along it.
    pub fn bulges(&self, shape: &SolidShape, mode: &SolidModuleMode, free: usize) -> Vec<Vec<Bulge>> {
        self.frees[free].solver.bulges(&shape.frees[free], &mode.displacements[free])
    }
}

impl SolidModuleMode {
    /// Greatest motion of each FREE's points; the greatest of all is 1.
    pub fn shifts(&self) -> Vec<f64> {
        let length = |place: &[f64; 3]| Vector3::from(*place).norm();
        self.displacements.iter().map(|points| points.iter().map(length).fold(0.0, f64::max)).collect()
    }
}
