use crate::PressureUnit;
use actuator::{FreePath, FreeState, Middle};

/// Points of the polynomial between which an end effect is interpolated.
const POINTS: usize = 4;

/// What both rigid caps together change of a FREE, at one pressure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndChange {
    /// End extension e = (lambda - lambda_far) L, m: by how much the FREE is longer than if it did everywhere what is done far from
    /// caps.
    pub extension: f64,
    /// End twist t = (tau - tau_far) L, rad, with the sign of a twist.
    pub turn: f64,
    /// Change of the expansion at mid-length; zero of a FREE long enough that its middle is far from the caps.
    pub expansion: f64,
}

impl EndChange {
    /// Of a solid of length `length` (m) in the state `state`, the middle of `far` being far from caps: of the same solid if that is
    /// long enough. `None` where that does not tell what its middle does.
    pub fn of(length: f64, state: &FreeState, far: &FreeState) -> Option<Self> {
        let middle = far.middle?;
        Some(EndChange {
            extension: (state.axial_stretch - middle.axial_stretch) * length,
            turn: (state.twist_per_length - middle.twist_per_length) * length,
            expansion: state.expansion - far.expansion,
        })
    }

    /// The state of a FREE of length `length` (m) between caps whose section is in the state `section`, which becomes its middle:
    /// lambda = lambda_far + e/L, tau = tau_far + t/L.
    pub fn cap_to_cap(self, length: f64, section: &FreeState) -> FreeState {
        FreeState {
            axial_stretch: section.axial_stretch + self.extension / length,
            twist_per_length: section.twist_per_length + self.turn / length,
            expansion: section.expansion + self.expansion,
            middle: Some(Middle {
                axial_stretch: section.axial_stretch,
                twist_per_length: section.twist_per_length,
            }),
            ..*section
        }
    }

    /// End-effect lengths of stretch and twist, m: how much of its length a FREE loses at each cap, as if the rest did what is done
    /// far from caps. delta = -e/(2 (lambda_far - 1)) and -t/(2 tau_far): infinite where that neither stretches nor twists.
    pub fn lengths(self, far: Middle) -> [f64; 2] {
        [-self.extension / (2.0 * (far.axial_stretch - 1.0)), -self.turn / (2.0 * far.twist_per_length)]
    }

    fn combined(changes: &[(f64, Self)]) -> Self {
        changes.iter().fold(EndChange::default(), |sum, (weight, change)| EndChange {
            extension: sum.extension + weight * change.extension,
            turn: sum.turn + weight * change.turn,
            expansion: sum.expansion + weight * change.expansion,
        })
    }
}

/// Effect of rigid caps on a FREE: end extension and end twist over pressure, from paths of solids.
///
/// Both are differences between *solids*, so that most of what the mesh does to either cancels. Layers that do not meet are the same at any
/// length, and with them e and t.
#[derive(Clone, Debug, PartialEq)]
pub struct EndEffect {
    unit: PressureUnit,
    /// (s, change), s rising from zero.
    changes: Vec<(f64, EndChange)>,
}

impl EndEffect {
    /// From the path `of_free` of a solid of length `length` (m), the middle of the path `far` being far from caps: both as far as they
    /// hold `pressures` (Pa, rising), the states at others being left out. `None` where fewer than two are left.
    pub fn of_solids(
        of_free: &FreePath,
        length: f64,
        far: &FreePath,
        pressures: &[f64],
        unit: PressureUnit,
    ) -> Option<Self> {
        let at = |path: &FreePath, pressure: f64| {
            path.states.iter().find(|state| (state.pressure - pressure).abs() <= 1e-9 * pressure).copied()
        };
        let found = pressures.iter().map_while(|pressure| {
            let s = unit.coordinate(*pressure);
            let change = EndChange::of(length, &at(of_free, *pressure)?, &at(far, *pressure)?)?;
            s.is_finite().then_some((s, change))
        });
        let changes: Vec<(f64, EndChange)> = found.collect();
        (changes.len() > 1).then_some(EndEffect { unit, changes })
    }

