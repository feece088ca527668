use crate::{BendingLaw, BendingResponse, RodCompliance, jet::Jet};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// A FREE's bending and shear in one straight state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingSample {
    /// Axial stretch, twist per reference length (rad/m) of the right-handed winding.
    pub strain: [f64; 2],
    /// Sections and ends; the ends without lever.
    pub compliance: RodCompliance,
    /// By how much both caps together lengthen (m) and turn (rad) a FREE against one that does everywhere what `strain` says.
    pub ends: [f64; 2],
}

impl BendingSample {
    /// The same with the mean strain of a FREE of a length (m) between its caps.
    fn between_caps(self, length: f64) -> Self {
        let strain = [0, 1].map(|i| self.strain[i] + self.ends[i] / length);
        BendingSample { strain, ends: [0.0; 2], ..self }
    }
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

/// All that is known at one pressure.
#[derive(Clone, Debug)]
struct Plane {
    pressure: f64,
    free: Vector2<f64>,
    coordinates: Matrix2<f64>,
    terms: [[f64; TERMS]; NUMBERS],
    /// Middle and half of the range of each number's samples. Threads that go slack change numbers by a factor of fifty, which no quadratic
    /// follows: beyond twice the range its word is not taken.
    ranges: [[f64; 2]; NUMBERS],
}

/// Numbers of a plane in a row.
const ENTRIES: usize = 6 + NUMBERS * (TERMS + 2);

/// A bending law from samples: at each pressure a quadratic in two combinations of stretch and twist, between two pressures a cubic.
///
/// What is interpolated are the logarithms of the compliances to bending and shear and the hyperbolic angle of the coupling, so that the
/// energy of bending is positive everywhere. Away from the samples the coordinates saturate and the law becomes constant. An end that would
/// make a piece's compliance negative is given no more than leaves it positive.
#[derive(Clone, Debug)]
pub struct BendingTable {
    samples: Vec<BendingPlane>,
    planes: Vec<Plane>,
    /// Change with the pressure of each plane's entries, 1/Pa.
    slopes: Vec<[f64; ENTRIES]>,
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

/// 1/(1 - t + t^2): from 1 + t with no curvature at 0 down to 0 at minus infinity.
fn fading(t: f64) -> [f64; 3] {
    let below = 1.0 / (1.0 - t + t * t);
    let slope = -1.0 + 2.0 * t;
    [below, -slope * below * below, 2.0 * below * below * (slope * slope * below - 1.0)]
}

/// x as long as it is at least `least`, and above `least - room` always, smoothly.
fn kept_above(x: Jet, least: f64, room: f64) -> Jet {
    if x.value >= least {
        return x;
    }
    let [value, slope, curvature] = fading((x.value - least) / room);
    x.compose([least - room + room * value, slope, curvature / room])
}

/// x as long as it is at most `most`, and below `most + room` always, smoothly.
fn kept_below(x: Jet, most: f64, room: f64) -> Jet {
    kept_above(x * -1.0, -most, room) * -1.0
}

/// Least singular value of the samples' places, over the greatest, of what a quadratic is told by them. Stiff threads that go slack lie far off
/// in coordinates that suit taut ones, and what such samples leave open is taken for zero instead of for a small difference of large numbers.
const TOLD: f64 = 0.1;
/// Half of what is added to a length by ends stays at least.
const LEAST_LEFT: f64 = 0.5;
/// Coupling over the mean of the compliances up to which it is taken as it is.
const COUPLED: f64 = 0.98;

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
        let ranges = std::array::from_fn(|number| {
            let all = plane.loaded.iter().map(|sample| numbers(sample)[number]);
            let (low, high) = all.fold((middle[number], middle[number]), |(low, high), value| {
                (low.min(value), high.max(value))
            });
            [0.5 * (low + high), 0.5 * (high - low)]
        });
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
            let found =
                solver.as_ref().and_then(|svd| svd.solve(&off, TOLD * svd.singular_values.max()).ok());
            if let Some(found) = found {
                fitted[1..].copy_from_slice(found.as_slice());
            }
        }
        Plane { pressure: plane.pressure, free, coordinates: plane.coordinates, terms: fitted, ranges }
    }

    fn entries(&self) -> [f64; ENTRIES] {
        let all = self.free.iter().chain(self.coordinates.iter());
        let all = all.chain(self.terms.as_flattened()).chain(self.ranges.as_flattened());
        let mut entries = [0.0; ENTRIES];
        entries.iter_mut().zip(all).for_each(|(entry, value)| *entry = *value);
        entries
    }

    fn of_entries(pressure: f64, entries: &[f64; ENTRIES]) -> Self {
        let (terms, ranges) = entries[6..].split_at(NUMBERS * TERMS);
        Plane {
            pressure,
            free: Vector2::from_column_slice(&entries[..2]),
            coordinates: Matrix2::from_column_slice(&entries[2..6]),
            terms: std::array::from_fn(|number| std::array::from_fn(|term| terms[number * TERMS + term])),
            ranges: std::array::from_fn(|number| [ranges[2 * number], ranges[2 * number + 1]]),
        }
    }
}

