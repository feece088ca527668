use crate::material::Rubber;
use crate::solid::element::{Condensation, ElementLaw, UNKNOWNS, Workspace};
use crate::solid::shape::{NODES, Shape};
use actuator::{Elastomer, OgdenForm};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// A number in [-1, 1) that depends on nothing but `index`.
fn noise(index: usize) -> f64 {
    let mut state = index as u64 + 17;
    2.0 * crate::free_map::next_fraction(&mut state) - 1.0
}

fn law() -> ElementLaw {
    let elastomer = Elastomer::Ogden { shear_modulus: 1.3, alpha: 1.2, form: OgdenForm::InitialModulus };
    ElementLaw { material: Rubber::from(elastomer), bulk: 50.0 }
}

/// Nodes of a cube of edge 2, moved about by `distortion`; the middle nodes too.
fn distorted(distortion: f64) -> [[f64; 3]; NODES] {
    std::array::from_fn(|a| {
        std::array::from_fn(|i| [a % 3, a / 3 % 3, a / 9][i] as f64 + distortion * noise(3 * a + i))
    })
}

fn flattened(nodes: &[[f64; 3]; NODES]) -> [f64; UNKNOWNS] {
    std::array::from_fn(|q| nodes[q % NODES][q / NODES])
}

fn deformed(nodes: &[[f64; 3]; NODES], roughness: f64) -> [f64; UNKNOWNS] {
    let f = Matrix3::new(1.2, 0.1, -0.2, 0.3, 0.9, 0.1, 0.0, -0.1, 1.1);
    let turn = Rotation3::from_euler_angles(0.4, -1.0, 2.0);
    flattened(&std::array::from_fn(|a| {
        let x = turn * f * Vector3::from(nodes[a]);
        std::array::from_fn(|i| x[i] + roughness * noise(1000 + 3 * a + i))
    }))
}

#[test]
fn residual_and_tangent_are_derivatives() {
    let (law, nodes) = (law(), distorted(0.08));
    let shape = Shape::new(&nodes, 0).unwrap();
    let x = deformed(&nodes, 0.05);
    let q = [0.7, 0.2, -0.3, 0.1];
    let mut work = Workspace::default();
    let mut condensation = Condensation::default();
    let at = |work: &mut Workspace, x: &[f64; UNKNOWNS], q: &[f64; 4], condensation: &mut Condensation| {
        work.evaluate(&law, &shape, x, q, condensation, true).unwrap()
    };
    at(&mut work, &x, &q, &mut condensation);
    let base = (work.clone(), condensation.clone());
    let h = 1e-5;
    let scale = base.0.residual.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    // The condensed tangent is d/dx of the condensed residual when the pressure follows its linearised equation.
    for column in 0..UNKNOWNS {
        let mut energies = [0.0; 2];
        let mut residuals = [[0.0; UNKNOWNS]; 2];
        for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
            let mut moved = x;
            moved[column] += sign * h;
            energies[side] = at(&mut work, &moved, &q, &mut condensation);
            let mut step = [0.0; UNKNOWNS];
            step[column] = sign * h;
            let dq = base.1.pressure_step(&law, &shape, &step, false);
            let follow = std::array::from_fn(|p| q[p] + dq[p]);
            at(&mut work, &moved, &follow, &mut condensation);
            residuals[side] = work.residual;
        }
        let slope = (energies[0] - energies[1]) / (2.0 * h);
        assert!((slope - base.0.residual[column]).abs() < 1e-8 * scale, "{column}");
        for (row, (plus, minus)) in residuals[0].iter().zip(residuals[1]).enumerate() {
            let slope = (plus - minus) / (2.0 * h);
            let entry = base.0.block(row % NODES, column % NODES)[(row / NODES, column / NODES)];
            assert!(
                (slope - entry).abs() < 2e-7 * scale / h * 1e-5 + 1e-7 * 50.0,
                "{row} {column}: {slope} {entry}"
            );
        }
    }
}

#[test]
fn mismatch_is_the_derivative_by_the_pressure() {
    let (law, nodes) = (law(), distorted(0.08));
    let shape = Shape::new(&nodes, 0).unwrap();
    let x = deformed(&nodes, 0.05);
    let q = [0.7, 0.2, -0.3, 0.1];
    let (mut work, mut condensation) = (Workspace::default(), Condensation::default());
    work.evaluate(&law, &shape, &x, &q, &mut condensation, false).unwrap();
    let mismatch = condensation.mismatch;
    for p in 0..4 {
        let energy = [1.0, -1.0].map(|sign| {
            let mut q = q;
            q[p] += sign * 0.5;
            work.evaluate(&law, &shape, &x, &q, &mut condensation, false).unwrap()
        });
        assert!((energy[0] - energy[1] - mismatch[p]).abs() < 1e-12, "{p}");
    }
}

#[test]
fn a_turned_element_has_turned_forces() {
    let (law, nodes) = (law(), distorted(0.1));
    let shape = Shape::new(&nodes, 0).unwrap();
    let x = deformed(&nodes, 0.05);
    let q = [0.3, 0.0, 0.1, -0.2];
    let turn = Rotation3::from_euler_angles(2.0, 1.0, -3.0);
    let turned: [f64; UNKNOWNS] = {
        let turned: [[f64; 3]; NODES] = std::array::from_fn(|a| {
            (turn * Vector3::new(x[a], x[NODES + a], x[2 * NODES + a]) + Vector3::new(5.0, 6.0, -7.0)).into()
        });
        flattened(&turned)
    };
    let (mut work, mut condensation) = (Workspace::default(), Condensation::default());
    let energy = work.evaluate(&law, &shape, &x, &q, &mut condensation, true).unwrap();
    let still = work.clone();
    let same = work.evaluate(&law, &shape, &turned, &q, &mut condensation, true).unwrap();
    assert!((energy - same).abs() < 1e-12 * energy.abs());
    for a in 0..NODES {
        let at = |work: &Workspace| Vector3::from_fn(|i, _| work.residual[i * NODES + a]);
        assert!((turn * at(&still) - at(&work)).norm() < 1e-11, "{a}");
        for b in 0..NODES {
            let block = |work: &Workspace| work.block(a, b);
            let expected = turn * block(&still) * turn.transpose();
            assert!((expected - block(&work)).norm() < 1e-10, "{a} {b}");
        }
    }
}

#[test]
fn a_flat_or_inverted_element_is_refused() {
    let mut nodes = distorted(0.0);
    for node in &mut nodes {
        node[2] = 0.0;
    }
    assert!(Shape::new(&nodes, 3).is_err());
    let mirrored = distorted(0.0).map(|[x, y, z]| [-x, y, z]);
    let error = Shape::new(&mirrored, 7).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.contains("element 7") && error.contains("more elements"), "{error}");
}
