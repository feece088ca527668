use super::Content;
use crate::{
    columns::Columns,
    map_columns,
    plot::{Chart, Mark, Picture, Series},
    table::{Table, short},
};
use actuator::{Fidelity, FreeMap, FreeParameter, FreePath, FreeState, Middle, units::*};
use serde_json::json;
use std::path::Path;

/// Longest table of nodes worth printing.
const MOST_ROWS: usize = 100;

/// Stem of a file, label of an axis, what is drawn and what of a solid's middle beside it.
type Quantity = (&'static str, &'static str, fn(&FreeState) -> f64, Option<fn(&Middle) -> f64>);

impl Content for FreeMap {
    fn text(&self, path: &Path) -> String {
        let (computed, nodes) = (self.paths.iter().flatten().count(), self.paths.len());
        let states: usize = self.paths.iter().flatten().map(|path| path.states.len()).sum();
        let text = format!(
            "{}: map of the FREE \"{}\" by {}, {computed} of {nodes} nodes, {states} states, {} for checks\n  {}\n\n",
            path.display(),
            self.source.0,
            self.computed_by(),
            self.checks.len(),
            self.settings
        );
        let solid = self.fidelity != Fidelity::Section;
        let reference = self.common_pressure();
        let mut head = vec!["winding (° from hoop)".to_owned(), "µ (MPa)".into()];
        head.extend(self.named_axes().iter().map(|axis| axis.parameter.label().to_owned()));
        head.extend([
            "states".into(),
            "limit (kPa)".into(),
            format!("at {} kPa: stretch", short(reference / KPA)),
            "expansion".into(),
            "twist (°/mm)".into(),
        ]);
        if solid {
            head.extend(["mid stretch".into(), "mid twist (°/mm)".into()]);
        }
        let mut table = Table::with_head(head);
        for (node, path) in self.paths.iter().enumerate().take(MOST_ROWS) {
            let mut cells: Vec<String> =
                self.named_coordinates(node).into_iter().map(|(_, value)| short(value)).collect();
            match path {
                None => cells.push("missing".into()),
                Some(path) => {
                    cells.push(path.states.len().to_string());
                    cells.push(path.limit_pressure().map_or("none met".into(), |p| short(p / KPA)));
                    if let Some(state) = state_at(path, reference) {
                        cells.push(format!("{:.4}", state.axial_stretch));
                        cells.push(format!("{:.4}", state.expansion));
                        cells.push(format!("{:.4}", state.twist_per_length / DEG * MM));
                        if let Some(middle) = state.middle {
                            cells.push(format!("{:.4}", middle.axial_stretch));
                            cells.push(format!("{:.4}", middle.twist_per_length / DEG * MM));
                        }
                    }
                }
            }
            table.row_of(cells);
        }
        text + &table.text()
    }

    fn json(&self) -> serde_json::Value {
        let node = |(node, path): (usize, &Option<FreePath>)| {
            let path = path.as_ref();
            let mut value = json!({
                "status": if path.is_some() { "converged" } else { "missing" },
                "states": path.map(|path| path.states.len()),
                "limit_pressure_kpa": path.and_then(FreePath::limit_pressure).map(|p| p / KPA),
            });
            for (parameter, coordinate) in self.named_coordinates(node) {
                value[parameter.name()] = json!(coordinate);
            }
            value
        };
        json!({
            "content": "map", "kind": "free", "fidelity": self.computed_by(), "name": self.source.0, "settings": self.settings,
            "checks": self.checks.len(),
            "nodes": self.paths.iter().enumerate().map(node).collect::<Vec<_>>(),
        })
    }

    fn columns(&self) -> Option<Columns> {
        Some(map_columns::free_map(self))
    }

