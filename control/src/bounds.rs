use actuator::Limits;
use rom::{ModuleModel, PoseModel};
use serde::{Deserialize, Serialize};

/// Least and greatest pressure that a solve may use in each FREE.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Least pressures, Pa.
    pub lower: Vec<f64>,
    /// Greatest pressures, Pa.
    pub upper: Vec<f64>,
    /// Limit pressure of each FREE, or the end of the model's domain where none is known, Pa: what `limit_margin` is measured to.
    pub limit: Vec<f64>,
}

/// Why there are no bounds.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundsError {
    /// Lists of different lengths.
    #[error("the model has {model} FREEs, but {what} has {given} entries; give one per FREE")]
    Count {
        /// FREEs of the model.
        model: usize,
        /// Which list.
        what: &'static str,
        /// Its length.
        given: usize,
    },
    /// Nothing is left between them.
    #[error("FREE {}: the least pressure {:.3} kPa lies above the greatest {:.3} kPa (set by {by}); lower the idle pressure or raise that limit", free + 1, lower / 1e3, upper / 1e3)]
    Empty {
        /// Index of the FREE.
        free: usize,
        /// Least pressure, Pa.
        lower: f64,
        /// Greatest pressure, Pa.
        upper: f64,
        /// What sets the greatest.
        by: &'static str,
    },
    /// A number that is none.
    #[error("FREE {}: a pressure limit is not a finite number", free + 1)]
    NotFinite {
        /// Index of the FREE.
        free: usize,
    },
}

impl Bounds {
    /// Bounds of a model of the given `domain` under the operator's `limits`: from the larger of the idle pressure and the
    /// domain's lower end to the least of the supply's greatest pressure, the domain's upper end and the limit pressure less
    /// `margin` (Pa). `limit_pressures` is empty or has one entry per FREE, `None` where there is no limit point.
    pub fn new(
        domain: &[(f64, f64)],
        limits: &Limits,
        limit_pressures: &[Option<f64>],
        margin: f64,
    ) -> Result<Self, BoundsError> {
        let count = |what, given| Err(BoundsError::Count { model: domain.len(), what, given });
        if limits.pressure_max.len() != domain.len() {
            return count("pressure_max", limits.pressure_max.len());
        }
        if !limit_pressures.is_empty() && limit_pressures.len() != domain.len() {
            return count("the list of limit pressures", limit_pressures.len());
        }
        let mut bounds = Bounds { lower: Vec::new(), upper: Vec::new(), limit: Vec::new() };
        for (free, &(least, greatest)) in domain.iter().enumerate() {
            let limit_pressure = limit_pressures.get(free).copied().flatten();
            let lower = limits.idle_pressure.max(least);
            let ceilings = [
                (limits.pressure_max[free], "pressure_max"),
                (greatest, "the model's domain"),
                (limit_pressure.map_or(f64::INFINITY, |limit| limit - margin), "the limit pressure"),
            ];
            let numbers = [limits.idle_pressure, limits.pressure_max[free], least, greatest, margin];
            if numbers.iter().chain(&limit_pressure).any(|value| !value.is_finite()) {
                return Err(BoundsError::NotFinite { free });
            }
            let (upper, by) = ceilings
                .into_iter()
                .fold((f64::INFINITY, ""), |least, next| if next.0 < least.0 { next } else { least });
            if lower > upper {
                return Err(BoundsError::Empty { free, lower, upper, by });
            }
            bounds.lower.push(lower);
            bounds.upper.push(upper);
            bounds.limit.push(limit_pressure.unwrap_or(greatest));
        }
        Ok(bounds)
    }

    /// Bounds of a fitted module under its own limits, `margin` (Pa) below its limit pressures; the model's domain keeps some
    /// distance to them already.
    pub fn of_model(model: &ModuleModel, margin: f64) -> Result<Self, BoundsError> {
        Self::new(model.domain(), model.limits(), model.limit_pressures(), margin)
    }

    /// Pressure (Pa) of a FREE after `place` of `last` even steps from the least to the greatest; both ends are met exactly.
    pub fn step(&self, free: usize, place: usize, last: usize) -> f64 {
        let (lower, upper) = (self.lower[free], self.upper[free]);
        match place {
            0 => lower,
            place if place == last => upper,
            place => lower + (upper - lower) * place as f64 / last as f64,
        }
    }

    /// What is wrong with them for a model of this domain, in words.
    pub(crate) fn complaint(&self, domain: &[(f64, f64)]) -> Option<String> {
        for (name, list) in [("lower", &self.lower), ("upper", &self.upper), ("limit", &self.limit)] {
            if list.len() != domain.len() {
                return Some(format!(
                    "the model has {} FREEs, but the {name} bounds have {} entries",
                    domain.len(),
                    list.len()
                ));
            }
        }
        for (free, &(least, greatest)) in domain.iter().enumerate() {
            let (lower, upper) = (self.lower[free], self.upper[free]);
            let p = format!("p{}", free + 1);
            if !(lower.is_finite() && upper.is_finite() && self.limit[free].is_finite()) {
                return Some(format!(
                    "the bounds of {p} are {lower} to {upper} Pa, limit {} Pa; give finite numbers",
                    self.limit[free]
                ));
            }
            if lower > upper {
                return Some(format!(
                    "the bounds of {p} are crossed: {} to {} kPa; swap them",
                    lower / 1e3,
                    upper / 1e3
                ));
            }
            if lower < least || upper > greatest {
                return Some(format!(
                    "the bounds of {p}, {} to {} kPa, leave the model's domain, {} to {} kPa; narrow them or map a wider range",
                    lower / 1e3,
                    upper / 1e3,
                    least / 1e3,
                    greatest / 1e3
                ));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> Limits {
        Limits { pressure_max: vec![70e3, 40e3, 70e3], pressure_rate: 2e5, idle_pressure: 2e3 }
    }

    #[test]
    fn the_tightest_limit_binds() {
        let domain = [(0.0, 60e3), (0.0, 60e3), (5e3, 60e3)];
        let bounds = Bounds::new(&domain, &limits(), &[None, None, Some(50e3)], 4e3).unwrap();
        assert_eq!(bounds.lower, [2e3, 2e3, 5e3]);
        assert_eq!(bounds.upper, [60e3, 40e3, 46e3]);
        assert_eq!(bounds.limit, [60e3, 60e3, 50e3]);
    }

    #[test]
    fn contradictions_are_named() {
        let domain = [(0.0, 60e3), (45e3, 60e3), (0.0, 60e3)];
        let message = Bounds::new(&domain, &limits(), &[], 0.0).unwrap_err().to_string();
        assert!(message.contains("FREE 2") && message.contains("pressure_max"), "{message}");
        let message = Bounds::new(&domain[..2], &limits(), &[], 0.0).unwrap_err().to_string();
        assert!(message.contains("2 FREEs") && message.contains("3 entries"), "{message}");
        let nan = Bounds::new(&[(0.0, f64::NAN); 3], &limits(), &[], 0.0).unwrap_err();
        assert_eq!(nan, BoundsError::NotFinite { free: 0 });
    }
}
