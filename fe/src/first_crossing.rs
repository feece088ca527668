/// Where a straight way of pressures leads from an equilibrium.
pub(crate) enum Step<F> {
    /// To the equilibrium of the same path that was asked for.
    Reached(F),
    /// To none: there the path ends, or Newton's method fell from it to another one.
    Lost,
}

/// Neighbouring equilibria of a path, the first stable.
pub(crate) struct Crossing<F> {
    /// The last one found stable.
    pub below: F,
    /// The first found unstable; `None` where none was found before the path was lost.
    pub above: Option<F>,
    /// Part of the whole way by which the path is unstable or lost.
    pub by: f64,
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

    /// Where the way from a stable equilibrium first comes to one that is not, or is lost: `go` follows it from an equilibrium to a part of the
    /// whole way. `None` where it stays stable to the end.
    ///
    /// # Errors
    /// Those of `go`.
    pub fn first_crossing<F: Clone, E>(
        &self,
        start: &F,
        mut go: impl FnMut(&F, f64) -> Result<Step<F>, E>,
        is_stable: impl Fn(&F) -> bool,
    ) -> Result<Option<Crossing<F>>, E> {
        let whole = 1.0 / (self.longest / self.step).ceil().max(1.0);
        let (mut below, mut low, mut stride) = (start.clone(), 0.0, whole);
        let (mut above, mut high) = loop {
            if low == 1.0 {
                return Ok(None);
            }
            let share = if low + stride > 1.0 - 1e-9 { 1.0 } else { low + stride };
            match go(&below, share)? {
                Step::Reached(found) if is_stable(&found) => {
                    (below, low) = (found, share);
                    stride = (2.0 * stride).min(whole);
                }
                Step::Reached(found) => break (Some(found), share),
                Step::Lost if (share - low) * self.longest > self.tolerance => stride = 0.5 * (share - low),
                Step::Lost => return Ok(Some(Crossing { below, above: None, by: share })),
            }
        };
        while (high - low) * self.longest > self.tolerance {
            let middle = 0.5 * (low + high);
            let mut step = go(&below, middle)?;
            if let (Step::Lost, Some(above)) = (&step, &above) {
                // On the other side the path may be firmer.
                step = go(above, middle)?;
            }
            match step {
                Step::Reached(found) if is_stable(&found) => (below, low) = (found, middle),
                Step::Reached(found) => (above, high) = (Some(found), middle),
                Step::Lost => high = middle,
            }
        }
        Ok(Some(Crossing { below, above, by: high }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A way on which a state is its place, stable below `critical`, and that is lost on the way up between `lost` and, coming down,
    /// above it.
    fn search(critical: f64, lost: [f64; 2]) -> Option<Crossing<f64>> {
        let search = Search { longest: 50.0, step: 2.5, tolerance: 0.1 };
        let go = |from: &f64, share: f64| -> Result<Step<f64>, ()> {
            let lost = if share > *from { lost[0]..lost[1] } else { lost[0]..lost[0] };
            Ok(if lost.contains(&share) { Step::Lost } else { Step::Reached(share) })
        };
        search.first_crossing(&0.0, go, |place| *place < critical).unwrap()
    }

    #[test]
    fn a_crossing_is_bracketed_to_the_tolerance() {
        for critical in [0.0301, 0.4999, 0.5, 0.5001, 0.99] {
            let found = search(critical, [2.0; 2]).unwrap();
            let above = found.above.unwrap();
            assert!(found.below < critical && critical <= above, "{critical}: {} {above}", found.below);
            assert!((above - found.below) * 50.0 <= 0.1, "{critical}: {} {above}", found.below);
        }
        assert!(search(1.1, [2.0; 2]).is_none());
    }

    #[test]
    fn a_path_that_is_lost_is_found_to_the_tolerance_too() {
        let ended = search(2.0, [0.633, 2.0]).unwrap();
        assert!(ended.above.is_none() && ended.below < 0.633 && 0.633 <= ended.by);
        assert!((ended.by - ended.below) * 50.0 <= 0.1, "{} {}", ended.below, ended.by);
        let found = search(0.6201, [0.633, 2.0]).unwrap();
        let above = found.above.unwrap();
        assert!(found.below < 0.6201 && 0.6201 <= above && (above - found.below) * 50.0 <= 0.1);
    }

    #[test]
    fn where_the_way_up_falls_off_the_way_down_is_taken() {
        // Between 31 and 33 of 50 the path is lost on the way up.
        let found = search(0.6301, [0.62, 0.645]).unwrap();
        let above = found.above.unwrap();
        assert!(found.below < 0.6301 && 0.6301 <= above && (above - found.below) * 50.0 <= 0.1);
    }
}
