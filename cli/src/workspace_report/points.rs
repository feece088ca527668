use super::SQUARE;
use crate::{
    failure::Failure,
    goal::Steered,
    map_csv::{self, number},
    output,
};
use actuator::{
    TipPose, grid_places,
    units::{KPA, MM},
};
use control::{Bounds, Dexterity};
use fe::vtk::{Array, UnstructuredGrid, VERTEX, Values};
use rom::{OutOfDomain, PoseEvaluation, PoseModel};
use std::path::Path;

/// Most points that are written.
const MOST: usize = 2_000_000;

/// A pose that is reached, and how.
pub struct Point {
    /// Pressures, Pa.
    pub pressures: Vec<f64>,
    /// The pose.
    pub pose: TipPose,
    /// How the position answers to the pressures.
    pub dexterity: Dexterity,
    /// How much every pressure may change at once without leaving the model's domain, Pa.
    pub clearance: f64,
}

/// Poses on an even grid of pressures within bounds, the last FREE's fastest, where the module has a stable state.
pub fn points(module: &Steered<'_>, bounds: &Bounds, per_axis: usize) -> Result<Vec<Point>, Failure> {
    let frees = bounds.lower.len();
    let counts: Vec<usize> = bounds
        .lower
        .iter()
        .zip(&bounds.upper)
        .map(|(low, high)| if high > low { per_axis } else { 1 })
        .collect();
    let all = counts.iter().try_fold(1usize, |all, count| all.checked_mul(*count)).filter(|all| *all <= MOST);
    let Some(all) = all else {
        return Err(Failure::usage(format!(
            "--points {per_axis}: more than {MOST} points for {frees} FREEs; give fewer"
        )));
    };
    let tip = module.tip();
    let mut into = PoseEvaluation::new(frees, 0);
    let mut found = Vec::with_capacity(all);
    for node in 0..all {
        let places = grid_places(counts.iter().copied(), node).into_iter().enumerate();
        let pressures: Vec<f64> =
            places.map(|(free, place)| bounds.step(free, place, counts[free] - 1)).collect();
        match tip.evaluate(&pressures, &mut into) {
            Err(OutOfDomain::Unstable { .. }) => continue,
            answer => answer.map_err(|error| Failure::refused(error.to_string()))?,
        }
        let clearance = module.clearance(&pressures);
        found.push(Point {
            pressures,
            pose: into.chart.to_pose(),
            dexterity: Dexterity::of(&into),
            clearance,
        });
    }
    Ok(found)
}

/// mm^3/kPa^3 in m^3/Pa^3.
pub const CUBIC: f64 = SQUARE * MM / (KPA * KPA * KPA);

/// Writes `points.csv` and `points.vtu`.
pub fn write_points(points: &[Point], out: &Path) -> Result<(), Failure> {
    let frees = points.first().map_or(0, |point| point.pressures.len());
    let names = map_csv::pressure_header(frees);
    let mut text = names.join(",") + "," + map_csv::POSE_HEADER;
    text += ",manipulability_mm3_per_kpa3,condition_number,clearance_kpa\n";
    for point in points {
        let mut cells: Vec<String> = point.pressures.iter().map(|pressure| number(pressure / KPA)).collect();
        cells.extend(map_csv::pose_cells(&point.pose));
        cells.push(number(point.dexterity.manipulability / CUBIC));
        // Infinite where a direction cannot be gone: an empty cell.
        cells.push(
            Some(point.dexterity.condition).filter(|value| value.is_finite()).map(number).unwrap_or_default(),
        );
        cells.push(number(point.clearance / KPA));
        text += &(cells.join(",") + "\n");
    }
    output::save(&out.join("points.csv"), text.as_bytes())?;
    let each = |name: &str, value: &dyn Fn(&Point) -> f64| {
        Array::new(name, 1, Values::F64(points.iter().map(value).collect()))
    };
    let pressures = names.iter().enumerate();
    let mut point_data: Vec<Array> =
        pressures.map(|(free, name)| each(name, &|point| point.pressures[free] / KPA)).collect();
    point_data.push(each("manipulability_mm3_per_kpa3", &|point| point.dexterity.manipulability / CUBIC));
    point_data.push(each("condition_number", &|point| point.dexterity.condition));
    point_data.push(each("clearance_kpa", &|point| point.clearance / KPA));
    let grid = UnstructuredGrid {
        points: points.iter().map(|point| point.pose.position.map(|metres| metres / MM).into()).collect(),
        cell_type: VERTEX,
        nodes_per_cell: 1,
        connectivity: (0..points.len() as i64).collect(),
        point_data,
        cell_data: vec![],
        field_data: vec![],
    };
    output::replace(&out.join("points.vtu"), &mut |out| grid.write(out))
}
