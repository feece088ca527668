use super::{LoadingMode, nominal_stress};
use crate::material::{Hyperelastic, Rubber};
use nalgebra::{Matrix3, Vector3};

/// When a rubber counts as stable under load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stability {
    /// The nominal stress rises with the stretch: the incremental stiffness dP/dl is positive.
    Stiffness,
    /// Drucker's postulate, d tau : d ln l > 0 for every increment without change of volume: the energy is convex in the logarithms of
    /// the stretches.
    Drucker,
}

/// Stretches around 1 within which a rubber is stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableRange {
    /// Where stability ends in compression; `None` where it holds as far as was looked (a tenth).
    pub least: Option<f64>,
    /// Where it ends in tension; `None` where it holds as far as was looked (ten times), or up to where the chains lock.
    pub greatest: Option<f64>,
}

/// How far is looked: stretches from 1/10 to 10.
const FARTHEST: f64 = 10.0;
/// Steps of the search, in the logarithm of the stretch: 1 %.
const STEP: f64 = 0.01;

/// Smallest incremental stiffness, Pa; NaN beyond what the rubber can be stretched.
fn stiffness(rubber: &Rubber, mode: LoadingMode, stretch: f64, criterion: Stability) -> f64 {
    let h = 1e-5;
    match criterion {
        Stability::Stiffness => {
            let at = |l: f64| nominal_stress(rubber, mode, l);
            (at(stretch * (1.0 + h)) - at(stretch * (1.0 - h))) / (2.0 * h * stretch)
        }
        Stability::Drucker => {
            let [l1, l2, _] = mode.stretches(stretch);
            // dW/d(ln l1) and dW/d(ln l2) at l3 = 1/(l1 l2).
            let slopes = |l1: f64, l2: f64| {
                let l = Vector3::new(l1, l2, (l1 * l2).recip());
                let tau = rubber
                    .first_piola_kirchhoff_stress(&Matrix3::from_diagonal(&l))
                    .diagonal()
                    .component_mul(&l);
                [tau[0] - tau[2], tau[1] - tau[2]]
            };
            let (up, down) = (h.exp(), (-h).exp());
            let by_first = [slopes(l1 * up, l2), slopes(l1 * down, l2)];
            let by_second = [slopes(l1, l2 * up), slopes(l1, l2 * down)];
            let difference = |pair: [[f64; 2]; 2], i: usize| (pair[0][i] - pair[1][i]) / (2.0 * h);
            let (a, d) = (difference(by_first, 0), difference(by_second, 1));
            let b = 0.5 * (difference(by_first, 1) + difference(by_second, 0));
            // The smaller eigenvalue of the symmetric matrix a b, b d.
            0.5 * (a + d) - (0.25 * (a - d) * (a - d) + b * b).sqrt()
        }
    }
}

/// The stretches of a mode within which the rubber is stable; ends to 1e-6.
pub fn stable_range(rubber: &Rubber, mode: LoadingMode, criterion: Stability) -> StableRange {
    let stable = |log: f64| stiffness(rubber, mode, log.exp(), criterion) > 0.0;
    let locked = |log: f64| stiffness(rubber, mode, log.exp(), criterion).is_nan();
    let end = |sign: f64| {
        let steps = (FARTHEST.ln() / STEP) as i32;
        let log = (0..=steps).map(|i| sign * STEP * f64::from(i)).find(|log| !stable(*log))?;
        if locked(log) {
            return None;
        }
        let (mut inside, mut outside) = (log - sign * STEP, log);
        while (outside - inside).abs() > 1e-7 {
            let middle = 0.5 * (inside + outside);
            if stable(middle) { inside = middle } else { outside = middle }
        }
        Some(inside.exp())
    };
    StableRange { least: end(-1.0), greatest: end(1.0) }
}
