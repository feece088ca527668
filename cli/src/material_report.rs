//! What `material` found: tables, JSON and charts.

use crate::{
    plot::{Chart, Mark, Series},
    table::{Table, short},
};
use actuator::units::{KPA, MPA};
use fe::material::{
    Rubber,
    calibration::{
        Fit, LoadingMode, Parameter, Stability, StableRange, TestPoint, nominal_stress, stable_range,
    },
};
use serde_json::{Value, json};

/// A fit with what it is judged by.
pub struct Judged {
    pub fit: Fit,
    /// Relative misfit of modes left out of the fit, where there are several.
    pub held_out: Option<f64>,
    /// Stable stretches of each mode: by stiffness and by Drucker.
    pub stable: Vec<(LoadingMode, StableRange, StableRange)>,
}

impl Judged {
    pub fn new(fit: Fit, held_out: Option<f64>) -> Self {
        let rubber = Rubber::from(fit.elastomer);
        let ranges = |mode| {
            let range = |criterion| stable_range(&rubber, mode, criterion);
            (mode, range(Stability::Stiffness), range(Stability::Drucker))
        };
        Judged { stable: LoadingMode::ALL.map(ranges).to_vec(), held_out, fit }
    }

    /// Whether the rubber is stable, by both criteria, at all stretches of the tests.
    pub fn covers(&self, points: &[TestPoint]) -> bool {
        points.iter().all(|point| {
            self.stable.iter().filter(|(mode, ..)| *mode == point.mode).all(|(_, stiffness, drucker)| {
                [stiffness, drucker].into_iter().all(|range| {
                    range.least.is_none_or(|least| point.stretch >= least)
                        && range.greatest.is_none_or(|greatest| point.stretch <= greatest)
                })
            })
        })
    }

    fn with_unit(parameter: &Parameter) -> (String, f64) {
        // shear_modulus[2] is the second of the list shear_modulus_mpa.
        let (name, place) = parameter.name.split_once('[').unwrap_or((&parameter.name, ""));
        let unit = if parameter.is_stress { "_mpa" } else { "" };
        let place = if place.is_empty() { String::new() } else { format!("[{place}") };
        (format!("{name}{unit}{place}"), if parameter.is_stress { MPA } else { 1.0 })
    }

    /// Constants, misfit by mode and stability, as tables.
    pub fn text(&self, points: &[TestPoint]) -> String {
        let mu = self.fit.elastomer.initial_shear_modulus();
        let mut text = format!(
            "{}: initial shear modulus {} MPa, E = {} MPa\n\n",
            self.fit.model.name(),
            short(mu / MPA),
            short(3.0 * mu / MPA)
        );
        let mut constants = Table::new(["<constant", "value", "95 % from", "to"]);
        for parameter in &self.fit.parameters {
            let (name, unit) = Self::with_unit(parameter);
            let end = |i: usize| parameter.ci95.map_or("–".into(), |ends| short(ends[i] / unit));
            constants.row([name, short(parameter.value / unit), end(0), end(1)]);
        }
        text += &constants.text();
        text += "\n";
        let mut modes = Table::new([
            "<mode",
            "points",
            "rms (kPa)",
            "relative (%)",
            "stiffness > 0 from",
            "to",
            "Drucker-stable from",
            "to",
        ]);
        let end = |value: Option<f64>, otherwise: &str| value.map_or(otherwise.to_owned(), short);
        for (mode, stiffness, drucker) in &self.stable {
            let own = self.fit.by_mode.iter().find(|(known, ..)| known == mode);
            modes.row([
                mode.name().into(),
                own.map_or("0".into(), |(_, count, ..)| count.to_string()),
                own.map_or("–".into(), |(_, _, rms, _)| short(rms / KPA)),
                own.map_or("–".into(), |(.., relative)| short(100.0 * relative)),
                end(stiffness.least, "< 0.1"),
                end(stiffness.greatest, "> 10"),
                end(drucker.least, "< 0.1"),
                end(drucker.greatest, "> 10"),
            ]);
        }
        text += &modes.text();
        if !self.covers(points) {
            text += "\nUnstable within the tests: a computation with it may find no equilibrium there. Take another model or fewer terms.\n";
        }
        text
    }

