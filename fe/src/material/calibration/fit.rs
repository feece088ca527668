use super::{
    LoadingMode, RubberModel, TestPoint,
    least_squares::{Minimum, half_widths, minimise},
    nominal_stress,
};
use crate::material::Rubber;
use actuator::{Elastomer, units::MPA};
use nalgebra::{DMatrix, DVector};

/// What a misfit is measured against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// The stress itself, but at least 5 % of the greatest of its mode: small and large strains count alike.
    #[default]
    Relative,
    /// The greatest stress of all points: large strains count most.
    Absolute,
}

/// Share of a mode's greatest stress below which stresses are not weighted up further.
const FLOOR: f64 = 0.05;
/// How many of the best starts are followed to their minimum.
const DESCENTS: usize = 12;

/// Why there is no fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// Fewer points than constants.
    #[error(
        "{model} has {constants} constants, the tests have {points} points away from rest; give more points or another model"
    )]
    TooFewPoints {
        /// The model.
        model: String,
        /// Its number of constants.
        constants: usize,
        /// Points with a stretch other than 1.
        points: usize,
    },
    /// A number that is no measurement.
    #[error(
        "point {index} has stretch {stretch} and stress {stress} Pa; stretches must be positive, both finite"
    )]
    Unusable {
        /// Place of the point, from zero.
        index: usize,
        /// Its stretch.
        stretch: f64,
        /// Its stress, Pa.
        stress: f64,
    },
    /// No start led to a rubber.
    #[error(
        "{model} finds no constants that make a rubber of these tests; check the signs of the stresses (tension positive)"
    )]
    NoMinimum {
        /// The model.
        model: String,
    },
}

/// A constant with its interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name in files, without unit.
    pub name: String,
    /// Whether it is a stress.
    pub is_stress: bool,
    /// Its value, SI.
    pub value: f64,
    /// 95 % interval from the curvature of the sum of squares; `None` where the tests do not determine it.
    pub ci95: Option<[f64; 2]>,
}

/// A rubber fitted to tests.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The model.
    pub model: RubberModel,
    /// The rubber.
    pub elastomer: Elastomer,
    /// Its constants.
    pub parameters: Vec<Parameter>,
    /// Root mean square of the stress's misfit over all points, Pa.
    pub rms: f64,
    /// Root mean square of the misfit over the stress (never less than 5 % of the greatest of its mode).
    pub relative_rms: f64,
    /// The two by mode, of modes that have points: mode, number of points, Pa, relative.
    pub by_mode: Vec<(LoadingMode, usize, f64, f64)>,
    /// Akaike's criterion, corrected for few points, of the weighted misfits: n ln(S/n) + 2 k n/(n - k - 1), k constants and
    /// their noise. Only differences between models fitted alike to the same points mean something.
    pub aicc: f64,
}

/// What each point's misfit is divided by, Pa.
fn divisors(points: &[TestPoint], weighting: Weighting) -> Vec<f64> {
    let greatest = |mode: Option<LoadingMode>| {
        let of_mode = points.iter().filter(|point| mode.is_none_or(|mode| point.mode == mode));
        of_mode.map(|point| point.stress.abs()).fold(f64::MIN_POSITIVE, f64::max)
    };
    let divisor = |point: &TestPoint| match weighting {
        Weighting::Relative => point.stress.abs().max(FLOOR * greatest(Some(point.mode))),
        Weighting::Absolute => greatest(None),
    };
    points.iter().map(divisor).collect()
}

/// Misfits over their divisors; `None` where a point is beyond what the rubber can be stretched.
fn misfits(elastomer: Elastomer, points: &[TestPoint], divisors: &[f64]) -> Option<DVector<f64>> {
    let rubber = Rubber::from(elastomer);
    let misfit = |(point, divisor): (&TestPoint, &f64)| {
        (nominal_stress(&rubber, point.mode, point.stretch) - point.stress) / divisor
    };
    let values = DVector::from_iterator(points.len(), points.iter().zip(divisors).map(misfit));
    values.iter().all(|value| value.is_finite()).then_some(values)
}

/// Fits `model` to all points together: Levenberg's and Marquardt's descents from several starts, the best of them; the same
/// points give the same constants.
///
/// # Errors
/// See [`CalibrationError`].
pub fn fit(model: RubberModel, points: &[TestPoint], weighting: Weighting) -> Result<Fit, CalibrationError> {
    for (index, TestPoint { stretch, stress, .. }) in points.iter().copied().enumerate() {
        if !(stretch.is_finite() && stretch > 0.0 && stress.is_finite()) {
            return Err(CalibrationError::Unusable { index, stretch, stress });
        }
    }
    let constants = model.parameters().len();
    let telling = points.iter().filter(|point| point.stretch != 1.0).count();
    if telling < constants {
        return Err(CalibrationError::TooFewPoints { model: model.name(), constants, points: telling });
    }
    let divisors = divisors(points, weighting);
    let residuals = |values: &[f64]| misfits(model.elastomer(values)?, points, &divisors);
    let no_minimum = || CalibrationError::NoMinimum { model: model.name() };
    let scale = neo_hookean_modulus(points, &divisors).filter(|mu| *mu > 0.0).ok_or_else(no_minimum)?;
    let mut starts = model.starts(scale, points);
    if let RubberModel::Ogden(_) = model {
        starts = starts.into_iter().filter_map(|start| with_moduli(&start, points, &divisors)).collect();
    }
    let mut ranked: Vec<(f64, Vec<f64>)> = starts
        .into_iter()
        .filter_map(|start| residuals(&start).map(|values| (values.norm_squared(), start)))
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let descents = ranked.into_iter().take(DESCENTS);
    let minima = descents.filter_map(|(_, start)| minimise(DVector::from_vec(start), &residuals));
    let best = minima.min_by(|a, b| a.cost.total_cmp(&b.cost)).ok_or_else(no_minimum)?;
    report(model, points, ordered(model, best)).ok_or_else(no_minimum)
}

