use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::super::{BlockPattern, FactorError, Factorisation, Inertia};
use super::{assemble, mixed, noise};

/// A matrix of one block, its values column by column.
fn one_block(size: u8) -> BlockPattern {
    BlockPattern::new(&[size], std::iter::empty())
}

fn negative_eigenvalues(dense: &DMatrix<f64>) -> usize {
    SymmetricEigen::new(dense.clone()).eigenvalues.iter().filter(|&&value| value < 0.0).count()
}

#[test]
fn solves_as_the_dense_matrix_for_several_right_hand_sides_and_matrices() {
    let (pattern, cliques) = mixed(160);
    let n = pattern.dimension();
    let mut factorisation = Factorisation::new(&pattern, &[]);
    let mut noise = noise(5);
    // The same analysis, other values: the second indefinite, more and then fewer right-hand sides.
    for (seed, shift, columns) in [(1, 8.0, 1), (2, 0.9, 5), (3, 8.0, 2)] {
        let (values, dense) = assemble(&pattern, &cliques, seed, shift);
        let inertia = factorisation.factorise(&values).unwrap();
        assert_eq!(inertia.negative, negative_eigenvalues(&dense));
        assert_eq!((inertia.zero, inertia.negative + inertia.positive), (0, n));
        let right = DMatrix::from_fn(n, columns, |_, _| noise());
        let mut found = right.clone();
        factorisation.solve(found.as_mut_slice());
        let expected = dense.clone().lu().solve(&right).unwrap();
        // The indefinite one is conditioned a thousand times worse.
        let tolerance = if shift > 1.0 { 1e-13 } else { 1e-9 };
        assert!((found - &expected).amax() < tolerance * expected.amax());
    }
}

#[test]
fn inertia_counts_the_negative_eigenvalues_of_shifted_matrices() {
    let (pattern, cliques) = mixed(90);
    let mut factorisation = Factorisation::new(&pattern, &[]);
    let mut counts = Vec::new();
    for shift in [-3.0, -1.0, -0.35, 0.35, 1.0, 3.0] {
        let (values, dense) = assemble(&pattern, &cliques, 11, shift);
        let inertia = factorisation.factorise(&values).unwrap();
        assert_eq!(inertia.negative, negative_eigenvalues(&dense), "shift {shift}");
        counts.push(inertia.negative);
    }
    assert!(
        counts[0] == pattern.dimension() && counts[5] == 0 && counts[1..5].iter().all(|&count| count > 10)
    );
}

#[test]
fn any_order_of_elimination_gives_the_same_solution() {
    let (pattern, cliques) = mixed(60);
    let (values, dense) = assemble(&pattern, &cliques, 4, 6.0);
    let n = pattern.dimension();
    let right = DVector::from_fn(n, |i, _| (i as f64).sin());
    let expected = dense.lu().solve(&right).unwrap();
    let natural: Vec<u32> = (0..60).collect();
    let backwards: Vec<u32> = (0..60).rev().collect();
    let stride: Vec<u32> = (0..60).map(|k| k * 7 % 60).collect();
    for order in [natural, backwards, stride] {
        let mut factorisation = Factorisation::in_order(&pattern, &order);
        assert_eq!(factorisation.factorise(&values).unwrap().positive, n);
        let mut found = right.clone();
        factorisation.solve(found.as_mut_slice());
        assert!((found - &expected).amax() < 1e-13 * expected.amax());
    }
}

#[test]
fn a_saddle_point_is_refused_and_not_solved_into_nan() {
    let mut factorisation = Factorisation::new(&one_block(2), &[]);
    let error = factorisation.factorise(&[0.0, 1.0, 1.0, 0.0]).unwrap_err();
    assert_eq!(error, FactorError::NoPivot { unknown: 0 });
    // The same with its zero met later, in another block: K = [[1, 1, 0], [1, 1, 1], [0, 1, 1]].
    let pattern = BlockPattern::new(&[1, 1, 1], [&[0_u32, 1][..], &[1, 2][..]].into_iter());
    let values = [1.0, 1.0, 1.0, 1.0, 1.0];
    let mut factorisation = Factorisation::in_order(&pattern, &[0, 1, 2]);
    assert_eq!(factorisation.factorise(&values).unwrap_err(), FactorError::NoPivot { unknown: 1 });
    // Zeros on the diagonal are taken where elimination fills them: eigenvalues of [[1, 1], [1, 0]] are of both signs.
    let mut factorisation = Factorisation::new(&one_block(2), &[]);
    let inertia = factorisation.factorise(&[1.0, 1.0, f64::NAN, 0.0]).unwrap();
    assert_eq!(inertia, Inertia { negative: 1, zero: 0, positive: 1 });
}

#[test]
fn a_singular_matrix_has_a_zero_pivot_or_none() {
    // A chain of springs without support. With whole numbers the last pivot is exactly zero, else rounding of either sign.
    let (pattern, mut values) = super::modes::chain(50, 0.0, 0.0);
    let mut factorisation = Factorisation::new(&pattern, &[]);
    let error = factorisation.factorise(&values).unwrap_err();
    assert!(matches!(error, FactorError::NoPivot { .. }));
    values.fill(0.0);
    let mut noise = noise(8);
    for k in 1..50_u32 {
        let stiffness = 1.0 + noise();
        values[pattern.place(k - 1, k - 1).index(0, 0)] += stiffness;
        values[pattern.place(k, k).index(0, 0)] += stiffness;
        values[pattern.place(k, k - 1).index(0, 0)] -= stiffness;
    }
    let inertia = factorisation.factorise(&values).unwrap();
    assert_eq!(inertia, Inertia { negative: 0, zero: 1, positive: 49 });
}

#[test]
fn what_is_not_finite_is_named_and_the_next_matrix_is_taken() {
    let (pattern, cliques) = mixed(40);
    let (values, dense) = assemble(&pattern, &cliques, 9, 6.0);
    let mut factorisation = Factorisation::new(&pattern, &[]);
    let (a, b) = (cliques[10][0], cliques[10][1]);
    for (index, poison) in [
        (pattern.place(a, a).index(0, 0), f64::NAN),
        (pattern.place(a, b).index(0, 0), f64::INFINITY),
        (pattern.place(b, a).index(0, 0), f64::NAN),
    ] {
        let mut poisoned = values.clone();
        poisoned[index] = poison;
        let error = factorisation.factorise(&poisoned).unwrap_err();
        let FactorError::NotFinite { index: found, value, .. } = error else { panic!("{error}") };
        assert_eq!((found, value.to_bits()), (index, poison.to_bits()));
    }
    factorisation.factorise(&values).unwrap();
    let mut found = DVector::from_element(pattern.dimension(), 1.0);
    factorisation.solve(found.as_mut_slice());
    assert!((dense * found).add_scalar(-1.0).amax() < 1e-13);
}

#[test]
#[should_panic(expected = "no factorisation to solve with")]
fn a_failed_factorisation_does_not_solve() {
    let mut factorisation = Factorisation::new(&one_block(1), &[]);
    factorisation.factorise(&[2.0]).unwrap();
    factorisation.factorise(&[0.0]).unwrap_err();
    factorisation.solve(&mut [1.0]);
}

#[test]
fn nothing_is_a_matrix_too() {
    let mut factorisation = Factorisation::new(&BlockPattern::new(&[], std::iter::empty()), &[]);
    assert_eq!(factorisation.factorise(&[]).unwrap(), Inertia { negative: 0, zero: 0, positive: 0 });
    factorisation.solve(&mut []);
}
