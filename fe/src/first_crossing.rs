/// Where a straight way of pressures leads from an equilibrium to the next.
pub(crate) enum Step<F> {
    /// To the one asked for.
    Reached(F),
    /// Not there: the path ends at this one, after a part of the whole way.
    Ended(F, f64),
}

/// Neighbouring equilibria, the first stable.
pub(crate) struct Crossing<F> {
    /// The last one found stable.
    pub below: F,
    /// The first found unstable; `None` where the path ends, stable, at `below`.
    pub above: Option<F>,
}

/// How finely a way is searched.
pub(crate) struct Search {
    /// Greatest change of a pressure on the way, Pa.
    pub longest: f64,
    /// Change in which stability is looked at, Pa: two changes of it within one that cancel go unseen.
    pub step: f64,
    /// Change to which the place is found, Pa.
    pub tolerance: f64,
}

impl Search {
    /// The search on a straight way between pressures (Pa).
    pub fn between(from: &[f64], to: &[f64], step: f64, tolerance: f64) -> Self {
        let longest = from.iter().zip(to).map(|(from, to)| (to - from).abs()).fold(0.0, f64::max);
        Search { longest, step, tolerance }
    }

    /// Where the way from a stable equilibrium first comes to one that is not: `go` follows it from an equilibrium to a part of the whole way.
    /// `None` where it stays stable to the end.
    ///
    /// # Errors
    /// Those of `go`.
    pub fn first_crossing<F: Clone, E>(
        &self,
        start: &F,
        mut go: impl FnMut(&F, f64) -> Result<Step<F>, E>,
        is_stable: impl Fn(&F) -> bool,
    ) -> Result<Option<Crossing<F>>, E> {
        let steps = (self.longest / self.step).ceil().max(1.0) as usize;
        let (mut below, mut low) = (start.clone(), 0.0);
        let mut crossed = None;
        for step in 1..=steps {
            let share = step as f64 / steps as f64;
            match go(&below, share)? {
                Step::Ended(found, _) if is_stable(&found) => {
                    return Ok(Some(Crossing { below: found, above: None }));
                }
                Step::Reached(found) if is_stable(&found) => (below, low) = (found, share),
                Step::Reached(found) => crossed = Some((found, share)),
                Step::Ended(found, share) => crossed = Some((found, share)),
            }
            if crossed.is_some() {
                break;
            }
        }
        let Some((mut above, mut high)) = crossed else { return Ok(None) };
        while (high - low) * self.longest > self.tolerance {
            let middle = 0.5 * (low + high);
            match go(&below, middle)? {
                Step::Reached(found) if is_stable(&found) => (below, low) = (found, middle),
                Step::Ended(found, _) if is_stable(&found) => {
                    return Ok(Some(Crossing { below: found, above: None }));
                }
                Step::Reached(found) => (above, high) = (found, middle),
                Step::Ended(found, share) => (above, high) = (found, share),
            }
        }
        Ok(Some(Crossing { below, above: Some(above) }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A way on which a state is its place, stable below `critical`, that ends at `end`.
    fn search(critical: f64, end: f64) -> Option<Crossing<f64>> {
        let search = Search { longest: 50.0, step: 2.5, tolerance: 0.1 };
        let go = |_: &f64, share: f64| -> Result<Step<f64>, ()> {
            Ok(if share <= end { Step::Reached(share) } else { Step::Ended(end, end) })
        };
        search.first_crossing(&0.0, go, |place| *place < critical).unwrap()
    }

    #[test]
    fn a_crossing_is_bracketed_to_the_tolerance() {
        for critical in [0.0301, 0.4999, 0.5, 0.5001, 0.99] {
            let found = search(critical, 1.0).unwrap();
            let above = found.above.unwrap();
            assert!(found.below < critical && critical <= above, "{critical}: {} {above}", found.below);
            assert!((above - found.below) * 50.0 <= 0.1, "{critical}: {} {above}", found.below);
        }
        assert!(search(1.1, 1.0).is_none());
    }

    #[test]
    fn a_path_that_ends_is_told_by_whether_it_was_stable_there() {
        let ended = search(2.0, 0.633).unwrap();
        assert!(ended.above.is_none() && ended.below == 0.633, "{}", ended.below);
        let found = search(0.6201, 0.633).unwrap();
        let above = found.above.unwrap();
        assert!(found.below < 0.6201 && 0.6201 <= above && (above - found.below) * 50.0 <= 0.1);
    }
}
