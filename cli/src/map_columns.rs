//! Maps by columns: one row a state, in the units that the columns name.

use crate::{
    columns::{Cell, Columns},
    map_csv::{POSE_HEADER, pose_numbers, pressure_header},
};
use actuator::{
    Fidelity, FreeMap, FreePath, FreeState, ModuleMap, PathEnd,
    units::{DEG, KPA, MM},
};

/// Columns of a FREE's map between its axes and its status.
const DEFORMATION: [&str; 3] = ["axial_stretch", "expansion", "twist_per_length_deg_per_mm"];
/// Columns of a solid's map beside those.
const MIDDLE: [&str; 2] = ["mid_axial_stretch", "mid_twist_per_length_deg_per_mm"];
/// Columns after the status: the state's evidence and what a rod needs of it.
const EVIDENCE: [&str; 12] = [
    "residual",
    "axial_stretch_error",
    "expansion_error",
    "twist_per_length_error_deg_per_mm",
    "limit_pressure_error_kpa",
    "energy_j_per_m",
    "volume_mm2",
    "axial_stiffness_n",
    "coupling_nmm",
    "torsional_stiffness_nmm2",
    "force_per_pressure_mm2",
    "torque_per_pressure_mm3",
];

/// Cells of [`DEFORMATION`] and, of a map between caps, of [`MIDDLE`].
fn deformation(state: &FreeState, capped: bool) -> Vec<Cell> {
    let mut numbers = vec![state.axial_stretch, state.expansion, state.twist_per_length / DEG * MM];
    if capped {
        let middle = state.middle.map(|middle| [middle.axial_stretch, middle.twist_per_length / DEG * MM]);
        numbers.extend(middle.unwrap_or([f64::NAN; 2]));
    }
    numbers.into_iter().map(Cell::Number).collect()
}

/// Cells of [`EVIDENCE`].
fn evidence(state: &FreeState, path: &FreePath) -> Vec<Cell> {
    let mut numbers = vec![state.residual];
    let error = state
        .mesh_error
        .map(|error| [error.axial_stretch, error.expansion, error.twist_per_length / DEG * MM]);
    numbers.extend(error.unwrap_or([f64::NAN; 3]));
    numbers.push(path.limit_error.map_or(f64::NAN, |error| error / KPA));
    let constants = state.section.map(|section| {
        let [[axial, coupling], [_, torsional]] = section.stiffness;
        let [force, torque] = section.pressure_slopes;
        [
            section.energy,
            section.volume / MM.powi(2),
            axial,
            coupling / MM,
            torsional / MM.powi(2),
            force / MM.powi(2),
            torque / MM.powi(3),
        ]
    });
    numbers.extend(constants.unwrap_or([f64::NAN; 7]));
    numbers.into_iter().map(Cell::Number).collect()
}

/// The map of a FREE. Pressures asked for that lie above the limit pressure are rows without values.
pub fn free_map(map: &FreeMap) -> Columns {
    let capped = map.fidelity != Fidelity::Section;
    let named: Vec<&str> = map.named_axes().iter().map(|axis| axis.parameter.name()).collect();
    let mut head = vec!["winding_angle_deg", "shear_modulus_mpa", "pressure_kpa"];
    head.extend(&named);
    let axes = head.len();
    head.extend(DEFORMATION);
    head.extend(if capped { &MIDDLE[..] } else { &[] });
    let values = head.len() - axes;
    head.extend(["limit_pressure_kpa", "status"]);
    head.extend(EVIDENCE);
    let mut columns = Columns::new(head.into_iter().map(str::to_owned), &["status"])
        .about("name", &map.source.0)
        .about("settings", &map.settings)
        .about("description", &map.source.1);
    for (node, path) in map.paths.iter().enumerate() {
        let path = path.as_ref();
        let limit = path.and_then(|path| path.limit_pressure());
        let coordinates: Vec<Cell> = map
            .coordinates(node)
            .iter()
            .zip(&map.axes)
            .map(|(value, axis)| Cell::Number(value / axis.parameter.unit()))
            .collect();
        let (named, always) = coordinates.split_at(named.len());
        let mut row = |pressure: f64, deformation: Vec<Cell>, status: &'static str, evidence: Vec<Cell>| {
            let mut cells = always.to_vec();
            cells.push(Cell::Number(pressure / KPA));
            cells.extend_from_slice(named);
            cells.extend(deformation);
            cells.push(limit.map_or(Cell::Empty, |limit| Cell::Number(limit / KPA)));
            cells.push(Cell::Word(status));
            cells.extend(evidence);
            columns.push(&cells);
        };
        let nothing = || vec![Cell::Empty; values];
        let Some(path) = path else {
            map.pressures.iter().for_each(|pressure| row(*pressure, nothing(), "missing", vec![]));
            continue;
        };
        let mut of = |state: &FreeState, status: &'static str| {
            row(state.pressure, deformation(state, capped), status, evidence(state, path));
        };
        let last = path.states.len().saturating_sub(1);
        for (k, state) in path.states.iter().enumerate() {
            let at_limit = k == last && path.end == PathEnd::LimitPoint;
            of(state, if at_limit { "limit point" } else { "converged" });
        }
        path.beyond.iter().for_each(|state| of(state, "unstable"));
        let end = path.states.last().map_or(0.0, |state| state.pressure);
        let beyond = if limit.is_some() { "beyond limit" } else { "missing" };
        map.pressures
            .iter()
            .filter(|p| **p > end * (1.0 + 1e-9))
            .for_each(|p| row(*p, nothing(), beyond, vec![]));
    }
    columns
}

