//! The table `[elastomer]` of a description.

use crate::{
    Elastomer, OgdenForm, OgdenTerm, OgdenTerms,
    section::{FieldError, Section},
    units::MPA,
};

const MODELS: &str = "\"neo-hookean\", \"ogden\", \"mooney-rivlin\", \"yeoh\", \"gent\", \"arruda-boyce\", \
                      \"st-venant-kirchhoff\" or \"linear-elastic\"";

fn finite(_: f64) -> Result<(), &'static str> {
    Ok(())
}

fn positive(value: f64) -> Result<(), &'static str> {
    (value > 0.0).then_some(()).ok_or("must be positive")
}

/// Reads the table; what it lacks is looked up in `defaults`.
pub(crate) fn read<'t>(
    section: &mut Section<'t>,
    defaults: Option<&Section<'t>>,
) -> Result<Elastomer, FieldError> {
    section.fall_back_on(defaults);
    let model = section.required_word("model", &format!("write model = {MODELS}"))?;
    let shear_modulus = || section.required_number("shear_modulus_mpa", positive).map(|mu| mu * MPA);
    let stress = |field| section.required_number(field, finite).map(|value| value * MPA);
    let elastomer = match model.as_str() {
        "neo-hookean" => Elastomer::NeoHookean { shear_modulus: shear_modulus()? },
        "ogden" => read_ogden(section)?,
        "mooney-rivlin" => Elastomer::MooneyRivlin { c10: stress("c10_mpa")?, c01: stress("c01_mpa")? },
        "yeoh" => {
            Elastomer::Yeoh { c10: stress("c10_mpa")?, c20: stress("c20_mpa")?, c30: stress("c30_mpa")? }
        }
        "gent" => Elastomer::Gent {
            shear_modulus: shear_modulus()?,
            locking_invariant: section.required_number("jm", positive)?,
        },
        "arruda-boyce" => Elastomer::ArrudaBoyce {
            shear_modulus: shear_modulus()?,
            locking_stretch: section.required_number("locking_stretch", positive)?,
        },
        "st-venant-kirchhoff" => Elastomer::StVenantKirchhoff { shear_modulus: shear_modulus()? },
        "linear-elastic" => Elastomer::LinearElastic { shear_modulus: shear_modulus()? },
        other => {
            return Err(section.error("model", format!("unknown model \"{other}\"; write {MODELS}")));
        }
    };
    if let Err(error) = elastomer.check() {
        let with_unit = format!("{}_mpa", error.field);
        let field = if section.has(&with_unit) { with_unit } else { error.field.to_owned() };
        return Err(section.error(&field, error.requirement.into()));
    }
    section.finish()?;
    Ok(elastomer)
}

/// One number each for mu and alpha, or a list each of the same length.
fn read_ogden(section: &Section) -> Result<Elastomer, FieldError> {
    let moduli = section.required_list("shear_modulus_mpa")?;
    let exponents = section.required_list("alpha")?;
    let form = match section.word("form")?.as_deref() {
        None | Some("2mu/alpha^2") => OgdenForm::InitialModulus,
        Some("2mu/alpha") => OgdenForm::Printed,
        Some(other) => {
            let message = format!("unknown form \"{other}\"; write \"2mu/alpha^2\" or \"2mu/alpha\"");
            return Err(section.error("form", message));
        }
    };
    if let ([modulus], [alpha]) = (&moduli[..], &exponents[..]) {
        positive(*modulus)
            .map_err(|rule| section.error("shear_modulus_mpa", format!("{rule}, got {modulus}")))?;
        return Ok(Elastomer::Ogden { shear_modulus: modulus * MPA, alpha: *alpha, form });
    }
    if moduli.len() != exponents.len() {
        let message = format!("has {} numbers, but shear_modulus_mpa has {}", exponents.len(), moduli.len());
        return Err(section.error("alpha", message));
    }
    let term = |(modulus, alpha): (&f64, &f64)| {
        let share = if form == OgdenForm::Printed { *alpha } else { 1.0 };
        OgdenTerm { shear_modulus: modulus * MPA * share, alpha: *alpha }
    };
    let terms: Vec<OgdenTerm> = moduli.iter().zip(&exponents).map(term).collect();
    let terms = OgdenTerms::new(&terms).ok_or_else(|| {
        let message = format!("has {} numbers; write 1 to {}", moduli.len(), OgdenTerms::MOST);
        section.error("shear_modulus_mpa", message)
    })?;
    Ok(Elastomer::OgdenSeries { terms })
}

