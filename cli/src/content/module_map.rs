use super::Content;
use crate::{
    columns::Columns,
    map_columns,
    plot::{Chart, Mark, Picture, Series},
    table::{Table, short},
};
use actuator::{ModuleMap, PoseChart, units::*};
use serde_json::json;
use std::path::Path;

/// Most corners of the pressures worth printing.
const MOST_ROWS: usize = 100;

impl Content for ModuleMap {
    fn text(&self, path: &Path) -> String {
        let (computed, nodes) = (self.states.iter().flatten().count(), self.states.len());
        let mut text = format!(
            "{}: map of the module \"{}\", {computed} of {nodes} nodes, {} states for checks, {} buckled, {} with FREEs in contact\n  {}\n\n",
            path.display(),
            self.source.0,
            self.checks.len(),
            self.buckled(),
            self.in_contact(),
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
            "buckled": self.buckled(), "in_contact": self.in_contact(), "checks": self.checks.len(),
            "pressures_kpa": self.pressures.iter().map(kpa).collect::<Vec<_>>(),
            "limit_pressures_kpa": self.limit_pressures.iter().map(|p| p.map(|p| p / KPA)).collect::<Vec<_>>(),
        })
    }

    fn columns(&self) -> Option<Columns> {
        Some(map_columns::module_map(self))
    }

    fn charts(&self) -> Vec<(String, Picture)> {
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
        let charts = [
            ("tip-from-above", view("tip at every node, seen along the axis", ("x (mm)", 0), ("y (mm)", 1))),
            ("tip-from-the-side", view("tip at every node, from the side", ("x (mm)", 0), ("z (mm)", 2))),
            ("twist", alone("one FREE at a time", "twist of the tip (°)", |chart| chart.twist / DEG)),
            (
                "bend",
                alone("one FREE at a time", "bend of the tip (°)", |chart| {
                    chart.bend[0].hypot(chart.bend[1]) / DEG
                }),
            ),
        ];
        charts.into_iter().map(|(stem, chart)| (stem.to_owned(), chart.into())).collect()
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
    /// Number of states in which FREEs overlap.
    fn in_contact(&self) -> usize;
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
        self.states.iter().flatten().filter(|state| state.is_buckled()).count()
    }

    fn in_contact(&self) -> usize {
        self.states.iter().flatten().filter(|state| state.is_in_contact()).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map_file::samples;

    #[test]
    fn a_module_is_told_by_its_corners() {
        let module = samples::module_map();
        let text = module.text(Path::new("a.map"));
        assert!(
            text.contains("2 of 3 nodes")
                && text.contains("1 buckled, 1 with FREEs in contact")
                && text.contains("missing"),
            "{text}"
        );
        assert_eq!(module.corners(), [0, 2]);
        assert_eq!(module.line(0), [0, 1, 2]);
    }
}
