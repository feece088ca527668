use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};

use super::fronts::{Front, Fronts};
use super::ordering::cheapest;
use super::pattern::BlockPattern;
use super::symbolic::{Relaxation, Symbolic};

/// Merging that suits meshes of 27-node hexahedra: the least time of those tried, at more zeros than faer's own.
const RELAXATION: &Relaxation = &[(16, 0.8), (48, 0.3), (96, 0.15), (usize::MAX, 0.02)];

/// A pivot smaller than this part of the diagonal entry it comes from is rounding: its sign means nothing.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// `K = L D L^T` of a symmetric matrix, L unit lower triangular in the order of elimination, D diagonal.
///
/// There is no pivoting, so K should be positive definite or not far from it: a tangent with a few negative eigenvalues
/// is, a saddle point (zeros on the diagonal) is not.
pub(crate) struct Factorisation {
    pub(super) fronts: Fronts,
    /// Panels of all fronts: L below the diagonal, D on it.
    pub(super) factor: Vec<f64>,
    /// Contributions that wait for their parents.
    stack: Vec<f64>,
    /// `L D` of the rows below the pivots.
    scaled: Vec<f64>,
    /// Diagonal of K at the pivots of a front.
    diagonal: Vec<f64>,
    memory: MemBuffer,
    flops: f64,
    pub(super) factorised: bool,
    pub(super) permuted: Vec<f64>,
    pub(super) gathered: Vec<f64>,
}

/// Signs of the pivots, which are those of the eigenvalues (Sylvester).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Inertia {
    /// Negative eigenvalues.
    pub negative: usize,
    /// Pivots of the size of rounding errors: singular to working accuracy, of either sign.
    pub zero: usize,
    /// Positive eigenvalues.
    pub positive: usize,
}

/// Why a matrix was not factorised.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub(crate) enum FactorError {
    /// Not a number, or infinite.
    #[error("entry {index} of the {count} values of the tangent is {value}")]
    NotFinite {
        /// Index into the values.
        index: usize,
        /// Number of values.
        count: usize,
        /// What is there.
        value: f64,
    },
    /// No pivot.
    #[error(
        "the tangent has no pivot at unknown {unknown}: it is singular there, or indefinite in a way that elimination in a fixed order cannot take"
    )]
    NoPivot {
        /// Scalar unknown in the caller's numbering.
        unknown: usize,
    },
}

impl Factorisation {
    /// Analysis of a pattern, serving all matrices of it. The order of elimination is found by minimum degree on the
    /// graph of the blocks, several times, and that of the fewest operations is taken.
    ///
    /// Orders of the blocks may be given: minimum degree starts from each too, and they are candidates themselves. Give
    /// sweeps in the directions of a structured mesh: in a tube, the nodes with the place along the axis fastest.
    ///
    /// # Panics
    /// If a given order is no permutation of the blocks.
    pub fn new(pattern: &BlockPattern, orders: &[&[u32]]) -> Self {
        Self::in_order(pattern, &cheapest(pattern, orders))
    }

    /// Analysis for one order of elimination.
    pub fn in_order(pattern: &BlockPattern, order: &[u32]) -> Self {
        let symbolic = Symbolic::new(pattern, order, RELAXATION);
        let fronts = Fronts::new(pattern, &symbolic);
        let largest = |size: fn(&Front) -> usize| fronts.fronts.iter().map(size).max().unwrap_or(0);
        let width = largest(|front| front.width);
        Self {
            factor: vec![0.0; fronts.stored],
            stack: vec![0.0; fronts.stack],
            scaled: vec![0.0; largest(|front| front.below() * front.width)],
            diagonal: vec![0.0; width],
            memory: MemBuffer::new(cholesky_in_place_scratch::<f64>(width, Par::Seq, Default::default())),
            flops: symbolic.flops(),
            factorised: false,
            permuted: Vec::new(),
            gathered: Vec::new(),
            fronts,
        }
    }

    /// Scalar unknowns.
    pub fn dimension(&self) -> usize {
        self.fronts.unknowns.len()
    }