impl Elastomer {
    /// The table `[elastomer]` of a description that says this rubber; numbers are written so that they are read back the same
    /// to rounding.
    pub fn to_toml(&self) -> String {
        let mpa = |pascals: f64| format!("{:?}", pascals / MPA);
        let list = |values: Vec<String>| format!("[{}]", values.join(", "));
        let fields: Vec<(&str, String)> = match *self {
            Elastomer::NeoHookean { shear_modulus }
            | Elastomer::StVenantKirchhoff { shear_modulus }
            | Elastomer::LinearElastic { shear_modulus } => vec![("shear_modulus_mpa", mpa(shear_modulus))],
            Elastomer::Ogden { shear_modulus, alpha, form } => {
                let form = match form {
                    OgdenForm::InitialModulus => "\"2mu/alpha^2\"",
                    OgdenForm::Printed => "\"2mu/alpha\"",
                };
                vec![
                    ("shear_modulus_mpa", mpa(shear_modulus)),
                    ("alpha", format!("{alpha:?}")),
                    ("form", form.into()),
                ]
            }
            Elastomer::OgdenSeries { terms } => {
                let each =
                    |value: fn(&OgdenTerm) -> String| list(terms.as_slice().iter().map(value).collect());
                vec![
                    ("shear_modulus_mpa", each(|term| format!("{:?}", term.shear_modulus / MPA))),
                    ("alpha", each(|term| format!("{:?}", term.alpha))),
                    ("form", "\"2mu/alpha^2\"".into()),
                ]
            }
            Elastomer::MooneyRivlin { c10, c01 } => vec![("c10_mpa", mpa(c10)), ("c01_mpa", mpa(c01))],
            Elastomer::Yeoh { c10, c20, c30 } => {
                vec![("c10_mpa", mpa(c10)), ("c20_mpa", mpa(c20)), ("c30_mpa", mpa(c30))]
            }
            Elastomer::Gent { shear_modulus, locking_invariant } => {
                vec![("shear_modulus_mpa", mpa(shear_modulus)), ("jm", format!("{locking_invariant:?}"))]
            }
            Elastomer::ArrudaBoyce { shear_modulus, locking_stretch } => vec![
                ("shear_modulus_mpa", mpa(shear_modulus)),
                ("locking_stretch", format!("{locking_stretch:?}")),
            ],
        };
        let mut text = format!("[elastomer]\nmodel = \"{}\"\n", self.model());
        for (field, value) in fields {
            text += &format!("{field} = {value}\n");
        }
        text
    }

    /// The model's name in files.
    pub fn model(&self) -> &'static str {
        match self {
            Elastomer::NeoHookean { .. } => "neo-hookean",
            Elastomer::Ogden { .. } | Elastomer::OgdenSeries { .. } => "ogden",
            Elastomer::MooneyRivlin { .. } => "mooney-rivlin",
            Elastomer::Yeoh { .. } => "yeoh",
            Elastomer::Gent { .. } => "gent",
            Elastomer::ArrudaBoyce { .. } => "arruda-boyce",
            Elastomer::StVenantKirchhoff { .. } => "st-venant-kirchhoff",
            Elastomer::LinearElastic { .. } => "linear-elastic",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Description, Rig};
    use std::path::Path;

    fn parse(table: &str) -> Result<Elastomer, String> {
        let text = format!(
            "kind = \"free\"\nlength_mm = 130\ninner_diameter_mm = 9.52\nwall_mm = 0.8\nwinding_angle_deg = 30\n\
             fibres = 6\nfibre_ea_newton = 644\n{table}"
        );
        match Rig::parse(Path::new("x.toml"), text).map_err(|error| error.to_string())?.description {
            Description::Free(free) => Ok(free.elastomer),
            Description::Module(_) => panic!("a FREE was written"),
        }
    }

