use super::Content;
use crate::{
    map_csv,
    map_file::MapFile,
    plot::{Chart, Mark, Series},
    table::{Table, short},
};
use actuator::{
    Fidelity, FreeMap, FreeParameter, FreePath, FreeState, Middle, ModuleMap, PoseChart, units::*,
};
use serde_json::json;
use std::path::Path;

/// Longest table of nodes worth printing.
const MOST_ROWS: usize = 100;

impl Content for MapFile {
    fn text(&self, path: &Path) -> String {
        self.content().text(path)
    }

    fn json(&self) -> serde_json::Value {
        let (computed, nodes) = self.computed();
        let mut value = self.content().json();
        value["complete"] = json!(computed == nodes);
        value["computed"] = json!(computed);
        value["missing"] = json!(nodes - computed);
        value["worst_residual"] = json!(self.worst_residual());
        value
    }

    fn csv(&self) -> Option<String> {
        self.content().csv()
    }

    fn charts(&self) -> Vec<(String, Chart)> {
        self.content().charts()
    }

    fn map(&self) -> Option<&MapFile> {
        Some(self)
    }
}

impl MapFile {
    fn content(&self) -> &dyn Content {
        match self {
            MapFile::Free(map) => map,
            MapFile::Module(map) => map,
        }
    }
}

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

    fn csv(&self) -> Option<String> {
        Some(map_csv::free_map(self))
    }

    fn charts(&self) -> Vec<(String, Chart)> {
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
        charts
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

impl Content for ModuleMap {
    fn text(&self, path: &Path) -> String {
        let (computed, nodes) = (self.states.iter().flatten().count(), self.states.len());
        let mut text = format!(
            "{}: map of the module \"{}\", {computed} of {nodes} nodes, {} states for checks, {} buckled\n  {}\n\n",
            path.display(),
            self.source.0,
            self.checks.len(),
            self.buckled(),
            self.settings
        );
        let mut table =
            Table::new(["FREE", "pressures", "from (kPa)", "to (kPa)", "limit (kPa)", "pressure max (kPa)"]);
        for (i, axis) in self.pressures.iter().enumerate() {
            table.row([
                (i + 1).to_string(),
                axis.len().to_string(),
                short(axis.first().copied().unwrap_or(0.0) / KPA),
                short(axis.last().copied().unwrap_or(0.0) / KPA),
                self.limit_pressures[i].map_or("none met".into(), |p| short(p / KPA)),
                short(self.limits.pressure_max[i] / KPA),
            ]);
        }
        text += &table.text();
        text += "\nTip at the corners of the pressures\n\n";
        let mut corners =
            Table::new(["<pressures (kPa)", "x (mm)", "y (mm)", "z (mm)", "twist (°)", "bend (°)"]);
        for node in self.corners().into_iter().take(MOST_ROWS) {
            let pressures: Vec<String> = self.node_pressures(node).iter().map(|p| short(p / KPA)).collect();
            let mut cells = vec![pressures.join(", ")];
            match &self.states[node] {
                None => cells.push("missing".into()),
                Some(state) => {
                    let position = state.chart.to_pose().position / MM;
                    cells.extend(position.iter().map(|mm| format!("{mm:.2}")));
                    cells.push(format!("{:.1}", state.chart.twist / DEG));
                    cells.push(format!("{:.1}", state.chart.bend[0].hypot(state.chart.bend[1]) / DEG));
                }
            }
            corners.row_of(cells);
        }
        text + &corners.text()
    }

    fn json(&self) -> serde_json::Value {
        let kpa = |axis: &Vec<f64>| axis.iter().map(|p| p / KPA).collect::<Vec<_>>();
        json!({
            "content": "map", "kind": "module", "name": self.source.0, "settings": self.settings,
            "buckled": self.buckled(), "checks": self.checks.len(),
            "pressures_kpa": self.pressures.iter().map(kpa).collect::<Vec<_>>(),
            "limit_pressures_kpa": self.limit_pressures.iter().map(|p| p.map(|p| p / KPA)).collect::<Vec<_>>(),
        })
    }

    fn csv(&self) -> Option<String> {
        Some(map_csv::module_map(self))
    }

    fn charts(&self) -> Vec<(String, Chart)> {
        let poses: Vec<_> =
            self.states.iter().flatten().map(|state| state.chart.to_pose().position / MM).collect();
        let name = &self.source.0;
        let view = |title: &str, across: (&str, usize), up: (&str, usize)| {
            let points = poses.iter().map(|p| (p[across.1], p[up.1])).collect();
            let chart = Chart::new(format!("{name}: {title}"), across.0, up.0);
            Chart { equal_axes: true, ..chart }.with(Series::new("", Mark::Dots, points))
        };
        let alone = |title: &str, label: &str, value: fn(&PoseChart) -> f64| {
            let mut chart = Chart::new(format!("{name}: {title}"), "pressure (kPa)", label);
            for i in 0..self.pressures.len() {
                let states = self.line(i).into_iter().filter_map(|node| {
                    let state = self.states[node].as_ref()?;
                    Some((self.node_pressures(node)[i] / KPA, value(&state.chart)))
                });
                chart =
                    chart.with(Series::new(format!("FREE {}", i + 1), Mark::LinePoints, states.collect()));
            }
            chart
        };
        vec![
            (
                "tip-from-above".into(),
                view("tip at every node, seen along the axis", ("x (mm)", 0), ("y (mm)", 1)),
            ),
            (
                "tip-from-the-side".into(),
                view("tip at every node, from the side", ("x (mm)", 0), ("z (mm)", 2)),
            ),
            ("twist".into(), alone("one FREE at a time", "twist of the tip (°)", |chart| chart.twist / DEG)),
            (
                "bend".into(),
                alone("one FREE at a time", "bend of the tip (°)", |chart| {
                    chart.bend[0].hypot(chart.bend[1]) / DEG
                }),
            ),
        ]
    }
}

/// Nodes of a module's map that the tables and charts pick out.
trait Nodes {
    /// Nodes where every pressure is its least or its greatest.
    fn corners(&self) -> Vec<usize>;
    /// Nodes where only FREE `i` is under pressure.
    fn line(&self, i: usize) -> Vec<usize>;
    /// Number of states on a buckled branch.
    fn buckled(&self) -> usize;
}

impl Nodes for ModuleMap {
    fn corners(&self) -> Vec<usize> {
        let is_end = |p: &f64, axis: &Vec<f64>| axis.first() == Some(p) || axis.last() == Some(p);
        let is_corner = |node: &usize| {
            self.node_pressures(*node).iter().zip(&self.pressures).all(|(p, axis)| is_end(p, axis))
        };
        (0..self.node_count()).filter(is_corner).collect()
    }

    fn line(&self, i: usize) -> Vec<usize> {
        let alone =
            |node: &usize| self.node_pressures(*node).iter().enumerate().all(|(k, p)| k == i || *p == 0.0);
        (0..self.node_count()).filter(alone).collect()
    }

    fn buckled(&self) -> usize {
        self.states.iter().flatten().filter(|state| state.negative_pivots > 0).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map_file::samples;

    #[test]
    fn a_map_is_told_in_words_numbers_and_pictures() {
        let map = samples::free_map();
        assert_eq!(map.common_pressure(), 2e4);
        let text = map.text(Path::new("a.map"));
        assert!(
            text.contains("2 of 2 nodes") && text.contains("none met") && text.contains("30.00"),
            "{text}"
        );
        assert_eq!(map.json()["nodes"][1]["limit_pressure_kpa"], 30.0);
        assert_eq!(map.charts().len(), 4);
        assert!(!text.contains("mid twist") && map.charts()[0].1.series.len() == 2);

        let solid = samples::solid_map();
        let text = solid.text(Path::new("a.map"));
        assert!(text.contains("by solid") && text.contains("mid twist") && text.contains("1.0220"), "{text}");
        assert_eq!(solid.json()["fidelity"], "solid");
        let names: Vec<String> =
            solid.charts()[0].1.series.iter().map(|series| series.name.clone()).collect();
        assert_eq!(names, ["20°", "20° mid", "70°", "70° mid"]);
        assert_eq!(solid.charts()[1].1.series.len(), 2);

        let module = samples::module_map();
        let text = module.text(Path::new("a.map"));
        assert!(
            text.contains("2 of 3 nodes") && text.contains("1 buckled") && text.contains("missing"),
            "{text}"
        );
        assert_eq!(module.corners(), [0, 2]);
        assert_eq!(module.line(0), [0, 1, 2]);
    }
}
