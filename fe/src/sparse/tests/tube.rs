use nalgebra::{Matrix3, SMatrix, Vector3};

use super::BlockPattern;

/// Unknowns of an element of 27 nodes.
type Stiffness = SMatrix<f64, 81, 81>;

/// A tube of 27-node hexahedra in small strain, held at z = 0, with a rigid cap of six unknowns at its other end.
pub(crate) struct Tube {
    pub elements_around: usize,
    pub elements_along: usize,
    pub elements_through: usize,
    pub inner_radius: f64,
    pub outer_radius: f64,
    pub length: f64,
    pub shear_modulus: f64,
    pub bulk_modulus: f64,
}

/// What moves a node.
#[derive(Clone, Copy, PartialEq)]
enum Motion {
    Held,
    Free(u32),
    Cap(Vector3<f64>),
}

impl Tube {
    fn nodes_around(&self) -> usize {
        2 * self.elements_around
    }

    fn nodes_through(&self) -> usize {
        2 * self.elements_through + 1
    }

    /// Node planes that are free: all but the held one and the cap's.
    fn free_planes(&self) -> usize {
        2 * self.elements_along - 1
    }

    /// Nodes in a plane.
    pub fn plane(&self) -> usize {
        self.nodes_around() * self.nodes_through()
    }

    /// Blocks: the free nodes plane by plane, then the cap.
    pub fn blocks(&self) -> usize {
        self.plane() * self.free_planes() + 1
    }

    fn node(&self, around: usize, through: usize, along: usize) -> (Vector3<f64>, Motion) {
        let angle = std::f64::consts::PI * around as f64 / self.elements_around as f64;
        let wall = (self.outer_radius - self.inner_radius) / (self.nodes_through() - 1) as f64;
        let radius = self.inner_radius + wall * through as f64;
        let z = self.length * along as f64 / (2 * self.elements_along) as f64;
        let place = Vector3::new(radius * angle.cos(), radius * angle.sin(), z);
        let motion = if along == 0 {
            Motion::Held
        } else if along == 2 * self.elements_along {
            Motion::Cap(place - Vector3::new(0.0, 0.0, self.length))
        } else {
            let of_plane = around % self.nodes_around() * self.nodes_through() + through;
            Motion::Free(((along - 1) * self.plane() + of_plane) as u32)
        };
        (place, motion)
    }

    /// The 27 nodes of each element, the first direction (around) fastest.
    fn elements(&self) -> Vec<Vec<(Vector3<f64>, Motion)>> {
        let mut elements = Vec::new();
        for along in 0..self.elements_along {
            for around in 0..self.elements_around {
                for through in 0..self.elements_through {
                    let node =
                        |k: usize| self.node(2 * around + k % 3, 2 * through + k / 3 % 3, 2 * along + k / 9);
                    elements.push((0..27).map(node).collect());
                }
            }
        }
        elements
    }

    fn cap(&self) -> u32 {
        self.blocks() as u32 - 1
    }

    /// The blocks of each element.
    pub fn cliques(&self) -> Vec<Vec<u32>> {
        let blocks = |element: Vec<(Vector3<f64>, Motion)>| {
            let mut blocks: Vec<u32> = element
                .iter()
                .filter_map(|(_, motion)| match motion {
                    Motion::Held => None,
                    Motion::Free(block) => Some(*block),
                    Motion::Cap(_) => Some(self.cap()),
                })
                .collect();
            blocks.dedup();
            blocks
        };
        self.elements().into_iter().map(blocks).collect()
    }

    pub fn pattern(&self) -> BlockPattern {
        let mut sizes = vec![3; self.blocks() - 1];
        sizes.push(6);
        let cliques = self.cliques();
        BlockPattern::new(&sizes, cliques.iter().map(Vec::as_slice))
    }

