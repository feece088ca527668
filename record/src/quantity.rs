use actuator::units::{DEG, KPA, MM, MPA};

/// One quantity of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Time.
    Time,
    /// Commanded pressure of FREE `index` (from zero).
    Command(usize),
    /// Measured pressure of FREE `index` (from zero).
    Pressure(usize),
    /// Position of the tip plate along x, y, z (0, 1, 2).
    Position(usize),
    /// Component w, x, y, z (0 to 3) of the tip plate's unit quaternion.
    Rotation(usize),
    /// Rotation of the tip plate about z, for tips that cannot tilt; read into the quaternion.
    RotationAboutZ,
    /// Twist of a single FREE.
    Twist,
    /// Change of length of a single FREE.
    Extension,
    /// Outer diameter of a single FREE.
    OuterDiameter,
    /// Torque on the free end of a single FREE.
    Torque,
    /// Axial force on the free end of a single FREE.
    Force,
}

/// What a quantity is measured in; decides which unit suffixes fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dimension {
    Time,
    Pressure,
    Length,
    Angle,
    Torque,
    Force,
    None,
}

impl Dimension {
    /// Unit suffixes and the SI value of one unit; the first is the usual one.
    fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Dimension::Time => &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0)],
            // 1 psi = 0.45359237 kg * 9.80665 m/s^2 / (25.4 mm)^2.
            Dimension::Pressure => &[
                ("kpa", KPA),
                ("pa", 1.0),
                ("mpa", MPA),
                ("bar", 1e5),
                ("mbar", 1e2),
                ("psi", 6_894.757_293_168_361),
            ],
            Dimension::Length => &[("mm", MM), ("m", 1.0), ("cm", 1e-2), ("um", 1e-6), ("in", 25.4 * MM)],
            Dimension::Angle => &[("rad", 1.0), ("deg", DEG), ("mrad", 1e-3)],
            Dimension::Torque => &[("nmm", 1e-3), ("nm", 1.0), ("mnm", 1e-3)],
            Dimension::Force => &[("n", 1.0), ("mn", 1e-3)],
            Dimension::None => &[("", 1.0)],
        }
    }
}

impl Quantity {
    fn dimension(self) -> Dimension {
        match self {
            Quantity::Time => Dimension::Time,
            Quantity::Command(_) | Quantity::Pressure(_) => Dimension::Pressure,
            Quantity::Position(_) | Quantity::Extension | Quantity::OuterDiameter => Dimension::Length,
            Quantity::Rotation(_) => Dimension::None,
            Quantity::RotationAboutZ | Quantity::Twist => Dimension::Angle,
            Quantity::Torque => Dimension::Torque,
            Quantity::Force => Dimension::Force,
        }
    }

    /// Name without unit, as columns are called: `t`, `p2_command`, `x`, `qw`, `twist`.
    pub fn stem(self) -> String {
        match self {
            Quantity::Time => "t".into(),
            Quantity::Command(free) => format!("p{}_command", free + 1),
            Quantity::Pressure(free) => format!("p{}", free + 1),
            Quantity::Position(axis) => ["x", "y", "z"][axis].into(),
            Quantity::Rotation(component) => ["qw", "qx", "qy", "qz"][component].into(),
            Quantity::RotationAboutZ => "rz".into(),
            Quantity::Twist => "twist".into(),
            Quantity::Extension => "extension".into(),
            Quantity::OuterDiameter => "outer_diameter".into(),
            Quantity::Torque => "torque".into(),
            Quantity::Force => "force".into(),
        }
    }

    /// Name of the usual column: the stem and the usual unit, as `p2_command_kpa`.
    pub fn column(self) -> String {
        let (unit, _) = self.dimension().units()[0];
        if unit.is_empty() { self.stem() } else { format!("{}_{unit}", self.stem()) }
    }

    /// SI value of one of the usual column's units.
    pub fn unit(self) -> f64 {
        self.dimension().units()[0].1
    }

