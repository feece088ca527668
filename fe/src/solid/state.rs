use super::{fibre::Fibres, mesh::Grid};
use actuator::EndLoad;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// What acts on a solid, in the base frame. Its base is clamped; the tip's cap is rigid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidLoad {
    /// Gauge pressure inside, Pa. Under volume control it is an unknown and this is where the search starts.
    pub pressure: f64,
    /// Whether the pressure acts on the bore only: the ends are sealed by something else than the caps.
    pub open_ends: bool,
    /// Dead force on the middle of the cap, N.
    pub force: Vector3<f64>,
    /// Moment on the cap, N m, of constant direction in space.
    pub moment: Vector3<f64>,
    /// Acceleration of gravity, m/s^2, on the rubber and the cap.
    pub gravity: Vector3<f64>,
    /// Which motions of the cap (x, y, z, turns about x, y, z) are held at those of `displacement` and `turn`; the others are free.
    pub held: [bool; 6],
    /// Displacement of the cap's middle, m, where held.
    pub displacement: Vector3<f64>,
    /// Turn of the cap, rad, where held: any number of turns about one axis. A change is made by turning in space by the difference,
    /// so that a turn about several axes depends on its history.
    pub turn: Vector3<f64>,
}

impl Default for SolidLoad {
    fn default() -> Self {
        SolidLoad {
            pressure: 0.0,
            open_ends: false,
            force: Vector3::zeros(),
            moment: Vector3::zeros(),
            gravity: Vector3::zeros(),
            held: [false; 6],
            displacement: Vector3::zeros(),
            turn: Vector3::zeros(),
        }
    }
}

impl std::fmt::Display for SolidLoad {
    /// The pressure, and what else acts, in kPa, mm, deg, N, N mm.
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{:.4} kPa", 1e-3 * self.pressure)?;
        let vectors = [
            (self.held[..3].contains(&true), "cap moved by", 1e3 * self.displacement, "mm"),
            (self.held[3..].contains(&true), "cap turned by", self.turn.map(f64::to_degrees), "deg"),
            (self.force != Vector3::zeros(), "force", self.force, "N"),
            (self.moment != Vector3::zeros(), "moment", 1e3 * self.moment, "N mm"),
        ];
        for (_, name, value, unit) in vectors.into_iter().filter(|vector| vector.0) {
            write!(out, ", {name} ({:.4}, {:.4}, {:.4}) {unit}", value.x, value.y, value.z)?;
        }
        Ok(())
    }
}

impl SolidLoad {
    /// Pressure alone, the cap free.
    pub fn pressure(pressure: f64) -> Self {
        SolidLoad { pressure, ..Self::default() }
    }

    /// Pressure, and a dead force and torque along the axis on the tip's cap, which is free.
    pub fn axial(pressure: f64, ends: EndLoad) -> Self {
        let along = |size: f64| Vector3::new(0.0, 0.0, size);
        SolidLoad { force: along(ends.force), moment: along(ends.torque), ..Self::pressure(pressure) }
    }

    /// One sector of several keeps the axis: the cap may move and turn along it only.
    pub(super) fn on_sectors(mut self, sectors: usize) -> Self {
        if sectors > 1 {
            for direction in [0, 1, 3, 4] {
                self.held[direction] = true;
            }
        }
        self
    }
}

/// A configuration of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidState {
    /// Positions of all points of the mesh, m.
    pub(super) positions: Vec<[f64; 3]>,
    /// Pressure (tension positive) in each element: its value in the middle and its three slopes, Pa.
    pub(super) pressures: Vec<[f64; 4]>,
    /// Frames of the nodes of beam fibres.
    pub(super) rotations: Vec<UnitQuaternion<f64>>,
    /// Middle of the tip's cap, m.
    pub(super) cap: Vector3<f64>,
    /// Its rotation from the undeformed state.
    pub(super) cap_rotation: UnitQuaternion<f64>,
    /// What acts.
    pub(crate) load: SolidLoad,
    /// Energy stored in rubber and fibres, J (of the part that is meshed).
    pub(super) energy: f64,
    /// Enclosed volume, m^3 (of the part that is meshed).
    pub(super) volume: f64,
    /// Residual over the size of the forces that cancel: evidence of equilibrium.
    pub(super) residual: f64,
}

