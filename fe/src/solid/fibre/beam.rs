use super::{Block, FibreState, surface::SurfacePoint, trace::Piece};
use crate::rigid_motion::{Frame, LogVariation};
use actuator::{Fibre, FibreLaw};
use nalgebra::{Matrix3, Matrix6, Rotation3, SMatrix, UnitQuaternion, Vector3, Vector6};

/// Poisson's ratio of the fibre, for its shear modulus E/(2 (1 + nu)); it enters shear and twist alone.
const POISSON: f64 = 0.3;
/// Shear factor of a round section, 6 (1 + nu)/(7 + 6 nu): Cowper (1966), J. Appl. Mech. 33, 335.
const SHEAR_FACTOR: f64 = 6.0 * (1.0 + POISSON) / (7.0 + 6.0 * POISSON);

/// Stiffnesses (GA, GA, EA, EI, EI, GJ), N and N m^2, of a round section of diameter d, even and linear elastic, with the given EA:
/// I = A d^2/16, J = 2 I.
pub(super) fn stiffness(fibre: &Fibre) -> Vector6<f64> {
    let axial = fibre.axial_stiffness;
    let bending = axial * fibre.diameter.powi(2) / 16.0;
    let shear = SHEAR_FACTOR * axial / (2.0 * (1.0 + POISSON));
    Vector6::new(shear, shear, axial, bending, bending, bending / (1.0 + POISSON))
}

/// Frame of the undeformed helix through a point of the surface: x outwards, z along the fibre. `turn` is the fibre's own, rad/m,
/// `flare` the slope of the radius along the tube.
pub(super) fn helix_frame([x, y, _]: [f64; 3], turn: f64, flare: f64) -> UnitQuaternion<f64> {
    let radial = Vector3::new(x, y, 0.0).normalize();
    let tangent = (Vector3::new(-y, x, 0.0) * turn + radial * flare + Vector3::z()).normalize();
    let normal = (radial - tangent * radial.dot(&tangent)).normalize();
    let basis = [normal, tangent.cross(&normal), tangent];
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_basis_unchecked(&basis))
}

/// A node of a fibre as one of its elements sees it.
#[derive(Clone, Copy, Debug)]
struct Node {
    rotation: u32,
    /// Factors of the face's points in its position, in the order of the element's blocks.
    values: [f64; 9],
    /// Turns the node's frame into the sector that the element is in.
    image: UnitQuaternion<f64>,
}

/// Half a piece of fibre with bending, twist and shear: a two-node element with helicoidal interpolation whose nodes' positions are
/// those of the surface, while their rotations are free.
///
/// Energy (d - d0).C (d - d0)/(2 L), d = log(H_a^-1 H_b) with translation first, as in the rods, d0 that of the undeformed helix, L the
/// length of its translation, C = diag(GA, GA, EA, EI, EI, GJ). It is exact for every helix. A thread that takes tension only
/// still bends and twists when it is slack.
#[derive(Clone, Debug)]
pub(crate) struct Beam {
    /// Points that take part, then the two nodes' rotations.
    blocks: Vec<Block>,
    nodes: [Node; 2],
    reference: Vector6<f64>,
    /// C/L.
    stiffness: Vector6<f64>,
    law: FibreLaw,
    fibre: u32,
    /// Of its middle, m.
    arc_length: f64,
}

/// Where an element of a beam lies.
pub(super) struct BeamPlace<'a> {
    pub piece: &'a Piece,
    /// From where to where of the piece, 0 to 1.
    pub shares: [f64; 2],
    /// Numbers of its nodes' rotations, with what turns these into the piece's sector.
    pub nodes: [(u32, UnitQuaternion<f64>); 2],
    pub fibre: u32,
    /// Reference arc length along the fibre to where the element begins, m.
    pub arc_length: f64,
}

