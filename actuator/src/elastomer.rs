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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Elastomer {
    /// W = mu/2 (l1^2 + l2^2 + l3^2 - 3).
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
}

impl Elastomer {
    /// The parameter mu of the file, Pa.
    pub fn shear_modulus(&self) -> f64 {
        match *self {
            Elastomer::NeoHookean { shear_modulus } | Elastomer::Ogden { shear_modulus, .. } => shear_modulus,
        }
    }

    /// Shear modulus at small strain, Pa: mu, or mu alpha for the printed Ogden form.
    pub fn initial_shear_modulus(&self) -> f64 {
        match *self {
            Elastomer::Ogden { shear_modulus, alpha, form: OgdenForm::Printed } => shear_modulus * alpha,
            _ => self.shear_modulus(),
        }
    }

    /// The same rubber with another mu (Pa).
    pub fn with_shear_modulus(self, mu: f64) -> Self {
        match self {
            Elastomer::NeoHookean { .. } => Elastomer::NeoHookean { shear_modulus: mu },
            Elastomer::Ogden { alpha, form, .. } => Elastomer::Ogden { shear_modulus: mu, alpha, form },
        }
    }
}