    /// What its pressures are measured by.
    pub fn unit(&self) -> PressureUnit {
        self.unit
    }

    /// Greatest coordinate s that it reaches.
    pub fn reach(&self) -> f64 {
        self.changes.last().map_or(0.0, |(s, _)| *s)
    }

    /// The change at coordinate s, by the cubic through the four nearest states; `None` beyond the reach.
    pub fn at(&self, s: f64) -> Option<EndChange> {
        let rounding = 1e-9 * self.reach();
        if !(s >= 0.0 && s <= self.reach() + rounding) {
            return None;
        }
        let count = POINTS.min(self.changes.len());
        let after = self.changes.partition_point(|(place, _)| *place <= s);
        let first = after.saturating_sub(count / 2).min(self.changes.len() - count);
        let near = &self.changes[first..first + count];
        let weighted: Vec<(f64, EndChange)> = near
            .iter()
            .map(|(place, change)| {
                let others = near.iter().filter(|(other, _)| other != place);
                (others.map(|(other, _)| (s - other) / (place - other)).product(), *change)
            })
            .collect();
        Some(EndChange::combined(&weighted))
    }

    /// Between this and another end effect at the same s: this for `share` = 0, the other for 1.
    pub fn between(&self, other: &Self, share: f64, s: f64) -> Option<EndChange> {
        Some(EndChange::combined(&[(1.0 - share, self.at(s)?), (share, other.at(s)?)]))
    }

