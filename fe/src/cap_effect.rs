use crate::{bending_table::slope, jet::Jet};
use actuator::EndLoad;
use nalgebra::{DMatrix, DVector};

/// What both caps of a FREE do under an axial load, by a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapSample {
    /// Force and torque along the axis.
    pub load: EndLoad,
    /// By how much the FREE is longer (m) and its tip is turned further (rad, right-handed winding) than if it did everywhere what its
    /// middle does.
    pub ends: [f64; 2],
}

/// What both caps of a FREE do at one pressure, as if right-handed and whatever its length.
///
/// In series with the tube they bear the same force N and torque M, so that their part of the complementary energy G(N, M) says everything:
/// the end extension `e = dG/dN` and the end turn `t = dG/dM`, by which a FREE of length L is `lambda L + e` long and turned by
/// `tau L + t` (lambda and tau those of its section under N and M). With one function for both, a rod of it has a strain energy and a
/// symmetric tangent; in N and M the caps' part stays smooth where the section's stiffness changes sharply.
///
/// G is a quartic in x/sqrt(1 + (x/2)^2) and the same of y, x and y being force and torque over their sizes: beyond the samples e and t fade.
#[derive(Clone, Debug, PartialEq)]
pub struct CapEffect {
    /// N, N m.
    sizes: [f64; 2],
    terms: [f64; TERMS],
}

/// Numbers of an effect in a row: sizes and terms.
const ENTRIES: usize = 2 + TERMS;

/// What both caps do at all pressures: between two planes of pressure a cubic.
#[derive(Clone, Debug, PartialEq)]
pub struct CapTable {
    /// Pa, rising.
    pressures: Vec<f64>,
    entries: Vec<[f64; ENTRIES]>,
    /// Their change with the pressure, 1/Pa.
    slopes: Vec<[f64; ENTRIES]>,
}

impl CapTable {
    /// Through the effects at one or more pressures (Pa, rising); `None` without any.
    pub fn new(planes: &[(f64, CapEffect)]) -> Option<Self> {
        let pressures: Vec<f64> = planes.iter().map(|(pressure, _)| *pressure).collect();
        let entries: Vec<[f64; ENTRIES]> = planes.iter().map(|(_, effect)| effect.entries()).collect();
        let step = |from: usize, entry: usize| {
            let width = pressures.get(from + 1)? - pressures[from];
            Some([width, (entries[from + 1][entry] - entries[from][entry]) / width])
        };
        let slopes = (0..planes.len()).map(|at| {
            std::array::from_fn(|entry| {
                slope(at.checked_sub(1).and_then(|before| step(before, entry)), step(at, entry))
            })
        });
        let slopes = slopes.collect();
        (!planes.is_empty()).then_some(CapTable { pressures, entries, slopes })
    }

    /// The effect at a pressure (Pa): that of the first and the last plane beyond them.
    pub fn at(&self, pressure: f64) -> CapEffect {
        let last = self.pressures.len() - 1;
        let pressure = pressure.clamp(self.pressures[0], self.pressures[last]);
        let after = self.pressures.iter().position(|plane| *plane > pressure).unwrap_or(last);
        let before = after.saturating_sub(1);
        let width = self.pressures[after] - self.pressures[before];
        let t = if width > 0.0 { (pressure - self.pressures[before]) / width } else { 0.0 };
        let (a, b) = (&self.entries[before], &self.entries[after]);
        let (slope_a, slope_b) = (&self.slopes[before], &self.slopes[after]);
        let (s, u) = (1.0 - t, width * t * (1.0 - t));
        let entries: [f64; ENTRIES] = std::array::from_fn(|i| {
            s * s * (1.0 + 2.0 * t) * a[i]
                + t * t * (3.0 - 2.0 * t) * b[i]
                + u * (s * slope_a[i] - t * slope_b[i])
        });
        CapEffect { sizes: [entries[0], entries[1]], terms: std::array::from_fn(|term| entries[2 + term]) }
    }
}

/// Energy of both caps and its derivatives at a force and a torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CapResponse {
    /// G, J.
    pub energy: f64,
    /// e (m) and t (rad).
    pub ends: [f64; 2],
    /// Their derivatives by force and torque: m/N, 1/N = rad/N, 1/(N m).
    pub compliance: [[f64; 2]; 2],
}

const TERMS: usize = 14;
/// Powers of both coordinates in each term. A constant does nothing.
const POWERS: [[i32; 2]; TERMS] = [
    [1, 0],
    [0, 1],
    [2, 0],
    [1, 1],
    [0, 2],
    [3, 0],
    [2, 1],
    [1, 2],
    [0, 3],
    [4, 0],
    [3, 1],
    [2, 2],
    [1, 3],
    [0, 4],
];
/// Of these, what the ends do without load.
const UNLOADED: usize = 2;
/// Least singular value of the samples' places, over the greatest, of what the terms are told by them.
const TOLD: f64 = 1e-3;

