//! Long recordings drawn with few points, so that a report stays small and no peak is lost.

/// At most about `most` points that draw the same picture: of each stretch of the curve the lowest and the highest.
pub fn thin(points: Vec<(f64, f64)>, most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most.max(4) {
        return points;
    }
    let stretch = points.len().div_ceil(most / 2);
    let mut kept = Vec::with_capacity(most + 2);
    for part in points.chunks(stretch) {
        let finite = || part.iter().enumerate().filter(|(_, (_, y))| y.is_finite());
        let by_height = |a: &(usize, &(f64, f64)), b: &(usize, &(f64, f64))| a.1.1.total_cmp(&b.1.1);
        match (finite().min_by(by_height), finite().max_by(by_height)) {
            (Some((low, _)), Some((high, _))) => {
                kept.push(part[low.min(high)]);
                if low != high {
                    kept.push(part[low.max(high)]);
                }
            }
            // A gap stays a gap.
            _ => kept.push((part[0].0, f64::NAN)),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_and_gaps_survive() {
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|i| (f64::from(i), 0.0)).collect();
        points[4321].1 = 7.0;
        points[6000].1 = -3.0;
        for point in &mut points[8000..8200] {
            point.1 = f64::NAN;
        }
        let few = thin(points, 400);
        assert!(few.len() <= 402 && few.contains(&(4321.0, 7.0)) && few.contains(&(6000.0, -3.0)));
        assert!(few.iter().any(|(_, y)| y.is_nan()));
        assert!(few.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