impl Beam {
    /// `stiffness` is C; `reference` are all points' positions (m), `rotations` those of all nodes, undeformed.
    pub(super) fn new(
        place: &BeamPlace,
        law: FibreLaw,
        stiffness: Vector6<f64>,
        face: &[u32; 9],
        (reference, rotations): (&[[f64; 3]], &[UnitQuaternion<f64>]),
    ) -> Self {
        let values = place.shares.map(|share| SurfacePoint::new(place.piece, share).values);
        let kept: Vec<usize> = (0..9).filter(|&a| values.iter().any(|values| values[a] != 0.0)).collect();
        let node = |end: usize| {
            let mut packed = [0.0; 9];
            kept.iter().zip(&mut packed).for_each(|(&a, into)| *into = values[end][a]);
            let (rotation, image) = place.nodes[end];
            Node { rotation, values: packed, image }
        };
        let mut blocks: Vec<Block> = kept.iter().map(|&a| Block::Point(face[a])).collect();
        blocks.extend(place.nodes.iter().map(|(rotation, _)| Block::Rotation(*rotation)));
        let mut beam = Beam {
            blocks,
            nodes: [node(0), node(1)],
            reference: Vector6::zeros(),
            stiffness,
            law,
            fibre: place.fibre,
            arc_length: 0.0,
        };
        let [a, b] = beam.frames(reference, rotations);
        beam.reference = a.log_to(&b);
        let length = beam.length();
        beam.stiffness /= length;
        beam.arc_length = place.arc_length + 0.5 * length;
        beam
    }

    /// L, m.
    pub(super) fn length(&self) -> f64 {
        self.reference.fixed_rows::<3>(0).norm()
    }

    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn frames(&self, positions: &[[f64; 3]], rotations: &[UnitQuaternion<f64>]) -> [Frame; 2] {
        self.nodes.map(|node| {
            let mut position = Vector3::zeros();
            for (value, block) in node.values.iter().zip(&self.blocks) {
                if let Block::Point(point) = block {
                    position += Vector3::from(positions[*point as usize]) * *value;
                }
            }
            Frame { rotation: node.image * rotations[node.rotation as usize], position }
        })
    }

    /// Numbers of its nodes' rotations and the positions, in the nodes' own sectors.
    #[cfg(test)]
    pub fn node_places(&self, positions: &[[f64; 3]]) -> [(usize, Vector3<f64>); 2] {
        let still = vec![
            UnitQuaternion::identity();
            self.nodes.iter().map(|n| n.rotation as usize + 1).max().unwrap_or(0)
        ];
        let frames = self.frames(positions, &still);
        [0, 1].map(|n| {
            let node = self.nodes[n];
            (node.rotation as usize, node.image.inverse() * frames[n].position)
        })
    }

    /// d, the force that it meets, and C/L there.
    fn respond(&self, [a, b]: &[Frame; 2]) -> (Vector6<f64>, Vector6<f64>, Vector6<f64>, f64) {
        let d = a.log_to(b);
        let strain = d - self.reference;
        let mut stiffness = self.stiffness;
        if self.law == FibreLaw::TensionOnly && strain[2] <= 0.0 {
            stiffness[2] = 0.0;
        }
        let force = stiffness.component_mul(&strain);
        (d, force, stiffness, 0.5 * force.dot(&strain))
    }

    #[cfg(test)]
    /// Energy, J.
    pub fn energy(&self, positions: &[[f64; 3]], rotations: &[UnitQuaternion<f64>]) -> Option<f64> {
        let (.., energy) = self.respond(&self.frames(positions, rotations));
        energy.is_finite().then_some(energy)
    }

