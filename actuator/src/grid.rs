/// Where a node of a grid stands on each axis, by the axes' numbers of values: the last axis fastest.
pub fn grid_places(counts: impl DoubleEndedIterator<Item = usize>, node: usize) -> Vec<usize> {
    let mut rest = node;
    let place = |count: usize| {
        let place = rest % count;
        rest /= count;
        place
    };
    let mut places: Vec<usize> = counts.rev().map(place).collect();
    places.reverse();
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_axis_is_fastest() {
        let counts = [2usize, 3, 4];
        let mut node = 0;
        for i in 0..2 {
            for j in 0..3 {
                for k in 0..4 {
                    assert_eq!(grid_places(counts.into_iter(), node), [i, j, k]);
                    node += 1;
                }
            }
        }
        assert!(grid_places(std::iter::empty(), 0).is_empty());
    }
}
