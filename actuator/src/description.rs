use crate::{
    Base, Fibre, FibreLaw, Free, Handedness, Limits, Module, PlacedFree, Tip, Tube, Winding, elastomer_file,
    section::{FieldError, Section},
    units::{DEG, GRAM, KPA, MM},
};
use std::{fmt, fs, io, path::Path, path::PathBuf};

/// Width of a thread (mm) where a description gives none (the paper gives none either): a fine sewing thread, and near what the
/// fibres of truss elements of the solid models amount to.
const DEFAULT_FIBRE_DIAMETER_MM: f64 = 0.15;
/// Greatest pressure (kPa) where a description gives none: the 10 psi of the paper's tests.
const DEFAULT_PRESSURE_MAX_KPA: f64 = 68.9;
/// Spacers where a description does not say: FREEs of a module stand closer than one diameter apart and hold each other in place.
const DEFAULT_SPACERS: u32 = 9;
/// Rate limit (kPa/s) where a description gives none.
const DEFAULT_PRESSURE_RATE_KPA_S: f64 = 200.0;

/// What a description describes.
#[derive(Clone, Debug, PartialEq)]
pub enum Description {
    /// A single FREE.
    Free(Free),
    /// Several between two plates.
    Module(Module),
}

/// A description file, read and checked: an actuator, its limits and how its recordings are written.
#[derive(Clone, Debug)]
pub struct Rig {
    /// The `name` of the file, or the file's stem.
    pub name: String,
    /// The actuator.
    pub description: Description,
    /// Its limits; pressures one per FREE.
    pub limits: Limits,
    /// The table `[recordings]`, as it stands, for the reader of recordings.
    pub recordings: toml::Table,
    /// Path, for messages.
    pub path: PathBuf,
    /// Text of the file, kept for provenance.
    pub text: String,
}

/// What is wrong with a description file, and where.
#[derive(Debug)]
pub enum DescriptionError {
    /// The file cannot be read.
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A line says something that cannot be.
    Invalid {
        /// The file.
        path: PathBuf,
        /// Line, counted from one.
        line: usize,
        /// Name of the field, where there is one.
        field: String,
        /// What is wrong and what to do.
        message: String,
    },
}

impl fmt::Display for DescriptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DescriptionError::Io { path, source } => write!(f, "{}: {source}", path.display()),
            DescriptionError::Invalid { path, line, field, message } if field.is_empty() => {
                write!(f, "{}:{line}: {message}", path.display())
            }
            DescriptionError::Invalid { path, line, field, message } => {
                write!(f, "{}:{line}: field `{field}`: {message}", path.display())
            }
        }
    }
}

impl std::error::Error for DescriptionError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            DescriptionError::Io { source, .. } => Some(source),
            DescriptionError::Invalid { .. } => None,
        }
    }
}

impl Rig {
    /// Reads a description from a TOML file.
    pub fn read(path: &Path) -> Result<Self, DescriptionError> {
        let text = fs::read_to_string(path).map_err(|source| {
            let source = match source.kind() {
                io::ErrorKind::InvalidData => io::Error::other("no text; a description is a TOML file"),
                _ => source,
            };
            DescriptionError::Io { path: path.to_owned(), source }
        })?;
        Self::parse(path, text)
    }

    /// Reads a description from the text of a TOML file; `path` is for messages.
    pub fn parse(path: &Path, text: String) -> Result<Self, DescriptionError> {
        let table = toml::de::DeTable::parse(&text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            FieldError { at, field: String::new(), message: error.message().to_owned() }.in_file(path, &text)
        })?;
        let mut section = Section::new(table.get_ref(), table.span().start, "");
        let mut rig = read_rig(&mut section).map_err(|error| error.in_file(path, &text))?;
        if rig.name.is_empty() {
            rig.name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        }
        if rig.has_recordings {
            // The table was already found well-formed above.
            let whole: toml::Table = toml::from_str(&text).unwrap_or_default();
            if let Some(toml::Value::Table(recordings)) = whole.get("recordings") {
                return Ok(rig.finish(recordings.clone(), path, text));
            }
        }
        Ok(rig.finish(toml::Table::new(), path, text))
    }

    /// The FREEs, in the order of their pressures.
    pub fn frees(&self) -> Vec<Free> {
        match &self.description {
            Description::Free(free) => vec![*free],
            Description::Module(module) => module.frees.iter().map(|placed| placed.free).collect(),
        }
    }
}

