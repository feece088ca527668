use super::{kinematics::Point, mesh::Grid};
use nalgebra::{Matrix3, Vector3};

/// Bulk modulus over the rubber's mu. The answer differs from that of an incompressible wall by about pressure/bulk modulus,
/// a few 1e-6 in stretch, while the equations keep ten digits.
pub(crate) const BULK_RATIO: f64 = 1e5;

/// Abscissas and weights of Gauss's rule of three points on (-1, 1).
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// A nine-node quadrilateral with a linear pressure of its own.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub nodes: [usize; 9],
    pub points: Vec<Point>,
    /// Points on the bore, for elements that touch it.
    pub bore: Vec<Point>,
    /// Points on the outer surface, for elements that touch it.
    pub surface: Vec<Point>,
    /// Whether the surface lies under a fibre.
    pub under_fibre: bool,
    /// Reference volume.
    pub volume: f64,
    /// M_ab, the integral of the products of the pressure functions.
    pub mass: Matrix3<f64>,
    /// Bulk modulus times the inverse of M.
    pub bulk: Matrix3<f64>,
}

fn lagrange(at: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * at * (at - 1.0), 1.0 - at * at, 0.5 * at * (at + 1.0)], [at - 0.5, -2.0 * at, at + 0.5])
}

/// Shape functions at local coordinates (around, through) in -1..1 of the element between the given lines of nodes.
fn point(angles: &[f64], radii: &[f64], around: f64, through: f64, weight: f64) -> Point {
    let (half_angle, half_width) = (0.5 * (angles[2] - angles[0]), 0.5 * (radii[2] - radii[0]));
    let ((na, da), (nr, dr)) = (lagrange(around), lagrange(through));
    let each = |f: &dyn Fn(usize, usize) -> f64| std::array::from_fn(|node| f(node / 3, node % 3));
    Point {
        radius: radii[1] + half_width * through,
        weight,
        values: each(&|i, j| na[i] * nr[j]),
        by_radius: each(&|i, j| na[i] * dr[j] / half_width),
        by_angle: each(&|i, j| da[i] * nr[j] / half_angle),
        linear: [1.0, around, through],
    }
}

impl Element {
    pub fn new(grid: &Grid, i: usize, j: usize, unique: impl Fn(usize) -> usize) -> Self {
        let angles = &grid.angles[2 * i..2 * i + 3];
        let radii = &grid.radii[2 * j..2 * j + 3];
        let (half_angle, half_width) = (0.5 * (angles[2] - angles[0]), 0.5 * (radii[2] - radii[0]));
        let mut points = Vec::with_capacity(9);
        for (around, wa) in GAUSS {
            for (through, wt) in GAUSS {
                let mut point = point(angles, radii, around, through, 0.0);
                point.weight = grid.pieces * wa * half_angle * wt * half_width * point.radius;
                points.push(point);
            }
        }
        let edge = |through: f64, touches: bool| -> Vec<Point> {
            let points =
                GAUSS.iter().map(|&(a, w)| point(angles, radii, a, through, grid.pieces * w * half_angle));
            if touches { points.collect() } else { Vec::new() }
        };
        let mass = points.iter().fold(Matrix3::zeros(), |sum, point| {
            let n = Vector3::from(point.linear);
            sum + point.weight * n * n.transpose()
        });
        Element {
            nodes: std::array::from_fn(|n| unique(grid.node(2 * i + n / 3, 2 * j + n % 3))),
            bore: edge(-1.0, j == 0),
            surface: edge(1.0, j + 1 == grid.elements_through()),
            under_fibre: grid.under_fibre[i],
            volume: mass[(0, 0)],
            mass,
            // The mass is positive definite: a Gram matrix of independent functions.
            bulk: BULK_RATIO * mass.try_inverse().unwrap_or_default(),
            points,
        }
    }
}
