//! Patches: what is homogeneous must come out so on any elements, or the elements converge to something else.

use super::{
    noise,
    problem::{Mode, Problem},
};
use crate::{
    material::{Hyperelastic, Rubber},
    solid::element::ElementLaw,
};
use actuator::{Elastomer, OgdenForm};
use nalgebra::{Matrix3, Vector3};

const SIZE: [f64; 3] = [2.0, 2.5, 1.5];

/// Shear modulus 1.
fn law(bulk: f64) -> ElementLaw {
    let elastomer = Elastomer::Ogden { shear_modulus: 1.0, alpha: 1.2, form: OgdenForm::InitialModulus };
    ElementLaw { material: Rubber::from(elastomer), bulk }
}

fn unit(point: usize, axis: usize) -> Mode {
    vec![(point, std::array::from_fn(|i| if i == axis { 1.0 } else { 0.0 }))]
}

fn on_face(x: f64, size: f64) -> bool {
    x == 0.0 || (x - size).abs() < 1e-12
}

#[test]
fn affine_boundaries_give_affine_insides() {
    let shape = Matrix3::new(1.3, 0.2, -0.1, 0.1, 0.8, 0.15, -0.2, 0.1, 1.1);
    for distortion in [0.0, 0.25] {
        for (bulk, volume_ratio) in [(3.0, 1.2), (1e4, 1.0005)] {
            let f = shape * f64::cbrt(volume_ratio / shape.determinant());
            let patch = Problem::shaken_box([2, 2, 2], SIZE, distortion, law(bulk));
            let affine: Vec<[f64; 3]> = patch.points.iter().map(|x| (f * Vector3::from(*x)).into()).collect();
            let inside = |p: usize| (0..3).all(|i| !on_face(patch.points[p][i], SIZE[i]));
            let points: Vec<usize> = (0..affine.len()).filter(|&p| inside(p)).collect();
            assert_eq!(points.len(), 27);
            let modes: Vec<Mode> = points.iter().flat_map(|&p| [0, 1, 2].map(|axis| unit(p, axis))).collect();
            let mut x = affine.clone();
            for &p in &points {
                (0..3).for_each(|i| x[p][i] += 0.03 * noise(5000 + 3 * p + i));
            }
            let mut q = vec![[0.0; 4]; patch.elements.len()];
            let left = patch.equilibrate(&modes, &mut x, &mut q);
            assert!(left < 1e-11 * bulk, "{left}");
            for (x, affine) in x.iter().zip(&affine) {
                let error = (Vector3::from(*x) - Vector3::from(*affine)).amax();
                assert!(error < 1e-10, "distortion {distortion}, bulk {bulk}: {error}");
            }
            let expected = bulk * (volume_ratio - 1.0);
            for q in q {
                let error = (q[0] - expected).abs().max(q[1].abs()).max(q[2].abs()).max(q[3].abs());
                assert!(error < 1e-10 * bulk, "distortion {distortion}, bulk {bulk}: {error}");
            }
        }
    }
}

/// Lateral stretch of a bar that is stretched by `axial` with free sides, and its pressure q.
fn uniaxial(law: &ElementLaw, axial: f64) -> (f64, f64) {
    let lateral_stress = |lateral: f64| {
        let f = Matrix3::from_diagonal(&Vector3::new(lateral, lateral, axial));
        let q = law.bulk * (f.determinant() - 1.0);
        (law.material.first_piola_kirchhoff_stress(&f)[(0, 0)] + q * lateral * axial, q)
    };
    let (mut low, mut high) = (0.5, 1.5);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if lateral_stress(middle).0 < 0.0 { low = middle } else { high = middle }
    }
    (low, lateral_stress(low).1)
}

#[test]
fn a_bar_with_free_sides_has_one_pressure() {
    for bulk in [3.0, 1e4] {
        let patch = Problem::shaken_box([2, 2, 2], SIZE, 0.25, law(bulk));
        let axial = 1.4;
        let (lateral, pressure) = uniaxial(&patch.law, axial);
        let exact = |x: &[f64; 3]| [lateral * x[0], lateral * x[1], axial * x[2]];
        // Three faces slide, the one at the end is moved, two sides are free.
        let mut modes = vec![];
        let mut x: Vec<[f64; 3]> = patch.points.iter().map(exact).collect();
        for (p, at) in patch.points.iter().enumerate() {
            for i in 0..3 {
                let held = at[i] == 0.0 || i == 2 && on_face(at[i], SIZE[i]);
                if !held {
                    modes.push(unit(p, i));
                    x[p][i] += 0.02 * noise(7000 + 3 * p + i);
                }
            }
        }
        let mut q = vec![[0.0; 4]; patch.elements.len()];
        patch.equilibrate(&modes, &mut x, &mut q);
        for (x, at) in x.iter().zip(&patch.points) {
            let error = (Vector3::from(*x) - Vector3::from(exact(at))).amax();
            assert!(error < 1e-10, "bulk {bulk}: {error}");
        }
        for q in q {
            let error = (q[0] - pressure).abs().max(q[1].abs()).max(q[2].abs()).max(q[3].abs());
            assert!(error < 1e-10 * bulk.max(1.0), "bulk {bulk}: {q:?} instead of {pressure}");
        }
    }
}