/// A rig without its file.
struct BareRig {
    name: String,
    description: Description,
    limits: Limits,
    has_recordings: bool,
}

impl BareRig {
    fn finish(self, recordings: toml::Table, path: &Path, text: String) -> Rig {
        let BareRig { name, description, limits, .. } = self;
        Rig { name, description, limits, recordings, path: path.to_owned(), text }
    }
}

fn read_rig(root: &mut Section) -> Result<BareRig, FieldError> {
    let name = root.word("name")?.unwrap_or_default();
    let kind = root.required_word("kind", "write kind = \"free\" or kind = \"module\"")?;
    let description = match kind.as_str() {
        "free" => Description::Free(read_free(root, None)?),
        "module" => Description::Module(read_module(root)?),
        other => {
            return Err(root.error("kind", format!("unknown kind \"{other}\"; write \"free\" or \"module\"")));
        }
    };
    let frees = match &description {
        Description::Free(_) => 1,
        Description::Module(module) => module.frees.len(),
    };
    let limits = read_limits(root.table("limits")?, frees)?;
    let has_recordings = root.table("recordings")?.is_some();
    root.finish()?;
    Ok(BareRig { name, description, limits, has_recordings })
}

fn read_free<'t>(section: &mut Section<'t>, defaults: Option<&Section<'t>>) -> Result<Free, FieldError> {
    section.fall_back_on(defaults);
    let length = section.required_number("length_mm", positive)? * MM;
    let inner_radius = 0.5 * section.required_number("inner_diameter_mm", positive)? * MM;
    let wall = section.required_number("wall_mm", positive)? * MM;
    if wall >= inner_radius * 4.0 {
        let message = format!("{} mm is more than twice the inner diameter; check the unit", wall / MM);
        return Err(section.error("wall_mm", message));
    }
    let angle = section.required_number("winding_angle_deg", |degrees| {
        let fits = (1.0..=89.5).contains(&degrees);
        fits.then_some(()).ok_or(
            "must lie between 1 and 89.5 degrees from the hoop direction (0 = rings, 90 = along the tube)",
        )
    })?;
    let handedness = match section.word("handedness")?.as_deref() {
        None | Some("right") => Handedness::Right,
        Some("left") => Handedness::Left,
        Some(other) => {
            let message = format!("unknown hand \"{other}\"; write \"right\" or \"left\"");
            return Err(section.error("handedness", message));
        }
    };
    let fibres = section.required_number("fibres", |count| {
        let whole = count.fract() == 0.0 && (1.0..=1000.0).contains(&count);
        whole.then_some(()).ok_or("must be a whole number from 1 to 1000")
    })?;
    let axial_stiffness = section.required_number("fibre_ea_newton", positive)?;
    let diameter = section.number("fibre_diameter_mm", positive)?.unwrap_or(DEFAULT_FIBRE_DIAMETER_MM) * MM;
    let law = match section.word("fibre_law")?.as_deref() {
        None | Some("tension-only") => FibreLaw::TensionOnly,
        Some("linear") => FibreLaw::Linear,
        Some(other) => {
            let message = format!(
                "unknown law \"{other}\"; write \"tension-only\" (real thread) or \"linear\" (a truss)"
            );
            return Err(section.error("fibre_law", message));
        }
    };
    let fallback = match defaults {
        Some(defaults) => defaults.table("elastomer")?,
        None => None,
    };
    let elastomer = match (section.table("elastomer")?, fallback) {
        (Some(mut own), fallback) => elastomer_file::read(&mut own, fallback.as_ref())?,
        (None, Some(mut fallback)) => elastomer_file::read(&mut fallback, None)?,
        (None, None) => {
            return Err(section.error(
                "elastomer",
                "is missing; add a table [elastomer] with the model and its constants".into(),
            ));
        }
    };
    let fibre = Fibre { axial_stiffness, diameter, law };
    Ok(Free {
        tube: Tube { length, inner_radius, wall },
        winding: Winding::from_hoop(angle * DEG, handedness, fibres as u32, fibre),
        elastomer,
    })
}