impl SolidState {
    /// What acts; under volume control with the pressure that was found.
    pub fn load(&self) -> &SolidLoad {
        &self.load
    }

    /// Relative residual of the equilibrium.
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// Position of the cap's middle, m, and its rotation.
    pub fn cap(&self) -> (Vector3<f64>, UnitQuaternion<f64>) {
        (self.cap, self.cap_rotation)
    }
}

/// A change of a configuration that turns the tube's cross-sections instead of shearing them: each plane of points is shifted and
/// turned as a whole, and within it a point moves away from the plane's middle, around it and along the plane's normal.
///
/// To first order it is the displacement it is made from; a turn of any size is exact, where Cartesian displacements would stretch
/// fibres by the square of the angle (a degree of cap rotation a step, with stiff ones).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Motion {
    /// Shift of each plane, m.
    pub shifts: Vec<Vector3<f64>>,
    /// Turn of each plane about its middle, rad.
    pub turns: Vec<Vector3<f64>>,
    /// For each point, beside that: outwards (m), around (rad), along the normal (m).
    pub points: Vec<[f64; 3]>,
    /// Changes of the elements' pressures, Pa.
    pub pressures: Vec<[f64; 4]>,
    /// Turns of the beams' nodes, rad, each in its own frame.
    pub rotations: Vec<Vector3<f64>>,
    /// Shift (m) and turn (rad, in space) of the cap.
    pub cap: [Vector3<f64>; 2],
}

impl Motion {
    pub fn none(state: &SolidState, planes: usize) -> Self {
        Motion {
            shifts: vec![Vector3::zeros(); planes],
            turns: vec![Vector3::zeros(); planes],
            points: vec![[0.0; 3]; state.positions.len()],
            pressures: vec![[0.0; 4]; state.pressures.len()],
            rotations: vec![Vector3::zeros(); state.rotations.len()],
            cap: [Vector3::zeros(); 2],
        }
    }

    /// Multiplies the motion by `factor`.
    pub fn scale(&mut self, factor: f64) {
        let still = self.clone();
        self.add(factor - 1.0, &still);
    }

    /// Adds `factor` times another motion.
    pub fn add(&mut self, factor: f64, other: &Motion) {
        let each = |to: &mut [f64], from: &[f64]| {
            for (to, from) in to.iter_mut().zip(from) {
                *to += factor * from;
            }
        };
        each(self.points.as_flattened_mut(), other.points.as_flattened());
        each(self.pressures.as_flattened_mut(), other.pressures.as_flattened());
        let vectors = [
            (&mut self.shifts, &other.shifts),
            (&mut self.turns, &other.turns),
            (&mut self.rotations, &other.rotations),
        ];
        for (to, from) in vectors {
            for (to, from) in to.iter_mut().zip(from) {
                *to += factor * from;
            }
        }
        for (to, from) in self.cap.iter_mut().zip(&other.cap) {
            *to += factor * from;
        }
    }
}

/// Middle and normal of each plane of points; in a sector's mesh the middle lies on the axis.
pub(super) struct Planes {
    pub middles: Vec<Vector3<f64>>,
    pub normals: Vec<Vector3<f64>>,
}

impl Planes {
    pub fn new(grid: &Grid, positions: &[[f64; 3]]) -> Self {
        let each = grid.lines[0] * grid.lines[1];
        let middles: Vec<Vector3<f64>> = positions
            .chunks_exact(each)
            .map(|plane| {
                let sum: Vector3<f64> = plane.iter().map(|at| Vector3::from(*at)).sum();
                let middle = sum / each as f64;
                if grid.sectors > 1 { Vector3::new(0.0, 0.0, middle.z) } else { middle }
            })
            .collect();
        let last = middles.len() - 1;
        let normals = (0..=last)
            .map(|k| {
                // The clamped and the capped end stay flat: there the chord to the neighbour would tilt.
                let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
                (middles[after] - middles[before]).try_normalize(0.0).unwrap_or(Vector3::z())
            })
            .collect();
        Planes { middles, normals }
    }
}

