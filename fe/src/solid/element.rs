use super::shape::{NODES, SLOPES, Shape};
use crate::material::{Hyperelastic, Rubber, flat};
use faer::{Accum, MatMut, MatRef, Par, linalg::matmul::matmul};
use nalgebra::Matrix3;

/// Pressure functions of an element.
pub(crate) const PRESSURES: usize = 4;
/// Displacement unknowns of an element, ordered by direction: unknown of node `a` in direction `i` is `i NODES + a`.
pub(crate) const UNKNOWNS: usize = 3 * NODES;
/// Pairs of directions (i, k), i <= k, whose blocks are computed; the others follow by symmetry.
pub(crate) const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Rubber in an element: `integral W(F) + q (J - 1) - q^2/(2 kappa) dV` is stationary, with q (tension positive) linear in the
/// element and free to jump between elements, and W independent of J = det F.
///
/// q is eliminated element by element from each Newton step, not from the energy: the residual of its own equation,
/// `r_q = integral psi (J - 1 - q/kappa) dV`, is carried along and vanishes at convergence together with that of the nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ElementLaw {
    pub material: Rubber,
    /// Bulk modulus kappa, Pa.
    pub bulk: f64,
}

/// What is needed to find the pressure's part of a Newton step, and to condense a residual again.
#[derive(Clone, Debug)]
pub(crate) struct Condensation {
    /// `d r_q/d x`: `p UNKNOWNS + unknown`, m^2.
    coupling: Vec<f64>,
    /// r_q of the last evaluation, m^3.
    pub mismatch: [f64; PRESSURES],
}

impl Default for Condensation {
    fn default() -> Self {
        Condensation { coupling: vec![0.0; PRESSURES * UNKNOWNS], mismatch: [0.0; PRESSURES] }
    }
}

impl Condensation {
    /// The change of the pressure that goes with a step of the nodes, by `dr_q/dq = -M/kappa`: `kappa M^-1 (r_q + dr_q/dx step)`;
    /// without r_q if the step does not correct it.
    pub fn pressure_step(
        &self,
        law: &ElementLaw,
        shape: &Shape,
        step: &[f64; UNKNOWNS],
        with_mismatch: bool,
    ) -> [f64; PRESSURES] {
        let change: [f64; PRESSURES] = std::array::from_fn(|p| {
            let row = &self.coupling[p * UNKNOWNS..(p + 1) * UNKNOWNS];
            let mismatch = if with_mismatch { self.mismatch[p] } else { 0.0 };
            mismatch + row.iter().zip(step).map(|(a, b)| a * b).sum::<f64>()
        });
        shape.pressure_metric.map(|row| law.bulk * row.iter().zip(change).map(|(a, b)| a * b).sum::<f64>())
    }

    /// Adds `kappa (dr_q/dx)^T M^-1 r_q`, the share of the eliminated pressure, to a residual of the nodes.
    pub fn condense(&self, law: &ElementLaw, shape: &Shape, residual: &mut [f64; UNKNOWNS]) {
        for (p, row) in shape.pressure_metric.iter().enumerate() {
            let factor = law.bulk * row.iter().zip(self.mismatch).map(|(a, b)| a * b).sum::<f64>();
            for (value, slope) in residual.iter_mut().zip(&self.coupling[p * UNKNOWNS..]) {
                *value += factor * slope;
            }
        }
    }
}

/// Space for the evaluation of one element, used again for each.
#[derive(Clone, Debug)]
pub(crate) struct Workspace {
    /// dE/dx at constant q, by direction and node, N.
    pub residual: [f64; UNKNOWNS],
    /// Condensed tangent in the blocks of [`PAIRS`], each NODES x NODES by columns, N/m.
    pub tangent: Vec<f64>,
    gradients: Vec<f64>,
    stresses: Vec<f64>,
    products: Vec<f64>,
    weighted: Vec<f64>,
    arch: pulp::Arch,
}

impl Default for Workspace {
    fn default() -> Self {
        Workspace {
            residual: [0.0; UNKNOWNS],
            tangent: vec![0.0; NODES * NODES * PAIRS.len()],
            gradients: vec![0.0; 3 * SLOPES],
            stresses: vec![0.0; 3 * SLOPES],
            products: vec![0.0; SLOPES * NODES * PAIRS.len()],
            weighted: vec![0.0; PRESSURES * UNKNOWNS],
            arch: pulp::Arch::new(),
        }
    }
}

/// An element is turned inside out, or its material has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inverted;

