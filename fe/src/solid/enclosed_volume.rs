use super::shape::{GAUSS, quadratic};

/// Nodes of a face, first coordinate fastest.
pub(crate) const FACE: usize = 9;

/// Functions of the face's nodes and their derivatives at its 3 x 3 integration points, and the weights.
pub(crate) struct FaceTable {
    values: [[f64; FACE]; FACE],
    slopes: [[[f64; FACE]; 2]; FACE],
    weights: [f64; FACE],
}

impl FaceTable {
    /// Functions, their derivatives and the weight at integration point `g`.
    pub fn at(&self, g: usize) -> (&[f64; FACE], &[[f64; FACE]; 2], f64) {
        (&self.values[g], &self.slopes[g], self.weights[g])
    }

    pub fn new() -> Self {
        let points = |g: usize| [GAUSS[g % 3], GAUSS[g / 3]];
        let tables = |g: usize| points(g).map(|(at, _)| quadratic(at));
        FaceTable {
            values: std::array::from_fn(|g| {
                let [u, v] = tables(g);
                std::array::from_fn(|a| u.0[a % 3] * v.0[a / 3])
            }),
            slopes: std::array::from_fn(|g| {
                let [u, v] = tables(g);
                [
                    std::array::from_fn(|a| u.1[a % 3] * v.0[a / 3]),
                    std::array::from_fn(|a| u.0[a % 3] * v.1[a / 3]),
                ]
            }),
            weights: std::array::from_fn(|g| points(g).iter().map(|point| point.1).product()),
        }
    }
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Share of a face in the enclosed volume, `V = 1/3 integral x . (x_u cross x_v) du dv`, positive where (u, v) turn outwards.
///
/// Over a closed surface -p V is the energy of a gauge pressure p inside, its gradient the follower load on the nodes and its second
/// derivative the load's symmetric tangent. V is linear in each node, so that d2V/dx_a dx_b is antisymmetric: `e_ikm w_m` with a
/// vector w for each pair of nodes, and w_ba = -w_ab.
pub(crate) struct FaceVolume {
    pub volume: f64,
    /// dV/dx by node, m^2.
    pub gradient: [[f64; 3]; FACE],
    /// The vectors w, m: entry a, b.
    pub tangent: [[[f64; 3]; FACE]; FACE],
}

impl FaceVolume {
    /// Volume and gradient and, if asked for, the tangent.
    pub fn new(table: &FaceTable, nodes: &[[f64; 3]; FACE], with_tangent: bool) -> Self {
        let mut face =
            FaceVolume { volume: 0.0, gradient: [[0.0; 3]; FACE], tangent: [[[0.0; 3]; FACE]; FACE] };
        for g in 0..FACE {
            let (values, [by_u, by_v], weight) = table.at(g);
            let at = |weights: &[f64; FACE]| -> [f64; 3] {
                let mut sum = [0.0; 3];
                for (weight, node) in weights.iter().zip(nodes) {
                    sum.iter_mut().zip(node).for_each(|(sum, x)| *sum += weight * x);
                }
                sum
            };
            let (x, x_u, x_v) = (at(values), at(by_u), at(by_v));
            let third = weight / 3.0;
            let (normal, after, before) = (cross(x_u, x_v), cross(x_v, x), cross(x, x_u));
            face.volume += third * dot(x, normal);
            for a in 0..FACE {
                for i in 0..3 {
                    face.gradient[a][i] +=
                        third * (values[a] * normal[i] + by_u[a] * after[i] + by_v[a] * before[i]);
                }
            }
            if !with_tangent {
                continue;
            }
            // Varying two factors of the triple product leaves the third: x_v, x_u or x.
            for a in 0..FACE {
                for b in 0..a {
                    let on_v = third * (values[a] * by_u[b] - by_u[a] * values[b]);
                    let on_u = third * (by_v[a] * values[b] - values[a] * by_v[b]);
                    let on_x = third * (by_u[a] * by_v[b] - by_v[a] * by_u[b]);
                    for (m, w) in face.tangent[a][b].iter_mut().enumerate() {
                        *w += on_v * x_v[m] + on_u * x_u[m] + on_x * x[m];
                    }
                }
            }
        }
        for a in 0..FACE {
            for b in 0..a {
                face.tangent[b][a] = face.tangent[a][b].map(|w| -w);
            }
        }
        face
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bent_face() -> [[f64; 3]; FACE] {
        std::array::from_fn(|a| {
            let (u, v) = ((a % 3) as f64, (a / 3) as f64);
            [1.0 + 0.1 * u * v, u + 0.2 * v * v, v - 0.3 * u + 0.05 * u * u * v]
        })
    }

    #[test]
    fn derivatives_are_those_of_the_volume() {
        let (table, nodes) = (FaceTable::new(), bent_face());
        let face = FaceVolume::new(&table, &nodes, true);
        // The volume is a cubic in each entry's line: central differences with a large step are exact to rounding
        // for the gradient's tangent (quadratic) and to third order for the volume itself (linear in one node: exact).
        let h = 0.5;
        for q in 0..27 {
            let moved = |e: f64| {
                let mut nodes = nodes;
                nodes[q / 3][q % 3] += e;
                FaceVolume::new(&table, &nodes, true)
            };
            let (plus, minus) = (moved(h), moved(-h));
            let slope = (plus.volume - minus.volume) / (2.0 * h);
            assert!((slope - face.gradient[q / 3][q % 3]).abs() < 1e-13, "{q}");
            for r in 0..27 {
                let (i, k) = (r % 3, q % 3);
                let slope = (plus.gradient[r / 3][i] - minus.gradient[r / 3][i]) / (2.0 * h);
                let w = face.tangent[r / 3][q / 3];
                let expected = match (3 + k - i) % 3 {
                    0 => 0.0,
                    1 => w[3 - i - k],
                    _ => -w[3 - i - k],
                };
                assert!((slope - expected).abs() < 1e-13, "{r} {q}");
            }
        }
    }

    #[test]
    fn six_faces_enclose_a_box() {
        let table = FaceTable::new();
        let size = [2.0, 3.0, 5.0];
        let mut volume = 0.0;
        for axis in 0..3 {
            for (side, flip) in [(0.0, true), (1.0, false)] {
                let nodes = std::array::from_fn(|a| {
                    let (mut u, mut v) = (0.5 * (a % 3) as f64, 0.5 * (a / 3) as f64);
                    if flip {
                        std::mem::swap(&mut u, &mut v);
                    }
                    let mut x = [7.0, -1.0, 2.0];
                    x[axis] += side * size[axis];
                    x[(axis + 1) % 3] += u * size[(axis + 1) % 3];
                    x[(axis + 2) % 3] += v * size[(axis + 2) % 3];
                    x
                });
                volume += FaceVolume::new(&table, &nodes, true).volume;
            }
        }
        assert!((volume - 30.0).abs() < 1e-12);
    }
}
