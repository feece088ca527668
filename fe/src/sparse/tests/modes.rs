use std::f64::consts::PI;

use super::super::{BlockPattern, Factorisation, Mode, lowest_modes};

/// Springs of stiffness 1 between `n` points, the first held by a spring too, and springs of stiffness `ground` at each.
pub(super) fn chain(n: usize, held: f64, ground: f64) -> (BlockPattern, Vec<f64>) {
    let pairs: Vec<[u32; 2]> = (1..n as u32).map(|k| [k - 1, k]).collect();
    let pattern = BlockPattern::new(&vec![1; n], pairs.iter().map(|pair| &pair[..]));
    let mut values = vec![0.0; pattern.len()];
    for &[a, b] in &pairs {
        values[pattern.place(a, a).index(0, 0)] += 1.0;
        values[pattern.place(b, b).index(0, 0)] += 1.0;
        values[pattern.place(b, a).index(0, 0)] -= 1.0;
    }
    values[pattern.place(0, 0).index(0, 0)] += held;
    for k in 0..n as u32 {
        values[pattern.place(k, k).index(0, 0)] += ground;
    }
    (pattern, values)
}

#[test]
fn fixed_free_chain_has_its_closed_form_modes() {
    // K v = value v with value_k = 4 sin^2((2 k - 1) pi / (2 (2 n + 1))), v_j ~ sin((2 k - 1) j pi / (2 n + 1)).
    let n = 300;
    let (pattern, values) = chain(n, 1.0, 0.0);
    let mut factorisation = Factorisation::new(&pattern, &[]);
    assert_eq!(factorisation.factorise(&values).unwrap().positive, n);
    let modes = lowest_modes(&mut factorisation, 5, None);
    assert_eq!(modes.len(), 5);
    for (k, mode) in modes.iter().enumerate() {
        let wave = (2 * k + 1) as f64 * PI / (2 * n + 1) as f64;
        let expected = 4.0 * (wave / 2.0).sin().powi(2);
        assert!((mode.value / expected - 1.0).abs() < 1e-9, "{} {expected}", mode.value);
        let shape: Vec<f64> = (1..=n).map(|j| (wave * j as f64).sin()).collect();
        let length = shape.iter().map(|x| x * x).sum::<f64>().sqrt();
        let along: f64 = shape.iter().zip(&mode.vector).map(|(a, b)| a * b / length).sum();
        assert!((along.abs() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn modes_of_both_signs_come_by_magnitude_and_agree_with_inertia() {
    // The same chain, each eigenvalue lowered: those below the shift are negative.
    let n = 120;
    let eigenvalue = |k: usize| 4.0 * ((2 * k + 1) as f64 * PI / (2 * (2 * n + 1)) as f64).sin().powi(2);
    let shift = 0.5 * (eigenvalue(2) + eigenvalue(3)) + 0.1 * (eigenvalue(3) - eigenvalue(2));
    let (pattern, values) = chain(n, 1.0, -shift);
    let mut factorisation = Factorisation::new(&pattern, &[]);
    assert_eq!(factorisation.factorise(&values).unwrap().negative, 3);
    let mut expected: Vec<f64> = (0..n).map(|k| eigenvalue(k) - shift).collect();
    expected.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let modes = lowest_modes(&mut factorisation, 4, None);
    assert!(modes[0].value > 0.0 && modes[1].value < 0.0);
    for (mode, expected) in modes.iter().zip(expected) {
        assert!((mode.value - expected).abs() < 1e-9 * expected.abs(), "{} {expected}", mode.value);
        assert!(mode.error < 1e-9);
    }
}

#[test]
fn double_eigenvalues_come_twice() {
    // Two chains that do not touch, with values repeated exactly, as the bending of a tube about two axes.
    let n = 80;
    let pairs: Vec<[u32; 2]> = (1..n).flat_map(|k| [[k - 1, k], [n + k - 1, n + k]]).collect();
    let pattern = BlockPattern::new(&vec![1; 2 * n as usize], pairs.iter().map(|pair| &pair[..]));
    let (single, chain_values) = chain(n as usize, 1.0, 0.0);
    let mut values = vec![0.0; pattern.len()];
    for first in [0, n] {
        for k in 0..n {
            let from = single.place(k, k).index(0, 0);
            values[pattern.place(first + k, first + k).index(0, 0)] = chain_values[from];
            if k > 0 {
                values[pattern.place(first + k, first + k - 1).index(0, 0)] = -1.0;
            }
        }
    }
    let mut factorisation = Factorisation::new(&pattern, &[]);
    factorisation.factorise(&values).unwrap();
    let modes = lowest_modes(&mut factorisation, 4, None);
    for pair in modes.chunks(2) {
        assert!((pair[0].value / pair[1].value - 1.0).abs() < 1e-9);
        let along: f64 = pair[0].vector.iter().zip(&pair[1].vector).map(|(a, b)| a * b).sum();
        assert!(along.abs() < 1e-9);
    }
    assert!(modes[2].value / modes[1].value > 8.0);
}

#[test]
fn a_metric_gives_the_generalised_problem() {
    let n = 60;
    let (pattern, values) = chain(n, 1.0, 0.0);
    let metric: Vec<f64> = (0..n).map(|k| 1.0 + (k % 3) as f64).collect();
    let mut factorisation = Factorisation::new(&pattern, &[]);
    factorisation.factorise(&values).unwrap();
    for mode in lowest_modes(&mut factorisation, 3, Some(&metric)) {
        let mut product = vec![0.0; n];
        pattern.multiply_into(&values, &mode.vector, &mut product);
        for ((k_v, v), m) in product.iter().zip(&mode.vector).zip(&metric) {
            assert!((k_v - mode.value * m * v).abs() < 1e-9 * mode.value);
        }
        let length: f64 = mode.vector.iter().zip(&metric).map(|(v, m)| m * v * v).sum();
        assert!((length - 1.0).abs() < 1e-12);
    }
}

#[test]
fn no_more_modes_than_unknowns() {
    let (pattern, values) = chain(2, 1.0, 0.0);
    let mut factorisation = Factorisation::new(&pattern, &[]);
    factorisation.factorise(&values).unwrap();
    let modes: Vec<Mode> = lowest_modes(&mut factorisation, 7, None);
    // (3 -+ sqrt 5) / 2.
    assert_eq!(modes.len(), 2);
    assert!((modes[0].value - 0.5 * (3.0 - 5.0_f64.sqrt())).abs() < 1e-14);
    assert!((modes[1].value - 0.5 * (3.0 + 5.0_f64.sqrt())).abs() < 1e-14);
}
