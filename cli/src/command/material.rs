use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    material_csv,
    material_report::{Judged, comparison},
    output,
    table::short,
};
use actuator::units::MPA;
use fe::material::calibration::{
    CalibrationError, LoadingMode, RubberModel, TestPoint, Weighting, fit, fit_fibre, held_out_rms,
    young_modulus_of_shore_a,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Fit a rubber to tests of the material, a modulus to a hardness, EA to the pull of a thread
///
/// TESTS.csv has the columns mode (uniaxial, equibiaxial or planar), stretch and stress_mpa (nominal: force over undeformed area;
/// tension positive, compression with stretch below 1 too). All modes are fitted together. What is found is printed with 95 %
/// intervals and the stretches within which the rubber is stable; into --out go the table `[elastomer]` for a description
/// (MODEL.toml) and pictures (MODEL.svg, MODEL.png).
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact material --test latex.csv --model ogden --terms 3 --out latex
  freeact material --test latex.csv --model all --out latex
  freeact material --shore-a 30.8
  freeact material --fibre cotton.csv --fibre-length-mm 100")]
pub struct Material {
    /// Tests of the rubber
    #[arg(long, value_name = "TESTS.csv", required_unless_present_any = ["shore_a", "fibre"])]
    test: Option<PathBuf>,

    /// Model of the rubber; all fits each and compares them
    #[arg(long, value_enum, default_value_t = Choice::Ogden, requires = "test")]
    model: Choice,

    /// Number of Ogden terms, 1 to 6; with all, the most of them [default: 1; with all 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=6))]
    terms: Option<u8>,

    /// What misfits are measured against: each stress (at least 5 % of its mode's greatest), or the greatest of all
    #[arg(long, value_enum, default_value_t = Measure::Relative)]
    weighting: Measure,

    /// Directory for MODEL.toml, MODEL.svg and MODEL.png
    #[arg(long, value_name = "DIR", requires = "test")]
    out: Option<PathBuf>,

    /// Shore A hardness: E and mu by Gent's relation of 1958
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    shore_a: Option<f64>,

    /// Pull of a thread: columns strain (or extension_mm) and force_n
    #[arg(long, value_name = "PULL.csv")]
    fibre: Option<PathBuf>,

    /// Length of the thread that extension_mm belongs to
    #[arg(long, value_name = "MM", requires = "fibre")]
    fibre_length_mm: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Choice {
    NeoHookean,
    Ogden,
    MooneyRivlin,
    Yeoh,
    Gent,
    ArrudaBoyce,
    StVenantKirchhoff,
    LinearElastic,
    All,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Measure {
    Relative,
    Absolute,
}

impl Choice {
    fn models(self, terms: Option<u8>) -> Vec<RubberModel> {
        let terms_or = |otherwise: u8| usize::from(terms.unwrap_or(otherwise));
        match self {
            Choice::NeoHookean => vec![RubberModel::NeoHookean],
            Choice::Ogden => vec![RubberModel::Ogden(terms_or(1))],
            Choice::MooneyRivlin => vec![RubberModel::MooneyRivlin],
            Choice::Yeoh => vec![RubberModel::Yeoh],
            Choice::Gent => vec![RubberModel::Gent],
            Choice::ArrudaBoyce => vec![RubberModel::ArrudaBoyce],
            Choice::StVenantKirchhoff => vec![RubberModel::StVenantKirchhoff],
            Choice::LinearElastic => vec![RubberModel::LinearElastic],
            Choice::All => {
                let mut all = vec![
                    RubberModel::LinearElastic,
                    RubberModel::StVenantKirchhoff,
                    RubberModel::NeoHookean,
                    RubberModel::MooneyRivlin,
                    RubberModel::Yeoh,
                    RubberModel::Gent,
                    RubberModel::ArrudaBoyce,
                ];
                all.extend((1..=terms_or(3)).map(RubberModel::Ogden));
                all
            }
        }
    }
}

impl Material {
    pub fn run(self, json: bool) -> Outcome {
        let mut found = serde_json::Map::new();
        let mut text = Vec::new();
        if let Some(hardness) = self.shore_a {
            let young = young_modulus_of_shore_a(hardness).ok_or_else(|| {
                Failure::usage(format!("--shore-a {hardness}: a Shore A hardness lies from 0 to below 100"))
            })?;
            text.push(format!(
                "Shore A {hardness}: E = {} MPa, mu = {} MPa (Gent 1958)\n",
                short(young / MPA),
                short(young / 3.0 / MPA)
            ));
            let value = json!({
                "shore_a": hardness, "young_modulus_mpa": young / MPA, "shear_modulus_mpa": young / 3.0 / MPA,
            });
            found.insert("hardness".into(), value);
        }
        if let Some(path) = &self.fibre {
            let (line, value) = self.pull(path)?;
            text.push(line);
            found.insert("fibre".into(), value);
        }
        if let Some(path) = &self.test {
            let (report, value) = self.rubber(path)?;
            text.push(report);
            found.insert("rubber".into(), value);
        }
        match json {
            true => output::print_json(&Value::Object(found)),
            false => output::print(&text.join("\n")),
        }
        Ok(Exit::Done)
    }

    fn pull(&self, path: &Path) -> Result<(String, Value), Failure> {
        if let Some(length) = self.fibre_length_mm.filter(|length| !(length.is_finite() && *length > 0.0)) {
            return Err(Failure::usage(format!("--fibre-length-mm {length}: a length is positive")));
        }
        let points = material_csv::read_pull(path, self.fibre_length_mm)?;
        let line = fit_fibre(&points).map_err(|error| refused(path, error))?;
        let interval = line
            .ci95
            .map_or(String::new(), |[low, high]| format!(" (95 %: {} to {})", short(low), short(high)));
        let text = format!(
            "{}: {} points, EA = {} N{interval}, {} N without strain, rms {} N\n",
            path.display(),
            line.points,
            short(line.axial_stiffness),
            short(line.force_at_rest),
            short(line.rms)
        );
        let value = json!({
            "fibre_ea_newton": line.axial_stiffness, "ci95": line.ci95, "force_at_rest_n": line.force_at_rest,
            "rms_n": line.rms, "points": line.points,
        });
        Ok((text, value))
    }

    fn rubber(&self, path: &Path) -> Result<(String, Value), Failure> {
        let points = material_csv::read_tests(path)?;
        let weighting = match self.weighting {
            Measure::Relative => Weighting::Relative,
            Measure::Absolute => Weighting::Absolute,
        };
        let (mut all, mut failed) = (Vec::new(), Vec::new());
        for model in self.model.models(self.terms) {
            match fit(model, &points, weighting) {
                Ok(fit) => all.push(Judged::new(fit, held_out_rms(model, &points, weighting))),
                Err(error) => failed.push((model.name(), error)),
            }
        }
        let Some(best) = best(&all, &points) else {
            let (_, error) = failed.swap_remove(0);
            return Err(refused(path, error));
        };
        if let Some(directory) = &self.out {
            output::make_directory(directory)?;
            for judged in &all {
                let stem = judged.fit.model.name();
                judged.chart(&points).write(directory, &stem)?;
                output::save(
                    &directory.join(format!("{stem}.toml")),
                    judged.fit.elastomer.to_toml().as_bytes(),
                )?;
            }
        }
        let counts = LoadingMode::ALL.map(|mode| {
            let count = points.iter().filter(|point| point.mode == mode).count();
            format!("{count} {}", mode.name())
        });
        let mut text = format!("{}: {} points, {}\n\n", path.display(), points.len(), counts.join(", "));
        if all.len() > 1 {
            text += &comparison(&all, &points);
            text += "\n";
        }
        for (model, error) in &failed {
            text += &format!("{model}: {error}\n");
        }
        text += &best.text(&points);
        text += &format!("\n{}", best.fit.elastomer.to_toml());
        let value = json!({
            "tests": path, "points": points.len(), "best": best.fit.model.name(),
            "weighting": if weighting == Weighting::Relative { "relative" } else { "absolute" },
            "fits": all.iter().map(|judged| judged.json(&points)).collect::<Vec<_>>(),
            "failed": failed.iter().map(|(model, error)| json!({ "model": model, "reason": error.to_string() })).collect::<Vec<_>>(),
        });
        Ok((text, value))
    }
}

/// Of the rubbers that are stable throughout the tests (or of all, where none is) the one that best tells modes left out; with one mode,
/// that of the least AICc.
fn best<'a>(all: &'a [Judged], points: &[TestPoint]) -> Option<&'a Judged> {
    let rank = |judged: &Judged| {
        let unstable = !judged.covers(points);
        let several = all.iter().any(|judged| judged.held_out.is_some());
        let score = if several { judged.held_out.unwrap_or(f64::INFINITY) } else { judged.fit.aicc };
        (unstable, score)
    };
    all.iter().min_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}

fn refused(path: &Path, error: CalibrationError) -> Failure {
    Failure::refused(format!("{}: {error}", path.display()))
}