    /// Units that a column of this quantity may carry, for messages.
    pub fn unit_names(self) -> String {
        self.dimension().units().iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    }

    fn from_stem(stem: &str) -> Option<Quantity> {
        let fixed = [
            Quantity::Time,
            Quantity::Position(0),
            Quantity::Position(1),
            Quantity::Position(2),
            Quantity::Rotation(0),
            Quantity::Rotation(1),
            Quantity::Rotation(2),
            Quantity::Rotation(3),
            Quantity::RotationAboutZ,
            Quantity::Twist,
            Quantity::Extension,
            Quantity::OuterDiameter,
            Quantity::Torque,
            Quantity::Force,
        ];
        if let Some(found) = fixed.into_iter().find(|quantity| quantity.stem() == stem) {
            return Some(found);
        }
        let number = stem.strip_prefix('p')?;
        let (number, command) = match number.strip_suffix("_command") {
            Some(number) => (number, true),
            None => (number, false),
        };
        let index = number.parse::<usize>().ok()?.checked_sub(1)?;
        Some(if command { Quantity::Command(index) } else { Quantity::Pressure(index) })
    }

    /// Quantity and SI value of one unit that a column name stands for: `p2_psi` is the measured pressure of FREE 2 in psi.
    pub fn from_column(name: &str) -> Result<(Quantity, f64), String> {
        if let Some(quantity @ Quantity::Rotation(_)) = Quantity::from_stem(name) {
            return Ok((quantity, 1.0));
        }
        let unknown = || {
            "unknown name; known are t_s, p1_command_kpa, p1_kpa, x_mm, y_mm, z_mm, qw, qx, qy, qz, rz_rad, \
             twist_rad, extension_mm, outer_diameter_mm, torque_nmm, force_n (other units by their suffix)"
                .to_owned()
        };
        if let Some(quantity) = Quantity::from_stem(name) {
            return Err(format!("lacks its unit; write {}", quantity.column()));
        }
        let (stem, unit) = name.rsplit_once('_').ok_or_else(unknown)?;
        let quantity = Quantity::from_stem(stem).ok_or_else(unknown)?;
        match quantity.dimension().units().iter().find(|(known, _)| *known == unit) {
            Some((_, value)) => Ok((quantity, *value)),
            None => Err(format!("unknown unit `{unit}`; known here are {}", quantity.unit_names())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_columns_are_found_again_and_units_scale() {
        for quantity in [
            Quantity::Time,
            Quantity::Command(0),
            Quantity::Pressure(11),
            Quantity::Position(2),
            Quantity::Rotation(3),
            Quantity::RotationAboutZ,
            Quantity::Twist,
            Quantity::Extension,
            Quantity::OuterDiameter,
            Quantity::Torque,
            Quantity::Force,
        ] {
            assert_eq!(Quantity::from_column(&quantity.column()), Ok((quantity, quantity.unit())));
        }
        assert_eq!(Quantity::from_column("p2_command_bar"), Ok((Quantity::Command(1), 1e5)));
        assert_eq!(Quantity::from_column("outer_diameter_in"), Ok((Quantity::OuterDiameter, 0.0254)));
        // 11 psi = 75,842.3 Pa.
        let (_, psi) = Quantity::from_column("p1_psi").unwrap();
        assert!((11.0 * psi - 75_842.33).abs() < 0.01);
    }

    #[test]
    fn strange_columns_say_what_is_known() {
        assert!(Quantity::from_column("p0_kpa").unwrap_err().contains("unknown name"));
        assert!(Quantity::from_column("p1").unwrap_err().contains("write p1_kpa"));
        assert!(Quantity::from_column("p1_command").unwrap_err().contains("write p1_command_kpa"));
        assert!(Quantity::from_column("p1_mm").unwrap_err().contains("known here are kpa"));
        assert!(Quantity::from_column("temperature").unwrap_err().contains("known are t_s"));
    }
}
