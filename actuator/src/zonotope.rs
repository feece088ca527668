use crate::{ConvexPolygon, Wrench};

/// The wrenches `base + sum_i s_i g_i` with 0 <= s_i <= 1: what the FREEs of a module can give to a plate that is held, where
/// force is linear in pressure (Bruder et al., "Force generation by parallel combinations of fiber-reinforced fluid-driven
/// actuators", 2018). The generator g_i is the wrench of FREE i per pressure times its greatest pressure, `base` the wrench
/// without pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct Zonotope {
    /// The wrench without pressure.
    pub base: Wrench,
    /// One for each FREE.
    pub generators: Vec<Wrench>,
}

impl Zonotope {
    /// The wrench at shares of the greatest pressures.
    pub fn at(&self, shares: &[f64]) -> Wrench {
        self.base + self.generators.iter().zip(shares).map(|(generator, share)| *generator * *share).sum()
    }

    /// Shares (each 0 or 1, last FREE fastest) and wrench of the corners of the box of pressures. With up to six independent
    /// generators they are the vertices; with more, some lie inside.
    pub fn corners(&self) -> Vec<(Vec<f64>, Wrench)> {
        let count = self.generators.len();
        let corner = |index: usize| {
            let shares: Vec<f64> = (0..count).map(|i| ((index >> (count - 1 - i)) & 1) as f64).collect();
            let wrench = self.at(&shares);
            (shares, wrench)
        };
        (0..1usize << count).map(corner).collect()
    }

    /// The shadow on the plane of two of the components (in the order of [`Wrench::to_array`]).
    pub fn shadow(&self, components: [usize; 2]) -> ConvexPolygon {
        let pick = |wrench: &Wrench| components.map(|k| wrench.to_array()[k]);
        let base = ConvexPolygon { vertices: vec![pick(&self.base)] };
        let segment = |g: &Wrench| ConvexPolygon::hull([[0.0; 2], pick(g)]);
        self.generators.iter().fold(base, |sum, generator| sum.minkowski_sum(&segment(generator)))
    }

    /// Volume of the shadow in the space of three of the components: the sum of |det(g_i, g_j, g_k)| over all triples.
    pub fn volume(&self, components: [usize; 3]) -> f64 {
        let picked: Vec<[f64; 3]> =
            self.generators.iter().map(|g| components.map(|k| g.to_array()[k])).collect();
        let mut volume = 0.0;
        for (i, a) in picked.iter().enumerate() {
            for (j, b) in picked.iter().enumerate().skip(i + 1) {
                for c in &picked[j + 1..] {
                    let cross =
                        [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
                    volume += (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]).abs();
                }
            }
        }
        volume
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zonotope(count: usize) -> Zonotope {
        let number = |i: usize, k: usize| ((i * 7 + k * 3 + 1) as f64 * 1.7).sin();
        let wrench = |i: usize| Wrench::from_array(std::array::from_fn(|k| number(i, k)));
        Zonotope { base: wrench(20), generators: (0..count).map(wrench).collect() }
    }

    #[test]
    fn a_shadow_is_the_hull_of_the_corners_and_has_the_area_of_all_pairs() {
        let zonotope = zonotope(5);
        for components in [[0, 1], [2, 5], [4, 3]] {
            let shadow = zonotope.shadow(components);
            let corners = zonotope.corners();
            assert_eq!(corners.len(), 32);
            let hull = ConvexPolygon::hull(corners.iter().map(|(_, w)| components.map(|k| w.to_array()[k])));
            assert_eq!(shadow.vertices.len(), hull.vertices.len());
            // A zonogon of n directions has 2 n vertices.
            assert_eq!(shadow.vertices.len(), 10);
            let g: Vec<[f64; 2]> =
                zonotope.generators.iter().map(|g| components.map(|k| g.to_array()[k])).collect();
            let pairs = (0..5).flat_map(|i| (0..i).map(move |j| (i, j)));
            let area: f64 = pairs.map(|(i, j)| (g[i][0] * g[j][1] - g[i][1] * g[j][0]).abs()).sum();
            assert!((shadow.area() - area).abs() < 1e-12);
            assert!((hull.area() - area).abs() < 1e-12);
        }
    }

    #[test]
    fn a_volume_is_that_of_its_slices() {
        // Volume of the shadow by the areas of slices is what a mesh would give; here: a box sheared, and a box with one more edge
        // along its diagonal, 1 + 3.
        let along = |x: f64, y: f64, z: f64| Wrench { force: [x, y, z], moment: [0.0; 3] };
        let mut solid = Zonotope {
            base: Wrench::default(),
            generators: vec![along(1.0, 0.0, 0.0), along(0.4, 1.0, 0.0), along(-0.3, 2.0, 1.0)],
        };
        assert!((solid.volume([0, 1, 2]) - 1.0).abs() < 1e-14);
        assert_eq!(solid.volume([3, 4, 5]), 0.0);
        solid.generators = vec![along(1.0, 0.0, 0.0), along(0.0, 1.0, 0.0), along(0.0, 0.0, 1.0)];
        solid.generators.push(along(1.0, 1.0, 1.0));
        assert!((solid.volume([0, 1, 2]) - 4.0).abs() < 1e-14);
    }

    #[test]
    fn shares_of_a_corner_are_those_of_its_wrench() {
        let zonotope = zonotope(3);
        let (shares, wrench) = zonotope.corners()[3].clone();
        assert_eq!(shares, [0.0, 1.0, 1.0]);
        assert_eq!(wrench, zonotope.at(&shares));
        assert_eq!(zonotope.at(&[0.0; 3]), zonotope.base);
    }
}
