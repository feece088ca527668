use crate::{
    Elastomer, LoadedFree,
    units::{DEG, MM, MPA},
};
use serde::{Deserialize, Serialize};

/// A quantity over which the map of a FREE may extend, beside the pressure.
///
/// Files hold the variants by their place in this list: new ones go to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FreeParameter {
    /// Winding angle from the hoop direction, rad.
    WindingAngle,
    /// Shear modulus mu of the rubber, Pa; the rubber's other stresses change in proportion.
    ShearModulus,
    /// Wall thickness, m, at constant inner diameter.
    Wall,
    /// Inner diameter, m, at constant wall thickness.
    InnerDiameter,
    /// Exponent alpha of an Ogden rubber of one term.
    OgdenExponent,
    /// Number of fibres around the tube, each of the same thread.
    Fibres,
    /// Axial force on the closed ends, N, positive when it pulls.
    AxialForce,
    /// Torque on the closed ends, N m, positive like a positive twist.
    Torque,
    /// Axial stiffness EA of one thread, N.
    FibreStiffness,
    /// Width of the thread across itself, m.
    FibreDiameter,
}

/// A value that a parameter cannot have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{} = {value}: {requirement}", .parameter.name())]
pub struct ParameterError {
    /// Which parameter.
    pub parameter: FreeParameter,
    /// The value, in the unit of its name.
    pub value: f64,
    /// What is wanted.
    pub requirement: &'static str,
}

impl FreeParameter {
    /// All of them.
    pub const ALL: [FreeParameter; 10] = [
        FreeParameter::WindingAngle,
        FreeParameter::ShearModulus,
        FreeParameter::Wall,
        FreeParameter::InnerDiameter,
        FreeParameter::OgdenExponent,
        FreeParameter::Fibres,
        FreeParameter::AxialForce,
        FreeParameter::Torque,
        FreeParameter::FibreStiffness,
        FreeParameter::FibreDiameter,
    ];

    /// Its name in files and on the command line, with its unit.
    pub fn name(self) -> &'static str {
        match self {
            FreeParameter::WindingAngle => "winding_angle_deg",
            FreeParameter::ShearModulus => "shear_modulus_mpa",
            FreeParameter::Wall => "wall_mm",
            FreeParameter::InnerDiameter => "inner_diameter_mm",
            FreeParameter::OgdenExponent => "alpha",
            FreeParameter::Fibres => "fibres",
            FreeParameter::AxialForce => "axial_force_n",
            FreeParameter::Torque => "torque_nmm",
            FreeParameter::FibreStiffness => "fibre_ea_newton",
            FreeParameter::FibreDiameter => "fibre_diameter_mm",
        }
    }

    /// Its name and unit as a label of a plot's axis.
    pub fn label(self) -> &'static str {
        match self {
            FreeParameter::WindingAngle => "winding angle (° from hoop)",
            FreeParameter::ShearModulus => "µ (MPa)",
            FreeParameter::Wall => "wall (mm)",
            FreeParameter::InnerDiameter => "inner diameter (mm)",
            FreeParameter::OgdenExponent => "α",
            FreeParameter::Fibres => "fibres",
            FreeParameter::AxialForce => "axial force (N)",
            FreeParameter::Torque => "torque (N mm)",
            FreeParameter::FibreStiffness => "fibre EA (N)",
            FreeParameter::FibreDiameter => "fibre diameter (mm)",
        }
    }

    /// SI units in the unit of its name.
    pub fn unit(self) -> f64 {
        match self {
            FreeParameter::WindingAngle => DEG,
            FreeParameter::ShearModulus => MPA,
            FreeParameter::Wall | FreeParameter::InnerDiameter | FreeParameter::FibreDiameter => MM,
            // N mm.
            FreeParameter::Torque => MM,
            FreeParameter::OgdenExponent
            | FreeParameter::Fibres
            | FreeParameter::AxialForce
            | FreeParameter::FibreStiffness => 1.0,
        }
    }

    /// Its value (SI) of a FREE; `None` where the rubber has no such constant.
    pub fn of(self, node: &LoadedFree) -> Option<f64> {
        let LoadedFree { free, load } = node;
        Some(match self {
            FreeParameter::WindingAngle => free.winding.angle_from_hoop(),
            FreeParameter::ShearModulus => free.elastomer.shear_modulus(),
            FreeParameter::Wall => free.tube.wall,
            FreeParameter::InnerDiameter => 2.0 * free.tube.inner_radius,
            FreeParameter::OgdenExponent => match free.elastomer {
                Elastomer::Ogden { alpha, .. } => alpha,
                _ => return None,
            },
            FreeParameter::Fibres => f64::from(free.winding.fibres),
            FreeParameter::AxialForce => load.force,
            FreeParameter::Torque => load.torque,
            FreeParameter::FibreStiffness => free.winding.fibre.axial_stiffness,
            FreeParameter::FibreDiameter => free.winding.fibre.diameter,
        })
    }

    /// The FREE with this parameter (SI) changed.
    ///
    /// # Errors
    /// [`ParameterError`] where the parameter cannot have the value, or the rubber not the parameter. Whether the whole then makes a
    /// tube is for the finite elements to say.
    pub fn set(self, mut node: LoadedFree, value: f64) -> Result<LoadedFree, ParameterError> {
        let wanted = |holds: bool, requirement| match holds {
            true => Ok(()),
            false => Err(ParameterError { parameter: self, value: value / self.unit(), requirement }),
        };
        let positive = value.is_finite() && value > 0.0;
        let LoadedFree { free, load } = &mut node;
        match self {
            FreeParameter::WindingAngle => {
                wanted(
                    value.is_finite() && value >= 0.0,
                    "an angle from the hoop direction is zero or more",
                )?;
                free.winding = free.winding.with_angle_from_hoop(value);
            }
            FreeParameter::ShearModulus => {
                wanted(positive, "a shear modulus is positive")?;
                free.elastomer = free.elastomer.with_shear_modulus(value);
            }
            FreeParameter::Wall => {
                wanted(positive, "a wall has a positive thickness")?;
                free.tube.wall = value;
            }
            FreeParameter::InnerDiameter => {
                wanted(positive, "a diameter is positive")?;
                free.tube.inner_radius = 0.5 * value;
            }
            FreeParameter::OgdenExponent => {
                wanted(value.is_finite() && value != 0.0, "an Ogden exponent is a number other than zero")?;
                match &mut free.elastomer {
                    Elastomer::Ogden { alpha, .. } => *alpha = value,
                    _ => wanted(false, "the description's rubber is not an Ogden rubber of one term")?,
                }
            }
            FreeParameter::Fibres => {
                let whole = value.fract() == 0.0 && (1.0..=1000.0).contains(&value);
                wanted(whole, "the number of fibres is a whole number from 1 to 1000")?;
                free.winding.fibres = value as u32;
            }
            FreeParameter::AxialForce => {
                wanted(value.is_finite(), "a force is a finite number")?;
                load.force = value;
            }
            FreeParameter::Torque => {
                wanted(value.is_finite(), "a torque is a finite number")?;
                load.torque = value;
            }
            FreeParameter::FibreStiffness => {
                wanted(value.is_finite() && value >= 0.0, "a stiffness is zero or more")?;
                free.winding.fibre.axial_stiffness = value;
            }
            FreeParameter::FibreDiameter => {
                wanted(positive, "a diameter is positive")?;
                free.winding.fibre.diameter = value;
            }
        }
        Ok(node)
    }
}