fn read_module(root: &mut Section) -> Result<Module, FieldError> {
    let defaults = root.table("defaults")?;
    let mut frees = Vec::new();
    for mut section in root.tables("free")? {
        let position = section.required_numbers("position_mm", 2)?;
        let free = read_free(&mut section, defaults.as_ref())?;
        section.finish()?;
        let [x, y] = [position[0] * MM, position[1] * MM];
        let clash = frees.iter().any(|other: &PlacedFree| {
            let [ox, oy] = other.position;
            let touching = free.tube.outer_radius() + other.free.tube.outer_radius();
            (x - ox).hypot(y - oy) < touching * (1.0 - 1e-9)
        });
        if clash {
            let message =
                "this FREE overlaps an earlier one; their axes must be at least two outer radii apart".into();
            return Err(section.error("position_mm", message));
        }
        frees.push(PlacedFree { free, position: [x, y] });
    }
    if frees.is_empty() {
        return Err(root.error("free", "a module needs at least one [[free]]".into()));
    }
    if let Some(defaults) = defaults {
        defaults.mark_free_fields();
        defaults.finish()?;
    }
    let tip = read_tip(root.table("tip")?)?;
    let base = read_base(root.table("base")?)?;
    let spacers = root.number("spacers", |count| {
        let fits = count.fract() == 0.0 && (0.0..=200.0).contains(&count);
        fits.then_some(()).ok_or("must be a whole number from 0 (FREEs free between the plates) to 200")
    })?;
    Ok(Module { frees, tip, base, spacers: spacers.map_or(DEFAULT_SPACERS, |count| count as u32) })
}

fn read_tip(section: Option<Section>) -> Result<Tip, FieldError> {
    let mut tip = Tip { plate_mass: 0.0, payload: 0.0, free_dof: [true; 6] };
    let Some(section) = section else { return Ok(tip) };
    tip.plate_mass = section.number("plate_mass_g", not_negative)?.unwrap_or(0.0) * GRAM;
    tip.payload = section.number("payload_g", not_negative)?.unwrap_or(0.0) * GRAM;
    if let Some(names) = section.words("free_dof")? {
        tip.free_dof = [false; 6];
        for name in names {
            match ["x", "y", "z", "rx", "ry", "rz"].iter().position(|known| **known == name) {
                Some(index) => tip.free_dof[index] = true,
                None => {
                    let message =
                        format!("unknown degree of freedom \"{name}\"; known are x, y, z, rx, ry, rz");
                    return Err(section.error("free_dof", message));
                }
            }
        }
    }
    section.finish()?;
    Ok(tip)
}

fn read_base(section: Option<Section>) -> Result<Base, FieldError> {
    let mut base = Base { gravity: [0.0; 3], free_mass: 0.0 };
    let Some(section) = section else { return Ok(base) };
    if let Some(direction) = section.numbers("gravity", 3)? {
        let norm = direction.iter().map(|component| component * component).sum::<f64>().sqrt();
        if norm > 0.0 {
            base.gravity = [direction[0] / norm, direction[1] / norm, direction[2] / norm];
        }
    }
    base.free_mass = section.number("free_mass_g", not_negative)?.unwrap_or(0.0) * GRAM;
    section.finish()?;
    Ok(base)
}

fn read_limits(section: Option<Section>, frees: usize) -> Result<Limits, FieldError> {
    let mut limits = Limits {
        pressure_max: vec![DEFAULT_PRESSURE_MAX_KPA * KPA; frees],
        pressure_rate: DEFAULT_PRESSURE_RATE_KPA_S * KPA,
        idle_pressure: 0.0,
    };
    let Some(section) = section else { return Ok(limits) };
    if let Some(values) = section.one_or_many("pressure_max_kpa", frees)? {
        if values.iter().any(|value| *value <= 0.0) {
            return Err(section.error("pressure_max_kpa", "must be positive".into()));
        }
        limits.pressure_max = values.iter().map(|value| value * KPA).collect();
    }
    if let Some(rate) = section.number("pressure_rate_kpa_s", positive)? {
        limits.pressure_rate = rate * KPA;
    }
    if let Some(idle) = section.number("idle_pressure_kpa", not_negative)? {
        limits.idle_pressure = idle * KPA;
        if limits.pressure_max.iter().any(|max| limits.idle_pressure >= *max) {
            return Err(section.error("idle_pressure_kpa", "must be below every pressure_max_kpa".into()));
        }
    }
    section.finish()?;
    Ok(limits)
}

