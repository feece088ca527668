use crate::{ErrorStatistics, FreeModel, OutsideFree};
use actuator::{FreeMap, FreePath};
use serde::{Deserialize, Serialize};

/// Error of a FREE's model over a set of states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DeformationErrors {
    /// Of the axial stretch, absolute.
    pub axial_stretch: ErrorStatistics,
    /// Of the expansion, absolute.
    pub expansion: ErrorStatistics,
    /// Of the twist per length, relative to the greatest of the state's own path (and to no less than a thousandth of the map's greatest,
    /// for windings that do not turn).
    pub twist_per_length: ErrorStatistics,
}

/// Errors of a FREE's model, against the finite elements. The state of rest, which every model meets, is never counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FreeErrors {
    /// On the states of the map's check paths, which took no part in the fit, in the model's domain.
    pub held_out: DeformationErrors,
    /// The same, below nine tenths of the path's end pressure only: nearer to a limit point the deformation is ever more sensitive
    /// to the limit pressure itself.
    pub held_out_below_nine_tenths: DeformationErrors,
    /// Of the limit pressure, relative, on check paths that end in a limit point.
    pub limit_pressure: ErrorStatistics,
    /// On the states of the fitted paths: what is left of the fit, not a measure of how it predicts.
    pub fitted: DeformationErrors,
    /// States of check paths outside the model's domain, which were not judged.
    pub outside: usize,
    /// Pressure (Pa), winding angle (rad) and shear modulus (Pa) of the held-out state whose expansion is worst.
    pub worst_at: Option<[f64; 3]>,
}

/// How often the error bars of a FREE's model hold on states that took no part in setting them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FreeBarCoverage {
    /// Number of states.
    pub states: usize,
    /// Those whose axial stretch is within its bar.
    pub axial_stretch: usize,
    /// Those whose expansion is within its bar.
    pub expansion: usize,
    /// Those whose twist per length is within its bar.
    pub twist_per_length: usize,
}

#[derive(Default)]
struct Collected {
    axial_stretch: Vec<f64>,
    expansion: Vec<f64>,
    twist_per_length: Vec<f64>,
}

impl Collected {
    fn statistics(&self) -> DeformationErrors {
        DeformationErrors {
            axial_stretch: ErrorStatistics::of(&self.axial_stretch),
            expansion: ErrorStatistics::of(&self.expansion),
            twist_per_length: ErrorStatistics::of(&self.twist_per_length),
        }
    }
}

/// Judges a path state by state: `into` is told pressure, end pressure and the three errors, or why the state is outside.
fn judge_path(
    model: &FreeModel,
    [angle, modulus]: [f64; 2],
    path: &FreePath,
    twist_of_map: f64,
    mut into: impl FnMut(f64, f64, Result<[f64; 3], OutsideFree>),
) {
    let twist = greatest_twist(path).max(1e-3 * twist_of_map).max(f64::MIN_POSITIVE);
    let end = path.states.last().map_or(0.0, |state| state.pressure);
    for state in path.states.iter().filter(|state| state.pressure > 0.0) {
        let errors = model.evaluate(state.pressure, angle, modulus).map(|ours| {
            [
                ours.axial_stretch - state.axial_stretch,
                ours.expansion - state.expansion,
                (ours.twist_per_length - state.twist_per_length) / twist,
            ]
        });
        into(state.pressure, end, errors);
    }
}

fn greatest_twist(path: &FreePath) -> f64 {
    path.states.iter().map(|state| state.twist_per_length.abs()).fold(0.0, f64::max)
}

impl FreeErrors {
    /// Errors of a model on its map.
    pub(crate) fn of(model: &FreeModel, map: &FreeMap) -> Self {
        let paths = || map.paths.iter().flatten().chain(map.checks.iter().map(|(_, path)| path));
        let twist_of_map = paths().map(greatest_twist).fold(0.0, f64::max);
        let mut result = FreeErrors::default();
        let (mut held_out, mut below, mut fitted) =
            (Collected::default(), Collected::default(), Collected::default());
        let mut limit_pressure = Vec::new();
        let mut worst = -1.0;
        let add = |to: &mut Collected, [stretch, expansion, twist]: [f64; 3]| {
            to.axial_stretch.push(stretch);
            to.expansion.push(expansion);
            to.twist_per_length.push(twist);
        };
        for (node, path) in &map.checks {
            let free = &node.free;
            let point = [free.winding.angle_from_hoop(), free.elastomer.shear_modulus()];
            judge_path(model, point, path, twist_of_map, |pressure, end, errors| match errors {
                Err(_) => result.outside += 1,
                Ok(errors) => {
                    add(&mut held_out, errors);
                    if pressure <= 0.9 * end {
                        add(&mut below, errors);
                    }
                    if errors[1].abs() > worst {
                        worst = errors[1].abs();
                        result.worst_at = Some([pressure, point[0], point[1]]);
                    }
                }
            });
            if let (Some(theirs), Ok(Some(ours))) =
                (path.limit_pressure(), model.limit_pressure(point[0], point[1]))
            {
                limit_pressure.push((ours - theirs) / theirs);
            }
        }
        for (i, angle) in map.winding_angles().iter().enumerate() {
            for (j, modulus) in map.shear_moduli().iter().enumerate() {
                let Some(path) = map.path(i, j) else { continue };
                judge_path(model, [*angle, *modulus], path, twist_of_map, |_, _, errors| {
                    // The last two hundredths below a limit point are outside the domain by intent.
                    if let Ok(errors) = errors {
                        add(&mut fitted, errors);
                    }
                });
            }
        }
        result.held_out = held_out.statistics();
        result.held_out_below_nine_tenths = below.statistics();
        result.fitted = fitted.statistics();
        result.limit_pressure = ErrorStatistics::of(&limit_pressure);
        result
    }
}
