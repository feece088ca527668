use crate::TipLoad;

/// How finely and how stiff a module is modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodSettings {
    /// Elements along each FREE of a module without spacers. A FREE may turn several times, but each element by less than 2.5 rad; one that
    /// turns by an angle within an element bends too little by a twelfth of its square: 1 % at 0.35 rad.
    pub elements: usize,
    /// Factor on the bending law of every FREE (bending, shear and their coupling), for calibration.
    pub bending_stiffness_scale: f64,
    /// Loads on the tip plate besides weights.
    pub tip_load: TipLoad,
}

impl Default for RodSettings {
    fn default() -> Self {
        RodSettings { elements: 20, bending_stiffness_scale: 1.0, tip_load: TipLoad::default() }
    }
}

impl RodSettings {
    /// In words, for a map.
    pub fn describe(&self) -> String {
        let factor = self.bending_stiffness_scale;
        let scaled =
            if factor == 1.0 { String::new() } else { format!(", bending and shear stiffness x {factor}") };
        format!(
            "geometrically exact rods, {} elements a FREE; with spacers, one element between two of them{scaled}",
            self.elements
        )
    }
}
