use actuator::{FreeState, Middle, units::*};

/// What a chart shows of a state.
pub struct Quantity {
    /// Of the file's name.
    pub stem: &'static str,
    /// In a title.
    pub name: &'static str,
    /// Of an axis.
    pub label: &'static str,
    /// Of the whole.
    pub of: fn(&FreeState) -> f64,
    /// Of the middle, where it may differ from the whole.
    pub of_middle: Option<fn(&Middle) -> f64>,
}

pub const STRETCH: Quantity = Quantity {
    stem: "axial-stretch",
    name: "axial stretch",
    label: "axial stretch λ",
    of: |state| state.axial_stretch,
    of_middle: Some(|middle| middle.axial_stretch),
};

pub const EXPANSION: Quantity = Quantity {
    stem: "expansion",
    name: "expansion",
    label: "expansion b/B",
    of: |state| state.expansion,
    of_middle: None,
};

pub const TWIST: Quantity = Quantity {
    stem: "twist",
    name: "twist",
    label: "twist per length (°/mm)",
    of: |state| state.twist_per_length / DEG * MM,
    of_middle: Some(|middle| middle.twist_per_length / DEG * MM),
};

pub const QUANTITIES: [Quantity; 3] = [STRETCH, EXPANSION, TWIST];
