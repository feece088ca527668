use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT::NonnegativeConeT,
    SupportedConeT::ZeroConeT,
};
use nalgebra::DMatrix;

/// A small dense quadratic program on Clarabel, whose solver and its symbolic factorisation are kept while the numbers change:
/// minimise `1/2 x'Px + q'x` with the first `equalities` rows of `A x = b` and the others `A x <= b`.
///
/// Equilibration is off: Clarabel computes it from the numbers of the first build and keeps it, so that answers would depend
/// on what was solved before. Callers scale their numbers to order one instead.
pub(crate) struct Program {
    variables: usize,
    equalities: usize,
    rows: usize,
    solver: Option<DefaultSolver<f64>>,
    upper_triangle: Vec<f64>,
    column_major: Vec<f64>,
    linear: Vec<f64>,
    right_hand_side: Vec<f64>,
}

impl Program {
    pub fn new(variables: usize, equalities: usize, rows: usize) -> Self {
        Program {
            variables,
            equalities,
            rows,
            solver: None,
            upper_triangle: Vec::with_capacity(variables * (variables + 1) / 2),
            column_major: Vec::with_capacity(variables * rows),
            linear: Vec::with_capacity(variables),
            right_hand_side: Vec::with_capacity(rows),
        }
    }

    pub fn shape(&self) -> (usize, usize, usize) {
        (self.variables, self.equalities, self.rows)
    }

    /// The minimiser to Clarabel's accuracy (about 1e-5 of the box), or `None` where Clarabel did not find it: the `x` of any
    /// other status may be a certificate of infeasibility and is not handed out.
    pub fn solve(&mut self, p: &DMatrix<f64>, q: &[f64], a: &DMatrix<f64>, b: &[f64]) -> Option<&[f64]> {
        let n = self.variables;
        self.upper_triangle.clear();
        for column in 0..n {
            self.upper_triangle.extend((0..=column).map(|row| p[(row, column)]));
        }
        self.column_major.clear();
        self.column_major.extend_from_slice(a.as_slice());
        self.linear.clear();
        self.linear.extend_from_slice(q);
        self.right_hand_side.clear();
        self.right_hand_side.extend_from_slice(b);
        let numbers = self.upper_triangle.iter().chain(q).chain(&self.column_major).chain(b);
        if numbers.into_iter().any(|value| !value.is_finite()) {
            return None;
        }
        match &mut self.solver {
            Some(solver) => {
                solver.update_P(&self.upper_triangle).ok()?;
                solver.update_q(&self.linear).ok()?;
                solver.update_A(&self.column_major).ok()?;
                solver.update_b(&self.right_hand_side).ok()?;
            }
            None => self.solver = Some(self.build()?),
        }
        let solver = self.solver.as_mut()?;
        solver.solve();
        let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        (solved && solver.solution.x.iter().all(|value| value.is_finite())).then_some(&solver.solution.x[..])
    }

    fn build(&self) -> Option<DefaultSolver<f64>> {
        let (n, rows) = (self.variables, self.rows);
        // Whole patterns, zeros included: an update may fill any entry.
        let p = CscMatrix::new(
            n,
            n,
            (0..=n).map(|column| column * (column + 1) / 2).collect(),
            (0..n).flat_map(|column| 0..=column).collect(),
            self.upper_triangle.clone(),
        );
        let a = CscMatrix::new(
            rows,
            n,
            (0..=n).map(|column| column * rows).collect(),
            (0..n).flat_map(|_| 0..rows).collect(),
            self.column_major.clone(),
        );
        let mut cones = Vec::with_capacity(2);
        if self.equalities > 0 {
            cones.push(ZeroConeT(self.equalities));
        }
        cones.push(NonnegativeConeT(rows - self.equalities));
        let settings = DefaultSettings {
            verbose: false,
            presolve_enable: false,
            input_sparse_dropzeros: false,
            equilibrate_enable: false,
            max_iter: 60,
            ..DefaultSettings::default()
        };
        DefaultSolver::new(&p, &self.linear, &a, &self.right_hand_side, &cones, settings).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    /// Nearest point of the box [-1, 1]^2 to (cx, cy).
    fn nearest(program: &mut Program, c: [f64; 2]) -> Option<Vec<f64>> {
        let a = dmatrix![1.0, 0.0; 0.0, 1.0; -1.0, 0.0; 0.0, -1.0];
        program.solve(&DMatrix::identity(2, 2), &[-c[0], -c[1]], &a, &[1.0; 4]).map(<[f64]>::to_vec)
    }

    #[test]
    fn an_updated_program_gives_the_bits_of_a_fresh_one() {
        let mut kept = Program::new(2, 0, 4);
        for c in [[0.3, 0.2], [5.0, -0.1], [1e3, 1e3], [-0.7, 4.0]] {
            let fresh = nearest(&mut Program::new(2, 0, 4), c).unwrap();
            assert_eq!(nearest(&mut kept, c).unwrap(), fresh);
            for (x, c) in fresh.iter().zip(c) {
                // Clarabel leaves up to 3e-5 of the box.
                assert!((x - c.clamp(-1.0, 1.0)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn equalities_hold() {
        let mut program = Program::new(2, 1, 3);
        let a = dmatrix![1.0, 1.0; 1.0, 0.0; 0.0, 1.0];
        let x = program.solve(&DMatrix::identity(2, 2), &[0.0, 0.0], &a, &[1.0, 0.2, 2.0]).unwrap();
        assert!((x[0] - 0.2).abs() < 1e-5 && (x[1] - 0.8).abs() < 1e-5, "{x:?}");
    }

    #[test]
    fn nothing_comes_out_of_an_empty_box_or_of_nan() {
        let mut program = Program::new(1, 0, 2);
        let a = dmatrix![1.0; -1.0];
        let p = DMatrix::identity(1, 1);
        assert!(program.solve(&p, &[0.0], &a, &[-1.0, -1.0]).is_none());
        assert!(program.solve(&p, &[f64::NAN], &a, &[1.0, 1.0]).is_none());
        assert!(program.solve(&p, &[0.0], &a, &[1.0, 1.0]).is_some());
    }
}
