use super::{
    banded::Banded,
    element::Element,
    kinematics::{Rows, STRETCH, UNKNOWNS},
    problem::{HELD, Problem},
};
use nalgebra::Vector3;

/// The equations linearised at a state, with lambda, psi and the pressure as a border.
///
/// The potential is P = W + q.g - q.M q/(2 K) - p V with g the integral of (J - 1) times the pressure functions; P is
/// stationary in the nodal values and q. The q are condensed element by element.
#[derive(Clone, Debug)]
pub(crate) struct System {
    pub stiffness: Banded,
    /// dP/d(unknown).
    pub residual: Vec<f64>,
    /// The same after condensing the q, which vanishes with `residual` and `dilation`.
    pub right: Vec<f64>,
    /// Sum of the magnitudes of the elements' shares in `residual`.
    magnitude: Vec<f64>,
    /// Second derivatives by an unknown and by lambda, psi, p.
    pub columns: [Vec<f64>; 3],
    /// Second derivatives by lambda, psi, p.
    pub corner: [[f64; 3]; 3],
    /// dP/dlambda and dP/dpsi.
    pub global_residual: [f64; 2],
    /// The same after condensing the q.
    pub global_right: [f64; 2],
    /// P.
    pub energy: f64,
    /// Enclosed volume per length.
    pub volume: f64,
    /// Largest mean of an element's volume equation: how far the volume is from what the pressure says.
    pub dilation: f64,
    pub rows: Vec<VolumeRows>,
}

/// An element's volume equations: derivatives by its unknowns, and values.
#[derive(Clone, Debug)]
pub(crate) struct VolumeRows {
    pub by_unknown: Rows<3>,
    pub values: Vector3<f64>,
}

impl Problem {
    /// An empty system of the right size.
    pub fn system(&self) -> System {
        System {
            stiffness: Banded::new(self.order, self.bandwidth),
            residual: vec![0.0; self.order],
            right: vec![0.0; self.order],
            magnitude: vec![0.0; self.order],
            columns: std::array::from_fn(|_| vec![0.0; self.order]),
            corner: [[0.0; 3]; 3],
            global_residual: [0.0; 2],
            global_right: [0.0; 2],
            energy: 0.0,
            volume: 0.0,
            dilation: 0.0,
            rows: vec![
                VolumeRows { by_unknown: [[0.0; 32]; 3], values: Vector3::zeros() };
                self.elements.len()
            ],
        }
    }
}

impl System {
    pub fn clear(&mut self) {
        self.stiffness.clear();
        for vector in [&mut self.residual, &mut self.right, &mut self.magnitude] {
            vector.fill(0.0);
        }
        self.columns.iter_mut().for_each(|column| column.fill(0.0));
        self.corner = [[0.0; 3]; 3];
        self.global_residual = [0.0; 2];
        self.global_right = [0.0; 2];
        (self.energy, self.volume, self.dilation) = (0.0, 0.0, 0.0);
    }

    /// Condenses an element's pressure and adds the element to the whole.
    #[allow(clippy::too_many_arguments)]
    pub fn accumulate(
        &mut self,
        problem: &Problem,
        element: &Element,
        index: usize,
        pressure: f64,
        mut gradient: [f64; UNKNOWNS],
        volume_gradient: [f64; UNKNOWNS],
        mut hessian: Rows<UNKNOWNS>,
    ) {
        // K du + B^T dq = -R and B du - M dq/K_bulk = -h give dq = K_bulk M^-1 (h + B du).
        let rows = &self.rows[index];
        self.dilation = self.dilation.max(rows.values.amax() / element.volume);
        let lifted = element.bulk * rows.values;
        let mut right = gradient;
        for a in 0..3 {
            let mut weighted = [0.0; 32];
            for b in 0..3 {
                for (entry, value) in weighted.iter_mut().zip(&rows.by_unknown[b]) {
                    *entry += element.bulk[(a, b)] * value;
                }
            }
            for i in 0..UNKNOWNS {
                let value = rows.by_unknown[a][i];
                right[i] += lifted[a] * value;
                for (entry, other) in hessian[i].iter_mut().zip(&weighted) {
                    *entry += value * other;
                }
            }
        }
        for i in 0..UNKNOWNS {
            gradient[i] -= pressure * volume_gradient[i];
            right[i] -= pressure * volume_gradient[i];
        }

        let unknown = |i: usize| problem.unknown[3 * element.nodes[i / 3] + i % 3];
        for i in (0..STRETCH).filter(|i| unknown(*i) != HELD) {
            let row = unknown(i);
            self.residual[row] += gradient[i];
            self.right[row] += right[i];
            self.magnitude[row] += gradient[i].abs() + (pressure * volume_gradient[i]).abs();
            self.columns[0][row] += hessian[i][STRETCH];
            self.columns[1][row] += hessian[i][STRETCH + 1];
            self.columns[2][row] -= volume_gradient[i];
            for (j, value) in hessian[i][..STRETCH].iter().enumerate() {
                let column = unknown(j);
                if column <= row {
                    self.stiffness.add(row, column, *value);
                }
            }
        }
        for a in 0..2 {
            let i = STRETCH + a;
            self.global_residual[a] += gradient[i];
            self.global_right[a] += right[i];
            self.corner[a][0] += hessian[i][STRETCH];
            self.corner[a][1] += hessian[i][STRETCH + 1];
            self.corner[a][2] -= volume_gradient[i];
            self.corner[2][a] -= volume_gradient[i];
        }
    }

    /// Norm of the residual over that of the elements' shares in it; forces below
    /// 1e-3 mu B^2 (a pressure of some 1e-4 mu) are measured against that.
    pub fn relative_residual(&self) -> f64 {
        let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
        norm(&self.residual) / (norm(&self.magnitude) + 1e-3)
    }
}
