use super::{
    Content,
    free_charts::{self, state_at},
    free_table,
};
use crate::{columns::Columns, map_columns, plot::Picture};
use actuator::{Fidelity, FreeMap, FreeParameter, FreePath, MapAxis, units::*};
use serde_json::json;
use std::path::Path;

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
        text + &free_table::text(self)
    }

    fn json(&self) -> serde_json::Value {
        let node = |(node, path): (usize, &Option<FreePath>)| {
            let path = path.as_ref();
            let mut value = json!({
                "status": if path.is_some() { "converged" } else { "missing" },
                "states": path.map(|path| path.states.len()),
                "limit_pressure_kpa": path.and_then(FreePath::limit_pressure).map(|p| p / KPA),
                "limit_pressure_error_kpa": path.and_then(|path| path.limit_error).map(|error| error / KPA),
                "greatest_pressure_kpa": path.and_then(|path| path.states.last()).map(|state| state.pressure / KPA),
                "unstable_states": path.map(|path| path.beyond.len()),
                "residual": path.map(free_table::residual),
                "mesh_error": path.and_then(free_table::mesh_error).map(|[stretch, expansion, twist]| json!({
                    "axial_stretch": stretch, "expansion": expansion, "twist_per_length_deg_per_mm": twist / DEG * MM,
                })),
            });
            for (parameter, coordinate) in self.named_coordinates(node) {
                value[parameter.name()] = json!(coordinate);
            }
            value
        };
        let axis = |axis: &MapAxis| {
            let values: Vec<f64> = axis.values.iter().map(|value| value / axis.parameter.unit()).collect();
            json!({ "name": axis.parameter.name(), "values": values })
        };
        json!({
            "axes": self.axes.iter().rev().map(axis).collect::<Vec<_>>(),
            "pressures_kpa": self.pressures.iter().map(|pressure| pressure / KPA).collect::<Vec<_>>(),
            "content": "map", "kind": "free", "fidelity": self.computed_by(), "name": self.source.0, "settings": self.settings,
            "checks": self.checks.len(),
            "nodes": self.paths.iter().enumerate().map(node).collect::<Vec<_>>(),
        })
    }

    fn columns(&self) -> Option<Columns> {
        Some(map_columns::free_map(self))
    }

    fn charts(&self) -> Vec<(String, Picture)> {
        free_charts::all(self)
    }
}

/// What the tables need of a FREE's map.
pub trait Reading {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map_file::samples;
    use actuator::MeshError;

    #[test]
    fn a_map_is_told_in_words_and_numbers() {
        let mut map = samples::free_map();
        assert_eq!(map.common_pressure(), 2e4);
        let text = map.text(Path::new("a.map"));
        assert!(
            text.contains("2 of 2 nodes") && text.contains("none met") && text.contains("30.00"),
            "{text}"
        );
        assert!(
            text.contains("1e-12") && !text.contains("mid twist") && !text.contains("mesh error"),
            "{text}"
        );
        let node = &map.json()["nodes"][1];
        assert_eq!((&node["limit_pressure_kpa"], &node["residual"]), (&json!(30.0), &json!(1e-12)));
        assert_eq!(map.json()["axes"][0]["name"], "shear_modulus_mpa");

        let solid = samples::solid_map();
        let text = solid.text(Path::new("a.map"));
        assert!(text.contains("by solid") && text.contains("mid twist") && text.contains("1.0220"), "{text}");
        assert_eq!(solid.json()["fidelity"], "solid");

        // Of many nodes a row an angle, with the worst of each.
        let path = |map: &mut FreeMap, i: usize| map.paths[i].clone();
        let (first, second) = (path(&mut map, 0), path(&mut map, 1));
        map.axes[1].values = (1..=60).map(|i| 1e4 * f64::from(i)).collect();
        map.paths = [vec![first; 60], vec![second; 60]].concat();
        map.paths[7] = None;
        let error = MeshError { axial_stretch: 2.5e-4, expansion: 0.0, twist_per_length: 0.0 };
        if let Some(path) = &mut map.paths[119] {
            path.states[1].mesh_error = Some(error);
            path.states[1].residual = 3e-9;
        }
        let text = map.text(Path::new("a.map"));
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
        let row = |angle: &str| {
            rows.iter().find(|row| row.first() == Some(&angle)).unwrap_or_else(|| panic!("{text}"))
        };
        assert_eq!(row("20.00")[1..], ["60", "1", "177", "–", "–", "59", "1e-12", "–", "–"]);
        assert_eq!(row("70.00")[1..], ["60", "0", "180", "30.00", "30.00", "0", "3e-9", "2.5e-4", "0.0e0"]);
        assert!(text.contains("60 values, among them 0.01000") && text.lines().count() < 20, "{text}");
        assert_eq!(map.json()["nodes"].as_array().map(Vec::len), Some(120));
    }
}
