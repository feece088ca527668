/// A number of an effect: its name, the unit its name carries, and the range in which the effect's equation is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name with the unit, as files show it, such as `radius_kpa`.
    pub name: &'static str,
    /// SI units in one unit of the name: 1e3 for kPa, 1e-3 for mm, 1 where the name carries SI or none.
    pub unit: f64,
    /// Value at which the effect is absent, SI.
    pub neutral: f64,
    /// Where an estimate starts, SI; away from `neutral` where the equation has no slope there.
    pub start: f64,
    /// Least value, SI.
    pub lower: f64,
    /// Greatest value, SI.
    pub upper: f64,
    /// A change that matters, SI: scale of estimates and of difference steps.
    pub scale: f64,
}

impl Parameter {
    /// A value (SI) in the unit of the name.
    pub fn in_unit(&self, value: f64) -> f64 {
        value / self.unit
    }
}