    #[test]
    fn each_model_is_read_in_si_and_written_back() {
        let read = |fields: &str| parse(&format!("[elastomer]\n{fields}")).unwrap();
        let series = read("model = \"ogden\"\nshear_modulus_mpa = [0.4, -0.01]\nalpha = [1.3, -2]");
        let Elastomer::OgdenSeries { terms } = series else { panic!("{series:?}") };
        assert_eq!(terms.as_slice()[1], OgdenTerm { shear_modulus: -0.01 * MPA, alpha: -2.0 });
        let printed = read(
            "model = \"ogden\"\nshear_modulus_mpa = [0.4, -0.01]\nalpha = [1.5, -2]\nform = \"2mu/alpha\"",
        );
        // 2 mu/alpha = 2 (mu alpha)/alpha^2.
        assert!((printed.initial_shear_modulus() - 0.62 * MPA).abs() < 1e-9);
        for rubber in [
            series,
            read("model = \"ogden\"\nshear_modulus_mpa = 0.393\nalpha = 1.2\nform = \"2mu/alpha\""),
            read("model = \"neo-hookean\"\nshear_modulus_mpa = 0.393"),
            read("model = \"mooney-rivlin\"\nc10_mpa = 0.16\nc01_mpa = -0.01"),
            read("model = \"yeoh\"\nc10_mpa = 0.2\nc20_mpa = -0.002\nc30_mpa = 4e-5"),
            read("model = \"gent\"\nshear_modulus_mpa = 0.3\njm = 80"),
            read("model = \"arruda-boyce\"\nshear_modulus_mpa = 0.3\nlocking_stretch = 5"),
            read("model = \"st-venant-kirchhoff\"\nshear_modulus_mpa = 0.3"),
            read("model = \"linear-elastic\"\nshear_modulus_mpa = 0.3"),
        ] {
            let again = parse(&rubber.to_toml()).unwrap();
            assert_eq!(format!("{again:.9?}"), format!("{rubber:.9?}"), "{}", rubber.to_toml());
        }
        assert_eq!(read("model = \"yeoh\"\nc10_mpa = 0.2\nc20_mpa = 0\nc30_mpa = 0").shear_modulus(), 0.4e6);
    }

    #[test]
    fn errors_name_the_field_and_its_line() {
        let message = |fields: &str| parse(&format!("[elastomer]\n{fields}")).unwrap_err();
        for (fields, start, word) in [
            ("model = \"gent\"\nshear_modulus_mpa = 0.3", "x.toml:8: field `elastomer.jm`", "is missing"),
            (
                "model = \"gent\"\nshear_modulus_mpa = 0.3\njm = -1",
                "x.toml:11: field `elastomer.jm`",
                "positive",
            ),
            (
                "model = \"mooney-rivlin\"\nc10_mpa = 0.1\nc01_mpa = -0.2",
                "x.toml:11: field `elastomer.c01_mpa`",
                "half the initial shear modulus",
            ),
            (
                "model = \"yeoh\"\nc10_mpa = 0.1\nc20_mpa = 1\nc30_mpa = 1\nc40_mpa = 1",
                "x.toml:13: field `elastomer.c40_mpa`",
                "not known here",
            ),
            (
                "model = \"ogden\"\nshear_modulus_mpa = [0.1, 0.2]\nalpha = 2",
                "x.toml:11: field `elastomer.alpha`",
                "has 1 numbers",
            ),
            (
                "model = \"ogden\"\nshear_modulus_mpa = [1,1,1,1,1,1,1]\nalpha = [1,1,1,1,1,1,1]",
                "x.toml:10: field `elastomer.shear_modulus_mpa`",
                "1 to 6",
            ),
            (
                "model = \"ogden\"\nshear_modulus_mpa = [0.1, -0.2]\nalpha = [1, 2]",
                "x.toml:10: field `elastomer.shear_modulus_mpa`",
                "positive",
            ),
            (
                "model = \"arruda-boyce\"\nshear_modulus_mpa = 0.3\nlocking_stretch = 1",
                "x.toml:11: field `elastomer.locking_stretch`",
                "above 1",
            ),
        ] {
            let text = message(fields);
            assert!(text.starts_with(start) && text.contains(word), "{fields}\n{text}");
        }
    }
}
