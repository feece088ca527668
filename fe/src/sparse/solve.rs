use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_unit_lower_triangular_in_place, solve_unit_upper_triangular_in_place,
};
use faer::{Accum, MatMut, MatRef, Par};

use super::factorisation::Factorisation;
use super::fronts::Front;

impl Factorisation {
    /// Solves for any number of right-hand sides, one column after the other, in place. Allocates only when there are
    /// more columns than ever before.
    ///
    /// # Panics
    /// If the last `factorise` failed, or the length is no multiple of the dimension.
    pub fn solve(&mut self, right_hand_sides: &mut [f64]) {
        assert!(self.factorised, "there is no factorisation to solve with");
        let dimension = self.dimension();
        if right_hand_sides.is_empty() {
            return;
        }
        assert_eq!(right_hand_sides.len() % dimension, 0, "right-hand sides of {dimension} unknowns each");
        let columns = right_hand_sides.len() / dimension;
        let longest = self.fronts.fronts.iter().map(Front::below).max().unwrap_or(0);
        if self.permuted.len() < right_hand_sides.len() {
            self.permuted.resize(right_hand_sides.len(), 0.0);
            self.gathered.resize(longest * columns, 0.0);
        }
        let permuted = &mut self.permuted[..right_hand_sides.len()];
        for (column, given) in
            permuted.chunks_exact_mut(dimension).zip(right_hand_sides.chunks_exact(dimension))
        {
            for (value, &unknown) in column.iter_mut().zip(&self.fronts.unknowns) {
                *value = given[unknown as usize];
            }
        }

        for front in &self.fronts.fronts {
            let (pivots, rows) = parts(front, &self.factor);
            let gathered = &mut self.gathered[..front.below() * columns];
            let mut x = MatMut::from_column_major_slice_mut(permuted, dimension, columns);
            let mut own = x.as_mut().subrows_mut(front.first, front.width);
            solve_unit_lower_triangular_in_place(pivots, own.as_mut(), Par::Seq);
            let product = MatMut::from_column_major_slice_mut(gathered, front.below(), columns);
            matmul(product, Accum::Replace, rows, own.as_ref(), 1.0, Par::Seq);
            let below = &self.fronts.rows[front.rows.clone()];
            for (column, gathered) in
                permuted.chunks_exact_mut(dimension).zip(gathered.chunks_exact(below.len().max(1)))
            {
                for (&row, &value) in below.iter().zip(gathered) {
                    column[row as usize] -= value;
                }
            }
        }
        for front in self.fronts.fronts.iter().rev() {
            let (pivots, rows) = parts(front, &self.factor);
            let below = &self.fronts.rows[front.rows.clone()];
            let gathered = &mut self.gathered[..front.below() * columns];
            for (column, gathered) in
                permuted.chunks_exact(dimension).zip(gathered.chunks_exact_mut(below.len().max(1)))
            {
                for (&row, value) in below.iter().zip(gathered) {
                    *value = column[row as usize];
                }
            }
            for column in permuted.chunks_exact_mut(dimension) {
                for (at, value) in column[front.first..front.first + front.width].iter_mut().enumerate() {
                    *value /= pivots[(at, at)];
                }
            }
            let x = MatMut::from_column_major_slice_mut(permuted, dimension, columns);
            let mut own = x.subrows_mut(front.first, front.width);
            let gathered = MatRef::from_column_major_slice(gathered, front.below(), columns);
            matmul(own.as_mut(), Accum::Add, rows.transpose(), gathered, -1.0, Par::Seq);
            solve_unit_upper_triangular_in_place(pivots.transpose(), own, Par::Seq);
        }

        for (column, solved) in
            permuted.chunks_exact(dimension).zip(right_hand_sides.chunks_exact_mut(dimension))
        {
            for (&value, &unknown) in column.iter().zip(&self.fronts.unknowns) {
                solved[unknown as usize] = value;
            }
        }
    }
}

/// Unit lower triangle of the pivots with D on its diagonal, and L of the rows below.
fn parts<'a>(front: &Front, factor: &'a [f64]) -> (MatRef<'a, f64>, MatRef<'a, f64>) {
    MatRef::from_column_major_slice(&factor[front.panel.clone()], front.height, front.width)
        .split_at_row(front.width)
}
