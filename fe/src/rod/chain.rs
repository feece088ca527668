use super::element::ElementLaw;
use crate::{
    rigid_motion::{Frame, joined},
    tip_plate::{InvertedBlock, at_arm, shifted, swing},
};
use nalgebra::{Matrix6, Matrix6xX, Vector3, Vector6};

/// Columns carried through the elimination: the gradient and, where sensitivities are asked for, its derivatives with respect
/// to the factor on the bending stiffness and to the pressure of each member.
pub(super) type Columns = Matrix6xX<f64>;

/// A FREE of a chain.
pub(super) struct Member<'a> {
    /// Its index in the module.
    pub free: usize,
    pub law: ElementLaw<'a>,
    /// Its weight along gravity, N.
    pub weight: Vector3<f64>,
    /// Its axis in the frames of the chain's nodes, m.
    pub arm: Vector3<f64>,
    /// Reference length next to a cap that feels it, m.
    pub end_zone: f64,
}

/// FREEs that share their nodes, as a chain of elements from the base plate (fixed) to the tip plate: one FREE on its own, or all
/// that spacers tie together.
pub(super) struct Chain<'a> {
    pub members: Vec<Member<'a>>,
    /// Origin of the chain's nodes on both plates, m.
    pub offset: Vector3<f64>,
}

/// The chain's equilibrium with its inner nodes still free.
pub(super) struct Assembly {
    pub energy: f64,
    /// Of nodes 1 to n, the last at the tip.
    pub columns: Vec<Columns>,
    diagonal: Vec<Matrix6<f64>>,
    /// Between nodes k and k + 1, for k from 1.
    upper: Vec<Matrix6<f64>>,
}

impl Member<'_> {
    /// Caps per reference length that an element feels: each cap is spread over its end zone, or over one element if that is longer.
    fn ends(&self, index: usize, elements: usize) -> f64 {
        let length = self.law.length;
        let zone = self.end_zone.max(length).min(length * elements as f64);
        let part = |from_cap: usize| (zone - from_cap as f64 * length).clamp(0.0, length) / zone;
        (part(index) + part(elements - 1 - index)) / length
    }

    /// Frame of the FREE's axis at a node.
    pub fn frame(&self, node: &Frame) -> Frame {
        shifted(node, &self.arm)
    }
}

/// The chain seen from the tip plate, in the plate's frame, and what is needed to find its inner nodes again.
pub(super) struct Condensed {
    pub stiffness: Matrix6<f64>,
    pub columns: Columns,
    /// Gradient at the plate before the inner nodes are eliminated.
    pub plain_gradient: Vector6<f64>,
    pub negative: u32,
    /// Motion of node k for a resting node k + 1, and per motion of node k + 1.
    moves: Vec<(Columns, Matrix6<f64>)>,
    to_tip: Matrix6<f64>,
}

