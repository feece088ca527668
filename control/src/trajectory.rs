use crate::{Target, Waypoint};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// How the time between two waypoints is spent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Blend {
    /// At constant speed: the speed jumps at a waypoint.
    #[default]
    Linear,
    /// From rest to rest with continuous acceleration: the share of the way is `10 s^3 - 15 s^4 + 6 s^5` of the time's share
    /// s; the greatest speed is 15/8 of the mean.
    RestToRest,
}

/// Why waypoints cannot be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrajectoryError {
    /// No waypoint.
    #[error("there is no waypoint; give at least one")]
    Empty,
    /// Times do not rise or are not numbers.
    #[error("waypoint {}: its time {time} s does not follow the one before; times must be finite and rise", index + 1)]
    Time {
        /// Index of the waypoint.
        index: usize,
        /// Its time, s.
        time: f64,
    },
    /// A quaternion without direction or a position that is no number.
    #[error("waypoint {}: its pose is not finite or its quaternion is zero", index + 1)]
    Pose {
        /// Index of the waypoint.
        index: usize,
    },
    /// Too slow, too fast or not a number.
    #[error(
        "a rate of {rate} Hz over {duration} s makes no sensible number of solves; give a rate that makes 1 to 10 million"
    )]
    Rate {
        /// The rate, Hz.
        rate: f64,
        /// Time from the first to the last waypoint, s.
        duration: f64,
    },
}

/// Targets on a time grid, from waypoints: straight lines between positions, shortest turns between rotations. Between
/// waypoints of which one leaves the rotation free, it is free.
#[derive(Clone, Debug)]
pub struct Trajectory {
    waypoints: Vec<Waypoint>,
    rate: f64,
    blend: Blend,
    rotation_weight: f64,
    ticks: usize,
}

impl Trajectory {
    /// A trajectory sampled at `rate` (Hz) from the first waypoint's time until the last is reached. `rotation_weight` (m) is
    /// what a radian counts, best the module's length.
    pub fn new(
        waypoints: Vec<Waypoint>,
        rate: f64,
        blend: Blend,
        rotation_weight: f64,
    ) -> Result<Self, TrajectoryError> {
        let (Some(first), Some(last)) = (waypoints.first(), waypoints.last()) else {
            return Err(TrajectoryError::Empty);
        };
        let duration = last.time - first.time;
        for (index, waypoint) in waypoints.iter().enumerate() {
            if !waypoint.time.is_finite() || index > 0 && waypoint.time <= waypoints[index - 1].time {
                return Err(TrajectoryError::Time { index, time: waypoint.time });
            }
            let turned = waypoint.rotation.is_none_or(|wxyz| unit(wxyz).is_some());
            if !turned || waypoint.position.iter().any(|value| !value.is_finite()) {
                return Err(TrajectoryError::Pose { index });
            }
        }
        // A grid that ends on the last waypoint but for rounding must not get one more tick.
        let steps = (duration * rate - 1e-6).ceil().max(0.0);
        if !(rate > 0.0 && rate.is_finite() && steps < 1e7) {
            return Err(TrajectoryError::Rate { rate, duration });
        }
        Ok(Trajectory { waypoints, rate, blend, rotation_weight, ticks: steps as usize + 1 })
    }

    /// Number of ticks.
    pub fn len(&self) -> usize {
        self.ticks
    }

    /// Never: there is at least one waypoint.
    pub fn is_empty(&self) -> bool {
        self.ticks == 0
    }

    /// Time between ticks, s.
    pub fn time_step(&self) -> f64 {
        1.0 / self.rate
    }

    /// Time of a tick, s, on the waypoints' clock.
    pub fn time(&self, tick: usize) -> f64 {
        self.waypoints[0].time + tick as f64 / self.rate
    }

