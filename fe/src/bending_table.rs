use crate::{BendingLaw, BendingResponse, RodCompliance, jet::Jet};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// A FREE's bending and shear in one straight state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingSample {
    /// Axial stretch, twist per reference length (rad/m) of the right-handed winding.
    pub strain: [f64; 2],
    /// Sections and ends; the ends without lever.
    pub compliance: RodCompliance,
}

/// Samples at one pressure: the FREE without axial load, and states about it.
#[derive(Clone, Debug, PartialEq)]
pub struct BendingPlane {
    /// Pa.
    pub pressure: f64,
    /// Without force and torque.
    pub free: BendingSample,
    /// Matrix that makes of a change of stretch and twist the two coordinates in which the others lie about -1 to 1.
    pub coordinates: Matrix2<f64>,
    /// Under force and torque.
    pub loaded: Vec<BendingSample>,
}

/// Numbers interpolated: ln of the compliances to bending and to shear, the hyperbolic angle of their coupling, and what an end adds, as
/// a length, to bending, shear and coupling.
const NUMBERS: usize = 6;
/// Terms of a quadratic in two coordinates: 1, x, y, x^2/2, x y, y^2/2.
const TERMS: usize = 6;

#[derive(Clone, Debug)]
struct Plane {
    pressure: f64,
    free: Vector2<f64>,
    coordinates: Matrix2<f64>,
    terms: [[f64; TERMS]; NUMBERS],
}

/// A bending law from samples: at each pressure a quadratic in two combinations of stretch and twist, and a polynomial through the
/// pressures.
///
/// What is interpolated are the logarithms of the compliances to bending and shear and the hyperbolic angle of the coupling, so that the
/// energy of bending is positive everywhere. Away from the samples the coordinates saturate and the law becomes constant.
#[derive(Clone, Debug)]
pub struct BendingTable {
    planes: Vec<Plane>,
}

fn numbers(sample: &BendingSample) -> [f64; NUMBERS] {
    let RodCompliance { bending, shear, coupling, end_bending, end_shear, end_coupling, .. } =
        sample.compliance;
    let mean = (bending * shear).sqrt();
    [
        bending.ln(),
        shear.ln(),
        (coupling / mean).clamp(-0.999, 0.999).atanh(),
        end_bending / bending,
        end_shear / shear,
        end_coupling / mean,
    ]
}

fn terms([x, y]: [f64; 2]) -> [f64; TERMS] {
    [1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y]
}

fn saturated(x: f64) -> f64 {
    Jet::constant(x).saturated().value
}

impl Plane {
    /// Through the free state, and next to the others.
    fn fitted(plane: &BendingPlane) -> Self {
        let free: Vector2<f64> = plane.free.strain.into();
        let middle = numbers(&plane.free);
        let mut fitted = [[0.0; TERMS]; NUMBERS];
        let place = |sample: &BendingSample| -> [f64; 2] {
            let at = plane.coordinates * (Vector2::from(sample.strain) - free);
            [saturated(at.x), saturated(at.y)]
        };
        let rows: Vec<[f64; TERMS]> = plane.loaded.iter().map(|sample| terms(place(sample))).collect();
        let matrix = DMatrix::from_fn(rows.len(), TERMS - 1, |row, column| rows[row][column + 1]);
        let solver = (!rows.is_empty()).then(|| matrix.svd(true, true));
        for (number, fitted) in fitted.iter_mut().enumerate() {
            fitted[0] = middle[number];
            let off = DVector::from_iterator(
                rows.len(),
                plane.loaded.iter().map(|sample| numbers(sample)[number] - middle[number]),
            );
            let found = solver.as_ref().and_then(|svd| svd.solve(&off, 1e-6).ok());
            if let Some(found) = found {
                fitted[1..].copy_from_slice(found.as_slice());
            }
        }
        Plane { pressure: plane.pressure, free, coordinates: plane.coordinates, terms: fitted }
    }
}

impl BendingTable {
    /// The law through samples at one or more pressures, rising; `None` without any.
    pub fn new(planes: &[BendingPlane]) -> Option<Self> {
        let planes: Vec<Plane> = planes.iter().map(Plane::fitted).collect();
        (!planes.is_empty()).then_some(BendingTable { planes })
    }

