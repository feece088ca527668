//! The joined system against the same system put together in one piece.

use super::*;
use crate::{
    solid_module::{SolidShape, equations::Loads},
    tip_plate::swing,
};
use nalgebra::{DMatrix, Matrix6, Vector3, Vector6};

#[test]
fn negative_eigenvalues_are_those_of_the_whole_system_at_once() {
    let mut pair = unlike_pair();
    pair.base.gravity = [0.0; 3];
    for placed in &mut pair.frees {
        placed.free = free(60.0, Handedness::Right, 0);
    }
    let mut joined = solids(&pair, [1, 4, 3]);
    let mut shape = joined.rest().unwrap().shape;
    let mut counts = vec![];
    // Pressed together, the tubes give way: first the plate sways, then each of them.
    for height in [30e-3, 27e-3, 24e-3, 21e-3, 18e-3] {
        let mut chart = shape.chart();
        chart.position[2] = height;
        shape = joined.hold(&shape, &chart, &[0.0; 2]).unwrap().shape;
        let loads = Loads {
            pressures: vec![0.0; 2],
            part: 1.0,
            payload: 0.0,
            free: [true; 6],
            held: Vector6::zeros(),
        };
        let sums = joined.assemble(&shape, &loads, true).unwrap();
        // All unknowns: the insides of the two, then the plate's coordinates.
        let inside: Vec<usize> = joined.frees.iter().map(|free| free.solver.unknowns() - 6).collect();
        let dimension = inside.iter().sum::<usize>() + 6;
        let mut whole = DMatrix::<f64>::zeros(dimension, dimension);
        let (mut stiffness, mut pull) = (Matrix6::zeros(), Vector6::zeros());
        let mut first = 0;
        for ((free, cap), count) in joined.frees.iter().zip(&sums.caps).zip(&inside) {
            let tangent = free.solver.dense_tangent();
            let lever = free.lever(1.0);
            let force: Vector3<f64> = cap.residual.fixed_rows::<3>(0).into();
            let on_cap: Matrix6<f64> = tangent.fixed_view::<6, 6>(*count, *count).into();
            stiffness += lever.transpose() * (on_cap + swing(&force)) * lever;
            pull += lever.transpose() * cap.residual;
            whole
                .view_mut((first, first), (*count, *count))
                .copy_from(&tangent.view((0, 0), (*count, *count)));
            let coupled = tangent.view((0, *count), (*count, 6)) * (lever * sums.variation.first);
            whole.view_mut((first, dimension - 6), (*count, 6)).copy_from(&coupled);
            whole.view_mut((dimension - 6, first), (6, *count)).copy_from(&coupled.transpose());
            first += count;
        }
        let hessian = shape.plate.vary().hessian(&pull, &stiffness);
        whole.view_mut((first, first), (6, 6)).copy_from(&hessian);
        joined.factorise(&shape, &loads, &sums).unwrap();
        let negative = whole.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
        assert_eq!(joined.tangent.as_ref().unwrap().negative as usize, negative, "{height}");
        counts.push(negative);
        let levers: Vec<Matrix6<f64>> =
            joined.frees.iter().map(|free| free.lever(1.0) * sums.variation.first).collect();
        let root: Vec<f64> =
            joined.metric(&shape, &levers, [true; 6]).iter().map(|weight| weight.sqrt()).collect();
        the_softest_modes_are(&mut joined, &shape, &whole, &root);
    }
    assert!(
        counts[0] == 0 && counts[4] > 2 && counts.iter().any(|count| (1..=2).contains(count)),
        "{counts:?}"
    );
}

/// Modes against all eigenvectors of M^-1/2 K M^-1/2, root = M^1/2.
fn the_softest_modes_are(joined: &mut SolidModule, shape: &SolidShape, whole: &DMatrix<f64>, root: &[f64]) {
    let dimension = root.len();
    let scaled = DMatrix::from_fn(dimension, dimension, |i, j| whole[(i, j)] / (root[i] * root[j]));
    let eigen = scaled.symmetric_eigen();
    let mut order: Vec<usize> = (0..dimension).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let modes = joined.softest_modes(shape, 3).unwrap();
    for (mode, index) in modes.iter().zip(&order) {
        let value = eigen.eigenvalues[*index];
        // The joined system's own rounding, of the stiffest against the softest.
        assert!((mode.value - value).abs() < 1e-6 * value.abs(), "{} {value}", mode.value);
    }
    // Of the first, where it is not one of several alike, how it moves the inside of the first FREE.
    let [first, second] = [0, 1].map(|place| eigen.eigenvalues[order[place]]);
    if (first - second).abs() < 1e-3 * first.abs() {
        return;
    }
    let vector = eigen.eigenvectors.column(order[0]);
    let inside = joined.frees[0].solver.unknowns() - 6;
    let mut own: Vec<f64> = (0..inside).map(|i| vector[i] / root[i]).collect();
    let plate = Vector6::from_fn(|i, _| vector[dimension - 6 + i] / root[dimension - 6 + i]);
    own.extend((joined.frees[0].lever(1.0) * shape.plate.vary().first * plate).iter());
    let expected = joined.frees[0].solver.displacements(&shape.frees[0], &own);
    let (a, b) = (modes[0].displacements[0].as_flattened(), expected.as_flattened());
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let cosine = dot(a, b) / (dot(a, a) * dot(b, b)).sqrt();
    assert!(1.0 - cosine.abs() < 1e-9, "{cosine}");
}