    pub fn json(&self, points: &[TestPoint]) -> Value {
        let fit = &self.fit;
        let parameters = fit.parameters.iter().map(|parameter| {
            let (name, unit) = Self::with_unit(parameter);
            let ci95 = parameter.ci95.map(|ends| ends.map(|end| end / unit));
            (name, json!({ "value": parameter.value / unit, "ci95": ci95 }))
        });
        let modes = self.stable.iter().map(|(mode, stiffness, drucker)| {
            let own = fit.by_mode.iter().find(|(known, ..)| known == mode);
            let value = json!({
                "points": own.map_or(0, |(_, count, ..)| *count),
                "rms_mpa": own.map(|(_, _, rms, _)| rms / MPA),
                "relative_rms": own.map(|(.., relative)| relative),
                "stiffness_positive": [stiffness.least, stiffness.greatest],
                "drucker_stable": [drucker.least, drucker.greatest],
            });
            (mode.name().to_owned(), value)
        });
        let mu = fit.elastomer.initial_shear_modulus() / MPA;
        json!({
            "model": fit.model.name(),
            "parameters": parameters.collect::<serde_json::Map<_, _>>(),
            "shear_modulus_mpa": mu, "young_modulus_mpa": 3.0 * mu,
            "rms_mpa": fit.rms / MPA, "relative_rms": fit.relative_rms,
            "aicc": fit.aicc.is_finite().then_some(fit.aicc),
            "held_out_relative_rms": self.held_out,
            "stable_within_tests": self.covers(points),
            "modes": modes.collect::<serde_json::Map<_, _>>(),
            "toml": fit.elastomer.to_toml(),
        })
    }

    /// Measured points and the curves through them.
    pub fn chart(&self, points: &[TestPoint]) -> Chart {
        let rubber = Rubber::from(self.fit.elastomer);
        let title = format!("{}, rms {} kPa", self.fit.model.name(), short(self.fit.rms / KPA));
        let mut chart = Chart::new(title, "stretch", "nominal stress (MPa)");
        for (colour, mode) in LoadingMode::ALL.into_iter().enumerate() {
            let own: Vec<(f64, f64)> = points
                .iter()
                .filter(|point| point.mode == mode)
                .map(|point| (point.stretch, point.stress / MPA))
                .collect();
            if own.is_empty() {
                continue;
            }
            let (from, to) =
                own.iter().fold((1.0f64, 1.0f64), |(from, to), (l, _)| (from.min(*l), to.max(*l)));
            let curve = (0..=200)
                .map(|i| from + (to - from) * f64::from(i) / 200.0)
                .map(|l| (l, nominal_stress(&rubber, mode, l) / MPA))
                .collect();
            chart = chart
                .with(Series::new(mode.name(), Mark::Points, own).coloured(colour))
                .with(Series::new("", Mark::Line, curve).coloured(colour));
        }
        chart
    }
}

/// All models in one table, the best of the tests first.
pub fn comparison(all: &[Judged], points: &[TestPoint]) -> String {
    let mut table = Table::new([
        "<model",
        "constants",
        "µ (MPa)",
        "rms (kPa)",
        "relative (%)",
        "AICc",
        "mode left out (%)",
        "stable in tests",
    ]);
    let mut order: Vec<&Judged> = all.iter().collect();
    order.sort_by(|a, b| a.fit.aicc.total_cmp(&b.fit.aicc));
    for judged in order {
        let fit = &judged.fit;
        table.row([
            fit.model.name(),
            fit.parameters.len().to_string(),
            short(fit.elastomer.initial_shear_modulus() / MPA),
            short(fit.rms / KPA),
            short(100.0 * fit.relative_rms),
            short(fit.aicc),
            judged.held_out.map_or("–".into(), |rms| short(100.0 * rms)),
            if judged.covers(points) { "yes".into() } else { "no".into() },
        ]);
    }
    table.text()
}
