use serde::{Deserialize, Serialize};

/// Which of the two energies in use is called "Ogden, mu, alpha".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OgdenForm {
    /// W = (2 mu/alpha^2)(l1^a + l2^a + l3^a - 3): mu is the initial shear modulus, alpha = 2 is neo-Hookean. The default.
    InitialModulus,
    /// W = (2 mu/alpha)(l1^a + l2^a + l3^a - 3), as the paper prints it: its initial shear modulus is mu alpha.
    Printed,
}

/// An incompressible rubber, by its model and constants. The energies themselves are in the crate `fe`.
///
/// l are the principal stretches, I1 = l1^2 + l2^2 + l3^2 and I2 = l1^-2 + l2^-2 + l3^-2 (volume unchanged). Files hold the
/// variants by their place in this list: new ones go to its end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Elastomer {
    /// W = mu/2 (I1 - 3).
    NeoHookean {
        /// mu, Pa.
        shear_modulus: f64,
    },
    /// One Ogden term.
    Ogden {
        /// mu, Pa; the initial shear modulus in the form [`OgdenForm::InitialModulus`].
        shear_modulus: f64,
        /// The exponent (never an angle).
        alpha: f64,
        /// Which energy.
        form: OgdenForm,
    },
    /// Several Ogden terms, in the form [`OgdenForm::InitialModulus`].
    OgdenSeries {
        /// The terms.
        terms: OgdenTerms,
    },
    /// W = c10 (I1 - 3) + c01 (I2 - 3); mu = 2 (c10 + c01).
    MooneyRivlin {
        /// c10, Pa.
        c10: f64,
        /// c01, Pa.
        c01: f64,
    },
    /// W = c10 (I1 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3; mu = 2 c10.
    Yeoh {
        /// c10, Pa.
        c10: f64,
        /// c20, Pa.
        c20: f64,
        /// c30, Pa.
        c30: f64,
    },
    /// W = -mu Jm/2 ln(1 - (I1 - 3)/Jm): chains that can be extended to I1 = 3 + Jm and no further.
    Gent {
        /// mu, Pa.
        shear_modulus: f64,
        /// Jm, the value of I1 - 3 that is never reached.
        locking_invariant: f64,
    },
    /// Arruda and Boyce's eight chains, the series of five terms
    /// W = mu_c sum of C_i/lm^(2i - 2) (I1^i - 3^i), C = 1/2, 1/20, 11/1050, 19/7000, 519/673750.
    ArrudaBoyce {
        /// The initial shear modulus, Pa: mu_c times [`chain_stiffening`]. (Not mu_c, the n k T of the chains.)
        shear_modulus: f64,
        /// lm, the stretch of the chains at which they lock.
        locking_stretch: f64,
    },
    /// St Venant and Kirchhoff: W = mu tr(E^2) with Green's strain E = (C - 1)/2. Softens in compression until it gives way.
    StVenantKirchhoff {
        /// mu, Pa.
        shear_modulus: f64,
    },
    /// Small strain: W = mu |e|^2 with e the deviator of the symmetric part of F - 1. Not objective: a rotation strains it.
    LinearElastic {
        /// mu, Pa.
        shear_modulus: f64,
    },
}

/// A term (2 mu/alpha^2)(l1^a + l2^a + l3^a - 3) of an Ogden energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OgdenTerm {
    /// mu, Pa: the term's share of the initial shear modulus.
    pub shear_modulus: f64,
    /// The exponent, not zero.
    pub alpha: f64,
}

/// One to six Ogden terms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<OgdenTerm>", into = "Vec<OgdenTerm>")]
pub struct OgdenTerms {
    count: usize,
    terms: [OgdenTerm; OgdenTerms::MOST],
}

impl OgdenTerms {
    /// The greatest number of terms.
    pub const MOST: usize = 6;