    /// Energy with its derivatives; the form of the arguments is that of [`super::FibreElement::evaluate`].
    pub fn evaluate(
        &self,
        positions: &[[f64; 3]],
        rotations: &[UnitQuaternion<f64>],
        gradient: &mut [f64],
        tangent: &mut [f64],
    ) -> Option<f64> {
        let frames = self.frames(positions, rotations);
        let (d, force, stiffness, energy) = self.respond(&frames);
        if !energy.is_finite() {
            return None;
        }
        let vary = LogVariation::new(&d, &force);
        let stiffness = Matrix6::from_diagonal(&stiffness);
        let on_b = vary.right * stiffness + vary.right_slope;
        let on_a = vary.left * stiffness + vary.left_slope;
        let aa = on_a * vary.left.transpose();
        let bb = on_b * vary.right.transpose();
        let ba = -on_b * vary.left.transpose();
        // By H exp(xi) at both nodes, translation first: what the nodes' own motion makes of it follows.
        let (on, own) = ([-(vary.left * force), vary.right * force], [aa, bb]);
        let mut pull = SMatrix::<f64, 12, 1>::zeros();
        let mut second = SMatrix::<f64, 12, 12>::zeros();
        let turns = frames.map(|frame| {
            let mut turn = Matrix6::identity();
            let back = frame.rotation.inverse().to_rotation_matrix();
            turn.fixed_view_mut::<3, 3>(0, 0).copy_from(back.matrix());
            turn
        });
        for n in 0..2 {
            // Position p + u and rotation R exp(w) are H exp(xi) with xi = (v, w), v = R^T u - w x R^T u/2 to second order: the force on v
            // adds w.(f x R^T u)/2.
            let half: Matrix3<f64> = on[n].fixed_rows::<3>(0).into_owned().cross_matrix() * 0.5;
            let mut symmetric = (own[n] + own[n].transpose()) * 0.5;
            let mut block = symmetric.fixed_view_mut::<3, 3>(3, 0);
            block += half;
            let mut block = symmetric.fixed_view_mut::<3, 3>(0, 3);
            block += half.transpose();
            pull.fixed_rows_mut::<6>(6 * n).copy_from(&(turns[n].transpose() * on[n]));
            let block = turns[n].transpose() * symmetric * turns[n];
            second.fixed_view_mut::<6, 6>(6 * n, 6 * n).copy_from(&block);
        }
        let across = turns[1].transpose() * ba * turns[0];
        second.fixed_view_mut::<6, 6>(6, 0).copy_from(&across);
        second.fixed_view_mut::<6, 6>(0, 6).copy_from(&across.transpose());
        self.spread(&pull, &second, gradient, tangent);
        Some(energy)
    }

    /// The parts that a block's unknowns have in (position, rotation) of node a, then of b.
    fn parts(&self, block: usize) -> [f64; 4] {
        let points = self.blocks.len() - 2;
        match block.checked_sub(points) {
            None => [self.nodes[0].values[block], 0.0, self.nodes[1].values[block], 0.0],
            Some(0) => [0.0, 1.0, 0.0, 0.0],
            Some(_) => [0.0, 0.0, 0.0, 1.0],
        }
    }

    /// Derivatives by the nodes' motions become those by the blocks' unknowns.
    fn spread(
        &self,
        pull: &SMatrix<f64, 12, 1>,
        second: &SMatrix<f64, 12, 12>,
        gradient: &mut [f64],
        tangent: &mut [f64],
    ) {
        let unknowns = 3 * self.blocks.len();
        tangent[..unknowns * unknowns].fill(0.0);
        for j in 0..self.blocks.len() {
            let mut sum = Vector3::zeros();
            // Columns of the block, by all of the nodes' motions.
            let mut columns = SMatrix::<f64, 12, 3>::zeros();
            for (place, part) in self.parts(j).into_iter().enumerate().filter(|(_, part)| *part != 0.0) {
                sum += pull.fixed_rows::<3>(3 * place) * part;
                columns += second.fixed_columns::<3>(3 * place) * part;
            }
            gradient[3 * j..3 * j + 3].copy_from_slice(sum.as_slice());
            for i in 0..self.blocks.len() {
                for (place, part) in self.parts(i).into_iter().enumerate().filter(|(_, part)| *part != 0.0) {
                    for column in 0..3 {
                        let into = &mut tangent[(3 * j + column) * unknowns + 3 * i..][..3];
                        let rows = columns.fixed_view::<3, 1>(3 * place, column);
                        into.iter_mut().zip(rows.iter()).for_each(|(entry, x)| *entry += part * x);
                    }
                }
            }
        }
    }

    /// Where it is and what it carries along itself, at its middle; a beam whose stretch is another element's has none.
    pub fn states(
        &self,
        positions: &[[f64; 3]],
        rotations: &[UnitQuaternion<f64>],
    ) -> impl Iterator<Item = FibreState> {
        let frames = self.frames(positions, rotations);
        let (d, force, ..) = self.respond(&frames);
        let length = self.length();
        let state = FibreState {
            fibre: self.fibre,
            arc_length: self.arc_length,
            position: ((frames[0].position + frames[1].position) * 0.5).into(),
            stretch: 1.0 + (d[2] - self.reference[2]) / length,
            tension: force[2],
            weight: length,
        };
        (self.stiffness[2] > 0.0).then_some(state).into_iter()
    }
}