/// One axis of the map of a FREE.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapAxis {
    /// What changes along it.
    pub parameter: FreeParameter,
    /// Its values (SI), rising.
    pub values: Vec<f64>,
}

impl MapAxis {
    /// The axes that every map has: winding angles from the hoop (rad) and shear moduli (Pa).
    pub fn of_angles_and_moduli(angles: Vec<f64>, moduli: Vec<f64>) -> Vec<MapAxis> {
        vec![
            MapAxis { parameter: FreeParameter::WindingAngle, values: angles },
            MapAxis { parameter: FreeParameter::ShearModulus, values: moduli },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::*;

    fn node() -> LoadedFree {
        let fibre = Fibre { axial_stiffness: 644.0, diameter: 1.5e-4, law: FibreLaw::Linear };
        LoadedFree::from(Free {
            tube: Tube { length: 0.13, inner_radius: 4.76e-3, wall: 0.8e-3 },
            winding: Winding::from_hoop(0.5, Handedness::Right, 6, fibre),
            elastomer: Elastomer::Ogden {
                shear_modulus: 0.393e6,
                alpha: 1.2,
                form: OgdenForm::InitialModulus,
            },
        })
    }

    #[test]
    fn what_is_set_is_what_is_read_and_nothing_else_changes() {
        let value = |parameter| match parameter {
            FreeParameter::Fibres => 8.0,
            _ => 0.7,
        };
        for parameter in FreeParameter::ALL {
            let changed = parameter.set(node(), value(parameter)).unwrap();
            for other in FreeParameter::ALL {
                let expected = if other == parameter { Some(value(parameter)) } else { other.of(&node()) };
                let (found, expected) = (other.of(&changed).unwrap(), expected.unwrap());
                assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{parameter:?} {other:?}");
            }
        }
    }

    #[test]
    fn impossible_values_are_refused_with_the_name_that_files_use() {
        let message = |parameter: FreeParameter, value| parameter.set(node(), value).unwrap_err().to_string();
        assert_eq!(
            message(FreeParameter::Fibres, 2.5),
            "fibres = 2.5: the number of fibres is a whole number from 1 to 1000"
        );
        assert!(message(FreeParameter::Wall, -0.8e-3).starts_with("wall_mm = -0.8"));
        assert!(message(FreeParameter::OgdenExponent, 0.0).starts_with("alpha = 0:"));
        assert!(message(FreeParameter::Torque, f64::NAN).contains("finite"));
        let mut other = node();
        other.free.elastomer = Elastomer::NeoHookean { shear_modulus: 1e5 };
        let error = FreeParameter::OgdenExponent.set(other, 1.3).unwrap_err();
        assert!(error.to_string().contains("not an Ogden rubber"));
        assert_eq!(FreeParameter::OgdenExponent.of(&other), None);
    }
}
