use super::{equilibrium::SolidShape, mode::SolidModuleMode, module::SolidModule};
use crate::vtk::{Array, UnstructuredGrid, Values};
use actuator::units::{KPA, MM};
use std::io::{self, Write};

impl SolidModule {
    /// Writes the rubber of all FREEs where it is, as an unstructured grid of VTK (`.vtu`): the arrays of [`crate::SolidSolver::write_vtu`], the
    /// number of the `free` (from 1) and its `free_pressure_kpa` for each element, and the motion of a mode as `buckling_mode`.
    ///
    /// # Errors
    /// What `out` answers.
    pub fn write_vtu(
        &self,
        shape: &SolidShape,
        mode: Option<&SolidModuleMode>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let mut whole: Option<UnstructuredGrid> = None;
        for (index, (free, state)) in self.frees.iter().zip(&shape.frees).enumerate() {
            let motion = mode.map(|mode| ("buckling_mode", &mode.displacements[index][..]));
            let fields: Vec<(&str, &[[f64; 3]])> = motion.into_iter().collect();
            let mut grid = free.solver.rubber_grid(state, &fields)?;
            let axis = free.axis() / MM;
            for point in &mut grid.points {
                *point = std::array::from_fn(|k| point[k] + axis[k]);
            }
            let cells = grid.connectivity.len() / grid.nodes_per_cell;
            let pressure = shape.pressures[index] / KPA;
            grid.cell_data.push(Array::new("free", 1, Values::I64(vec![index as i64 + 1; cells])));
            grid.cell_data.push(Array::new("free_pressure_kpa", 1, Values::F64(vec![pressure; cells])));
            grid.field_data.clear();
            match &mut whole {
                Some(whole) => whole.append(grid)?,
                None => whole = Some(grid),
            }
        }
        whole.map_or(Ok(()), |whole| whole.write(out))
    }
}
