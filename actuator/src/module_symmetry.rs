use crate::{Module, ModuleState, PlacedFree, PoseChart};
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// A motion of space about z that carries a module into itself: a mirror through the plane y = 0 or none, then a turn about z.
///
/// A mirror makes right-handed FREEs left-handed ones. Where FREE `i` comes to stand at the place of FREE `j`, what the module does
/// under pressures `p`, moved along, is what it does under pressures `q` with `q_j = p_i`.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleSymmetry {
    /// The FREE at whose place each FREE comes to stand.
    places: Vec<usize>,
    is_mirror: bool,
    /// Turn about z after the mirror, rad.
    turn: f64,
}

/// Places differ by less than this part of the module's width where they count as the same: what a file's rounding leaves.
const SAME_PLACE: f64 = 1e-6;

impl ModuleSymmetry {
    /// What moves vectors sideways of the axis.
    fn sideways(&self) -> Matrix2<f64> {
        let (sine, cosine) = self.turn.sin_cos();
        let mirror = if self.is_mirror { -1.0 } else { 1.0 };
        Matrix2::new(cosine, -sine * mirror, sine, cosine * mirror)
    }

    /// Whether it moves nothing.
    pub fn is_identity(&self) -> bool {
        !self.is_mirror && self.turn == 0.0
    }

    /// The turn about z, rad from 0 to 2 pi, after the mirror if there is one.
    pub fn turn(&self) -> f64 {
        self.turn
    }

    /// What belongs to the FREEs (pressures, ...), moved along.
    pub fn carry<T: Clone>(&self, of_frees: &[T]) -> Vec<T> {
        let mut carried = of_frees.to_vec();
        for (value, place) in of_frees.iter().zip(&self.places) {
            carried[*place] = value.clone();
        }
        carried
    }

    /// A force, N, or another vector in space.
    pub fn vector(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let sideways = self.sideways() * Vector2::new(x, y);
        [sideways.x, sideways.y, z]
    }

    /// Turns about x, y and z, or moments: a mirror turns them round.
    pub fn turns(&self, turns: [f64; 3]) -> [f64; 3] {
        let sign = if self.is_mirror { -1.0 } else { 1.0 };
        self.vector(turns).map(|value| sign * value)
    }

    /// A pose chart in the order of [`PoseChart::to_array`], or its derivative. Bend and position of the chart are seen from the frame
    /// that has turned by half the twist; as z is kept, they move as they would in the base frame.
    pub fn chart(&self, [twist, bend_x, bend_y, x, y, z]: [f64; 6]) -> [f64; 6] {
        let [bend_x, bend_y, twist] = self.turns([bend_x, bend_y, twist]);
        let [x, y, z] = self.vector([x, y, z]);
        [twist, bend_x, bend_y, x, y, z]
    }

    /// An equilibrium of the module, moved along: that under the pressures moved along.
    pub fn state(&self, state: &ModuleState) -> ModuleState {
        ModuleState {
            chart: PoseChart::from_array(self.chart(state.chart.to_array())),
            slopes: state.slopes.iter().map(|slope| self.chart(*slope)).collect(),
            ..state.clone()
        }
    }

    /// Whether a vector, and a set of directions that are free or not, are kept.
    fn keeps(&self, vector: [f64; 3], free_dof: [bool; 6]) -> bool {
        let moved = self.vector(vector);
        let kept = (0..3).all(|i| (moved[i] - vector[i]).abs() < SAME_PLACE);
        let sideways = self.sideways();
        // An axis goes into the other where the turn is one of 90 degrees; in between both must be free, or none.
        let mixes = sideways[(0, 1)].abs() > SAME_PLACE;
        let [x, y, _, rx, ry, _] = free_dof;
        kept && (!mixes || (x == y && rx == ry))
    }
}

