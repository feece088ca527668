use super::SQUARE;
use crate::{failure::Failure, map_csv::number, output};
use actuator::units::{DEG, MM};
use control::{Face, Sideways, Surface};
use fe::vtk::{Array, QUADRANGLE, UnstructuredGrid, Values};
use std::path::Path;

/// Area (m^2) of the boundary by how many pressures are not at a bound there: at most two where it is the image of a face of the box
/// of pressures, more where the map is singular.
pub fn areas(surface: &Surface, frees: usize) -> Vec<(usize, f64)> {
    let mut areas = vec![0.0; frees + 1];
    for facet in &surface.facets {
        areas[facet.face.dimension(frees)] += surface.middle_and_area(facet).1;
    }
    areas.into_iter().enumerate().filter(|(_, area)| *area > 0.0).collect()
}

fn held(face: Face, free: usize) -> &'static str {
    match (face.is_least(free), face.is_greatest(free)) {
        (true, true) => "fixed",
        (true, false) => "least",
        (false, true) => "greatest",
        (false, false) => "between",
    }
}

/// Writes `boundary.csv`, `boundary.vtu` and `reach.csv`.
pub fn write(surface: &Surface, sideways: &Sideways, frees: usize, out: &Path) -> Result<(), Failure> {
    let names: Vec<String> = (1..=frees).map(|free| format!("p{free}")).collect();
    let mut text = format!("x_mm,y_mm,z_mm,area_mm2,free_pressures,{}\n", names.join(","));
    for facet in &surface.facets {
        let (middle, area) = surface.middle_and_area(facet);
        let mut cells: Vec<String> = middle.iter().map(|metres| number(metres / MM)).collect();
        cells.push(number(area / SQUARE));
        cells.push(facet.face.dimension(frees).to_string());
        cells.extend((0..frees).map(|free| held(facet.face, free).to_owned()));
        text += &(cells.join(",") + "\n");
    }
    output::save(&out.join("boundary.csv"), text.as_bytes())?;
    let faces = || surface.facets.iter().map(|facet| facet.face);
    let free_pressures = faces().map(|face| face.dimension(frees) as u8).collect();
    let mut cell_data = vec![Array::new("free_pressures", 1, Values::U8(free_pressures))];
    // At the least 0, at the greatest 1, between them 0.5.
    let share = |face: Face, free| match (face.is_least(free), face.is_greatest(free)) {
        (true, false) => 0.0,
        (false, true) => 1.0,
        _ => 0.5,
    };
    for (free, name) in names.iter().enumerate() {
        let shares = faces().map(|face| share(face, free)).collect();
        cell_data.push(Array::new(name, 1, Values::F64(shares)));
    }
    let corners = surface.facets.iter().flat_map(|facet| facet.corners);
    let grid = UnstructuredGrid {
        points: surface.points.iter().map(|point| point.map(|metres| metres / MM)).collect(),
        cell_type: QUADRANGLE,
        nodes_per_cell: 4,
        connectivity: corners.map(|corner| corner as i64).collect(),
        point_data: vec![],
        cell_data,
        field_data: vec![],
    };
    output::replace(&out.join("boundary.vtu"), &mut |out| grid.write(out))?;
    let mut text = "direction_deg,reach_mm,z_mm\n".to_owned();
    for (direction, reach) in sideways.reaches() {
        let cells = reach.map_or([String::new(), String::new()], |(r, z)| [number(r / MM), number(z / MM)]);
        text += &format!("{},{}\n", number(direction / DEG), cells.join(","));
    }
    output::save(&out.join("reach.csv"), text.as_bytes())
}
