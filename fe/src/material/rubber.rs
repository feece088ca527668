use super::{
    Answer, ArrudaBoyce, Gent, Hyperelastic, Isochoric, LinearElastic, MooneyRivlin, NeoHookean, Ogden,
    StVenantKirchhoff, Yeoh,
};
use actuator::Elastomer;
use nalgebra::Matrix3;

/// The shape-changing part of an [`Elastomer`]'s energy: W(F/(det F)^(1/3)). Its volume is held by the element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rubber {
    /// Neo-Hookean.
    NeoHookean(Isochoric<NeoHookean>),
    /// One or more Ogden terms, either form.
    Ogden(Isochoric<Ogden>),
    /// Mooney-Rivlin.
    MooneyRivlin(Isochoric<MooneyRivlin>),
    /// Yeoh.
    Yeoh(Isochoric<Yeoh>),
    /// Gent; NaN from its locking on.
    Gent(Isochoric<Gent>),
    /// Arruda-Boyce.
    ArrudaBoyce(Isochoric<ArrudaBoyce>),
    /// St Venant-Kirchhoff without its lambda.
    StVenantKirchhoff(Isochoric<StVenantKirchhoff>),
    /// Small strain: the deviator of the strain of F itself. Not objective.
    LinearElastic(LinearElastic),
}

impl From<Elastomer> for Rubber {
    fn from(elastomer: Elastomer) -> Self {
        match elastomer {
            Elastomer::NeoHookean { shear_modulus } => {
                Rubber::NeoHookean(Isochoric(NeoHookean { shear_modulus }))
            }
            Elastomer::Ogden { shear_modulus, alpha, form } => {
                Rubber::Ogden(Isochoric(Ogden::new(shear_modulus, alpha, form)))
            }
            Elastomer::OgdenSeries { terms } => Rubber::Ogden(Isochoric(Ogden::series(&terms))),
            Elastomer::MooneyRivlin { c10, c01 } => {
                Rubber::MooneyRivlin(Isochoric(MooneyRivlin { c10, c01 }))
            }
            Elastomer::Yeoh { c10, c20, c30 } => Rubber::Yeoh(Isochoric(Yeoh { c10, c20, c30 })),
            Elastomer::Gent { shear_modulus, locking_invariant } => {
                Rubber::Gent(Isochoric(Gent { shear_modulus, locking_invariant }))
            }
            Elastomer::ArrudaBoyce { shear_modulus, locking_stretch } => {
                Rubber::ArrudaBoyce(Isochoric(ArrudaBoyce::new(shear_modulus, locking_stretch)))
            }
            Elastomer::StVenantKirchhoff { shear_modulus } => {
                Rubber::StVenantKirchhoff(Isochoric(StVenantKirchhoff { first_lame: 0.0, shear_modulus }))
            }
            Elastomer::LinearElastic { shear_modulus } => {
                Rubber::LinearElastic(LinearElastic::deviatoric(shear_modulus))
            }
        }
    }
}

impl Hyperelastic for Rubber {
    fn answer(&self, deformation_gradient: &Matrix3<f64>) -> Answer {
        match self {
            Rubber::NeoHookean(material) => material.answer(deformation_gradient),
            Rubber::Ogden(material) => material.answer(deformation_gradient),
            Rubber::MooneyRivlin(material) => material.answer(deformation_gradient),
            Rubber::Yeoh(material) => material.answer(deformation_gradient),
            Rubber::Gent(material) => material.answer(deformation_gradient),
            Rubber::ArrudaBoyce(material) => material.answer(deformation_gradient),
            Rubber::StVenantKirchhoff(material) => material.answer(deformation_gradient),
            Rubber::LinearElastic(material) => material.answer(deformation_gradient),
        }
    }
}