impl Module {
    /// All motions of space about z that carry the module with its FREEs, gravity and guides into itself, the identity first. FREEs
    /// that are alike (but for the hand, under a mirror) may change places.
    pub fn symmetries(&self) -> Vec<ModuleSymmetry> {
        let count = self.frees.len();
        let mut found = vec![ModuleSymmetry { places: (0..count).collect(), is_mirror: false, turn: 0.0 }];
        let distance = |placed: &PlacedFree| placed.position[0].hypot(placed.position[1]);
        let width = self.frees.iter().map(distance).fold(0.0, f64::max);
        // All on the axis: there is nothing by which to choose a turn.
        let Some(outermost) =
            self.frees.iter().find(|placed| distance(placed) == width).filter(|_| width > 0.0)
        else {
            return found;
        };
        let angle = |placed: &PlacedFree| placed.position[1].atan2(placed.position[0]);
        for is_mirror in [false, true] {
            let start = if is_mirror { -angle(outermost) } else { angle(outermost) };
            let others =
                self.frees.iter().filter(|placed| (distance(placed) - width).abs() < SAME_PLACE * width);
            for other in others {
                let turn = (angle(other) - start).rem_euclid(TAU);
                // A whole turn less a rounding error is none.
                let turn = if TAU - turn < SAME_PLACE { 0.0 } else { turn };
                let mut motion = ModuleSymmetry { places: vec![], is_mirror, turn };
                if let Some(places) = self.places(&motion, SAME_PLACE * width) {
                    motion.places = places;
                    if motion.keeps(self.base.gravity, self.tip.free_dof) && !motion.is_identity() {
                        found.push(motion);
                    }
                }
            }
        }
        found
    }

    /// The FREE at whose place each FREE comes to stand, if all find one that is like them.
    fn places(&self, motion: &ModuleSymmetry, tolerance: f64) -> Option<Vec<usize>> {
        let place = |placed: &PlacedFree| {
            let [x, y] = placed.position;
            let [x, y, _] = motion.vector([x, y, 0.0]);
            let mut free = placed.free;
            if motion.is_mirror {
                free.winding.handedness = free.winding.handedness.opposite();
            }
            self.frees.iter().position(|other| {
                let apart = (other.position[0] - x).hypot(other.position[1] - y);
                apart < tolerance && other.free == free
            })
        };
        let places = self.frees.iter().map(place).collect::<Option<Vec<usize>>>()?;
        let mut taken = vec![false; places.len()];
        // Two FREEs in one place cannot both go to the first of two others.
        places.iter().all(|place| !std::mem::replace(&mut taken[*place], true)).then_some(places)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Base, Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tip, Tube, Winding};
    use nalgebra::Vector3;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn module(hands: &[Handedness], start: f64) -> Module {
        let fibre = Fibre { axial_stiffness: 644.0, diameter: 1.5e-4, law: FibreLaw::Linear };
        let placed = |(place, hand): (usize, &Handedness)| {
            let angle = start + TAU * place as f64 / hands.len() as f64;
            PlacedFree {
                free: Free {
                    tube: Tube { length: 0.175, inner_radius: 4.76e-3, wall: 0.8e-3 },
                    winding: Winding::from_hoop(0.5, *hand, 6, fibre),
                    elastomer: Elastomer::Ogden {
                        shear_modulus: 0.393e6,
                        alpha: 1.2,
                        form: OgdenForm::InitialModulus,
                    },
                },
                position: [0.0106 * angle.cos(), 0.0106 * angle.sin()],
            }
        };
        Module {
            frees: hands.iter().enumerate().map(placed).collect(),
            tip: Tip { plate_mass: 5e-3, payload: 0.0, free_dof: [true; 6] },
            base: Base { gravity: [0.0, 0.0, 1.0], free_mass: 4e-3 },
            spacers: 0,
        }
    }

    use Handedness::{Left, Right};

