//! The elements' pressures: bounded below by the displacements on all meshes (inf-sup), and smooth where the load is.

use super::{problem::Problem, specimen};
use crate::{
    material::Rubber,
    solid::{SolidLoad, SolidMesh, SolidSolver, SolidState, element::ElementLaw, shape::NODES},
};
use actuator::Elastomer;
use nalgebra::{DMatrix, Vector3};

/// Least `sup_v (q, div v)/(|grad v| |q|)` over pressures q of no mean, of displacements that vanish on the boundary: the square root
/// of the second eigenvalue of `M^-1 B A^-1 B^T`.
fn inf_sup(n: usize, size: [f64; 3], distortion: f64) -> f64 {
    let material = Rubber::from(Elastomer::NeoHookean { shear_modulus: 1.0 });
    let block = Problem::shaken_box([n; 3], size, distortion, ElementLaw { material, bulk: 1.0 });
    let lines = 2 * n + 1;
    let mut unknown = vec![None; block.points.len()];
    let mut count = 0;
    for (p, unknown) in unknown.iter_mut().enumerate() {
        let inside =
            [p % lines, p / lines % lines, p / lines / lines].iter().all(|i| *i > 0 && i + 1 < lines);
        if inside {
            *unknown = Some(count);
            count += 1;
        }
    }
    let pressures = 4 * block.elements.len();
    let mut laplace = DMatrix::<f64>::zeros(count, count);
    let mut divergence = [0; 3].map(|_| DMatrix::<f64>::zeros(count, pressures));
    let mut mass = DMatrix::<f64>::zeros(pressures, pressures);
    for (e, (element, shape)) in block.elements.iter().zip(&block.shapes).enumerate() {
        for g in 0..NODES {
            let (weight, psi) = (shape.weights[g], shape.pressure[g]);
            let slope = |a: usize, i: usize| shape.slopes[(3 * g + i) * NODES + a];
            for p in 0..4 {
                (0..4).for_each(|r| mass[(4 * e + p, 4 * e + r)] += weight * psi[p] * psi[r]);
            }
            for a in 0..NODES {
                let Some(row) = unknown[element[a]] else { continue };
                for (i, divergence) in divergence.iter_mut().enumerate() {
                    (0..4).for_each(|p| divergence[(row, 4 * e + p)] += weight * psi[p] * slope(a, i));
                }
                for b in 0..NODES {
                    let Some(column) = unknown[element[b]] else { continue };
                    laplace[(row, column)] += weight * (0..3).map(|i| slope(a, i) * slope(b, i)).sum::<f64>();
                }
            }
        }
    }
    let laplace = laplace.cholesky().unwrap();
    let mut schur = DMatrix::<f64>::zeros(pressures, pressures);
    for divergence in &divergence {
        schur += divergence.transpose() * laplace.solve(divergence);
    }
    let lower = mass.cholesky().unwrap().l();
    let half = lower.solve_lower_triangular(&schur).unwrap();
    let scaled = lower.solve_lower_triangular(&half.transpose()).unwrap();
    let mut eigenvalues: Vec<f64> =
        (0.5 * (&scaled + scaled.transpose())).symmetric_eigenvalues().iter().copied().collect();
    eigenvalues.sort_by(f64::total_cmp);
    // The mean pressure does no work.
    assert!(eigenvalues[0].abs() < 1e-10);
    eigenvalues[1].max(0.0).sqrt()
}

#[test]
fn no_pressure_escapes_the_displacements() {
    for (size, distortion) in [([1.0, 1.0, 1.0], 0.0), ([1.0, 1.0, 1.0], 0.25), ([0.25, 1.0, 1.0], 0.0)] {
        let found = [2, 3, 4].map(|n| inf_sup(n, size, distortion));
        println!("inf-sup of {size:?}, distortion {distortion}: {found:.4?}");
        assert!(found[2] > 0.9 * found[1] && found[1] > 0.9 * found[0], "{found:?}");
        assert!(found[2] > 0.1, "{found:?}");
    }
}

/// Mean pressures of elements, by the mesh's places: along fastest.
fn means(solver: &SolidSolver, state: &SolidState, group: usize) -> Vec<Vec<f64>> {
    let [ni, nj, nk] = solver.body.grid.elements;
    let mut lines = vec![vec![0.0; nk / group]; nj / group];
    for (index, q) in state.pressures.iter().enumerate() {
        let (j, k) = (index / ni % nj, index / ni / nj);
        lines[j / group][k / group] += q[0] / (ni * group * group) as f64;
    }
    lines
}

#[test]
fn pressures_of_neighbours_do_not_alternate() {
    // A bare tube, K/mu = 10^4, bent by a force across while it is inflated.
    let specimen = specimen(0.02, &[], 1e4);
    let load = |share: f64| SolidLoad {
        pressure: 1e4 * share,
        force: Vector3::new(0.1 * share, 0.0, 0.0),
        ..SolidLoad::default()
    };
    let mesh = SolidMesh::new(8, 10);
    let [coarse, fine] = [1, 2].map(|factor| {
        let mut solver = SolidSolver::new(&specimen, mesh.refined(factor)).unwrap();
        let rest = solver.rest();
        let state = solver.follow(&rest, 0.0, &[1.0], &load, &mut |_, _| true).unwrap();
        means(&solver, &state, factor)
    });
    let all = fine.iter().flatten();
    let [low, high] =
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| [low.min(*q), high.max(*q)]);
    let range = high - low;
    // Second differences along and around, of the mesh and of the same regions of one twice as fine.
    let mut worst = [0.0f64; 2];
    let (around, along) = (coarse.len(), coarse[0].len());
    for j in 0..around {
        for k in 0..along {
            let on_ring = |lines: &[Vec<f64>]| {
                lines[(j + 1) % around][k] - 2.0 * lines[j][k] + lines[(j + around - 1) % around][k]
            };
            worst[0] = worst[0].max((on_ring(&coarse) - on_ring(&fine)).abs());
            // At the clamped ends the pressure has a singular edge that no mesh resolves.
            if k > 1 && k + 2 < along {
                let on_line = |lines: &[Vec<f64>]| lines[j][k + 1] - 2.0 * lines[j][k] + lines[j][k - 1];
                worst[1] = worst[1].max((on_line(&coarse) - on_line(&fine)).abs());
            }
        }
    }
    println!("pressures {low:.0} to {high:.0} Pa; second differences off by {worst:.0?} Pa around and along");
    assert!(worst[0] < 0.03 * range && worst[1] < 0.03 * range, "{worst:?} of {range}");
}
