use super::{
    Block, FibreState,
    surface::{SurfacePoint, face_slopes},
    truss::{GAUSS, TrussPiece, dot},
};
use actuator::{Fibre, FibreLaw};

/// sqrt(3): the samples are at +-1/sqrt(3) both ways.
const ROOT: f64 = 1.732_050_807_568_877_2;

#[derive(Clone, Copy, Debug)]
struct Point {
    /// lambda^2 = sum_g factors_g |y_g|^2.
    factors: [f64; 4],
    /// EA ds, N m.
    weight: f64,
    values: [f64; 9],
    fibre: u32,
    arc_length: f64,
}

/// All that fibres of one family have in a cell that they cross on their way from line to line of the mesh.
///
/// A quadratic surface through points of a smooth one has slopes of second order in error, which would stretch a fibre that is next
/// to inextensible: it locks. Only at the four places +-1/sqrt(3) are they one order better, so metric tensors are taken
/// from there: with y_g the derivative of the position in the fibres' direction at place g and L_g the bilinear function that is one there,
///
/// lambda^2 = sum_g L_g |y_g|^2 / sum_g L_g |Y_g|^2, Y_g that of the undeformed surface,
///
/// an assumed strain in the manner of shells. Energy and law are those of [`super::Truss`]; along pieces lambda^2 is quadratic,
/// and two points on each integrate it.
#[derive(Clone, Debug)]
pub(crate) struct Crossing {
    face: [u32; 9],
    blocks: [Block; 9],
    law: FibreLaw,
    /// Of a whole fibre, N.
    axial_stiffness: f64,
    /// Factors of the nine points in y_g.
    pub(super) slopes: [[f64; 9]; 4],
    points: Vec<Point>,
}

/// What the points' energies add up to, as a function of the four |y_g|^2: value, twice the gradient, four times the Hessian.
pub(super) type BySamples = (f64, [f64; 4], [[f64; 4]; 4]);

impl Crossing {
    /// The pieces of a family's fibres in the face of the given points; `reference` are all points' positions, m.
    pub(super) fn new(pieces: &[TrussPiece], fibre: &Fibre, face: &[u32; 9], reference: &[[f64; 3]]) -> Self {
        // All pieces have one direction, that of the first.
        let [around, along] = pieces[0].piece.direction();
        let direction = [around / along, 1.0];
        let slopes: [[f64; 9]; 4] = std::array::from_fn(|g| {
            let sign = |bit: usize| if g & bit == 0 { -1.0 / ROOT } else { 1.0 / ROOT };
            face_slopes([sign(1), sign(2)], direction)
        });
        let metric = slopes.map(|slopes| {
            let along = SurfacePoint::combine(&slopes, face, reference);
            dot(along, along)
        });
        let bilinear = |[a, z]: [f64; 2]| -> [f64; 4] {
            std::array::from_fn(|g| {
                let part = |bit: usize, x: f64| 0.5 * (1.0 + if g & bit == 0 { -ROOT * x } else { ROOT * x });
                part(1, a) * part(2, z)
            })
        };
        let mut points = vec![];
        for traced in pieces {
            let rate = traced.piece.direction()[1];
            for (share, weight) in GAUSS {
                let factors = bilinear(traced.piece.at(share));
                let square: f64 = factors.iter().zip(metric).map(|(factor, m)| factor * m).sum();
                let speed = square.sqrt() * rate;
                points.push(Point {
                    factors: factors.map(|factor| factor / square),
                    weight: fibre.axial_stiffness * traced.share * weight * speed,
                    values: SurfacePoint::new(&traced.piece, share).values,
                    fibre: traced.fibre,
                    arc_length: traced.arc_length + speed * share,
                });
            }
        }
        Crossing {
            face: *face,
            blocks: face.map(Block::Point),
            law: fibre.law,
            axial_stiffness: fibre.axial_stiffness,
            slopes,
            points,
        }
    }

    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    pub(super) fn samples(&self, positions: &[[f64; 3]]) -> [[f64; 3]; 4] {
        let corner = positions[self.face[0] as usize];
        // Relative to one of them: far from the origin nothing is lost.
        let near = self.face.map(|point| {
            let x = positions[point as usize];
            [x[0] - corner[0], x[1] - corner[1], x[2] - corner[2]]
        });
        self.slopes.map(|slopes| {
            let mut sum = [0.0; 3];
            for (slope, x) in slopes.iter().zip(&near) {
                sum.iter_mut().zip(x).for_each(|(total, x)| *total += slope * x);
            }
            sum
        })
    }