/// The evaluation of an element, compiled for the vector instructions of the processor it runs on.
struct Evaluation<'a> {
    work: &'a mut Workspace,
    law: &'a ElementLaw,
    shape: &'a Shape,
    positions: &'a [f64; UNKNOWNS],
    q: &'a [f64; PRESSURES],
    condensation: &'a mut Condensation,
    with_tangent: bool,
}

impl pulp::WithSimd for Evaluation<'_> {
    type Output = Result<f64, Inverted>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let Evaluation { work, law, shape, positions, q, condensation, with_tangent } = self;
        work.evaluate_here(law, shape, positions, q, condensation, with_tangent)
    }
}

/// Cofactor H = J F^-T and J.
fn cofactor(f: &Matrix3<f64>) -> (Matrix3<f64>, f64) {
    let h = Matrix3::from_fn(|i, j| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        f[(a, c)] * f[(b, d)] - f[(a, d)] * f[(b, c)]
    });
    let volume_ratio = (0..3).map(|j| f[(0, j)] * h[(0, j)]).sum();
    (h, volume_ratio)
}

/// Adds `q d2J/dF2` to a tangent: d2J/dF_iJ dF_kL = e_ikm e_JLN F_mN.
fn add_volume_tangent(tangent: &mut crate::material::Tangent, f: &Matrix3<f64>, q: f64) {
    for m in 0..3 {
        let (i, k) = ((m + 1) % 3, (m + 2) % 3);
        for n in 0..3 {
            let (j, l) = ((n + 1) % 3, (n + 2) % 3);
            let value = q * f[(m, n)];
            tangent[(flat(i, j), flat(k, l))] += value;
            tangent[(flat(k, l), flat(i, j))] += value;
            tangent[(flat(i, l), flat(k, j))] -= value;
            tangent[(flat(k, j), flat(i, l))] -= value;
        }
    }
}

impl Workspace {
    /// Deformation gradients at the integration points: `F_iL` of point g at `i SLOPES + 3 g + L`.
    fn gradients(&mut self, shape: &Shape, positions: &[f64; UNKNOWNS]) {
        matmul(
            MatMut::from_column_major_slice_mut(&mut self.gradients, SLOPES, 3),
            Accum::Replace,
            MatRef::from_column_major_slice(&shape.slopes, NODES, SLOPES).transpose(),
            MatRef::from_column_major_slice(positions, NODES, 3),
            1.0,
            Par::Seq,
        );
    }

