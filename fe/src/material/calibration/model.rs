use super::TestPoint;
use actuator::{Elastomer, OgdenForm, OgdenTerm, OgdenTerms, units::MPA};

/// A model whose constants are sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RubberModel {
    /// mu.
    NeoHookean,
    /// mu and alpha of each of so many terms (1 to 6).
    Ogden(usize),
    /// c10, c01.
    MooneyRivlin,
    /// c10, c20, c30.
    Yeoh,
    /// mu, Jm.
    Gent,
    /// mu (initial), locking stretch.
    ArrudaBoyce,
    /// mu.
    StVenantKirchhoff,
    /// mu.
    LinearElastic,
}

impl RubberModel {
    /// The model's name in files; Ogden's has its number of terms behind it.
    pub fn name(self) -> String {
        match self {
            RubberModel::NeoHookean => "neo-hookean".into(),
            RubberModel::Ogden(terms) => format!("ogden-{terms}"),
            RubberModel::MooneyRivlin => "mooney-rivlin".into(),
            RubberModel::Yeoh => "yeoh".into(),
            RubberModel::Gent => "gent".into(),
            RubberModel::ArrudaBoyce => "arruda-boyce".into(),
            RubberModel::StVenantKirchhoff => "st-venant-kirchhoff".into(),
            RubberModel::LinearElastic => "linear-elastic".into(),
        }
    }

    /// Names of the constants, as files have them without their unit, and whether each is a stress.
    pub fn parameters(self) -> Vec<(String, bool)> {
        let named = |names: &[(&str, bool)]| {
            names.iter().map(|(name, stress)| ((*name).to_owned(), *stress)).collect()
        };
        match self {
            RubberModel::NeoHookean | RubberModel::StVenantKirchhoff | RubberModel::LinearElastic => {
                named(&[("shear_modulus", true)])
            }
            RubberModel::Ogden(1) => named(&[("shear_modulus", true), ("alpha", false)]),
            RubberModel::Ogden(terms) => (1..=terms)
                .flat_map(|i| [(format!("shear_modulus[{i}]"), true), (format!("alpha[{i}]"), false)])
                .collect(),
            RubberModel::MooneyRivlin => named(&[("c10", true), ("c01", true)]),
            RubberModel::Yeoh => named(&[("c10", true), ("c20", true), ("c30", true)]),
            RubberModel::Gent => named(&[("shear_modulus", true), ("jm", false)]),
            RubberModel::ArrudaBoyce => named(&[("shear_modulus", true), ("locking_stretch", false)]),
        }
    }

    /// The rubber of these constants (stresses in MPa, so that all are of like size); `None` where they make none.
    pub(super) fn elastomer(self, values: &[f64]) -> Option<Elastomer> {
        let elastomer = match (self, values) {
            (RubberModel::NeoHookean, [mu]) => Elastomer::NeoHookean { shear_modulus: mu * MPA },
            (RubberModel::StVenantKirchhoff, [mu]) => {
                Elastomer::StVenantKirchhoff { shear_modulus: mu * MPA }
            }
            (RubberModel::LinearElastic, [mu]) => Elastomer::LinearElastic { shear_modulus: mu * MPA },
            (RubberModel::Ogden(1), [mu, alpha]) => {
                Elastomer::Ogden { shear_modulus: mu * MPA, alpha: *alpha, form: OgdenForm::InitialModulus }
            }
            (RubberModel::Ogden(_), values) => {
                let term = |pair: &[f64]| OgdenTerm { shear_modulus: pair[0] * MPA, alpha: pair[1] };
                let terms: Vec<OgdenTerm> = values.chunks_exact(2).map(term).collect();
                Elastomer::OgdenSeries { terms: OgdenTerms::new(&terms)? }
            }
            (RubberModel::MooneyRivlin, [c10, c01]) => {
                Elastomer::MooneyRivlin { c10: c10 * MPA, c01: c01 * MPA }
            }
            (RubberModel::Yeoh, [c10, c20, c30]) => {
                Elastomer::Yeoh { c10: c10 * MPA, c20: c20 * MPA, c30: c30 * MPA }
            }
            (RubberModel::Gent, [mu, jm]) => {
                Elastomer::Gent { shear_modulus: mu * MPA, locking_invariant: *jm }
            }
            (RubberModel::ArrudaBoyce, [mu, lm]) => {
                Elastomer::ArrudaBoyce { shear_modulus: mu * MPA, locking_stretch: *lm }
            }
            _ => return None,
        };
        elastomer.check().ok().map(|()| elastomer)
    }

    /// Where descents start, for data whose neo-Hookean modulus is `mu` (MPa). Of Ogden's terms only the exponents count: moduli
    /// that go with them are found by linear least squares.
    pub(super) fn starts(self, mu: f64, points: &[TestPoint]) -> Vec<Vec<f64>> {
        match self {
            RubberModel::NeoHookean | RubberModel::StVenantKirchhoff | RubberModel::LinearElastic => {
                vec![vec![mu]]
            }
            RubberModel::MooneyRivlin => vec![vec![0.5 * mu, 0.0]],
            RubberModel::Yeoh => vec![vec![0.5 * mu, 0.0, 0.0]],
            RubberModel::Gent => {
                let invariant = |point: &TestPoint| {
                    point.mode.stretches(point.stretch).map(|l| l * l).iter().sum::<f64>() - 3.0
                };
                let reached = points.iter().map(invariant).fold(1e-6, f64::max);
                [1.02, 1.1, 1.5, 3.0, 10.0, 100.0].map(|room| vec![mu, room * reached]).to_vec()
            }
            RubberModel::ArrudaBoyce => [1.1, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0].map(|lm| vec![mu, lm]).to_vec(),
            RubberModel::Ogden(terms) => {
                const EXPONENTS: [f64; 11] = [-6.0, -4.0, -2.5, -1.5, 0.7, 1.3, 2.0, 3.0, 4.5, 7.0, 10.0];
                let mut chosen = Vec::new();
                choose(&EXPONENTS, terms, &mut Vec::new(), &mut chosen);
                chosen
                    .into_iter()
                    .map(|alphas| alphas.into_iter().flat_map(|alpha| [mu, alpha]).collect())
                    .collect()
            }
        }
    }
}

/// All ways to choose `count` of `values`, in order.
fn choose(values: &[f64], count: usize, so_far: &mut Vec<f64>, chosen: &mut Vec<Vec<f64>>) {
    if count == 0 {
        chosen.push(so_far.clone());
        return;
    }
    for (i, value) in values.iter().enumerate() {
        so_far.push(*value);
        choose(&values[i + 1..], count - 1, so_far, chosen);
        so_far.pop();
    }
}
