//! How far the tip's cap gives way to small loads on it, by the tangent of an equilibrium; and the whole tube's state from a sector's.

use super::{SolidError, newton::SolidSolver, state::SolidState};
use nalgebra::{Matrix6, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// First-order answer of an equilibrium to a force (x, y, z) and a moment (x, y, z, in space) on its cap, one column each.
///
/// By the symmetric tangent: where the equilibrium itself carries a moment M, the load of a column is one under which M
/// turns by half of the cap's turn.
#[derive(Clone, Debug, PartialEq)]
pub struct TipCompliance {
    /// Shift (m) of the cap's middle and its turn (rad, in space) per newton and newton metre.
    pub matrix: Matrix6<f64>,
    /// Shift of the middle of the plane of points at half the undeformed length, m per newton or newton metre: of each column.
    pub middle: [Vector3<f64>; 6],
    /// Height of that plane and of the cap, m.
    pub heights: [f64; 2],
}

impl TipCompliance {
    /// How far the matrix is from symmetric, relative to the geometric mean of the diagonal.
    pub fn asymmetry(&self) -> f64 {
        let c = &self.matrix;
        let size = |i: usize, j: usize| (c[(i, i)] * c[(j, j)]).abs().sqrt();
        let each = (0..36).map(|n| (n % 6, n / 6));
        each.map(|(i, j)| (c[(i, j)] - c[(j, i)]).abs() / size(i, j)).fold(0.0, f64::max)
    }
}

impl SolidSolver {
    /// Compliance of the cap at an equilibrium of the whole tube with a free cap: one factorisation, six substitutions.
    ///
    /// # Errors
    /// [`SolidError::Invalid`] for a sector or a cap that is held; [`SolidError::NotConverged`] and [`SolidError::Singular`] as
    /// [`SolidSolver::stability`].
    pub fn tip_compliance(&mut self, state: &SolidState) -> Result<TipCompliance, SolidError> {
        let refuse = |field, value: usize, requirement| {
            Err(SolidError::Invalid { field, value: value as f64, requirement })
        };
        if self.body.grid.sectors > 1 {
            let sectors = self.body.grid.sectors;
            return refuse("the number of sectors", sectors, "a tip that bends takes the whole tube");
        }
        let held = state.load.held.iter().filter(|held| **held).count();
        if held > 0 {
            return refuse("the number of held motions of the cap", held, "the cap must be free to give way");
        }
        self.assemble(state, true).map_err(|lost| self.lost(state, lost, "the tangent"))?;
        self.factorise(state.load.held).map_err(|_| SolidError::Singular("a pivot is zero".into()))?;
        let dimension = self.unknowns();
        let mut columns = vec![0.0; 6 * dimension];
        for (load, column) in columns.chunks_exact_mut(dimension).enumerate() {
            let mut forces = [Vector3::zeros(); 2];
            forces[load / 3][load % 3] = 1.0;
            self.body.add_dead_loads(forces, Vector3::zeros(), column);
        }
        self.substitute(&mut columns);
        let [ni, nj, nk] = self.body.grid.lines;
        let plane = (nk - 1) / 2;
        let range = plane * ni * nj..(plane + 1) * ni * nj;
        let mean = |vectors: &[[f64; 3]]| -> Vector3<f64> {
            vectors[range.clone()].iter().map(|u| Vector3::from(*u)).sum::<Vector3<f64>>() / (ni * nj) as f64
        };
        let heights = [mean(&state.positions).z, state.cap.z];
        let mut compliance =
            TipCompliance { matrix: Matrix6::zeros(), middle: [Vector3::zeros(); 6], heights };
        for (load, column) in columns.chunks_exact(dimension).enumerate() {
            let (displacements, [shift, turn]) = self.body.displacements(state, column);
            compliance.matrix.fixed_view_mut::<3, 1>(0, load).copy_from(&shift);
            compliance.matrix.fixed_view_mut::<3, 1>(3, load).copy_from(&turn);
            compliance.middle[load] = mean(&displacements);
        }
        Ok(compliance)
    }

    /// The state of the whole tube of which `state` is one sector's, found by `sector` with the same mesh; with a free cap, and loads
    /// that hold it where it is.
    ///
    /// # Errors
    /// [`SolidError::Invalid`] where the meshes do not fit.
    pub fn whole_of(&self, sector: &SolidSolver, state: &SolidState) -> Result<SolidState, SolidError> {
        let (own, part) = (&self.body.grid, &sector.body.grid);
        let sectors = part.sectors;
        let [ni, nj, nk] = part.lines;
        let fits = own.sectors == 1 && own.lines == [ni, (nj - 1) * sectors, nk] && sectors > 1;
        if !fits || !state.rotations.is_empty() {
            return Err(SolidError::Invalid {
                field: "the number of lines of points around a sector",
                value: nj as f64,
                requirement: "a whole is made of a sector of the same mesh, with fibres as trusses",
            });
        }
        let mut whole = self.rest();
        let turns: Vec<Rotation3<f64>> = (0..sectors)
            .map(|index| Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * index as f64 / sectors as f64))
            .collect();
        for k in 0..nk {
            for (index, turn) in turns.iter().enumerate() {
                for j in 0..nj - 1 {
                    for i in 0..ni {
                        let from = Vector3::from(state.positions[part.point(i, j, k) as usize]);
                        let to = own.point(i, index * (nj - 1) + j, k) as usize;
                        whole.positions[to] = (turn * from).into();
                    }
                }
            }
        }
        let [ei, ej, _] = part.elements;
        for (element, [i, j, k]) in own.element_places().enumerate() {
            whole.pressures[element] = state.pressures[(k * ej + j % ej) * ei + i];
        }
        let angle = state.cap_rotation.scaled_axis().z;
        whole.cap = Vector3::new(0.0, 0.0, state.cap.z);
        whole.cap_rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        whole.load = state.load;
        whole.load.held = [false; 6];
        whole.energy = sectors as f64 * state.energy;
        whole.volume = sectors as f64 * state.volume;
        whole.residual = state.residual;
        Ok(whole)
    }
}