    /// Values of the stiffness.
    pub fn stiffness(&self, pattern: &BlockPattern) -> Vec<f64> {
        let mut values = vec![0.0; pattern.len()];
        for element in self.elements() {
            let places: Vec<Vector3<f64>> = element.iter().map(|node| node.0).collect();
            let stiffness = element_stiffness(&places, self.shear_modulus, self.bulk_modulus);
            let motions: Vec<(u32, SMatrix<f64, 3, 6>)> =
                element.iter().map(|node| self.motion(node.1)).collect();
            for (p, (a, motion_a)) in motions.iter().enumerate() {
                for (q, (b, motion_b)) in motions.iter().enumerate() {
                    // Each pair of blocks once; on the diagonal, where several nodes may meet, all of them.
                    if *a == u32::MAX || *b == u32::MAX || a < b {
                        continue;
                    }
                    let pair = motion_a.transpose() * stiffness.fixed_view::<3, 3>(3 * p, 3 * q) * motion_b;
                    let place = pattern.place(*a, *b);
                    for i in 0..pattern.size(*a) {
                        for j in 0..pattern.size(*b) {
                            values[place.index(i, j)] += pair[(i, j)];
                        }
                    }
                }
            }
        }
        values
    }

    /// Block that moves a node (`u32::MAX`: none) and the node's motion per unknown of it.
    fn motion(&self, motion: Motion) -> (u32, SMatrix<f64, 3, 6>) {
        let mut matrix = SMatrix::<f64, 3, 6>::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
        match motion {
            Motion::Held => (u32::MAX, matrix),
            Motion::Free(block) => (block, matrix),
            Motion::Cap(arm) => {
                matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-arm.cross_matrix()));
                (self.cap(), matrix)
            }
        }
    }
}

/// 2 mu dev eps : dev eps + kappa (projection of div u on linear pressures)^2, the pressures eliminated.
fn element_stiffness(places: &[Vector3<f64>], mu: f64, kappa: f64) -> Stiffness {
    let mut stiffness = Stiffness::zeros();
    let mut divergence = SMatrix::<f64, 81, 4>::zeros();
    let mut mass = SMatrix::<f64, 4, 4>::zeros();
    let root = 0.6_f64.sqrt();
    let gauss = [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)];
    for k in 0..27 {
        let points = [gauss[k % 3], gauss[k / 3 % 3], gauss[k / 9]];
        let lines = points.map(|(x, _)| {
            [[0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)], [x - 0.5, -2.0 * x, x + 0.5]]
        });
        let gradient = |n: usize| {
            let index = [n % 3, n / 3 % 3, n / 9];
            Vector3::from_fn(|d, _| (0..3).map(|e| lines[e][usize::from(d == e)][index[e]]).product())
        };
        let mut jacobian = Matrix3::zeros();
        for (n, place) in places.iter().enumerate() {
            jacobian += place * gradient(n).transpose();
        }
        // The node order (around, through, along) is left-handed.
        let volume = jacobian.determinant().abs() * points.iter().map(|point| point.1).product::<f64>();
        let inverse = jacobian.try_inverse().expect("an element of a tube has a volume").transpose();
        let gradients: Vec<Vector3<f64>> = (0..27).map(|n| inverse * gradient(n)).collect();
        let pressures = nalgebra::Vector4::new(1.0, points[0].0, points[1].0, points[2].0);
        mass += volume * pressures * pressures.transpose();
        for (p, a) in gradients.iter().enumerate() {
            for i in 0..3 {
                for q in 0..4 {
                    divergence[(3 * p + i, q)] += volume * a[i] * pressures[q];
                }
            }
            for (q, b) in gradients.iter().enumerate() {
                let block =
                    Matrix3::identity() * a.dot(b) + b * a.transpose() - a * b.transpose() * (2.0 / 3.0);
                let mut target = stiffness.fixed_view_mut::<3, 3>(3 * p, 3 * q);
                target += block * (mu * volume);
            }
        }
    }
    let inverse = mass.try_inverse().expect("a mass matrix is positive definite");
    stiffness + divergence * inverse * divergence.transpose() * kappa
}
