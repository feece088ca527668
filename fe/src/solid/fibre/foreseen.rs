use super::{
    Crossing, FibreElement, Truss,
    truss::{Gauss, dot, norm},
};

impl Crossing {
    /// Squares |y_g|^2 after a part of the displacements, to first order.
    fn foreseen(&self, positions: &[[f64; 3]], displacements: &[[f64; 3]], part: f64) -> Vec<f64> {
        let (y, moved) = (self.samples(positions), self.samples(displacements));
        y.iter().zip(&moved).map(|(y, moved)| dot(*y, *y) + 2.0 * part * dot(*y, *moved)).collect()
    }

    /// Replaces the tension in the tangent at the positions by that of other squares.
    fn swap_tension(&self, positions: &[[f64; 3]], squares: &[f64], tangent: &mut [f64]) -> Option<()> {
        let (_, own, _) = self.by_samples(&self.samples(positions).map(|y| dot(y, y)))?;
        let (_, other, _) = self.by_samples(squares.try_into().ok()?)?;
        for (column, into) in tangent[..27 * 27].chunks_exact_mut(27).enumerate() {
            let b = column / 3;
            let scaled: [f64; 4] = std::array::from_fn(|g| (other[g] - own[g]) * self.slopes[g][b]);
            for a in 0..9 {
                into[3 * a + column % 3] += (0..4).map(|g| scaled[g] * self.slopes[g][a]).sum::<f64>();
            }
        }
        Some(())
    }
}

impl Truss {
    /// Stretches after a part of the displacements, to first order.
    fn foreseen(&self, positions: &[[f64; 3]], displacements: &[[f64; 3]], part: f64) -> Vec<f64> {
        let (positions, displacements) = (self.gather(positions), self.gather(displacements));
        let stretch = |point: &Gauss| {
            let (along, moved) =
                (self.combine(&point.slopes, &positions), self.combine(&point.slopes, &displacements));
            let stretch = norm(along);
            stretch + part * dot(along, moved) / stretch
        };
        self.points.iter().map(stretch).collect()
    }

    /// Replaces the tension in the tangent at the positions by that of other stretches.
    fn swap_tension(&self, positions: &[[f64; 3]], stretches: &[f64], tangent: &mut [f64]) -> Option<()> {
        let positions = self.gather(positions);
        let unknowns = 3 * self.blocks().len();
        for (point, foreseen) in self.points.iter().zip(stretches) {
            let along = self.combine(&point.slopes, &positions);
            let stretch = norm(along);
            let taut = |stretch: f64| if self.is_slack(stretch) { 0.0 } else { stretch - 1.0 };
            // f/lambda (1 - t t), f = EA ds (lambda - 1): the part of the tangent that is the tension's.
            let more = point.weight * (taut(*foreseen) - taut(stretch)) / stretch;
            let t = along.map(|x| x / stretch);
            for (column, into) in tangent[..unknowns * unknowns].chunks_exact_mut(unknowns).enumerate() {
                let (b, j) = (column / 3, column % 3);
                for (row, entry) in into.iter_mut().enumerate() {
                    let (a, i) = (row / 3, row % 3);
                    let across = if i == j { 1.0 } else { 0.0 } - t[i] * t[j];
                    *entry += more * point.slopes[a] * point.slopes[b] * across;
                }
            }
        }
        Some(())
    }
}

/// What the tensions of fibres are foreseen to be after a step, to first order.
///
/// Fibres are next to inextensible: a step that is right to first order leaves stretches of second order in them, whose tensions, of either
/// sign, are large beside those that belong there and vanish with the next step. In the tangent they would stiffen the body or make it
/// buckle. Tensions that follow the displacements linearly are nearly right, and Newton's method takes longer steps with them (as with
/// stresses as independent unknowns: Magisano, Leonetti, Garcea, Int. J. Numer. Meth. Engng 2017). The residual stays that of the positions.
#[derive(Clone, Debug, Default)]
pub(crate) struct ForeseenTensions(Vec<Vec<f64>>);

impl ForeseenTensions {
    /// After a part of the displacements (m) of all points from the positions. Those of beams are left alone.
    pub fn new(
        elements: &[FibreElement],
        positions: &[[f64; 3]],
        displacements: &[[f64; 3]],
        part: f64,
    ) -> Self {
        let foreseen = |element: &FibreElement| match element {
            FibreElement::Truss(truss) => truss.foreseen(positions, displacements, part),
            FibreElement::Crossing(crossing) => crossing.foreseen(positions, displacements, part),
            FibreElement::Beam(_) => vec![],
        };
        ForeseenTensions(elements.iter().map(foreseen).collect())
    }

    /// Puts them into the tangent of element `index` at the positions. `None` where a fibre has shrunk to a point.
    pub fn put_into(
        &self,
        index: usize,
        element: &FibreElement,
        positions: &[[f64; 3]],
        tangent: &mut [f64],
    ) -> Option<()> {
        match (element, self.0.get(index)) {
            (FibreElement::Truss(truss), Some(foreseen)) => truss.swap_tension(positions, foreseen, tangent),
            (FibreElement::Crossing(crossing), Some(foreseen)) => {
                crossing.swap_tension(positions, foreseen, tangent)
            }
            _ => Some(()),
        }
    }
}
