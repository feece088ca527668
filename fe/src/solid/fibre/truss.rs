use super::{Block, FibreState, surface::SurfacePoint, trace::Piece};
use actuator::{Fibre, FibreLaw};

/// Points and weights of Gauss's rule of two points on (0, 1).
///
/// Two, because a fibre of EA = 644 N on rubber of 0.4 MPa is next to inextensible: each point is one condition on the surface.
/// Along a line of the mesh a face brings two new points, and at these two places the slope of a quadratic through points of a
/// smooth curve is one order better than elsewhere: a motion that does not stretch the fibre is let through with a
/// stretch of fourth order, where three points would meet the error of second order and resist it. Nothing is left free: two stretches
/// determine the linear stretch that three points on a line can have, and the rubber holds whatever lies across the fibre.
pub(super) const GAUSS: [(f64, f64); 2] = [(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)];

#[derive(Clone, Copy, Debug)]
pub(super) struct Gauss {
    /// dN_a/ds, 1/m, by reference arc length, in the order of the element's blocks.
    pub slopes: [f64; 9],
    /// EA ds, N m.
    pub weight: f64,
}

/// Where an integration point is; not needed to solve.
#[derive(Clone, Copy, Debug)]
struct Place {
    values: [f64; 9],
    fibre: u32,
    arc_length: f64,
}

/// All that fibres of one family have in one face of the surface: lines without bending stiffness that follow the face's
/// interpolation.
///
/// Energy: sum over fibres of the integral of EA (lambda - 1)^2/2 ds, lambda = |sum_a dN_a/ds x_a|, s the arc length of the
/// interpolated undeformed line: an undeformed surface is free of tension.
#[derive(Clone, Debug)]
pub(crate) struct Truss {
    /// Points of the face that take part: 3 on a line of the mesh, else 9.
    blocks: Vec<Block>,
    law: FibreLaw,
    /// Of a whole fibre, N.
    axial_stiffness: f64,
    pub(super) points: Vec<Gauss>,
    places: Vec<Place>,
}

/// A piece with what it belongs to.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrussPiece {
    pub piece: Piece,
    /// Its strand's part of the fibre's stiffness.
    pub share: f64,
    pub fibre: u32,
    /// Reference arc length along the fibre to where the piece begins, m.
    pub arc_length: f64,
}

