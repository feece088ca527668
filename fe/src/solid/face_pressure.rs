use super::enclosed_volume::{FACE, FaceTable, cross};

/// Follower pressure on one face, per unit of pressure: the forces `integral N_a (x_u cross x_v) du dv` on its nodes, outwards where
/// (u, v) turn outwards, and their derivative.
///
/// On a closed surface the sum is the gradient of the enclosed volume ([`super::enclosed_volume::FaceVolume`]) and symmetric. On an open
/// part it has no energy: its derivative is unsymmetric along the free edge, by `N_a N_b [dx]x/2` integrated along it.
pub(crate) struct FacePressure {
    /// m^2 by node.
    pub forces: [[f64; 3]; FACE],
    /// Derivative of force i of node a by x_k of node b: `[a][b][i][k]`, m.
    pub tangent: [[[[f64; 3]; 3]; FACE]; FACE],
}

impl FacePressure {
    pub fn new(table: &FaceTable, nodes: &[[f64; 3]; FACE]) -> Self {
        let mut face = FacePressure { forces: [[0.0; 3]; FACE], tangent: [[[[0.0; 3]; 3]; FACE]; FACE] };
        for g in 0..FACE {
            let (values, [by_u, by_v], weight) = table.at(g);
            let sum = |weights: &[f64; FACE]| -> [f64; 3] {
                std::array::from_fn(|i| weights.iter().zip(nodes).map(|(w, node)| w * node[i]).sum())
            };
            let (x_u, x_v) = (sum(by_u), sum(by_v));
            let normal = cross(x_u, x_v);
            for (a, value) in values.iter().enumerate() {
                let share = weight * value;
                face.forces[a].iter_mut().zip(normal).for_each(|(force, n)| *force += share * n);
                for b in 0..FACE {
                    // d(x_u cross x_v) = N_b,u e_k cross x_v + x_u cross N_b,v e_k = [w]x e_k.
                    let w: [f64; 3] = std::array::from_fn(|i| share * (by_v[b] * x_u[i] - by_u[b] * x_v[i]));
                    for k in 0..3 {
                        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                        face.tangent[a][b][i][k] += w[j];
                        face.tangent[a][b][j][k] -= w[i];
                    }
                }
            }
        }
        face
    }
}

#[cfg(test)]
mod tests {
    use super::{super::enclosed_volume::FaceVolume, *};

    fn bent_face() -> [[f64; 3]; FACE] {
        std::array::from_fn(|a| {
            let (u, v) = ((a % 3) as f64, (a / 3) as f64);
            [1.0 + 0.1 * u * v, u + 0.2 * v * v, v - 0.3 * u + 0.05 * u * u * v]
        })
    }

    #[test]
    fn tangent_is_the_derivative_of_the_forces() {
        let (table, nodes) = (FaceTable::new(), bent_face());
        let face = FacePressure::new(&table, &nodes);
        for b in 0..FACE {
            for k in 0..3 {
                // Forces are quadratic in a node's place: central differences are exact.
                let moved = |e: f64| {
                    let mut nodes = nodes;
                    nodes[b][k] += e;
                    FacePressure::new(&table, &nodes).forces
                };
                let (plus, minus) = (moved(0.5), moved(-0.5));
                for a in 0..FACE {
                    for i in 0..3 {
                        let slope = plus[a][i] - minus[a][i];
                        assert!((slope - face.tangent[a][b][i][k]).abs() < 1e-13, "{a} {i} {b} {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn on_a_closed_surface_it_is_the_gradient_of_the_volume_and_symmetric() {
        // A cube of six faces, its points pushed about; points numbered by place on the 3 x 3 x 3 grid.
        let table = FaceTable::new();
        let mut seed = 3;
        let points: Vec<[f64; 3]> = (0..27)
            .map(|p| {
                std::array::from_fn(|i| {
                    [p % 3, p / 3 % 3, p / 9][i] as f64 + 0.2 * crate::free_map::next_fraction(&mut seed)
                })
            })
            .collect();
        let mut faces = vec![];
        for axis in 0..3 {
            for side in [0, 2] {
                faces.push(std::array::from_fn::<usize, FACE, _>(|a| {
                    let (mut u, mut v) = (a % 3, a / 3);
                    if side == 0 {
                        std::mem::swap(&mut u, &mut v);
                    }
                    let mut place = [0; 3];
                    (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (side, u, v);
                    place[0] + 3 * place[1] + 9 * place[2]
                }));
            }
        }
        let mut difference = [[0.0f64; 3]; 27];
        let mut tangent = vec![[0.0f64; 81]; 81];
        for face in &faces {
            let nodes = face.map(|point| points[point]);
            let pressure = FacePressure::new(&table, &nodes);
            let volume = FaceVolume::new(&table, &nodes, false);
            for (a, &p) in face.iter().enumerate() {
                for i in 0..3 {
                    difference[p][i] += pressure.forces[a][i] - volume.gradient[a][i];
                    for (b, &q) in face.iter().enumerate() {
                        for k in 0..3 {
                            tangent[3 * p + i][3 * q + k] += pressure.tangent[a][b][i][k];
                        }
                    }
                }
            }
        }
        assert!(difference.as_flattened().iter().all(|value| value.abs() < 1e-13));
        let unsymmetric = |r: usize, c: usize| (tangent[r][c] - tangent[c][r]).abs();
        assert!((0..81).all(|r| (0..81).all(|c| unsymmetric(r, c) < 1e-13)));
        // One face alone is open.
        let alone = FacePressure::new(&table, &faces[0].map(|point| points[point]));
        let pair = (0..3).flat_map(|i| (0..3).map(move |k| (i, k)));
        assert!(
            pair.clone().any(|(i, k)| (alone.tangent[0][1][i][k] - alone.tangent[1][0][k][i]).abs() > 1e-3)
        );
    }
}
