use super::{
    body::{Element, Follows},
    element::Workspace,
    shape::NODES,
};
use crate::sparse::BlockPattern;
use nalgebra::{Matrix3, Matrix3x6, Matrix6, UnitQuaternion, Vector3};

/// A point, or the frame of a beam's node, in the assembly of the tangent.
#[derive(Clone, Copy)]
pub(super) struct Member {
    pub follows: Follows,
    /// Tells members apart.
    pub index: u32,
    /// Its motion by the cap's, if it follows that.
    pub lever: Matrix3x6<f64>,
    /// Of its unknowns.
    pub frame: Matrix3<f64>,
}

/// Where blocks of the tangent go.
pub(super) struct Scatter<'a> {
    pub values: &'a mut [f64],
    pub pattern: &'a BlockPattern,
    pub follows: &'a [Follows],
    pub frames: &'a [Matrix3<f64>],
    pub cap_frame: Matrix3<f64>,
    pub cap_block: u32,
    pub positions: &'a [[f64; 3]],
    pub cap: Vector3<f64>,
    /// Of the cap with itself, in space.
    pub cap_tangent: Matrix6<f64>,
}

impl Scatter<'_> {
    pub fn add_element(&mut self, element: &Element, work: &Workspace) {
        let frames = element.points.map(|point| self.frames[point as usize]);
        for pair in &element.pairs {
            let [a, b] = pair.nodes.map(usize::from);
            let block = frames[a].tr_mul(&work.block(a, b)) * frames[b];
            for k in 0..3 {
                for i in 0..3 {
                    self.values[pair.place.index(i, k)] += block[(i, k)];
                }
            }
        }
        for &a in &element.on_cap {
            for b in 0..NODES as u8 {
                if b <= a || !element.on_cap.contains(&b) {
                    let [a, b] = [a, b].map(usize::from);
                    let block = work.block(a, b);
                    let [a, b] = [a, b].map(|a| self.member(element.points[a]));
                    self.add(&a, &b, &block);
                }
            }
        }
    }

    /// A point: a step of the cap moves those on it by [1, -[r]x].
    pub fn member(&self, point: u32) -> Member {
        let follows = self.follows[point as usize];
        let mut lever = Matrix3x6::zeros();
        if follows == Follows::Cap {
            let arm = Vector3::from(self.positions[point as usize]) - self.cap;
            lever.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
            lever.fixed_view_mut::<3, 3>(0, 3).copy_from(&-arm.cross_matrix());
        }
        Member { follows, index: point, lever, frame: self.frames[point as usize] }
    }

    /// The frame R of a beam's node: a turn W of the cap is R^T W in the frame of one held by it, to all orders.
    pub fn turning(&self, follows: Follows, node: u32, rotation: &UnitQuaternion<f64>) -> Member {
        let mut lever = Matrix3x6::zeros();
        if follows == Follows::Cap {
            let back = rotation.inverse().to_rotation_matrix();
            lever.fixed_view_mut::<3, 3>(0, 3).copy_from(back.matrix());
        }
        let index = self.follows.len() as u32 + node;
        Member { follows, index, lever, frame: Matrix3::identity() }
    }

    /// Adds the block between two members (points in space) and, where they differ, its transpose between them the other way round.
    pub fn add(&mut self, p: &Member, q: &Member, block: &Matrix3<f64>) {
        let same = p.index == q.index;
        match (p.follows, q.follows) {
            (Follows::Base, _) | (_, Follows::Base) => {}
            (Follows::Cap, Follows::Cap) => {
                let sum = p.lever.tr_mul(block) * q.lever;
                self.cap_tangent += if same { sum } else { sum + sum.transpose() };
            }
            (Follows::Cap, Follows::Own(b)) => {
                let block = p.lever.tr_mul(&(block * q.frame));
                let place = self.pattern.place(self.cap_block, b);
                for (half, rows) in
                    [0, 3].into_iter().zip([block.fixed_rows::<3>(0), block.fixed_rows::<3>(3)])
                {
                    let rows = self.cap_frame.tr_mul(&rows);
                    for i in 0..3 {
                        for k in 0..3 {
                            self.values[place.index(half + i, k)] += rows[(i, k)];
                        }
                    }
                }
            }
            (Follows::Own(_), Follows::Cap) => self.add(q, p, &block.transpose()),
            (Follows::Own(a), Follows::Own(b)) => {
                let block = p.frame.tr_mul(block) * q.frame;
                let place = self.pattern.place(a, b);
                for i in 0..3 {
                    for k in 0..3 {
                        self.values[place.index(i, k)] += block[(i, k)];
                        if a == b && !same {
                            self.values[place.index(k, i)] += block[(i, k)];
                        }
                    }
                }
            }
        }
    }
}