/// Slope in the middle of three points (or at the first one, the last being absent) of the parabola through them, no steeper than keeps a
/// cubic between the neighbours where these rise or fall on both sides (Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238).
pub(crate) fn slope(before: Option<[f64; 2]>, after: Option<[f64; 2]>) -> f64 {
    match (before, after) {
        (Some([h, secant]), Some([k, other])) => {
            let parabola = (secant * k + other * h) / (h + k);
            if secant * other <= 0.0 {
                return parabola;
            }
            let steepest = 3.0 * secant.abs().min(other.abs());
            parabola.clamp(-steepest, steepest)
        }
        (Some([_, secant]), None) | (None, Some([_, secant])) => secant,
        (None, None) => 0.0,
    }
}

impl BendingTable {
    /// The law through samples at one or more pressures, rising; `None` without any.
    pub fn new(samples: &[BendingPlane]) -> Option<Self> {
        let planes: Vec<Plane> = samples.iter().map(Plane::fitted).collect();
        let entries: Vec<[f64; ENTRIES]> = planes.iter().map(Plane::entries).collect();
        let step = |from: usize, entry: usize| {
            let width = planes.get(from + 1)?.pressure - planes[from].pressure;
            Some([width, (entries[from + 1][entry] - entries[from][entry]) / width])
        };
        let slopes = (0..planes.len())
            .map(|at| {
                std::array::from_fn(|entry| {
                    slope(at.checked_sub(1).and_then(|before| step(before, entry)), step(at, entry))
                })
            })
            .collect();
        (!planes.is_empty()).then(|| BendingTable { samples: samples.to_vec(), planes, slopes })
    }

    /// The same as a law of the mean strains of a FREE of a length (m) between its caps, which [`crate::CappedSection`] asks for.
    pub fn between_caps(&self, length: f64) -> Self {
        let samples: Vec<BendingPlane> = self
            .samples
            .iter()
            .map(|plane| BendingPlane {
                free: plane.free.between_caps(length),
                loaded: plane.loaded.iter().map(|sample| sample.between_caps(length)).collect(),
                ..*plane
            })
            .collect();
        Self::new(&samples).unwrap_or_else(|| self.clone())
    }

    /// Pressures of the samples, Pa.
    pub fn pressures(&self) -> Vec<f64> {
        self.planes.iter().map(|plane| plane.pressure).collect()
    }

    /// Everything at a pressure: Hermite's cubic between two planes, a line through the first two below them.
    fn at(&self, pressure: f64) -> Plane {
        let last = self.planes.len() - 1;
        let [first, top] = [0, last].map(|plane| self.planes[plane].pressure);
        let pressure = pressure.clamp(first - 0.02 * top, 1.02 * top);
        let after = self.planes.iter().position(|plane| plane.pressure > pressure).unwrap_or(last);
        let before = after.saturating_sub(1).min(last.saturating_sub(1));
        let [low, high] =
            [before, (before + 1).min(last)].map(|plane| (&self.planes[plane], &self.slopes[plane]));
        let ([a, b], width) = ([low.0.entries(), high.0.entries()], high.0.pressure - low.0.pressure);
        let off = pressure - low.0.pressure;
        let entries = std::array::from_fn(|i| {
            let t = if width > 0.0 { off / width } else { 0.0 };
            if !(0.0..=1.0).contains(&t) {
                let (value, slope, from) =
                    if t < 0.0 { (a[i], low.1[i], off) } else { (b[i], high.1[i], off - width) };
                return value + slope * from;
            }
            let (s, u) = (1.0 - t, width * t * (1.0 - t));
            s * s * (1.0 + 2.0 * t) * a[i]
                + t * t * (3.0 - 2.0 * t) * b[i]
                + u * (s * low.1[i] - t * high.1[i])
        });
        Plane::of_entries(pressure, &entries)
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
            [0, 1, 2, 3, 4, 5].map(|number| {
                let [middle, half] = plane.ranges[number];
                let (room, found) = (half.abs() + f64::MIN_POSITIVE, quadratic(&plane.terms[number]));
                kept_below(kept_above(found, middle - 2.0 * room, room), middle + 2.0 * room, room)
            });
        let one = Jet::constant(1.0);
        let with_ends = |end: Jet| kept_above(one + end * ends, LEAST_LEFT, LEAST_LEFT);
        let (more_bending, more_shear) = (with_ends(end_bending), with_ends(end_shear));
        // The coupling over the mean of what the compliances are with the ends stays below one.
        let share = (angle.tanh() + end_coupling * ends) * (more_bending * more_shear).powf(-0.5);
        let room = 1.0 - COUPLED;
        let share = kept_below(kept_above(share, -COUPLED, room), COUPLED, room);
        let (bending, shear) = (bending.exp() * more_bending, shear.exp() * more_shear);
        [bending, (bending * shear).powf(0.5) * share, shear]
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