/// The k-th derivative of x^n.
fn power(x: f64, n: i32, k: i32) -> f64 {
    let factor: i32 = (0..k).map(|i| n - i).product();
    if factor == 0 { 0.0 } else { f64::from(factor) * x.powi(n - k) }
}

impl CapEffect {
    /// Through what the ends do without load, and next to the samples under loads of about these sizes (N, N m). `radius` (m) is the outer one,
    /// by which extensions are weighed against turns.
    pub fn new(unloaded: [f64; 2], loaded: &[CapSample], sizes: [f64; 2], radius: f64) -> Self {
        let mut terms = [0.0; TERMS];
        terms[0] = unloaded[0] * sizes[0];
        terms[1] = unloaded[1] * sizes[1];
        // Of each sample an extension and a turn, which without the terms that are known are linear in the others.
        let measures = [sizes[0] * radius, sizes[1]];
        let rows: Vec<[f64; TERMS]> = loaded
            .iter()
            .flat_map(|sample| {
                let place = [sample.load.force / sizes[0], sample.load.torque / sizes[1]];
                [0, 1].map(|quantity| slopes(place, quantity).map(|slope| slope / measures[quantity]))
            })
            .collect();
        let known = |row: &[f64; TERMS]| row[0] * terms[0] + row[1] * terms[1];
        let wanted = loaded.iter().flat_map(|sample| [sample.ends[0] / radius, sample.ends[1]]);
        let wanted: Vec<f64> = wanted.zip(&rows).map(|(wanted, row)| wanted - known(row)).collect();
        if !rows.is_empty() {
            let matrix = DMatrix::from_fn(rows.len(), TERMS - UNLOADED, |i, j| rows[i][j + UNLOADED]);
            let svd = matrix.svd(true, true);
            if let Ok(found) = svd.solve(&DVector::from_vec(wanted), TOLD * svd.singular_values.max()) {
                terms[UNLOADED..].copy_from_slice(found.as_slice());
            }
        }
        CapEffect { sizes, terms }
    }

    fn entries(&self) -> [f64; ENTRIES] {
        std::array::from_fn(|i| if i < 2 { self.sizes[i] } else { self.terms[i - 2] })
    }

    /// What both caps do under a force (N) and a torque (N m).
    pub(crate) fn at(&self, force: f64, torque: f64) -> CapResponse {
        let [x, y] = coordinates([force / self.sizes[0], torque / self.sizes[1]]);
        let sum = |k: i32, l: i32| -> f64 {
            let term =
                |([i, j], term): (&[i32; 2], &f64)| term * power(x.value, *i, k) * power(y.value, *j, l);
            POWERS.iter().zip(&self.terms).map(term).sum()
        };
        let own = [sum(0, 0), sum(1, 0), sum(0, 1), sum(2, 0), sum(1, 1), sum(0, 2)];
        let found = Jet::compose2(x, y, own);
        CapResponse {
            energy: found.value,
            ends: [0, 1].map(|i| found.gradient[i] / self.sizes[i]),
            compliance: [0, 1]
                .map(|i| [0, 1].map(|j| found.hessian[(i, j)] / (self.sizes[i] * self.sizes[j]))),
        }
    }

    /// End extension (m) and end turn (rad) under a load.
    pub fn ends(&self, load: EndLoad) -> [f64; 2] {
        self.at(load.force, load.torque).ends
    }
}

fn coordinates(place: [f64; 2]) -> [Jet; 2] {
    [0, 1].map(|i| Jet::variable(place[i], i).saturated())
}