    #[test]
    fn modules_have_the_motions_that_their_places_hands_and_guides_allow() {
        let count = |module: &Module| module.symmetries().len();
        // Two mirrors and half a turn; quarter turns; a third of a turn; one pair that a mirror exchanges.
        assert_eq!(count(&module(&[Right, Left, Right, Left], 0.25 * PI)), 4);
        assert_eq!(count(&module(&[Right; 4], 0.25 * PI)), 4);
        assert_eq!(count(&module(&[Right; 3], 0.3)), 3);
        assert_eq!(count(&module(&[Right, Left], 0.0)), 2);
        assert_eq!(count(&module(&[Right, Right, Left, Left], 0.25 * PI)), 2);
        assert_eq!(count(&module(&[Right, Left, Left], 0.3)), 1);
        assert_eq!(count(&module(&[Right], 0.0)), 1);
        let mut other = module(&[Right; 4], 0.25 * PI);
        other.frees[2].free.tube.wall *= 1.1;
        assert_eq!(count(&other), 1);
        let mut other = module(&[Right; 4], 0.25 * PI);
        other.base.gravity = [1.0, 0.0, 0.0];
        assert_eq!(count(&other), 1);
        other.base.gravity = [0.0; 3];
        other.tip.free_dof[0] = false;
        assert_eq!(count(&other), 2);
        let mut other = module(&[Right; 4], 0.25 * PI);
        other.frees[1].position = [0.0, 0.0];
        assert_eq!(count(&other), 1);
        // Two alike FREEs in one place are not two that may change with two others.
        other.frees[1].position = other.frees[0].position;
        assert!(count(&other) <= 2);
    }

    #[test]
    fn places_are_moved_as_vectors_are() {
        for hands in [[Right, Left, Right, Left], [Right; 4], [Left, Left, Right, Right]] {
            let module = module(&hands, 0.25 * PI);
            let places: Vec<[f64; 2]> = module.frees.iter().map(|placed| placed.position).collect();
            for motion in module.symmetries() {
                // What is carried along stands where its FREE was moved to.
                for (to, from) in places.iter().zip(motion.carry(&places)) {
                    let moved = motion.vector([from[0], from[1], 0.0]);
                    assert!((moved[0] - to[0]).hypot(moved[1] - to[1]) < 1e-15, "{motion:?}");
                }
            }
        }
    }

    #[test]
    fn poses_are_moved_as_frames_are() {
        let chart = PoseChart { twist: 7.9, bend: [0.4, -0.7], position: [0.01, -0.03, 0.16] };
        let state = ModuleState {
            chart,
            slopes: vec![[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]],
            negative_pivots: 2,
            residual: 1e-12,
            gap: Some(1e-3),
        };
        let pose = chart.to_pose();
        for (is_mirror, turn) in [(false, 0.0), (false, FRAC_PI_2), (true, 0.0), (true, 2.0)] {
            let motion = ModuleSymmetry { places: vec![0], is_mirror, turn };
            let moved = motion.state(&state);
            let found = moved.chart.to_pose();
            // x -> M x carries the plate's points X(u) = p + R u into M p + (M R M^T) M u.
            let matrix = motion.sideways().to_homogeneous();
            let position: Vector3<f64> = motion.vector(pose.position.into()).into();
            assert!((found.position - position).norm() < 1e-14);
            let rotation = matrix * pose.rotation.to_rotation_matrix().matrix() * matrix.transpose();
            assert!((found.rotation.to_rotation_matrix().matrix() - rotation).amax() < 1e-12, "{motion:?}");
            assert_eq!((moved.negative_pivots, moved.residual, moved.gap), (2, 1e-12, Some(1e-3)));
            // Slopes move as differences of charts do.
            let ahead =
                PoseChart::from_array(std::array::from_fn(|i| chart.to_array()[i] + state.slopes[0][i]));
            let ahead = motion.state(&ModuleState { chart: ahead, ..state.clone() });
            for i in 0..6 {
                let difference = ahead.chart.to_array()[i] - moved.chart.to_array()[i];
                assert!((difference - moved.slopes[0][i]).abs() < 1e-12);
            }
        }
    }
}