    /// Pressures of the samples, Pa.
    pub fn pressures(&self) -> Vec<f64> {
        self.planes.iter().map(|plane| plane.pressure).collect()
    }

    /// Everything at a pressure: Lagrange's polynomials through the planes.
    fn at(&self, pressure: f64) -> Plane {
        let top = self.planes[self.planes.len() - 1].pressure;
        let first = self.planes[0].pressure;
        let pressure = pressure.clamp(first - 0.02 * top, 1.02 * top);
        let mut sum = Plane {
            pressure,
            free: Vector2::zeros(),
            coordinates: Matrix2::zeros(),
            terms: [[0.0; TERMS]; NUMBERS],
        };
        for (i, plane) in self.planes.iter().enumerate() {
            let others = self.planes.iter().enumerate().filter(|(k, _)| *k != i);
            let weight: f64 = others
                .map(|(_, other)| (pressure - other.pressure) / (plane.pressure - other.pressure))
                .product();
            sum.free += plane.free * weight;
            sum.coordinates += plane.coordinates * weight;
            let each = sum.terms.as_flattened_mut().iter_mut().zip(plane.terms.as_flattened());
            each.for_each(|(sum, term)| *sum += weight * term);
        }
        sum
    }

    /// Compliances (bending, coupling, shear) of a piece, as functions of stretch and twist.
    fn compliances(&self, pressure: f64, stretch: f64, twist: f64, ends: f64) -> [Jet; 3] {
        let plane = self.at(pressure);
        let strain = [Jet::variable(stretch, 0), Jet::variable(twist, 1)];
        let off = [0, 1].map(|i| strain[i] - Jet::constant(plane.free[i]));
        let [x, y] = [0, 1].map(|row| {
            (off[0] * plane.coordinates[(row, 0)] + off[1] * plane.coordinates[(row, 1)]).saturated()
        });
        let quadratic = |[c, cx, cy, cxx, cxy, cyy]: &[f64; TERMS]| {
            let (u, v) = (x.value, y.value);
            let value = c + cx * u + cy * v + 0.5 * cxx * u * u + cxy * u * v + 0.5 * cyy * v * v;
            Jet::compose2(x, y, [value, cx + cxx * u + cxy * v, cy + cxy * u + cyy * v, *cxx, *cxy, *cyy])
        };
        let [bending, shear, angle, end_bending, end_shear, end_coupling] =
            [0, 1, 2, 3, 4, 5].map(|number| quadratic(&plane.terms[number]));
        let one = Jet::constant(1.0);
        [
            bending.exp() * (one + end_bending * ends),
            ((bending + shear) * 0.5).exp() * (angle.tanh() + end_coupling * ends),
            shear.exp() * (one + end_shear * ends),
        ]
    }
}

fn response(stiffness: [Jet; 3]) -> BendingResponse {
    BendingResponse {
        stiffness: stiffness.map(|jet| jet.value),
        slopes: [0, 1].map(|i| stiffness.map(|jet| jet.gradient[i])),
        curvatures: [(0, 0), (0, 1), (1, 1)].map(|place| stiffness.map(|jet| jet.hessian[place])),
    }
}

impl BendingLaw for BendingTable {
    fn respond(
        &self,
        pressure: f64,
        axial_stretch: f64,
        twist_per_length: f64,
        ends: f64,
    ) -> BendingResponse {
        let [bending, coupling, shear] = self.compliances(pressure, axial_stretch, twist_per_length, ends);
        let inverse = (bending * shear - coupling * coupling).powf(-1.0);
        response([shear * inverse, coupling * inverse * -1.0, bending * inverse])
    }

    fn respond_tied(
        &self,
        pressure: f64,
        axial_stretch: f64,
        twist_per_length: f64,
        ends: f64,
    ) -> BendingResponse {
        let [bending, _, shear] = self.compliances(pressure, axial_stretch, twist_per_length, ends);
        response([bending.powf(-1.0), Jet::constant(0.0), shear.powf(-1.0)])
    }
}

#[cfg(test)]
#[path = "bending_table_tests.rs"]
mod tests;