    /// The terms, or `None` where there is none or more than [`OgdenTerms::MOST`].
    pub fn new(given: &[OgdenTerm]) -> Option<Self> {
        let mut terms = [OgdenTerm::default(); Self::MOST];
        terms.get_mut(..given.len()).filter(|room| !room.is_empty())?.copy_from_slice(given);
        Some(OgdenTerms { count: given.len(), terms })
    }

    /// The terms.
    pub fn as_slice(&self) -> &[OgdenTerm] {
        &self.terms[..self.count]
    }
}

impl TryFrom<Vec<OgdenTerm>> for OgdenTerms {
    type Error = &'static str;

    fn try_from(terms: Vec<OgdenTerm>) -> Result<Self, Self::Error> {
        Self::new(&terms).ok_or("an Ogden energy has one to six terms")
    }
}

impl From<OgdenTerms> for Vec<OgdenTerm> {
    fn from(terms: OgdenTerms) -> Self {
        terms.as_slice().to_vec()
    }
}

/// Factors C_i of Arruda and Boyce's series, by Taylor expansion of the inverse Langevin function (1993, eq. 17).
pub const ARRUDA_BOYCE: [f64; 5] = [1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673_750.0];

/// Initial shear modulus of Arruda and Boyce's series over mu_c, at the locking stretch lm:
/// 2 sum of C_i i 3^(i - 1)/lm^(2i - 2).
pub fn chain_stiffening(locking_stretch: f64) -> f64 {
    let ratio = 3.0 / (locking_stretch * locking_stretch);
    ARRUDA_BOYCE
        .iter()
        .rev()
        .zip([5.0, 4.0, 3.0, 2.0, 1.0])
        .fold(0.0, |sum, (c, i)| sum * ratio + 2.0 * c * i)
}

/// A constant of an elastomer that makes no rubber.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{field} is {value}: {requirement}")]
pub struct ElastomerError {
    /// The constant, as files name it without its unit.
    pub field: &'static str,
    /// Its value, SI.
    pub value: f64,
    /// What it must be.
    pub requirement: &'static str,
}

impl Elastomer {
    /// The mu of the file, Pa: the initial shear modulus, but for the printed Ogden form.
    pub fn shear_modulus(&self) -> f64 {
        match self {
            Elastomer::NeoHookean { shear_modulus }
            | Elastomer::Ogden { shear_modulus, .. }
            | Elastomer::Gent { shear_modulus, .. }
            | Elastomer::ArrudaBoyce { shear_modulus, .. }
            | Elastomer::StVenantKirchhoff { shear_modulus }
            | Elastomer::LinearElastic { shear_modulus } => *shear_modulus,
            Elastomer::OgdenSeries { terms } => terms.as_slice().iter().map(|term| term.shear_modulus).sum(),
            Elastomer::MooneyRivlin { c10, c01 } => 2.0 * (c10 + c01),
            Elastomer::Yeoh { c10, .. } => 2.0 * c10,
        }
    }

    /// Shear modulus at small strain, Pa: mu, or mu alpha for the printed Ogden form.
    pub fn initial_shear_modulus(&self) -> f64 {
        match *self {
            Elastomer::Ogden { shear_modulus, alpha, form: OgdenForm::Printed } => shear_modulus * alpha,
            _ => self.shear_modulus(),
        }
    }

    /// The same rubber with another mu (Pa): all its stresses scale alike.
    pub fn with_shear_modulus(self, mu: f64) -> Self {
        let scale = mu / self.shear_modulus();
        match self {
            Elastomer::NeoHookean { .. } => Elastomer::NeoHookean { shear_modulus: mu },
            Elastomer::Ogden { alpha, form, .. } => Elastomer::Ogden { shear_modulus: mu, alpha, form },
            Elastomer::OgdenSeries { mut terms } => {
                terms.terms.iter_mut().for_each(|term| term.shear_modulus *= scale);
                Elastomer::OgdenSeries { terms }
            }
            Elastomer::MooneyRivlin { c10, c01 } => {
                Elastomer::MooneyRivlin { c10: scale * c10, c01: scale * c01 }
            }
            Elastomer::Yeoh { c10, c20, c30 } => {
                Elastomer::Yeoh { c10: scale * c10, c20: scale * c20, c30: scale * c30 }
            }
            Elastomer::Gent { locking_invariant, .. } => {
                Elastomer::Gent { shear_modulus: mu, locking_invariant }
            }
            Elastomer::ArrudaBoyce { locking_stretch, .. } => {
                Elastomer::ArrudaBoyce { shear_modulus: mu, locking_stretch }
            }
            Elastomer::StVenantKirchhoff { .. } => Elastomer::StVenantKirchhoff { shear_modulus: mu },
            Elastomer::LinearElastic { .. } => Elastomer::LinearElastic { shear_modulus: mu },
        }
    }

