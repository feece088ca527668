//! Strain and stress in the rubber, from the integration points.

use super::{
    body::Body,
    newton::SolidSolver,
    shape::{GAUSS, NODES, interpolation},
    state::SolidState,
};
use crate::material::Hyperelastic;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// A principal logarithmic strain and where it is, at an integration point of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainAt {
    /// ln of the principal stretch.
    pub log_strain: f64,
    /// Where it is in the undeformed body, m.
    pub reference: [f64; 3],
    /// Where it is now, m.
    pub position: [f64; 3],
}

/// Principal logarithmic strains of the rubber over its integration points.
///
/// Away from the caps means between 40 and 60 % of the undeformed length. At the edges of the caps and under fibres without width
/// the exact strain is unbounded, so that the extremes grow as the mesh is refined; means converge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strains {
    /// Greatest anywhere.
    pub greatest: StrainAt,
    /// Least (most compressive) anywhere.
    pub least: StrainAt,
    /// Greatest away from the caps.
    pub greatest_mid: StrainAt,
    /// Least away from the caps.
    pub least_mid: StrainAt,
    /// Averages of the three over the undeformed volume away from the caps, the greatest first.
    pub mean_mid: [f64; 3],
}

/// The rubber at an integration point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub element: usize,
    /// m.
    pub reference: [f64; 3],
    /// m.
    pub position: [f64; 3],
    /// Undeformed volume it stands for, m^3.
    pub weight: f64,
    /// J = det F.
    pub volume_ratio: f64,
    /// ln V, V^2 = F F^T.
    pub log_strain: Matrix3<f64>,
    /// sigma = P F^T/J, Pa.
    pub cauchy_stress: Matrix3<f64>,
}

/// Eigenvalues, the greatest first.
pub(super) fn principal(tensor: &Matrix3<f64>) -> [f64; 3] {
    let mut values: [f64; 3] = tensor.symmetric_eigenvalues().into();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// All integration points, 27 for each element: those of element e are number 27 e to 27 e + 26.
pub(super) fn points(body: &Body, state: &SolidState) -> Vec<Point> {
    let values: Vec<[f64; NODES]> =
        (0..NODES).map(|g| interpolation([g % 3, g / 3 % 3, g / 9].map(|i| GAUSS[i].0)).0).collect();
    let mut points = Vec::with_capacity(NODES * state.pressures.len());
    for (element, q) in state.pressures.iter().enumerate() {
        let (nodes, shape, law) = body.element(element);
        for (g, values) in values.iter().enumerate() {
            let sum = |factors: &[f64], of: &[[f64; 3]]| -> Vector3<f64> {
                factors.iter().zip(nodes).map(|(n, &node)| *n * Vector3::from(of[node as usize])).sum()
            };
            // The columns' frame is the element's own, turned about the tube's axis: V and sigma do not depend on it.
            let column = |l: usize| sum(&shape.slopes[(3 * g + l) * NODES..][..NODES], &state.positions);
            let f = Matrix3::from_columns(&[column(0), column(1), column(2)]);
            let volume_ratio = f.determinant();
            let pressure: f64 = shape.pressure[g].iter().zip(q).map(|(psi, q)| psi * q).sum();
            let stress = law.material.first_piola_kirchhoff_stress(&f) * f.transpose() / volume_ratio;
            let stretch = SymmetricEigen::new(f * f.transpose());
            let axes = stretch.eigenvectors;
            points.push(Point {
                element,
                reference: sum(values, &body.grid.points).into(),
                position: sum(values, &state.positions).into(),
                weight: shape.weights[g],
                volume_ratio,
                log_strain: axes
                    * Matrix3::from_diagonal(&stretch.eigenvalues.map(|square| 0.5 * square.ln()))
                    * axes.transpose(),
                cauchy_stress: stress + pressure * Matrix3::identity(),
            });
        }
    }
    points
}

/// Values of a tensor at all nodes from those at the integration points: in each element the triquadratic function through the 27
/// values, taken at the nodes, then averaged over the elements that meet in a node. Where tube and coat meet the two are
/// averaged, too.
pub(super) fn at_nodes(body: &Body, values: &[Matrix3<f64>]) -> Vec<Matrix3<f64>> {
    // The quadratics that are one at one Gauss point and zero at the others, at the nodes -1, 0, 1.
    let g = GAUSS[2].0;
    let quadratics = [-1.0f64, 0.0, 1.0].map(|x| {
        let outer = |sign: f64| 0.5 * x * (x + sign * g) / (g * g);
        [outer(-1.0), 1.0 - x * x / (g * g), outer(1.0)]
    });
    let mut sums = vec![(Matrix3::zeros(), 0.0); body.grid.points.len()];
    for (element, values) in values.chunks_exact(NODES).enumerate() {
        for (a, &node) in body.element(element).0.iter().enumerate() {
            let rows = [a % 3, a / 3 % 3, a / 9].map(|place| quadratics[place]);
            let factor = |g: usize| rows[0][g % 3] * rows[1][g / 3 % 3] * rows[2][g / 9];
            let (sum, count) = &mut sums[node as usize];
            *sum += values.iter().enumerate().map(|(g, value)| factor(g) * value).sum::<Matrix3<f64>>();
            *count += 1.0;
        }
    }
    // The first and the last line of a sector's mesh are one, turned.
    let last = |point: usize| body.grid.master(point).map(|master| (point, master));
    for (image, master) in (0..sums.len()).filter_map(last).collect::<Vec<_>>() {
        let turn = body.sector();
        let (sum, count) = sums[image];
        sums[master].0 += turn.transpose() * sum * turn;
        sums[master].1 += count;
        sums[image] = (turn * sums[master].0 * turn.transpose(), sums[master].1);
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

fn strains(body: &Body, state: &SolidState) -> Strains {
    let none = |log_strain| StrainAt { log_strain, reference: [0.0; 3], position: [0.0; 3] };
    let (low, high) = (none(f64::NEG_INFINITY), none(f64::INFINITY));
    let mut found =
        Strains { greatest: low, least: high, greatest_mid: low, least_mid: high, mean_mid: [0.0; 3] };
    let length = body.specimen.tube.length;
    let mut volume = 0.0;
    for point in points(body, state) {
        let values = principal(&point.log_strain);
        let at = |log_strain| StrainAt { log_strain, reference: point.reference, position: point.position };
        let keep = |greatest: &mut StrainAt, least: &mut StrainAt| {
            if values[0] > greatest.log_strain {
                *greatest = at(values[0]);
            }
            if values[2] < least.log_strain {
                *least = at(values[2]);
            }
        };
        keep(&mut found.greatest, &mut found.least);
        if (point.reference[2] / length - 0.5).abs() <= 0.1 {
            keep(&mut found.greatest_mid, &mut found.least_mid);
            volume += point.weight;
            found.mean_mid.iter_mut().zip(values).for_each(|(sum, value)| *sum += point.weight * value);
        }
    }
    found.mean_mid.iter_mut().for_each(|sum| *sum /= volume);
    found
}

impl SolidSolver {
    /// Principal logarithmic strains of the rubber in a state.
    pub fn strains(&self, state: &SolidState) -> Strains {
        strains(&self.body, state)
    }
}