    fn is_slack(&self, stretch: f64) -> bool {
        self.law == FibreLaw::TensionOnly && stretch <= 1.0
    }

    pub(super) fn by_samples(&self, metric: &[f64; 4]) -> Option<BySamples> {
        let mut sum: BySamples = (0.0, [0.0; 4], [[0.0; 4]; 4]);
        for Point { factors, weight, .. } in &self.points {
            let square: f64 = factors.iter().zip(metric).map(|(factor, m)| factor * m).sum();
            if !(square > 0.0 && square.is_finite()) {
                return None;
            }
            let stretch = square.sqrt();
            if self.is_slack(stretch) {
                continue;
            }
            // With u = lambda^2: dE/du = EA ds (1 - 1/lambda)/2, d2E/du2 = EA ds/(4 lambda^3).
            let strain = stretch - 1.0;
            sum.0 += 0.5 * weight * strain * strain;
            let (first, second) = (weight * strain / stretch, weight / (stretch * square));
            for g in 0..4 {
                sum.1[g] += first * factors[g];
                for h in 0..4 {
                    sum.2[g][h] += second * factors[g] * factors[h];
                }
            }
        }
        Some(sum)
    }

    #[cfg(test)]
    /// Energy, J.
    pub fn energy(&self, positions: &[[f64; 3]]) -> Option<f64> {
        let metric = self.samples(positions).map(|y| dot(y, y));
        self.by_samples(&metric).map(|(energy, ..)| energy)
    }

    /// Energy with its derivatives; the form of the arguments is that of [`super::FibreElement::evaluate`].
    pub fn evaluate(&self, positions: &[[f64; 3]], gradient: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
        let (gradient, tangent) = (&mut gradient[..27], &mut tangent[..27 * 27]);
        let y = self.samples(positions);
        let (energy, first, second) = self.by_samples(&y.map(|y| dot(y, y)))?;
        // With e_g = |y_g|^2 and B_g the factors: d e_g/dx_a = 2 B_ga y_g =: 2 v_ga, d2 e_g/dx_a dx_b = 2 B_ga B_gb 1.
        let v: [[f64; 27]; 4] =
            std::array::from_fn(|g| std::array::from_fn(|row| self.slopes[g][row / 3] * y[g][row % 3]));
        // sum_h H_gh v_h, so that the Hessian is sum_g v_g times it.
        let follow: [[f64; 27]; 4] = std::array::from_fn(|g| {
            std::array::from_fn(|row| (0..4).map(|h| second[g][h] * v[h][row]).sum())
        });
        let combined = |into: &mut [f64], [p, q, r, t]: [f64; 4]| {
            for (row, entry) in into.iter_mut().enumerate() {
                *entry = p * v[0][row] + q * v[1][row] + r * v[2][row] + t * v[3][row];
            }
        };
        combined(gradient, first);
        for (column, into) in tangent.chunks_exact_mut(27).enumerate() {
            combined(into, follow.map(|follow| follow[column]));
            let scaled: [f64; 4] = std::array::from_fn(|g| first[g] * self.slopes[g][column / 3]);
            for a in 0..9 {
                let along: f64 = (0..4).map(|g| scaled[g] * self.slopes[g][a]).sum();
                into[3 * a + column % 3] += along;
            }
        }
        Some(energy)
    }

    /// Where the fibres are and what they carry, at all integration points.
    pub fn states<'a>(&'a self, positions: &[[f64; 3]]) -> impl Iterator<Item = FibreState> + 'a {
        let metric = self.samples(positions).map(|y| dot(y, y));
        let nine = self.face.map(|point| positions[point as usize]);
        self.points.iter().map(move |point| {
            let square: f64 = point.factors.iter().zip(metric).map(|(factor, m)| factor * m).sum();
            let stretch = square.sqrt();
            let strain = if self.is_slack(stretch) { 0.0 } else { stretch - 1.0 };
            let each =
                |axis| point.values.iter().zip(&nine).map(|(n, x): (&f64, &[f64; 3])| n * x[axis]).sum();
            FibreState {
                fibre: point.fibre,
                arc_length: point.arc_length,
                position: std::array::from_fn(each),
                stretch,
                tension: self.axial_stiffness * strain,
                weight: point.weight / self.axial_stiffness,
            }
        })
    }
}
