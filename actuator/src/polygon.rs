/// A convex polygon, its vertices counter-clockwise; a segment has two of them, a point one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConvexPolygon {
    /// The vertices.
    pub vertices: Vec<[f64; 2]>,
}

/// Twice the area of the triangle o, a, b, positive counter-clockwise.
fn turn(o: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

impl ConvexPolygon {
    /// The convex hull of points that are finite: Andrew's chains of the lower and the upper side.
    pub fn hull(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut points: Vec<[f64; 2]> = points.into_iter().collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        points.dedup();
        if points.len() < 3 {
            return ConvexPolygon { vertices: points };
        }
        // A turn smaller than rounding of the coordinates is none.
        let size = |k: usize| points.iter().map(|point| point[k].abs()).fold(0.0, f64::max);
        let least = 1e-14 * size(0) * size(1);
        let mut vertices: Vec<[f64; 2]> = Vec::new();
        let mut side = |order: &mut dyn Iterator<Item = &[f64; 2]>| {
            let first = vertices.len();
            for point in order {
                while vertices.len() >= first + 2 {
                    let n = vertices.len();
                    if turn(vertices[n - 2], vertices[n - 1], *point) > least {
                        break;
                    }
                    vertices.pop();
                }
                vertices.push(*point);
            }
            // The next side begins with it.
            vertices.pop();
        };
        side(&mut points.iter());
        side(&mut points.iter().rev());
        ConvexPolygon { vertices }
    }

    /// All sums of a point of this polygon and one of the other: the hull of the sums of their vertices.
    pub fn minkowski_sum(&self, other: &ConvexPolygon) -> Self {
        let sums = |a: &[f64; 2]| {
            let [x, y] = *a;
            other.vertices.iter().map(move |b| [x + b[0], y + b[1]])
        };
        Self::hull(self.vertices.iter().flat_map(sums))
    }

    /// Least and greatest coordinate along an axis; the wrong way round, infinite, of no points.
    pub fn extent(&self, axis: usize) -> (f64, f64) {
        let along = self.vertices.iter().map(|vertex| vertex[axis]);
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    }

    /// The vertices with the first once more at the end: the outline as a line.
    pub fn closed(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.vertices.iter().chain(self.vertices.first()).copied()
    }

    /// Area, in the product of the axes' units.
    pub fn area(&self) -> f64 {
        let Some(first) = self.vertices.first() else { return 0.0 };
        0.5 * self.vertices.windows(2).map(|pair| turn(*first, pair[0], pair[1])).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hull_of_a_square_with_points_inside_and_on_its_sides() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let more = [[1.0, 1.0], [1.0, 0.0], [2.0, 1.0], [0.0, 0.0], [0.3, 1.9]];
        let hull = ConvexPolygon::hull(more.into_iter().chain(square));
        assert_eq!(hull.vertices, square);
        assert_eq!(hull.area(), 4.0);
        assert_eq!((hull.extent(0), hull.extent(1)), ((0.0, 2.0), (0.0, 2.0)));
        assert_eq!(
            hull.closed().collect::<Vec<_>>(),
            [square[0], square[1], square[2], square[3], square[0]]
        );
    }

    #[test]
    fn points_and_segments_are_polygons_without_area() {
        assert_eq!(ConvexPolygon::hull([]).area(), 0.0);
        assert_eq!(ConvexPolygon::hull([]).closed().count(), 0);
        assert_eq!(ConvexPolygon::hull([]).extent(0), (f64::INFINITY, f64::NEG_INFINITY));
        assert_eq!(ConvexPolygon::hull([[1.0, 2.0]; 3]).vertices, [[1.0, 2.0]]);
        let line = ConvexPolygon::hull((0..10).map(|i| [0.1 * f64::from(i), 0.3 * f64::from(i)]));
        assert_eq!(line.vertices.len(), 2);
        assert_eq!(line.area(), 0.0);
    }

    #[test]
    fn a_sum_of_polygons_has_the_sum_of_their_supports() {
        let triangle = ConvexPolygon::hull([[0.0, 0.0], [3.0, 1.0], [1.0, 2.0]]);
        let pentagon = ConvexPolygon::hull((0..5).map(|i| {
            let angle = 1.2566 * f64::from(i) + 0.3;
            [angle.cos(), 2.0 * angle.sin()]
        }));
        let sum = triangle.minkowski_sum(&pentagon);
        let support = |polygon: &ConvexPolygon, [x, y]: [f64; 2]| {
            polygon.vertices.iter().map(|v| v[0] * x + v[1] * y).fold(f64::NEG_INFINITY, f64::max)
        };
        for i in 0..30 {
            let direction = [f64::from(i).sin(), f64::from(i).cos()];
            let apart = support(&triangle, direction) + support(&pentagon, direction);
            assert!((support(&sum, direction) - apart).abs() < 1e-12);
        }
        assert_eq!(sum.vertices.len(), 8);
    }
}
