use crate::{Elastomer, Tube, Winding};
use serde::{Deserialize, Serialize};

/// One Fiber Reinforced Elastomeric Enclosure: a tube, its winding and its rubber.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Free {
    /// The elastomer tube.
    pub tube: Tube,
    /// The fibres on it.
    pub winding: Winding,
    /// The rubber.
    pub elastomer: Elastomer,
}

impl Free {
    /// The same FREE with another winding angle (from the hoop, rad) and shear modulus (Pa): a node of a map.
    pub fn at(self, winding_angle: f64, shear_modulus: f64) -> Self {
        Free {
            winding: self.winding.with_angle_from_hoop(winding_angle),
            elastomer: self.elastomer.with_shear_modulus(shear_modulus),
            ..self
        }
    }
}
