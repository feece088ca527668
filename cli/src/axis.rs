//! Axes of a map on the command line: `wall_mm=0.6:1.0:0.2`.

use crate::values::Values;
use actuator::{FreeParameter, MapAxis};
use std::str::FromStr;

/// A named axis with its values, in the unit of its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What changes along it.
    pub parameter: FreeParameter,
    /// Its values as they were given.
    pub values: Values,
}

impl FromStr for Axis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((name, values)) = text.split_once('=') else {
            return Err("write NAME=VALUES, as in wall_mm=0.6:1.0:0.2".into());
        };
        let parameter = FreeParameter::ALL.into_iter().find(|parameter| parameter.name() == name.trim());
        let Some(parameter) = parameter else {
            let names: Vec<&str> = FreeParameter::ALL.iter().map(|parameter| parameter.name()).collect();
            return Err(format!("`{}` is no axis; there are {}", name.trim(), names.join(", ")));
        };
        Ok(Axis { parameter, values: values.parse()? })
    }
}

impl Axis {
    /// The axis in SI units, its values rising.
    ///
    /// # Errors
    /// A value that is given twice.
    pub fn rising(&self) -> Result<MapAxis, String> {
        let values = self.values.rising(self.parameter.name())?;
        let unit = self.parameter.unit();
        Ok(MapAxis { parameter: self.parameter, values: values.iter().map(|value| value * unit).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_the_names_of_the_files() {
        let axis: Axis = "wall_mm=0.8,0.6".parse().unwrap();
        let axis = axis.rising().unwrap();
        assert_eq!(axis.parameter, FreeParameter::Wall);
        assert!((axis.values[0] - 0.6e-3).abs() < 1e-18 && axis.values.len() == 2);
        let wrong = |text: &str| text.parse::<Axis>().unwrap_err();
        assert!(wrong("wall=1").contains("`wall` is no axis; there are winding_angle_deg"));
        assert!(wrong("wall_mm").contains("NAME=VALUES"));
        assert!(wrong("wall_mm=a").contains("not a number"));
        assert!("fibres=4,4".parse::<Axis>().unwrap().rising().unwrap_err().contains("given twice"));
    }
}
