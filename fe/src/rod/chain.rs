use super::{
    element::ElementLaw,
    motion::{Frame, joined},
    pivots::InvertedBlock,
};
use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3, Vector6};

/// Columns carried through the elimination: the gradient, its derivative with respect to the FREE's pressure, and with respect
/// to the factor on the bending stiffness.
pub(super) type Columns = SMatrix<f64, 6, 3>;

/// One FREE as a chain of elements from the base plate (fixed) to the tip plate.
pub(super) struct Chain<'a> {
    pub law: ElementLaw<'a>,
    /// Weight of the FREE along gravity, N.
    pub weight: Vector3<f64>,
    /// Its axis on both plates, m.
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
        Frame { rotation: plate.rotation, position: plate.position + plate.rotation * self.offset }
    }

    /// Motion of the chain's tip for a motion of the plate, both in the plate's directions: v - t x w, w.
    pub fn to_tip(&self) -> Matrix6<f64> {
        let mut matrix = Matrix6::identity();
        matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&-self.offset.cross_matrix());
        matrix
    }

    /// All frames from base to tip.
    pub fn frames<'f>(&self, inner: &'f [Frame], plate: &Frame) -> impl Iterator<Item = Frame> + use<'f> {
        std::iter::once(self.base()).chain(inner.iter().copied()).chain(std::iter::once(self.tip(plate)))
    }

    /// Energy, gradient and tangent; `None` when the section law has no answer somewhere.
    pub fn assemble(
        &self,
        inner: &[Frame],
        plate: &Frame,
        pressure: f64,
        sensitivities: bool,
    ) -> Option<Assembly> {
        let elements = inner.len() + 1;
        let mut assembly = Assembly {
            energy: 0.0,
            columns: vec![Columns::zeros(); elements],
            diagonal: vec![Matrix6::zeros(); elements],
            upper: vec![Matrix6::zeros(); elements],
        };
        let mut below = self.base();
        for (index, above) in self.frames(inner, plate).skip(1).enumerate() {
            let element = self.law.evaluate(&below, &above, pressure, sensitivities)?;
            assembly.energy += element.energy;
            let parts = [element.gradient, element.pressure_gradient, element.bending_gradient];
            for (column, [on_below, on_above]) in parts.iter().enumerate() {
                let mut target = assembly.columns[index].column_mut(column);
                target += on_above;
                if index > 0 {
                    let mut target = assembly.columns[index - 1].column_mut(column);
                    target += on_below;
                }
            }
            let [aa, ab, bb] = element.tangent;
            assembly.diagonal[index] += bb;
            if index > 0 {
                assembly.diagonal[index - 1] += aa;
                assembly.upper[index - 1] = ab;
            }
            self.add_weight(
                &above,
                if index + 1 == elements { 0.5 } else { 1.0 } / elements as f64,
                index,
                &mut assembly,
            );
            below = above;
        }
        Some(assembly)
    }

    /// A share of the weight hung on a node: energy -w.x; with G = -R^T w its gradient is (G, 0), its second derivative
    /// v.(G x w_rotation)/2 twice, because a node moved by exp(xi) also swings.
    fn add_weight(&self, node: &Frame, share: f64, index: usize, assembly: &mut Assembly) {
        let weight = self.weight * share;
        assembly.energy -= weight.dot(&node.position);
        let pull = -node.rotation.inverse_transform_vector(&weight);
        let mut target = assembly.columns[index].column_mut(0);
        target += joined(pull, Vector3::zeros());
        let half: Matrix3<f64> = pull.cross_matrix() * 0.5;
        let mut block = assembly.diagonal[index].fixed_view_mut::<3, 3>(0, 3);
        block += half;
        let mut block = assembly.diagonal[index].fixed_view_mut::<3, 3>(3, 0);
        block += half.transpose();
    }

    /// Eliminates the inner nodes from the base up; `None` when one of their blocks is singular.
    pub fn condense(&self, assembly: &Assembly) -> Option<Condensed> {
        let last = assembly.columns.len() - 1;
        let mut moves = Vec::with_capacity(last);
        let mut negative = 0;
        let (mut block, mut columns) = (assembly.diagonal[0], assembly.columns[0]);
        for k in 0..last {
            let InvertedBlock { inverse, negative: more } = InvertedBlock::new(&block)?;
            negative += more;
            let upper = assembly.upper[k];
            let (own, follow) = (-inverse * columns, -inverse * upper);
            // S_(k+1) = K_(k+1) - U^T S_k^-1 U, and the same for the columns.
            block = assembly.diagonal[k + 1] + upper.transpose() * follow;
            columns = assembly.columns[k + 1] + upper.transpose() * own;
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

impl Condensed {
    /// Newton's motion of the inner nodes for a motion of the plate (in the plate's frame).
    pub fn inner_motion(&self, plate: &Vector6<f64>) -> Vec<Vector6<f64>> {
        let mut above = self.to_tip * plate;
        let mut motion: Vec<_> = self
            .moves
            .iter()
            .rev()
            .map(|(own, follow)| {
                above = own.column(0) + follow * above;
                above
            })
            .collect();
        motion.reverse();
        motion
    }
}