/// The map of a module.
pub fn module_map(map: &ModuleMap) -> Columns {
    let mut head = pressure_header(map.pressures.len());
    head.extend(POSE_HEADER.split(',').chain(["status", "gap_mm"]).map(str::to_owned));
    let mut columns = Columns::new(head, &["status"])
        .about("name", &map.source.0)
        .about("settings", &map.settings)
        .about("description", &map.source.1);
    for (node, state) in map.states.iter().enumerate() {
        let mut cells: Vec<Cell> =
            map.node_pressures(node).iter().map(|pressure| Cell::Number(pressure / KPA)).collect();
        let status = match state {
            Some(state) => {
                cells.extend(pose_numbers(&state.chart.to_pose()).map(Cell::Number));
                match (state.is_buckled(), state.is_in_contact()) {
                    (false, false) => "converged",
                    (false, true) => "contact",
                    (true, false) => "buckled",
                    (true, true) => "buckled contact",
                }
            }
            None => {
                cells.extend([Cell::Empty; 7]);
                "missing"
            }
        };
        cells.push(Cell::Word(status));
        let gap = state.as_ref().and_then(|state| state.gap);
        cells.push(gap.map_or(Cell::Empty, |gap| Cell::Number(gap / MM)));
        columns.push(&cells);
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map_file::samples;

    #[test]
    fn a_free_has_one_row_a_state_and_empty_rows_beyond_its_limit() {
        let text = free_map(&samples::free_map()).csv();
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(
            rows[0],
            "winding_angle_deg,shear_modulus_mpa,pressure_kpa,axial_stretch,expansion,twist_per_length_deg_per_mm,limit_pressure_kpa,status,\
             residual,axial_stretch_error,expansion_error,twist_per_length_error_deg_per_mm,limit_pressure_error_kpa,energy_j_per_m,volume_mm2,\
             axial_stiffness_n,coupling_nmm,torsional_stiffness_nmm2,force_per_pressure_mm2,torque_per_pressure_mm3"
        );
        assert_eq!(rows[1], "20,0.393,0,1,1,0,,converged,0.000000000001,,,,,,,,,,,");
        // -30e-5 rad/m a pascal at 40 kPa is -12 rad/m = -0.6875 deg/mm.
        assert_eq!(rows[3], "20,0.393,40,1.06,1.04,-0.687549354157,,converged,0.000000000001,,,,,,,,,,,");
        assert_eq!(rows[6], "70,0.393,30,0.98,1.03,-0.515662015618,30,limit point,0.000000000001,,,,,,,,,,,");
        assert_eq!(rows[7], "70,0.393,40,,,,30,beyond limit,,,,,,,,,,,,");
        assert_eq!(rows.len(), 8);
        assert!(rows.iter().all(|row| row.split(',').count() == 20));
    }

    #[test]
    fn a_solid_has_its_middle_beside() {
        let text = free_map(&samples::solid_map()).csv();
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert!(rows.iter().all(|row| row.len() == 22), "{text}");
        assert_eq!(rows[0][6..8], ["mid_axial_stretch", "mid_twist_per_length_deg_per_mm"]);
        assert_eq!(rows[3][3..8], ["1.06", "1.04", "-0.687549354157", "1.066", "-0.756304289573"]);
        assert_eq!(rows[7][3..10], ["", "", "", "", "", "30", "beyond limit"]);
    }

    #[test]
    fn a_module_has_one_row_a_node() {
        let text = module_map(&samples::module_map()).csv();
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows[0], "p1_kpa,x_mm,y_mm,z_mm,qw,qx,qy,qz,status,gap_mm");
        assert_eq!(rows[1], "0,0,0,130,1,0,0,0,converged,");
        assert!(rows[2].ends_with(",1,buckled contact,-1"), "{}", rows[2]);
        assert_eq!(rows[3], "40,,,,,,,,missing,");
    }
}