fn positive(value: f64) -> Result<(), &'static str> {
    (value > 0.0).then_some(()).ok_or("must be positive")
}

fn not_negative(value: f64) -> Result<(), &'static str> {
    (value >= 0.0).then_some(()).ok_or("must not be negative")
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: &str = r#"name = "one"
kind = "free"
length_mm = 130
inner_diameter_mm = 9.52
wall_mm = 0.8
winding_angle_deg = 20.0
handedness = "right"
fibres = 6
fibre_ea_newton = 644.0
fibre_law = "linear"
[elastomer]
model = "ogden"
shear_modulus_mpa = 0.393
alpha = 1.2
"#;

    fn message(text: &str) -> String {
        Rig::parse(Path::new("x.toml"), text.to_owned()).unwrap_err().to_string()
    }

    #[test]
    fn a_free_is_read_in_si() {
        let rig = Rig::parse(Path::new("x.toml"), FREE.to_owned()).unwrap();
        let Description::Free(free) = rig.description else { panic!("{:?}", rig.description) };
        assert!((free.tube.outer_radius() - 5.56e-3).abs() < 1e-12);
        assert_eq!(free.winding.fibre.law, FibreLaw::Linear);
        assert_eq!(free.elastomer.shear_modulus(), 0.393e6);
        assert_eq!(rig.limits.pressure_max, [68.9e3]);
    }

    #[test]
    fn defaults_stand_behind_each_free_of_a_module() {
        let text = r#"kind = "module"
[defaults]
length_mm = 175.0
inner_diameter_mm = 9.52
wall_mm = 0.8
winding_angle_deg = 30.0
fibres = 6
fibre_ea_newton = 644.0
[defaults.elastomer]
model = "neo-hookean"
shear_modulus_mpa = 0.4
[[free]]
position_mm = [7.5, 0.0]
[[free]]
position_mm = [-7.5, 0.0]
handedness = "left"
winding_angle_deg = 60.0
[tip]
free_dof = ["z", "rz"]
[limits]
pressure_max_kpa = [50.0, 40.0]
"#;
        let rig = Rig::parse(Path::new("dir/pair.toml"), text.to_owned()).unwrap();
        let Description::Module(module) = rig.description else { panic!("{:?}", rig.description) };
        assert_eq!(rig.name, "pair");
        assert_eq!(module.tip.free_dof, [false, false, true, false, false, true]);
        assert!((module.frees[1].free.winding.angle_from_hoop().to_degrees() - 60.0).abs() < 1e-12);
        assert_eq!(module.frees[1].free.winding.handedness, Handedness::Left);
        assert_eq!(rig.limits.pressure_max, [50e3, 40e3]);
    }

    #[test]
    fn errors_name_file_line_and_field() {
        assert_eq!(
            message(&FREE.replace("wall_mm = 0.8", "wall_mm = -0.8")),
            "x.toml:5: field `wall_mm`: must be positive, got -0.8"
        );
        assert!(
            message(&FREE.replace("wall_mm", "wall_m")).contains("x.toml:1: field `wall_mm`: is missing")
        );
        assert!(
            message(&format!("{FREE}colour = 1\n"))
                .starts_with("x.toml:15: field `elastomer.colour`: is not known here")
        );
        assert!(message(&FREE.replace("\"right\"", "\"up\"")).contains("x.toml:7: field `handedness`"));
        assert!(message(&FREE.replace("= 20.0", "= \"20\"")).contains("must be a number, not a string"));
        assert!(message(&FREE.replace("= 0.8", "= 0.8 mm")).starts_with("x.toml:5:"));
        assert!(
            message(&FREE.replace("winding_angle_deg = 20.0", "winding_angle_deg = 0"))
                .contains("between 1 and 89.5")
        );
        assert!(message(&FREE.replace("= 9.52", "= nan")).contains("finite"));
        assert!(message("kind = \"module\"\n").contains("at least one [[free]]"));
    }
}