/// Derivatives of each term by one of the places.
fn slopes(place: [f64; 2], by: usize) -> [f64; TERMS] {
    let [x, y] = coordinates(place);
    let (k, l) = if by == 0 { (1, 0) } else { (0, 1) };
    let factor = [x, y][by].gradient[by];
    POWERS.map(|[i, j]| factor * power(x.value, i, k) * power(y.value, j, l))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [f64; 2] = [1.3, 0.03];
    const RADIUS: f64 = 5.56e-3;

    /// e and t from G = a N + b M + (c N^2 + 2 d N M + f M^2)/2 + g N M^2.
    fn given(load: EndLoad) -> [f64; 2] {
        let (n, m) = (load.force, load.torque);
        [1e-4 - 2e-5 * n - 7e-3 * m - 0.04 * m * m, 0.1 - 7e-3 * n - 3.0 * m - 0.08 * n * m]
    }

    fn samples() -> Vec<CapSample> {
        let places: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
        // About those of the sweep.
        let all = places.into_iter().flat_map(|x| places.map(|y| [x, y]));
        let all = all.filter(|[x, y]| x.abs() + y.abs() <= 1.0);
        let load = |[x, y]: [f64; 2]| EndLoad { force: x * SIZES[0], torque: y * SIZES[1] };
        all.map(load).map(|load: EndLoad| CapSample { load, ends: given(load) }).collect()
    }

    fn effect() -> CapEffect {
        CapEffect::new(given(EndLoad::NONE), &samples(), SIZES, RADIUS)
    }

    #[test]
    fn it_passes_next_to_its_samples_and_through_the_unloaded_one() {
        let effect = effect();
        let (found, wanted) = (effect.ends(EndLoad::NONE), given(EndLoad::NONE));
        assert!((0..2).all(|i| (found[i] - wanted[i]).abs() < 1e-12), "{found:?} {wanted:?}");
        for sample in samples() {
            let found = effect.ends(sample.load);
            // A quartic of the saturated coordinates leaves 2 % of the range of a cubic.
            assert!((found[0] - sample.ends[0]).abs() < 5e-6, "{found:?} {sample:?}");
            assert!((found[1] - sample.ends[1]).abs() < 5e-3, "{found:?} {sample:?}");
        }
    }

    #[test]
    fn ends_and_compliance_are_derivatives_of_one_energy() {
        let effect = effect();
        for (force, torque) in [(0.0, 0.0), (0.9, -0.02), (-1.3, 0.025), (3.0, 0.09), (-8.0, -0.4)] {
            let own = effect.at(force, torque);
            let steps = [1e-4 * SIZES[0], 1e-4 * SIZES[1]];
            for by in 0..2 {
                let beside = |side: f64| {
                    let mut at = [force, torque];
                    at[by] += side * steps[by];
                    effect.at(at[0], at[1])
                };
                let (above, below) = (beside(1.0), beside(-1.0));
                let slope = (above.energy - below.energy) / (2.0 * steps[by]);
                assert!((slope - own.ends[by]).abs() < 1e-6 * slope.abs().max([1e-4, 0.1][by]));
                for of in 0..2 {
                    let slope = (above.ends[of] - below.ends[of]) / (2.0 * steps[by]);
                    let size = [1e-4, 0.1][of] / SIZES[by];
                    assert!((slope - own.compliance[of][by]).abs() < 1e-6 * size, "{force} {torque}");
                }
            }
        }
    }

    #[test]
    fn between_pressures_the_effect_goes_over_smoothly() {
        let scaled = |by: f64| {
            let own = effect();
            CapEffect { terms: own.terms.map(|term| by * term), ..own }
        };
        let table =
            CapTable::new(&[(0.0, scaled(0.0)), (1e4, scaled(1.0)), (2e4, scaled(2.0)), (4e4, scaled(4.0))]);
        let table = table.unwrap();
        let load = EndLoad { force: 0.4, torque: -0.01 };
        for pressure in [0.0, 3e3, 1e4, 1.7e4, 3.9e4, 4e4] {
            let (found, wanted) = (table.at(pressure).ends(load), effect().ends(load));
            for i in 0..2 {
                let wanted = 1e-4 * pressure * wanted[i];
                assert!((found[i] - wanted).abs() < 1e-9 * wanted.abs() + 1e-15, "{pressure}: {found:?}");
            }
        }
        assert_eq!(table.at(9e4), table.at(4e4));
        assert!(CapTable::new(&[]).is_none());
    }

    #[test]
    fn far_beyond_the_samples_the_ends_fade() {
        let effect = effect();
        let far = effect.ends(EndLoad { force: 0.0, torque: 40.0 * SIZES[1] });
        assert!(far[1].abs() < 0.02, "{far:?}");
    }

    #[test]
    fn few_samples_tell_no_more_than_they_know() {
        let none = CapEffect::new([1e-4, 0.1], &[], SIZES, RADIUS);
        let found = none.ends(EndLoad::NONE);
        assert!((found[0] - 1e-4).abs() < 1e-15 && (found[1] - 0.1).abs() < 1e-12, "{found:?}");
        let along = samples().into_iter().filter(|sample| sample.load.torque == 0.0).collect::<Vec<_>>();
        let few = CapEffect::new(given(EndLoad::NONE), &along, SIZES, RADIUS);
        let own = few.at(0.0, 0.0).compliance;
        assert!((own[0][0] + 2e-5).abs() < 2e-6 && own[1][1].abs() < 1e-9, "{own:?}");
    }
}