pub(super) fn dot(x: [f64; 3], y: [f64; 3]) -> f64 {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

pub(super) fn norm(x: [f64; 3]) -> f64 {
    dot(x, x).sqrt()
}

/// Reference length of a piece, m, by the truss's rule.
pub(super) fn length(piece: &Piece, face: &[u32; 9], reference: &[[f64; 3]]) -> f64 {
    let speed = |share| norm(SurfacePoint::combine(&SurfacePoint::new(piece, share).slopes, face, reference));
    GAUSS.iter().map(|&(share, weight)| weight * speed(share)).sum()
}

impl Truss {
    /// The pieces of a family's fibres in the face of the given points; `reference` are all points' positions, m.
    pub(super) fn new(pieces: &[TrussPiece], fibre: &Fibre, face: &[u32; 9], reference: &[[f64; 3]]) -> Self {
        let mut points = vec![];
        let mut places = vec![];
        for traced in pieces {
            let whole = length(&traced.piece, face, reference);
            for (share, weight) in GAUSS {
                let SurfacePoint { values, slopes } = SurfacePoint::new(&traced.piece, share);
                let speed = norm(SurfacePoint::combine(&slopes, face, reference));
                points.push(Gauss {
                    slopes: slopes.map(|slope| slope / speed),
                    weight: fibre.axial_stiffness * traced.share * weight * speed,
                });
                let arc_length = traced.arc_length + whole * share;
                places.push(Place { values, fibre: traced.fibre, arc_length });
            }
        }
        let takes_part =
            |a: &usize| points.iter().zip(&places).any(|(p, q)| p.slopes[*a] != 0.0 || q.values[*a] != 0.0);
        let kept: Vec<usize> = (0..9).filter(takes_part).collect();
        let gathered = |all: &[f64; 9]| {
            let mut packed = [0.0; 9];
            kept.iter().zip(&mut packed).for_each(|(&a, place)| *place = all[a]);
            packed
        };
        points.iter_mut().for_each(|point| point.slopes = gathered(&point.slopes));
        places.iter_mut().for_each(|place| place.values = gathered(&place.values));
        Truss {
            blocks: kept.iter().map(|&a| Block::Point(face[a])).collect(),
            law: fibre.law,
            axial_stiffness: fibre.axial_stiffness,
            points,
            places,
        }
    }

    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    pub(super) fn gather(&self, positions: &[[f64; 3]]) -> [[f64; 3]; 9] {
        let mut gathered = [[0.0; 3]; 9];
        for (place, block) in gathered.iter_mut().zip(&self.blocks) {
            if let Block::Point(point) = block {
                *place = positions[*point as usize];
            }
        }
        gathered
    }

    pub(super) fn combine(&self, factors: &[f64; 9], positions: &[[f64; 3]; 9]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (factor, position) in factors.iter().zip(positions).take(self.blocks.len()) {
            sum.iter_mut().zip(position).for_each(|(total, x)| *total += factor * x);
        }
        sum
    }

    pub(super) fn is_slack(&self, stretch: f64) -> bool {
        self.law == FibreLaw::TensionOnly && stretch <= 1.0
    }

    #[cfg(test)]
    /// Energy, J.
    pub fn energy(&self, positions: &[[f64; 3]]) -> Option<f64> {
        let positions = self.gather(positions);
        let mut energy = 0.0;
        for Gauss { slopes, weight } in &self.points {
            let stretch = norm(self.combine(slopes, &positions));
            if !self.is_slack(stretch) {
                energy += 0.5 * weight * (stretch - 1.0).powi(2);
            }
        }
        energy.is_finite().then_some(energy)
    }

    /// Energy with its derivatives; the form of the arguments is that of [`super::FibreElement::evaluate`].
    pub fn evaluate(&self, positions: &[[f64; 3]], gradient: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
        let unknowns = 3 * self.blocks.len();
        let (gradient, tangent) = (&mut gradient[..unknowns], &mut tangent[..unknowns * unknowns]);
        gradient.fill(0.0);
        tangent.fill(0.0);
        let positions = self.gather(positions);
        let mut energy = 0.0;
        for Gauss { slopes, weight } in &self.points {
            let along = self.combine(slopes, &positions);
            let stretch = norm(along);
            if !(stretch > 0.0 && stretch.is_finite()) {
                return None;
            }
            if self.is_slack(stretch) {
                continue;
            }
            let strain = stretch - 1.0;
            energy += 0.5 * weight * strain * strain;
            // d lambda/d x' = t, d2 lambda/d x'2 = (1 - t t)/lambda: with f = EA ds (lambda - 1), the derivatives by x' are
            // f t and f/lambda 1 + (EA ds - f/lambda) t t.
            let t = along.map(|x| x / stretch);
            let force = weight * strain;
            let across = force / stretch;
            let second: [[f64; 3]; 3] = std::array::from_fn(|i| {
                std::array::from_fn(|j| (weight - across) * t[i] * t[j] + if i == j { across } else { 0.0 })
            });
            // Columns of `second` repeated for all rows, times the rows' slopes.
            let mut columns = [[0.0; 27]; 3];
            for (a, slope) in slopes.iter().enumerate() {
                for j in 0..3 {
                    for i in 0..3 {
                        columns[j][3 * a + i] = slope * second[j][i];
                    }
                }
            }
            for (b, (slope, pull)) in slopes.iter().zip(gradient.chunks_exact_mut(3)).enumerate() {
                for i in 0..3 {
                    pull[i] += force * slope * t[i];
                }
                for (j, column) in columns.iter().enumerate() {
                    let start = (3 * b + j) * unknowns;
                    let into = &mut tangent[start..start + unknowns];
                    into.iter_mut().zip(column).for_each(|(sum, value)| *sum += slope * value);
                }
            }
        }
        Some(energy)
    }

    /// Where the fibres are and what they carry, at all integration points.
    pub fn states<'a>(&'a self, positions: &[[f64; 3]]) -> impl Iterator<Item = FibreState> + 'a {
        let positions = self.gather(positions);
        self.points.iter().zip(&self.places).map(move |(point, place)| {
            let stretch = norm(self.combine(&point.slopes, &positions));
            let strain = if self.is_slack(stretch) { 0.0 } else { stretch - 1.0 };
            FibreState {
                fibre: place.fibre,
                arc_length: place.arc_length,
                position: self.combine(&place.values, &positions),
                stretch,
                tension: self.axial_stiffness * strain,
                weight: point.weight / self.axial_stiffness,
            }
        })
    }
}