    fn gradient(&self, g: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|i, l| self.gradients[i * SLOPES + 3 * g + l])
    }

    fn add_forces(&mut self, shape: &Shape) {
        matmul(
            MatMut::from_column_major_slice_mut(&mut self.residual, NODES, 3),
            Accum::Replace,
            MatRef::from_column_major_slice(&shape.slopes, NODES, SLOPES),
            MatRef::from_column_major_slice(&self.stresses, SLOPES, 3),
            1.0,
            Par::Seq,
        );
    }

    /// Energy, residual and, if asked for, the condensed tangent of an element with its nodes at `positions` (m, by direction
    /// and node) and the pressure `q` (Pa).
    pub fn evaluate(
        &mut self,
        law: &ElementLaw,
        shape: &Shape,
        positions: &[f64; UNKNOWNS],
        q: &[f64; PRESSURES],
        condensation: &mut Condensation,
        with_tangent: bool,
    ) -> Result<f64, Inverted> {
        let arch = self.arch;
        arch.dispatch(Evaluation { work: self, law, shape, positions, q, condensation, with_tangent })
    }

    #[inline(always)]
    fn evaluate_here(
        &mut self,
        law: &ElementLaw,
        shape: &Shape,
        positions: &[f64; UNKNOWNS],
        q: &[f64; PRESSURES],
        condensation: &mut Condensation,
        with_tangent: bool,
    ) -> Result<f64, Inverted> {
        self.gradients(shape, positions);
        condensation.mismatch = [0.0; PRESSURES];
        if with_tangent {
            condensation.coupling.fill(0.0);
        }
        let mut energy = 0.0;
        for g in 0..NODES {
            let f = self.gradient(g);
            let (h, volume_ratio) = cofactor(&f);
            if volume_ratio.is_nan() || volume_ratio <= 0.0 {
                return Err(Inverted);
            }
            let (weight, psi) = (shape.weights[g], &shape.pressure[g]);
            let pressure: f64 = psi.iter().zip(q).map(|(psi, q)| psi * q).sum();
            let stretched = volume_ratio - 1.0 - pressure / law.bulk;
            for (mismatch, psi) in condensation.mismatch.iter_mut().zip(psi) {
                *mismatch += weight * psi * stretched;
            }
            let mut answer = law.material.answer(&f);
            if !answer.energy.is_finite() {
                return Err(Inverted);
            }
            energy += weight * (answer.energy + pressure * (volume_ratio - 1.0 - 0.5 * pressure / law.bulk));
            let stress = answer.stress + pressure * h;
            for i in 0..3 {
                for l in 0..3 {
                    self.stresses[i * SLOPES + 3 * g + l] = weight * stress[(i, l)];
                }
            }
            if !with_tangent {
                continue;
            }
            add_volume_tangent(&mut answer.tangent, &f, pressure);
            let slopes: &[f64; SLOPES] =
                shape.slopes[g * SLOPES..(g + 1) * SLOPES].try_into().expect("27 nodes");
            let (first, rest) = slopes.split_at(NODES);
            let (second, third) = rest.split_at(NODES);
            // products: row (g, J), column (pair, b): weight sum_L A_iJkL dN_b/dX_L.
            let rows = self.products.chunks_exact_mut(NODES * PAIRS.len()).skip(3 * g).take(3);
            for (j, row) in rows.enumerate() {
                for (&(i, k), block) in PAIRS.iter().zip(row.chunks_exact_mut(NODES)) {
                    let [c0, c1, c2] = [0, 1, 2].map(|l| weight * answer.tangent[(flat(i, j), flat(k, l))]);
                    for b in 0..NODES {
                        block[b] = c0 * first[b] + c1 * second[b] + c2 * third[b];
                    }
                }
            }
            for k in 0..3 {
                let [c0, c1, c2] = [0, 1, 2].map(|l| weight * h[(k, l)]);
                let mut normal = [0.0; NODES];
                for b in 0..NODES {
                    normal[b] = c0 * first[b] + c1 * second[b] + c2 * third[b];
                }
                for (p, psi) in psi.iter().enumerate() {
                    let from = p * UNKNOWNS + k * NODES;
                    for (value, normal) in condensation.coupling[from..from + NODES].iter_mut().zip(&normal) {
                        *value += psi * normal;
                    }
                }
            }
        }
        self.add_forces(shape);
        if with_tangent {
            self.tangent(law, shape, condensation);
        }
        Ok(energy)
    }

    #[inline(always)]
    /// Multiplies the products with the slopes and adds the condensed pressure: `kappa (dr_q/dx)^T M^-1 (dr_q/dx)`.
    fn tangent(&mut self, law: &ElementLaw, shape: &Shape, condensation: &Condensation) {
        let columns = NODES * PAIRS.len();
        matmul(
            MatMut::from_column_major_slice_mut(&mut self.tangent, NODES, columns),
            Accum::Replace,
            MatRef::from_column_major_slice(&shape.slopes, NODES, SLOPES),
            MatRef::from_row_major_slice(&self.products, SLOPES, columns),
            1.0,
            Par::Seq,
        );
        for p in 0..PRESSURES {
            let weighted = &mut self.weighted[p * UNKNOWNS..(p + 1) * UNKNOWNS];
            weighted.fill(0.0);
            for (q, row) in condensation.coupling.chunks_exact(UNKNOWNS).enumerate() {
                let factor = law.bulk * shape.pressure_metric[p][q];
                for (value, slope) in weighted.iter_mut().zip(row) {
                    *value += factor * slope;
                }
            }
        }
        for (&(i, k), block) in PAIRS.iter().zip(self.tangent.chunks_exact_mut(NODES * NODES)) {
            for p in 0..PRESSURES {
                let left = &condensation.coupling[p * UNKNOWNS + i * NODES..][..NODES];
                let right = &self.weighted[p * UNKNOWNS + k * NODES..][..NODES];
                for (column, factor) in block.chunks_exact_mut(NODES).zip(right) {
                    for (value, slope) in column.iter_mut().zip(left) {
                        *value += factor * slope;
                    }
                }
            }
        }
    }

    /// Block of the condensed tangent between nodes `a` and `b`.
    pub fn block(&self, a: usize, b: usize) -> Matrix3<f64> {
        const SIZE: usize = NODES * NODES;
        let (ab, ba) = (b * NODES + a, a * NODES + b);
        let at = |pair: usize, entry: usize| self.tangent[pair * SIZE + entry];
        Matrix3::new(
            at(0, ab),
            at(1, ab),
            at(2, ab),
            at(1, ba),
            at(3, ab),
            at(4, ab),
            at(2, ba),
            at(4, ba),
            at(5, ab),
        )
    }
}
