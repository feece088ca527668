//! The table of a FREE's map: a row a node; of a big map a row a winding angle.

use super::{
    free_charts::{spread, state_at},
    free_map::Reading,
};
use crate::table::{Table, short};
use actuator::{Fidelity, FreeMap, FreePath, units::*};

/// Longest table of nodes worth printing.
const MOST_ROWS: usize = 100;

pub fn text(map: &FreeMap) -> String {
    match map.paths.len() <= MOST_ROWS {
        true => of_nodes(map),
        false => of_angles(map),
    }
}

/// Greatest residual of a path's states.
pub fn residual(path: &FreePath) -> f64 {
    path.states.iter().chain(&path.beyond).map(|state| state.residual).fold(0.0, f64::max)
}

/// Greatest mesh errors of a path's states in stretch, expansion and twist (rad/m), where they were asked for.
pub fn mesh_error(path: &FreePath) -> Option<[f64; 3]> {
    let errors = path.states.iter().filter_map(|state| state.mesh_error);
    let each = errors.map(|error| [error.axial_stretch, error.expansion, error.twist_per_length]);
    each.reduce(|a, b| std::array::from_fn(|i| a[i].max(b[i])))
}

fn of_nodes(map: &FreeMap) -> String {
    let solid = map.fidelity != Fidelity::Section;
    let errors = map.paths.iter().flatten().any(|path| mesh_error(path).is_some());
    let reference = map.common_pressure();
    let mut head = vec!["winding (° from hoop)".to_owned(), "µ (MPa)".into()];
    head.extend(map.named_axes().iter().map(|axis| axis.parameter.label().to_owned()));
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
    head.push("residual".into());
    if errors {
        head.extend(["mesh error: stretch".into(), "twist (°/mm)".into()]);
    }
    let mut table = Table::with_head(head);
    for (node, path) in map.paths.iter().enumerate() {
        let mut cells: Vec<String> =
            map.named_coordinates(node).into_iter().map(|(_, value)| short(value)).collect();
        let Some(path) = path else {
            cells.push("missing".into());
            table.row_of(cells);
            continue;
        };
        cells.push(path.states.len().to_string());
        cells.push(path.limit_pressure().map_or("none met".into(), |p| short(p / KPA)));
        let state = state_at(path, reference);
        let four = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
        let twist = |value: f64| value / DEG * MM;
        cells.push(four(state.map(|state| state.axial_stretch)));
        cells.push(four(state.map(|state| state.expansion)));
        cells.push(four(state.map(|state| twist(state.twist_per_length))));
        if solid {
            let middle = state.and_then(|state| state.middle);
            cells.push(four(middle.map(|middle| middle.axial_stretch)));
            cells.push(four(middle.map(|middle| twist(middle.twist_per_length))));
        }
        cells.push(format!("{:.0e}", residual(path)));
        if let Some([stretch, _, turn]) = mesh_error(path) {
            cells.extend([format!("{stretch:.1e}"), format!("{:.1e}", twist(turn))]);
        }
        table.row_of(cells);
    }
    table.text()
}

fn of_angles(map: &FreeMap) -> String {
    let mut text = String::new();
    for axis in map.axes.iter().rev() {
        let values = axis.values.iter().map(|value| short(value / axis.parameter.unit()));
        let values: Vec<String> = values.collect();
        let shown = spread(values.len(), 12);
        let told: Vec<&str> = shown.iter().map(|&i| values[i].as_str()).collect();
        let of = if shown.len() < values.len() {
            format!("{} values, among them ", values.len())
        } else {
            String::new()
        };
        text += &format!("  {}: {of}{}\n", axis.parameter.label(), told.join(", "));
    }
    text += "\n";
    let mut table = Table::new([
        "winding (° from hoop)",
        "nodes",
        "missing",
        "states",
        "limit (kPa): least",
        "greatest",
        "none met",
        "residual",
        "mesh error: stretch",
        "twist (°/mm)",
    ]);
    let angles = map.winding_angles();
    for i in spread(angles.len(), MOST_ROWS) {
        let moduli = map.shear_moduli().len();
        let nodes = (0..map.paths.len()).filter(|node| node / moduli % angles.len() == i);
        let paths: Vec<Option<&FreePath>> = nodes.map(|node| map.paths[node].as_ref()).collect();
        let there = || paths.iter().flatten();
        let limits: Vec<f64> = there().filter_map(|path| path.limit_pressure()).collect();
        let end = |pick: fn(f64, f64) -> f64| {
            limits.iter().copied().reduce(pick).map_or("–".into(), |p| short(p / KPA))
        };
        let errors = there().filter_map(|path| mesh_error(path));
        let error = errors.reduce(|a, b| std::array::from_fn(|i| a[i].max(b[i])));
        let of_error =
            |i: usize, unit: f64| error.map_or("–".into(), |error| format!("{:.1e}", error[i] / unit));
        table.row([
            short(angles[i] / DEG),
            paths.len().to_string(),
            (paths.len() - there().count()).to_string(),
            there().map(|path| path.states.len()).sum::<usize>().to_string(),
            end(f64::min),
            end(f64::max),
            (there().count() - limits.len()).to_string(),
            format!("{:.0e}", there().map(|path| residual(path)).fold(0.0, f64::max)),
            of_error(0, 1.0),
            of_error(2, DEG / MM),
        ]);
    }
    text + &table.text() + "\n  each node: --csv or --json\n"
}