impl Chain<'_> {
    /// Frame of the chain's base.
    pub fn base(&self) -> Frame {
        Frame { rotation: nalgebra::UnitQuaternion::identity(), position: self.offset }
    }

    /// Frame of the chain's tip on a plate.
    pub fn tip(&self, plate: &Frame) -> Frame {
        shifted(plate, &self.offset)
    }

    /// Motion of the chain's tip for a motion of the plate.
    pub fn to_tip(&self) -> Matrix6<f64> {
        at_arm(&self.offset)
    }

    /// Column of a member's pressure, by its place in the chain.
    pub fn pressure_column(member: usize) -> usize {
        2 + member
    }

    /// Column of the factor on the bending stiffness.
    pub const BENDING_COLUMN: usize = 1;

    /// All frames from base to tip.
    pub fn frames<'f>(&self, inner: &'f [Frame], plate: &Frame) -> impl Iterator<Item = Frame> + use<'f> {
        std::iter::once(self.base()).chain(inner.iter().copied()).chain(std::iter::once(self.tip(plate)))
    }

    /// Energy, gradient and tangent at the module's pressures; `None` when the section law has no answer somewhere.
    pub fn assemble(
        &self,
        inner: &[Frame],
        plate: &Frame,
        pressures: &[f64],
        sensitivities: bool,
    ) -> Option<Assembly> {
        let elements = inner.len() + 1;
        let columns = if sensitivities { Self::pressure_column(self.members.len()) } else { 1 };
        let mut assembly = Assembly {
            energy: 0.0,
            columns: vec![Columns::zeros(columns); elements],
            diagonal: vec![Matrix6::zeros(); elements],
            upper: vec![Matrix6::zeros(); elements],
        };
        for (place, member) in self.members.iter().enumerate() {
            let arm = at_arm(&member.arm);
            let back = arm.transpose();
            let mut below = member.frame(&self.base());
            for (index, node) in self.frames(inner, plate).skip(1).enumerate() {
                let above = member.frame(&node);
                let ends = member.ends(index, elements);
                let law = ElementLaw { ends, ..member.law };
                let element = law.evaluate(&below, &above, pressures[member.free], sensitivities)?;
                assembly.energy += element.energy;
                let mut add = |column: usize, [on_below, on_above]: [Vector6<f64>; 2]| {
                    let mut target = assembly.columns[index].column_mut(column);
                    target += back * on_above;
                    if index > 0 {
                        let mut target = assembly.columns[index - 1].column_mut(column);
                        target += back * on_below;
                    }
                };
                add(0, element.gradient);
                if sensitivities {
                    add(Self::BENDING_COLUMN, element.bending_gradient);
                    add(Self::pressure_column(place), element.pressure_gradient);
                }
                let [aa, ab, bb] = element.tangent;
                assembly.diagonal[index] += back * bb * arm;
                if index > 0 {
                    assembly.diagonal[index - 1] += back * aa * arm;
                    assembly.upper[index - 1] += back * ab * arm;
                }
                let share = if index + 1 == elements { 0.5 } else { 1.0 } / elements as f64;
                let (energy, pull, block) = hung(&(member.weight * share), &above);
                assembly.energy += energy;
                let mut target = assembly.columns[index].column_mut(0);
                target += back * pull;
                assembly.diagonal[index] += back * block * arm;
                below = above;
            }
        }
        Some(assembly)
    }

    /// Eliminates the inner nodes, each made stiffer by `stiffener`, from the base up; `None` when one of their blocks is singular.
    pub fn condense(&self, assembly: &Assembly, stiffener: &Matrix6<f64>) -> Option<Condensed> {
        let last = assembly.columns.len() - 1;
        let mut moves = Vec::with_capacity(last);
        let mut negative = 0;
        let (mut block, mut columns) = (assembly.diagonal[0], assembly.columns[0].clone());
        for k in 0..last {
            let InvertedBlock { inverse, negative: more } = InvertedBlock::new(&(block + stiffener))?;
            negative += more;
            let upper = assembly.upper[k];
            let (own, follow) = (-(inverse * columns), -inverse * upper);
            // S_(k+1) = K_(k+1) - U^T S_k^-1 U, and the same for the columns.
            block = assembly.diagonal[k + 1] + upper.transpose() * follow;
            columns = &assembly.columns[k + 1] + upper.transpose() * &own;
            moves.push((own, follow));
        }
        let to_tip = self.to_tip();
        let turn = to_tip.transpose();
        Some(Condensed {
            stiffness: turn * block * to_tip,
            columns: turn * columns,
            plain_gradient: turn * assembly.columns[last].column(0),
            negative,
            moves,
            to_tip,
        })
    }
}

/// A weight hung on a frame: energy -w.x, its gradient (-R^T w, 0) and second derivatives.
fn hung(weight: &Vector3<f64>, at: &Frame) -> (f64, Vector6<f64>, Matrix6<f64>) {
    let pull = -at.rotation.inverse_transform_vector(weight);
    (-weight.dot(&at.position), joined(pull, Vector3::zeros()), swing(&pull))
}

impl Condensed {
    /// Motion of the inner nodes against a column for a motion of the plate (in the plate's frame).
    pub fn inner_motion(&self, column: usize, plate: &Vector6<f64>) -> Vec<Vector6<f64>> {
        let mut above = self.to_tip * plate;
        let mut motion: Vec<_> = self
            .moves
            .iter()
            .rev()
            .map(|(own, follow)| {
                above = own.column(column) + follow * above;
                above
            })
            .collect();
        motion.reverse();
        motion
    }
}