    /// Multiplications with their additions of one factorisation: the sum of the squared column lengths of L.
    pub fn flops(&self) -> f64 {
        self.flops
    }

    /// Values kept of L and D, zeros of merged supernodes and unused triangles included.
    pub fn stored(&self) -> usize {
        self.fronts.stored
    }

    /// Factorises a matrix of the pattern. No allocation.
    pub fn factorise(&mut self, values: &[f64]) -> Result<Inertia, FactorError> {
        self.factorised = false;
        let mut inertia = Inertia { negative: 0, zero: 0, positive: 0 };
        let memory = MemStack::new(&mut self.memory);
        for front in &self.fronts.fronts {
            let (width, height, below) = (front.width, front.height, front.below());
            let panel = &mut self.factor[front.panel.clone()];
            panel.fill(0.0);
            self.fronts.fill(front, values, panel);
            for (pivot, diagonal) in self.diagonal[..width].iter_mut().enumerate() {
                *diagonal = panel[pivot * (height + 1)];
            }
            let children = &self.fronts.children[front.children.clone()];
            for &child in children {
                let child = &self.fronts.fronts[child as usize];
                let contribution = &self.stack[child.base..][..child.below().pow(2)];
                self.fronts.extend_add(child, contribution, panel, 0, 0..width, height);
            }

            let whole = MatMut::from_column_major_slice_mut(panel, height, width);
            let (mut pivots, mut rows) = whole.split_at_row_mut(width);
            let no_pivot = |at: usize| {
                let not_finite = values.iter().enumerate().find(|(_, value)| !value.is_finite());
                match not_finite {
                    Some((index, &value)) => FactorError::NotFinite { index, count: values.len(), value },
                    None => FactorError::NoPivot { unknown: self.fronts.unknowns[front.first + at] as usize },
                }
            };
            cholesky_in_place(pivots.as_mut(), Default::default(), Par::Seq, memory, Default::default())
                .map_err(|faer::linalg::cholesky::ldlt::factor::LdltError::ZeroPivot { index }| {
                    no_pivot(index)
                })?;
            for (at, diagonal) in self.diagonal[..width].iter().enumerate() {
                let pivot = pivots[(at, at)];
                if pivot == 0.0 || !pivot.is_finite() {
                    return Err(no_pivot(at));
                } else if pivot.abs() <= ROUNDING * diagonal.abs() {
                    inertia.zero += 1;
                } else if pivot > 0.0 {
                    inertia.positive += 1;
                } else {
                    inertia.negative += 1;
                }
            }
            if below == 0 {
                continue;
            }

            // rows := rows L^-T = L_rows D, kept in `scaled`; then contribution = -L_rows D L_rows^T.
            solve_unit_lower_triangular_in_place(pivots.as_ref(), rows.as_mut().transpose_mut(), Par::Seq);
            let scaled = &mut self.scaled[..below * width];
            for (pivot, scaled) in scaled.chunks_exact_mut(below).enumerate() {
                let inverse = 1.0 / pivots[(pivot, pivot)];
                let column =
                    rows.as_mut().col_mut(pivot).try_as_col_major_mut().expect("columns are contiguous");
                for (entry, scaled) in column.as_slice_mut().iter_mut().zip(scaled) {
                    *scaled = *entry;
                    *entry *= inverse;
                }
            }
            let (waiting, free) = self.stack.split_at_mut(front.top);
            let contribution = &mut free[..below * below];
            triangular::matmul(
                MatMut::from_column_major_slice_mut(contribution, below, below),
                BlockStructure::TriangularLower,
                Accum::Replace,
                rows.as_ref(),
                BlockStructure::Rectangular,
                MatRef::from_column_major_slice(scaled, below, width).transpose(),
                BlockStructure::Rectangular,
                -1.0,
                Par::Seq,
            );
            for &child in children {
                let child = &self.fronts.fronts[child as usize];
                let source = &waiting[child.base..][..child.below().pow(2)];
                self.fronts.extend_add(child, source, contribution, width, width..height, below);
            }
            self.stack.copy_within(front.top..front.top + below * below, front.base);
        }
        self.factorised = true;
        Ok(inertia)
    }
}