/// Outward and around directions of a point of a plane, its distance from the middle and its height over the plane.
fn local_frame(
    at: Vector3<f64>,
    middle: Vector3<f64>,
    normal: Vector3<f64>,
) -> ([Vector3<f64>; 2], f64, f64) {
    let arm = at - middle;
    let height = arm.dot(&normal);
    let outward = arm - height * normal;
    let radius = outward.norm();
    let outward = outward / radius;
    ([outward, normal.cross(&outward)], radius, height)
}

/// Sets the frame of each point (columns: away from its plane's middle, around it, along the plane's normal). It turns with the body.
pub(super) fn set_local_frames(grid: &Grid, positions: &[[f64; 3]], frames: &mut [Matrix3<f64>]) {
    let planes = Planes::new(grid, positions);
    let each = grid.lines[0] * grid.lines[1];
    for (point, (at, frame)) in positions.iter().zip(frames).enumerate() {
        let normal = planes.normals[point / each];
        let ([outward, around], ..) = local_frame(Vector3::from(*at), planes.middles[point / each], normal);
        *frame = Matrix3::from_columns(&[outward, around, normal]);
    }
}

/// Turn of a plane of points about its middle by which their displacements beyond the middle's shift are met best: around, in the mean
/// of their angles, and out of the plane, by least squares.
fn plane_turn(
    grid: &Grid,
    points: &[[f64; 3]],
    displacements: &[[f64; 3]],
    (middle, shift): (Vector3<f64>, Vector3<f64>),
    normal: Vector3<f64>,
) -> Vector3<f64> {
    // A sector turns about the axis alone, which its points do for themselves.
    if grid.sectors > 1 {
        return Vector3::zeros();
    }
    // Out of the plane by t.(a x n) for a tilt t and an arm a in the plane.
    let (mut around_sum, mut squares, mut moments) = (0.0, Matrix3::zeros(), Vector3::zeros());
    for (at, displacement) in points.iter().zip(displacements) {
        let ([outward, around], radius, _) = local_frame(Vector3::from(*at), middle, normal);
        let moved = Vector3::from(*displacement) - shift;
        around_sum += moved.dot(&around) / radius;
        let lever = radius * outward.cross(&normal);
        squares += lever * lever.transpose();
        moments += lever * moved.dot(&normal);
    }
    // The levers lie in the plane: along the normal the sum is made regular.
    squares += normal * normal.transpose() * (0.5 * squares.trace());
    let tilt = squares.try_inverse().map_or(Vector3::zeros(), |inverse| inverse * moments);
    tilt + normal * (around_sum / points.len() as f64)
}

/// The motion of which `displacements` of the points are the first order. Pressures, rotations and cap are left at zero.
pub(super) fn motion_of(grid: &Grid, state: &SolidState, displacements: &[[f64; 3]]) -> Motion {
    let planes = Planes::new(grid, &state.positions);
    let mut motion = Motion::none(state, planes.middles.len());
    let each = grid.lines[0] * grid.lines[1];
    for (k, shift) in motion.shifts.iter_mut().enumerate() {
        let range = k * each..(k + 1) * each;
        let sum: Vector3<f64> = displacements[range.clone()].iter().map(|u| Vector3::from(*u)).sum();
        *shift = sum / each as f64;
        if grid.sectors > 1 {
            *shift = Vector3::new(0.0, 0.0, shift.z);
        }
        let (middle, normal) = (planes.middles[k], planes.normals[k]);
        let turn = plane_turn(
            grid,
            &state.positions[range.clone()],
            &displacements[range.clone()],
            (middle, *shift),
            normal,
        );
        motion.turns[k] = turn;
        for point in range {
            let at = Vector3::from(state.positions[point]);
            let ([outward, around], radius, _) = local_frame(at, middle, normal);
            let moved = Vector3::from(displacements[point]) - *shift - turn.cross(&(at - middle));
            motion.points[point] = [moved.dot(&outward), moved.dot(&around) / radius, moved.dot(&normal)];
        }
    }
    motion
}