    fn charts(&self) -> Vec<(String, Picture)> {
        let quantities: [Quantity; 3] = [
            (
                "axial-stretch",
                "axial stretch λ",
                |state| state.axial_stretch,
                Some(|middle| middle.axial_stretch),
            ),
            ("expansion", "expansion b/B", |state| state.expansion, None),
            (
                "twist",
                "twist per length (°/mm)",
                |state| state.twist_per_length / DEG * MM,
                Some(|middle| middle.twist_per_length / DEG * MM),
            ),
        ];
        let mut charts = Vec::new();
        for (j, modulus) in self.shear_moduli().iter().enumerate() {
            let mu = short(modulus / MPA);
            for (stem, label, value, of_middle) in quantities {
                let mut chart =
                    Chart::new(format!("{}, µ = {mu} MPa", self.source.0), "pressure (kPa)", label);
                for (i, angle) in self.winding_angles().iter().enumerate() {
                    let Some(path) = self.path(i, j) else { continue };
                    let points =
                        path.states.iter().map(|state| (state.pressure / KPA, value(state))).collect();
                    let name = format!("{:.0}°", angle / DEG);
                    let middle: Vec<_> = path
                        .states
                        .iter()
                        .filter_map(|state| Some((state.pressure / KPA, of_middle?(&state.middle?))))
                        .collect();
                    let beside = Series::new(format!("{name} mid"), Mark::Dashed, middle).coloured(i);
                    chart = chart.with(Series::new(name, Mark::Line, points).coloured(i));
                    if !beside.points.is_empty() {
                        chart = chart.with(beside);
                    }
                }
                charts.push((format!("{stem}-{mu}-mpa"), chart));
            }
        }
        let title = format!("{}: greatest pressure that has an equilibrium", self.source.0);
        let mut limits = Chart::new(title, "winding angle (° from hoop)", "limit pressure (kPa)");
        for (j, modulus) in self.shear_moduli().iter().enumerate() {
            let limit = |i: usize| self.path(i, j).and_then(FreePath::limit_pressure);
            let points = self.winding_angles().iter().enumerate();
            let points = points.filter_map(|(i, angle)| Some((angle / DEG, limit(i)? / KPA))).collect();
            limits = limits.with(Series::new(
                format!("µ = {} MPa", short(modulus / MPA)),
                Mark::LinePoints,
                points,
            ));
        }
        charts.push(("limit-pressure".into(), limits));
        charts.into_iter().map(|(stem, chart): (String, Chart)| (stem, chart.into())).collect()
    }
}

/// What the tables need of a FREE's map.
trait Reading {
    /// Greatest pressure asked for that every computed path reaches, Pa.
    fn common_pressure(&self) -> f64;
    /// The fidelity as it is written on the command line.
    fn computed_by(&self) -> &'static str;
    /// Where a node lies: winding angle, shear modulus and the named axes, in the units of their names.
    fn named_coordinates(&self, node: usize) -> Vec<(FreeParameter, f64)>;
}

impl Reading for FreeMap {
    fn common_pressure(&self) -> f64 {
        let reached =
            |pressure: f64| self.paths.iter().flatten().all(|path| state_at(path, pressure).is_some());
        self.pressures.iter().rev().copied().find(|pressure| reached(*pressure)).unwrap_or(0.0)
    }

    fn computed_by(&self) -> &'static str {
        match self.fidelity {
            Fidelity::Section => "section",
            Fidelity::Solid { .. } => "solid",
            Fidelity::CappedSection => "section with caps",
        }
    }

    fn named_coordinates(&self, node: usize) -> Vec<(FreeParameter, f64)> {
        let coordinates = self.coordinates(node).into_iter().zip(&self.axes);
        let mut named: Vec<_> =
            coordinates.map(|(value, axis)| (axis.parameter, value / axis.parameter.unit())).collect();
        named.rotate_right(2);
        named
    }
}

/// The state at a pressure of the grid.
fn state_at(path: &FreePath, pressure: f64) -> Option<&FreeState> {
    path.states.iter().find(|state| (state.pressure - pressure).abs() <= 1e-9 * pressure.max(1.0))
}