    /// Greatest difference from another end effect at the same s, as far as both reach: of e over the greatest e, of t over the
    /// greatest t. Infinite where their pressures are measured differently.
    pub fn difference(&self, other: &Self) -> f64 {
        if !self.unit.is_like(other.unit) {
            return f64::INFINITY;
        }
        let most = |of: &dyn Fn(&EndChange) -> f64, values: &[EndChange]| {
            values.iter().map(|change| of(change).abs()).fold(0.0, f64::max)
        };
        let own: Vec<EndChange> = self.changes.iter().map(|(_, change)| *change).collect();
        let off: Vec<EndChange> = self
            .changes
            .iter()
            .filter_map(|(s, change)| Some(EndChange::combined(&[(1.0, other.at(*s)?), (-1.0, *change)])))
            .collect();
        let relative =
            |of: &dyn Fn(&EndChange) -> f64| most(of, &off) / most(of, &own).max(f64::MIN_POSITIVE);
        relative(&|change| change.extension).max(relative(&|change| change.turn))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use actuator::PathEnd;

    fn state(pressure: f64, stretch: [f64; 2], twist: [f64; 2], expansion: f64) -> FreeState {
        FreeState {
            pressure,
            axial_stretch: stretch[0],
            expansion,
            twist_per_length: twist[0],
            residual: 0.0,
            middle: Some(Middle { axial_stretch: stretch[1], twist_per_length: twist[1] }),
            section: None,
            mesh_error: None,
        }
    }

    /// e = 1e-3 (s - 2 s^3) m and t = 0.5 s^2 of a solid of 50 mm, with a limit of 40 kPa.
    fn cubic(steps: usize) -> (FreePath, Vec<f64>) {
        let unit = PressureUnit::Limit(4e4);
        let places: Vec<f64> = (0..=steps).map(|i| i as f64 / steps as f64).collect();
        let states = places.iter().map(|s| {
            let middle = [1.0 + 0.3 * s, -20.0 * s];
            let total = [middle[0] + 1e-3 * (s - 2.0 * s.powi(3)) / 0.05, middle[1] + 0.5 * s * s / 0.05];
            state(unit.pressure(*s), [total[0], middle[0]], [total[1], middle[1]], 1.0 + s)
        });
        let mut path = FreePath::solved(states.collect(), PathEnd::Range);
        // A state nobody asked for, with nonsense in it.
        path.states.insert(2, state(1.01 * path.states[1].pressure, [9.0, 1.0], [9.0, 1.0], 9.0));
        (path, places.iter().map(|s| unit.pressure(*s)).collect())
    }

    #[test]
    fn cubics_in_s_are_interpolated_exactly_and_nothing_beyond() {
        let (path, pressures) = cubic(6);
        let unit = PressureUnit::Limit(4e4);
        let effect = EndEffect::of_solids(&path, 0.05, &path, &pressures, unit).unwrap();
        for s in [0.0, 0.01, 0.3, 0.49, 0.77, 0.99, 1.0] {
            let change = effect.at(s).unwrap();
            assert!((change.extension - 1e-3 * (s - 2.0 * s.powi(3))).abs() < 1e-14, "{s} {change:?}");
            assert!((change.turn - 0.5 * s * s).abs() < 1e-12 && change.expansion == 0.0);
        }
        assert_eq!((effect.at(1.001), effect.at(-1e-6), effect.at(f64::NAN)), (None, None, None));
        assert!(unit.coordinate(4.001e4).is_nan());
        // A path that ends before is known as far as it goes.
        let short = EndEffect::of_solids(&path, 0.05, &path, &pressures[..4], unit).unwrap();
        assert!((short.reach() - 0.5).abs() < 1e-12 && short.at(0.51).is_none());
        assert!(EndEffect::of_solids(&path, 0.05, &path, &pressures[..1], unit).is_none());
    }

    #[test]
    fn a_change_makes_of_the_middle_what_it_was_made_from() {
        let (free, far) =
            (state(1e4, [1.05, 1.08], [-3.0, -5.0], 1.19), state(1e4, [9.0, 1.1], [9.0, -6.0], 1.2));
        let change = EndChange::of(0.04, &free, &far).unwrap();
        assert!((change.extension + 0.05 * 0.04).abs() < 1e-15 && (change.turn - 3.0 * 0.04).abs() < 1e-15);
        let section = FreeState { axial_stretch: 1.1, twist_per_length: -6.0, middle: None, ..far };
        let made = change.cap_to_cap(0.04, &section);
        assert!((made.axial_stretch - 1.05).abs() < 1e-15 && (made.twist_per_length + 3.0).abs() < 1e-12);
        assert!((made.expansion - 1.19).abs() < 1e-15);
        assert_eq!(made.middle, far.middle);
        // Half of the stretch is lost: as if a quarter of the length at each cap did not stretch at all.
        let [stretch, twist] = change.lengths(far.middle.unwrap());
        assert!((stretch - 0.01).abs() < 1e-12 && (twist - 0.01).abs() < 1e-12);
    }

    #[test]
    fn end_effects_are_compared_at_equal_shares_of_the_limit_pressure() {
        let (path, pressures) = cubic(6);
        let effect =
            |path: &FreePath, unit| EndEffect::of_solids(path, 0.05, path, &pressures, unit).unwrap();
        let one = effect(&path, PressureUnit::Limit(4e4));
        let mut other = path.clone();
        // A tenth more twist; e is greatest, 1e-3, at the end.
        other.states.iter_mut().for_each(|state| {
            let middle = state.middle.unwrap().twist_per_length;
            state.twist_per_length += 0.1 * (state.twist_per_length - middle);
        });
        let two = effect(&other, PressureUnit::Limit(4e4));
        assert!((one.difference(&two) - 0.1).abs() < 1e-9);
        assert!((one.between(&two, 0.5, 1.0).unwrap().turn - 0.525).abs() < 1e-9);
        assert_eq!(one.difference(&effect(&path, PressureUnit::Other(4e5))), f64::INFINITY);
        assert_eq!(PressureUnit::Other(4e5).coordinate(1e5), 0.25);
    }
}