/// The motion from one configuration to another. `about` is what it is about, summed from steps: it says which of the turns that differ by
/// 2 pi is meant, and the turns of cap and rotation nodes. Such a sum is not good for an extrapolation: a shift of a plane and the
/// opposite shift of its points are nothing together, and grow from step to step as rounding errors do that nothing corrects.
pub(super) fn motion_between(grid: &Grid, from: &SolidState, to: &SolidState, about: Motion) -> Motion {
    let (planes, moved) = (Planes::new(grid, &from.positions), Planes::new(grid, &to.positions));
    let each = grid.lines[0] * grid.lines[1];
    let mut motion = about;
    for (k, shift) in motion.shifts.iter_mut().enumerate() {
        *shift = moved.middles[k] - planes.middles[k];
    }
    let arm = |back: &Rotation3<f64>, point: usize| {
        back * (Vector3::from(to.positions[point]) - moved.middles[point / each])
    };
    for (k, turn) in motion.turns.iter_mut().enumerate() {
        let (points, back) = (k * each..(k + 1) * each, Rotation3::new(-*turn));
        let left = |point| arm(&back, point) + planes.middles[k] - Vector3::from(from.positions[point]);
        let left: Vec<[f64; 3]> = points.clone().map(|point| left(point).into()).collect();
        let middle = (planes.middles[k], Vector3::zeros());
        let more = plane_turn(grid, &from.positions[points], &left, middle, planes.normals[k]);
        // Turns of a plane and of its points are nothing together, too.
        let whole = (Rotation3::new(*turn) * Rotation3::new(more)).scaled_axis();
        let axis = whole.try_normalize(0.0).unwrap_or(Vector3::z());
        *turn = whole + axis * (TAU * ((turn.dot(&axis) - whole.norm()) / TAU).round());
    }
    let backs: Vec<Rotation3<f64>> = motion.turns.iter().map(|turn| Rotation3::new(-turn)).collect();
    for (point, entry) in motion.points.iter_mut().enumerate() {
        let k = point / each;
        let (middle, normal) = (planes.middles[k], planes.normals[k]);
        let at = Vector3::from(from.positions[point]);
        let ([outward, around], radius, height) = local_frame(at, middle, normal);
        let arm = arm(&backs[k], point);
        let (x, y) = (arm.dot(&outward), arm.dot(&around));
        let angle = y.atan2(x);
        let turns = ((entry[1] - angle) / TAU).round();
        *entry = [x.hypot(y) - radius, angle + TAU * turns, arm.dot(&normal) - height];
    }
    for (change, (new, old)) in motion.pressures.iter_mut().zip(to.pressures.iter().zip(&from.pressures)) {
        *change = std::array::from_fn(|p| new[p] - old[p]);
    }
    motion.cap[0] = to.cap - from.cap;
    motion
}

impl SolidState {
    /// The configuration after a motion: positions, pressures, rotations and cap; what the points of the base and of the cap and
    /// the images of a sector do is for the body to say.
    pub(super) fn moved(&self, grid: &Grid, motion: &Motion) -> SolidState {
        let planes = Planes::new(grid, &self.positions);
        let each = grid.lines[0] * grid.lines[1];
        let turns: Vec<Rotation3<f64>> = motion.turns.iter().map(|turn| Rotation3::new(*turn)).collect();
        let mut next = self.clone();
        for (point, [out, around, along]) in motion.points.iter().copied().enumerate() {
            let k = point / each;
            let (middle, normal) = (planes.middles[k], planes.normals[k]);
            let ([e_out, e_around], radius, height) =
                local_frame(Vector3::from(self.positions[point]), middle, normal);
            let (sine, cosine) = around.sin_cos();
            let arm = (radius + out) * (cosine * e_out + sine * e_around) + (height + along) * normal;
            next.positions[point] = (middle + motion.shifts[k] + turns[k] * arm).into();
        }
        for (pressure, change) in
            next.pressures.as_flattened_mut().iter_mut().zip(motion.pressures.as_flattened())
        {
            *pressure += change;
        }
        for (rotation, turn) in next.rotations.iter_mut().zip(&motion.rotations) {
            *rotation = Fibres::moved(rotation, (*turn).into());
        }
        next.cap += motion.cap[0];
        next.cap_rotation = UnitQuaternion::from_scaled_axis(motion.cap[1]) * next.cap_rotation;
        next
    }
}