    /// Whether the constants make a rubber: all are finite, the exponents are not zero, the initial shear modulus is positive.
    pub fn check(&self) -> Result<(), ElastomerError> {
        let ensure = |field, value: f64, holds: bool, requirement| match value.is_finite() && holds {
            true => Ok(()),
            false => Err(ElastomerError { field, value, requirement }),
        };
        let finite = |field, value| ensure(field, value, true, "it must be finite");
        let exponent = |alpha: f64| {
            let requirement = "the exponent must not be zero (nor within 0.001 of it) nor beyond 20 in size";
            ensure("alpha", alpha, (1e-3..=20.0).contains(&alpha.abs()), requirement)
        };
        match *self {
            Elastomer::Ogden { alpha, form, .. } => {
                exponent(alpha)?;
                let positive = form == OgdenForm::InitialModulus || alpha > 0.0;
                ensure("alpha", alpha, positive, "it makes the initial shear modulus negative in this form")?;
            }
            Elastomer::OgdenSeries { terms } => {
                for term in terms.as_slice() {
                    exponent(term.alpha)?;
                }
            }
            Elastomer::MooneyRivlin { c10, c01 } => {
                finite("c10", c10)?;
                ensure(
                    "c01",
                    c01,
                    c10 + c01 > 0.0,
                    "c10 + c01, half the initial shear modulus, must be positive",
                )?;
            }
            Elastomer::Yeoh { c10, c20, c30 } => {
                ensure("c10", c10, c10 > 0.0, "it is half the initial shear modulus and must be positive")?;
                finite("c20", c20)?;
                finite("c30", c30)?;
            }
            Elastomer::Gent { locking_invariant: jm, .. } => {
                ensure("jm", jm, jm > 0.0, "I1 - 3 must find room below it: it must be positive")?;
            }
            Elastomer::ArrudaBoyce { locking_stretch: lm, .. } => {
                ensure("locking_stretch", lm, lm > 1.0, "chains lock beyond their rest: it must be above 1")?;
            }
            _ => {}
        }
        let mu = self.shear_modulus();
        ensure("shear_modulus", mu, mu > 0.0, "the initial shear modulus must be positive, in Pa")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terms(values: &[(f64, f64)]) -> OgdenTerms {
        let terms: Vec<OgdenTerm> =
            values.iter().map(|&(shear_modulus, alpha)| OgdenTerm { shear_modulus, alpha }).collect();
        OgdenTerms::new(&terms).unwrap()
    }

    #[test]
    fn another_modulus_scales_all_stresses() {
        let series = Elastomer::OgdenSeries { terms: terms(&[(0.3e6, 1.2), (-1e3, -2.0), (2e3, 5.0)]) };
        for rubber in [
            series,
            Elastomer::MooneyRivlin { c10: 0.15e6, c01: -0.02e6 },
            Elastomer::Yeoh { c10: 0.2e6, c20: -2e3, c30: 40.0 },
            Elastomer::ArrudaBoyce { shear_modulus: 0.3e6, locking_stretch: 4.0 },
        ] {
            rubber.check().unwrap();
            let doubled = rubber.with_shear_modulus(2.0 * rubber.shear_modulus());
            assert!((doubled.initial_shear_modulus() / rubber.initial_shear_modulus() - 2.0).abs() < 1e-15);
            let back = doubled.with_shear_modulus(rubber.shear_modulus());
            assert_eq!(format!("{back:.9?}"), format!("{rubber:.9?}"));
        }
        let Elastomer::OgdenSeries { terms } = series.with_shear_modulus(series.shear_modulus() * 3.0) else {
            panic!("another model");
        };
        assert!((terms.as_slice()[1].shear_modulus + 3e3).abs() < 1e-9);
    }

    #[test]
    fn stiffening_of_chains_is_the_published_series() {
        // mu/mu_c = 1 + 3/(5 lm^2) + 99/(175 lm^4) + 513/(875 lm^6) + 42039/(67375 lm^8).
        for lm in [1.5f64, 2.8, 7.0] {
            let published = 1.0
                + 3.0 / (5.0 * lm.powi(2))
                + 99.0 / (175.0 * lm.powi(4))
                + 513.0 / (875.0 * lm.powi(6))
                + 42039.0 / (67375.0 * lm.powi(8));
            assert!((chain_stiffening(lm) / published - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn constants_that_make_no_rubber_are_named() {
        let field = |rubber: Elastomer| rubber.check().unwrap_err().field;
        let mu = 1e5;
        assert_eq!(field(Elastomer::NeoHookean { shear_modulus: f64::NAN }), "shear_modulus");
        assert_eq!(field(Elastomer::Gent { shear_modulus: mu, locking_invariant: 0.0 }), "jm");
        assert_eq!(
            field(Elastomer::ArrudaBoyce { shear_modulus: mu, locking_stretch: 0.9 }),
            "locking_stretch"
        );
        assert_eq!(field(Elastomer::MooneyRivlin { c10: mu, c01: -mu }), "c01");
        assert_eq!(field(Elastomer::Yeoh { c10: mu, c20: f64::INFINITY, c30: 0.0 }), "c20");
        assert_eq!(field(Elastomer::OgdenSeries { terms: terms(&[(mu, 1.0), (mu, 0.0)]) }), "alpha");
        let printed = Elastomer::Ogden { shear_modulus: mu, alpha: -2.0, form: OgdenForm::Printed };
        assert_eq!(field(printed), "alpha");
    }

    #[test]
    fn files_keep_the_place_of_each_model() {
        let bytes = |rubber: Elastomer| postcard::to_stdvec(&rubber).unwrap();
        // As files of format 1 have it: variant 0, 1.0; variant 1, 1.0, 2.0, form 0.
        assert_eq!(bytes(Elastomer::NeoHookean { shear_modulus: 1.0 }), [0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
        let ogden = Elastomer::Ogden { shear_modulus: 1.0, alpha: 2.0, form: OgdenForm::InitialModulus };
        assert_eq!(bytes(ogden), [1, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0x40, 0]);
        for (place, rubber) in [
            (2, Elastomer::OgdenSeries { terms: terms(&[(1.0, 2.0), (3.0, 4.0)]) }),
            (3, Elastomer::MooneyRivlin { c10: 1.0, c01: 2.0 }),
            (4, Elastomer::Yeoh { c10: 1.0, c20: 2.0, c30: 3.0 }),
            (5, Elastomer::Gent { shear_modulus: 1.0, locking_invariant: 2.0 }),
            (6, Elastomer::ArrudaBoyce { shear_modulus: 1.0, locking_stretch: 2.0 }),
            (7, Elastomer::StVenantKirchhoff { shear_modulus: 1.0 }),
            (8, Elastomer::LinearElastic { shear_modulus: 1.0 }),
        ] {
            let stored = bytes(rubber);
            assert_eq!(stored[0], place);
            assert_eq!(postcard::from_bytes::<Elastomer>(&stored).unwrap(), rubber);
        }
        // Seven terms.
        let too_many = [vec![2, 7], vec![0; 7 * 16]].concat();
        assert!(postcard::from_bytes::<Elastomer>(&too_many).is_err());
    }
}