    /// Target at a time (s); before the first waypoint and after the last, theirs.
    pub fn target(&self, time: f64) -> Target {
        let after = self.waypoints.partition_point(|waypoint| waypoint.time <= time);
        let from = &self.waypoints[after.max(1) - 1];
        let to = &self.waypoints[after.min(self.waypoints.len() - 1)];
        let share = if to.time > from.time {
            ((time - from.time) / (to.time - from.time)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let share = match self.blend {
            Blend::Linear => share,
            Blend::RestToRest => share.powi(3) * (10.0 + share * (6.0 * share - 15.0)),
        };
        let position = Vector3::from(from.position).lerp(&Vector3::from(to.position), share);
        let rotation = match (from.rotation.and_then(unit), to.rotation.and_then(unit)) {
            (Some(a), Some(b)) => {
                // The shortest way; half a turn has none, and any will do.
                let turned = a.try_slerp(&b, share, 1e-9).unwrap_or(if share < 0.5 { a } else { b });
                Some([turned.w, turned.i, turned.j, turned.k])
            }
            _ => None,
        };
        Target {
            position: position.into(),
            rotation,
            position_weight: 1.0,
            rotation_weight: self.rotation_weight,
        }
    }
}

fn unit([w, x, y, z]: [f64; 4]) -> Option<UnitQuaternion<f64>> {
    let finite = [w, x, y, z].iter().all(|value| value.is_finite());
    finite.then(|| UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waypoint(time: f64, x: f64, rotation: Option<[f64; 4]>) -> Waypoint {
        Waypoint { time, position: [x, 0.0, 0.17], rotation }
    }

    #[test]
    fn lines_between_waypoints_and_ends_beyond() {
        let points = vec![waypoint(1.0, 0.0, None), waypoint(2.0, 0.01, None), waypoint(4.0, 0.03, None)];
        for blend in [Blend::Linear, Blend::RestToRest] {
            let trajectory = Trajectory::new(points.clone(), 10.0, blend, 0.17).unwrap();
            assert_eq!(trajectory.len(), 31);
            let x = |time| trajectory.target(time).position[0];
            for (time, expected) in
                [(0.0, 0.0), (1.0, 0.0), (1.5, 0.005), (2.0, 0.01), (3.0, 0.02), (4.0, 0.03), (9.0, 0.03)]
            {
                assert!((x(time) - expected).abs() < 1e-15, "{time}: {}", x(time));
            }
            let speed = (x(1.5 + 1e-4) - x(1.5 - 1e-4)) / 2e-4;
            let expected = if blend == Blend::Linear { 0.01 } else { 0.01 * 15.0 / 8.0 };
            assert!((speed - expected).abs() < 1e-8);
            let at_rest = (x(2.0) - x(2.0 - 1e-4)) / 1e-4;
            assert_eq!(at_rest < 1e-8, blend == Blend::RestToRest);
        }
    }

    #[test]
    fn rotations_take_the_shortest_way_and_are_free_beside_a_free_one() {
        let half = std::f64::consts::FRAC_PI_4;
        // A quarter turn about z, written with the other sign.
        let quarter = Some([-half.cos(), 0.0, 0.0, -half.sin()]);
        let points = vec![
            waypoint(0.0, 0.0, Some([1.0, 0.0, 0.0, 0.0])),
            waypoint(1.0, 0.0, quarter),
            waypoint(2.0, 0.0, None),
        ];
        let trajectory = Trajectory::new(points, 100.0, Blend::Linear, 0.17).unwrap();
        let middle = unit(trajectory.target(0.5).rotation.unwrap()).unwrap();
        assert!((middle.angle() - 0.5 * std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!(trajectory.target(1.5).rotation.is_none());
    }

    #[test]
    fn the_last_waypoint_is_reached_whatever_the_rate() {
        for (rate, ticks) in [(10.0, 4), (9.0, 4), (1.0 / 0.3, 2), (1.0, 2), (0.1, 2)] {
            let points = vec![waypoint(0.1, 0.0, None), waypoint(0.4, 0.01, None)];
            let trajectory = Trajectory::new(points, rate, Blend::Linear, 0.17).unwrap();
            assert_eq!(trajectory.len(), ticks, "{rate}");
            assert!((trajectory.target(trajectory.time(ticks - 1)).position[0] - 0.01).abs() < 1e-12);
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let make = |points: Vec<Waypoint>, rate| {
            Trajectory::new(points, rate, Blend::Linear, 0.17).map(|_| ()).unwrap_err()
        };
        assert_eq!(make(vec![], 1.0), TrajectoryError::Empty);
        let two = |time, x| vec![waypoint(0.0, 0.0, None), waypoint(time, x, None)];
        assert_eq!(make(two(0.0, 0.0), 1.0), TrajectoryError::Time { index: 1, time: 0.0 });
        assert!(matches!(make(two(f64::NAN, 0.0), 1.0), TrajectoryError::Time { index: 1, .. }));
        assert_eq!(make(two(1.0, f64::NAN), 1.0), TrajectoryError::Pose { index: 1 });
        assert_eq!(make(vec![waypoint(0.0, 0.0, Some([0.0; 4]))], 1.0), TrajectoryError::Pose { index: 0 });
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(matches!(make(two(1.0, 0.0), rate), TrajectoryError::Rate { .. }), "{rate}");
        }
    }
}