/// mu (MPa) of the neo-Hookean rubber nearest to the points.
fn neo_hookean_modulus(points: &[TestPoint], divisors: &[f64]) -> Option<f64> {
    let unit = Rubber::from(Elastomer::NeoHookean { shear_modulus: MPA });
    let (mut top, mut bottom) = (0.0, 0.0);
    for (point, divisor) in points.iter().zip(divisors) {
        let shape = nominal_stress(&unit, point.mode, point.stretch) / divisor;
        top += shape * point.stress / divisor;
        bottom += shape * shape;
    }
    (bottom > 0.0).then(|| top / bottom)
}

/// Ogden's terms of given exponents with the moduli of least squares, in which the stress is linear.
fn with_moduli(start: &[f64], points: &[TestPoint], divisors: &[f64]) -> Option<Vec<f64>> {
    let units: Vec<Rubber> = start
        .chunks_exact(2)
        .map(|pair| RubberModel::Ogden(1).elastomer(&[1.0, pair[1]]).map(Rubber::from))
        .collect::<Option<_>>()?;
    let matrix = DMatrix::from_fn(points.len(), units.len(), |i, j| {
        nominal_stress(&units[j], points[i].mode, points[i].stretch) / divisors[i]
    });
    let right = DVector::from_iterator(points.len(), points.iter().zip(divisors).map(|(p, d)| p.stress / d));
    let moduli = matrix.svd(true, true).solve(&right, 1e-12).ok()?;
    Some(start.chunks_exact(2).zip(moduli.iter()).flat_map(|(pair, mu)| [*mu, pair[1]]).collect())
}

/// Ogden's terms by rising exponent.
fn ordered(model: RubberModel, minimum: Minimum) -> Minimum {
    let RubberModel::Ogden(terms) = model else { return minimum };
    let mut order: Vec<usize> = (0..terms).collect();
    order.sort_by(|a, b| minimum.at[2 * a + 1].total_cmp(&minimum.at[2 * b + 1]));
    let place = |j: usize| 2 * order[j / 2] + j % 2;
    Minimum {
        at: DVector::from_fn(2 * terms, |j, _| minimum.at[place(j)]),
        jacobian: DMatrix::from_fn(minimum.jacobian.nrows(), 2 * terms, |i, j| {
            minimum.jacobian[(i, place(j))]
        }),
        cost: minimum.cost,
    }
}

fn report(model: RubberModel, points: &[TestPoint], minimum: Minimum) -> Option<Fit> {
    let elastomer = model.elastomer(minimum.at.as_slice())?;
    let widths = half_widths(&minimum);
    let parameters = model
        .parameters()
        .into_iter()
        .enumerate()
        .map(|(j, (name, is_stress))| {
            let unit = if is_stress { MPA } else { 1.0 };
            let value = minimum.at[j];
            let ci95 =
                widths.as_ref().map(|widths| [value - widths[j], value + widths[j]].map(|end| end * unit));
            Parameter { name, is_stress, value: value * unit, ci95 }
        })
        .collect();
    let by_mode = LoadingMode::ALL
        .into_iter()
        .filter_map(|mode| {
            let own: Vec<TestPoint> = points.iter().copied().filter(|point| point.mode == mode).collect();
            let (rms, relative) = rms(elastomer, &own)?;
            Some((mode, own.len(), rms, relative))
        })
        .collect();
    let (rms, relative_rms) = rms(elastomer, points)?;
    let (n, k) = (points.len() as f64, model.parameters().len() as f64 + 1.0);
    let aicc = match n > k + 1.0 {
        true => n * (minimum.cost / n).ln() + 2.0 * k * n / (n - k - 1.0),
        false => f64::INFINITY,
    };
    Some(Fit { model, elastomer, parameters, rms, relative_rms, by_mode, aicc })
}

/// Root mean squares of the misfit, Pa and relative; `None` of no points and beyond what the rubber can be stretched.
pub(super) fn rms(elastomer: Elastomer, points: &[TestPoint]) -> Option<(f64, f64)> {
    let mean = |divisors: &[f64]| {
        let values = misfits(elastomer, points, divisors)?;
        (!values.is_empty()).then(|| (values.norm_squared() / values.len() as f64).sqrt())
    };
    Some((mean(&vec![1.0; points.len()])?, mean(&divisors(points, Weighting::Relative))?))
}
