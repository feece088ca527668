use nalgebra::{Complex, Matrix2, Matrix6, RowVector2, SMatrix, SVector};

use crate::TipCompliance;

type C = Complex<f64>;
const I: C = C::new(0.0, 1.0);

/// A straight FREE between two caps, as a rod: what acts along its axis and how it is stretched away from the caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightRod {
    /// Reference length, m.
    pub length: f64,
    /// Net axial force (N) and torque (N m): zero on a FREE with free, closed ends, whatever the pressure.
    pub force: f64,
    /// N m.
    pub torque: f64,
    /// Axial stretch away from the caps.
    pub stretch: f64,
    /// Height of the cap, m: the stretch times the length but for what the caps hold back.
    pub height: f64,
}

/// What a rod's sections, and its ends between cap and free tube, give way to bending moments and forces across: per reference
/// length, in the sense of an energy of the section
/// `(kappa, gamma)^T [[bending, coupling], [coupling, shear]]^-1 (kappa, gamma) / 2` in both planes, with the moment and the force
/// of the section, which turn with it.
///
/// A winding allows one coupling more than a plain tube: a force across bends the tube in the plane *across* the force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodCompliance {
    /// Curvature per moment, 1/(N m^2).
    pub bending: f64,
    /// Shear strain per force, 1/N.
    pub shear: f64,
    /// Curvature per force and shear strain per moment about the same axis, 1/(N m).
    pub coupling: f64,
    /// What each end adds: turn per moment, 1/(N m); negative where the cap stiffens.
    pub end_bending: f64,
    /// Shift per force, m/N.
    pub end_shear: f64,
    /// Shift per moment about the same axis, 1/N.
    pub end_coupling: f64,
    /// Shift per moment about the axis across, 1/N: where along the tube the end's turn happens.
    pub end_lever: f64,
}

/// Force and moment on the tip per shift and turn, all as x + i y, and the shift at half the length per shift and turn. Unlike
/// compliances these pass buckling loads smoothly.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Transverse {
    stiffness: Matrix2<C>,
    middle: RowVector2<C>,
}

impl Transverse {
    /// The parts of a cap's compliance across the axis: of a tube that is the same at a turn by less than a half circle they
    /// are complex numbers.
    fn of(compliance: &TipCompliance) -> Option<Self> {
        let c: &Matrix6<f64> = &compliance.matrix;
        // Of both planes the mean: z = (c_xx + c_yy)/2 + i (c_yx - c_xy)/2.
        let part = |i: usize, j: usize| {
            C::new(0.5 * (c[(i, j)] + c[(i + 1, j + 1)]), 0.5 * (c[(i + 1, j)] - c[(i, j + 1)]))
        };
        let middle = |j: usize| {
            let [x, y] = [compliance.middle[j], compliance.middle[j + 1]];
            C::new(0.5 * (x.x + y.y), 0.5 * (x.y - y.x))
        };
        let stiffness = Matrix2::new(part(0, 0), part(0, 3), part(3, 0), part(3, 3)).try_inverse()?;
        Some(Transverse { stiffness, middle: RowVector2::new(middle(0), middle(3)) * stiffness })
    }

    /// Seven numbers of two tubes, the first the shorter one, each about one for a rod of unit bending stiffness.
    fn figures(
        [short, long]: &[Self; 2],
        [short_rod, rod]: [&StraightRod; 2],
        bending: f64,
    ) -> SVector<f64, 7> {
        let of = |own: &Self, length: f64| {
            let k = &own.stiffness;
            let both = 0.5 * (k[(0, 1)] + k[(1, 0)].conj());
            [k[(1, 1)].re * length, both.re * length * length, k[(0, 0)].re * length.powi(3)]
                .map(|value| value * bending)
        };
        let [a, b] = [of(short, short_rod.height), of(long, rod.height)];
        SVector::from([a[0], b[0], a[1], b[1], a[2], b[2], long.middle[1].im / rod.height])
    }
}

impl RodCompliance {
    fn from_array(x: &[f64; 7]) -> Self {
        let [bending, end_bending, coupling, end_coupling, shear, end_shear, end_lever] = *x;
        RodCompliance { bending, shear, coupling, end_bending, end_shear, end_coupling, end_lever }
    }

    /// EI, N m^2, with the shear strain left to itself.
    pub fn bending_stiffness(&self) -> f64 {
        1.0 / self.bending
    }

    /// GA, N, with the curvature left to itself.
    pub fn shear_stiffness(&self) -> f64 {
        1.0 / self.shear
    }

    /// The same answers of the tip by ends without a lever: `u -> u - i lever m` is a shift that no load on the tip tells
    /// from a shear strain, 2 lambda lever per force. Rods that are clamped by their end sections have this shear compliance.
    pub fn folded(&self, stretch: f64) -> Self {
        RodCompliance { shear: self.shear - 2.0 * stretch * self.end_lever, end_lever: 0.0, ..*self }
    }

    /// Reference length (m) by which each cap shortens the tube's bending.
    pub fn stiff_length(&self) -> f64 {
        -self.end_bending / self.bending
    }

    /// Tip of a straight rod with these sections and ends, clamped at its base.
    ///
    /// With u and theta the shift and the turn as x + i y, along the axis z = z0 + lambda s, and f, m force and moment in space:
    /// f is constant, m + i z f - i N u is constant, `gamma = u' + i lambda theta`, `kappa = theta'`; the section's own
    /// force and moment are f + i N theta and m + i M theta.
    fn transverse(&self, rod: &StraightRod) -> Transverse {
        const STEPS: usize = 64;
        let StraightRod { length, force, torque, stretch, height } = *rod;
        let start = 0.5 * (height - stretch * length);
        let real = |x: f64| C::new(x, 0.0);
        let section = |moment: C, shear: C| {
            [self.bending * moment + self.coupling * shear, self.coupling * moment + self.shear * shear]
        };
        // Lever: positive at the base, mirrored at the tip.
        let end = |moment: C, shear: C, side: f64| {
            let lever = I * (side * self.end_lever);
            [
                self.end_bending * moment + (real(self.end_coupling) - lever) * shear,
                (real(self.end_coupling) + lever) * moment + self.end_shear * shear,
            ]
        };
        // (turn, shift) at the tip and shift in the middle, for a force f and the constant c of the moment.
        let run = |f: C, c: C| {
            let own = |z: f64, [theta, u]: [C; 2]| {
                let moment = c - I * z * f + I * force * u;
                (moment + I * torque * theta, f + I * force * theta)
            };
            let add = |y: [C; 2], h: f64, k: [C; 2]| [y[0] + k[0] * h, y[1] + k[1] * h];
            let none = [real(0.0); 2];
            let (moment, shear) = own(0.0, none);
            let mut y = end(moment, shear, 1.0);
            y[1] -= I * start * y[0];
            let mut middle = y[1];
            let h = length / STEPS as f64;
            let slope = |s: f64, y: [C; 2]| {
                let (moment, shear) = own(start + stretch * s, y);
                let [kappa, gamma] = section(moment, shear);
                [kappa, gamma - I * stretch * y[0]]
            };
            for step in 0..STEPS {
                let s = step as f64 * h;
                let k1 = slope(s, y);
                let k2 = slope(s + 0.5 * h, add(y, 0.5 * h, k1));
                let k3 = slope(s + 0.5 * h, add(y, 0.5 * h, k2));
                let k4 = slope(s + h, add(y, h, k3));
                for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
                    y = add(y, weight * h / 6.0, k);
                }
                if step + 1 == STEPS / 2 {
                    middle = y[1];
                }
            }
            y[1] -= I * start * y[0];
            let (moment, shear) = own(height, y);
            let jump = end(moment, shear, -1.0);
            ([y[0] + jump[0], y[1] + jump[1]], middle)
        };
        let (by_force, middle_force) = run(real(1.0), real(0.0));
        let (by_constant, middle_constant) = run(real(0.0), real(1.0));
        // Moment on the cap: c = m - i M theta/2 + i height f - i N u.
        let moment_of = |[theta, u]: [C; 2], f: f64, c: f64| {
            real(c) + 0.5 * I * torque * theta - I * height * f + I * force * u
        };
        let moments = [moment_of(by_force, 1.0, 0.0), moment_of(by_constant, 0.0, 1.0)];
        let motions = Matrix2::new(by_force[1], by_constant[1], by_force[0], by_constant[0]);
        let loads = Matrix2::new(real(1.0), real(0.0), moments[0], moments[1]);
        let inverse = motions.try_inverse().unwrap_or_else(|| Matrix2::from_element(real(f64::NAN)));
        Transverse {
            stiffness: loads * inverse,
            middle: RowVector2::new(middle_force, middle_constant) * inverse,
        }
    }

    /// Complex stiffness of the tip, (force, moment) per (shift, turn), all as x + i y.
    pub fn tip_stiffness(&self, rod: &StraightRod) -> Matrix2<C> {
        self.transverse(rod).stiffness
    }

    /// The rod and the ends that answer as two tubes do, which are alike but for their lengths; `None` where there is none.
    pub fn identified(tubes: [(&StraightRod, &TipCompliance); 2]) -> Option<Self> {
        let rods = tubes.map(|(rod, _)| rod);
        let [short, long] = tubes.map(|(_, compliance)| Transverse::of(compliance));
        let measured = [short?, long?];
        // A tip that turns but does not shift has 4 EI/L; the turn per moment would be lost at a buckling load.
        let bending = 4.0 / (rods[0].height * measured[0].stiffness[(1, 1)].re.abs());
        let wanted = Transverse::figures(&measured, rods, bending);
        let size = rods[0].height;
        let scale = [0, 1, 1, 2, 2, 3, 2].map(|power| bending * size.powi(power));
        let of = |x: &SVector<f64, 7>| Self::from_array(&std::array::from_fn(|i| x[i] * scale[i]));
        let off = |x: &SVector<f64, 7>| {
            let own = of(x);
            Transverse::figures(&rods.map(|rod| own.transverse(rod)), rods, bending) - wanted
        };
        let found = STARTS.iter().filter_map(|(factor, coupling, shear)| {
            let mut start = SVector::<f64, 7>::zeros();
            (start[0], start[2], start[4]) = (*factor, factor * coupling, factor * shear);
            solved(&off, start)
        });
        found.map(|x| of(&x)).find(|found| found.folded(rods[1].stretch).is_sound())
    }

    /// Whether bending and shear store energy.
    pub fn is_sound(&self) -> bool {
        self.bending > 0.0 && self.shear > 0.0 && self.coupling * self.coupling < self.bending * self.shear
    }
}

/// Where the search for a rod starts: bending (one is that of a tube whose tip does not shift), coupling and shear over it. From stiff
/// rods on Newton's method doubles them as long as they are too stiff, and seldom misses; threads along a tube couple bending and
/// shear so strongly (0.94 of their mean at 75 degrees from the hoop) that it is lost on the way from none.
const STARTS: [(f64, f64, f64); 5] =
    [(1.0, 0.0, 0.0), (1e-4, 0.0, 0.0), (1.0, 0.9, 0.9), (1.0, -0.9, 0.9), (0.1, 0.0, 1.0)];

/// A zero of seven numbers of seven, by Newton's method with steps shortened until they help; `None` where it is lost.
fn solved(
    off: &dyn Fn(&SVector<f64, 7>) -> SVector<f64, 7>,
    start: SVector<f64, 7>,
) -> Option<SVector<f64, 7>> {
    let mut x = start;
    let mut error = off(&x);
    for _ in 0..40 {
        let slope = SMatrix::<f64, 7, 7>::from_columns(&std::array::from_fn::<_, 7, _>(|i| {
            let mut moved = [x, x];
            moved[0][i] += 1e-5;
            moved[1][i] -= 1e-5;
            (off(&moved[0]) - off(&moved[1])) / 2e-5
        }));
        let step = slope.lu().solve(&error)?;
        let mut share = 1.0;
        let (next, found) = loop {
            let next = x - step * share;
            let found = off(&next);
            if found.norm() < error.norm() || error.norm() < 1e-9 {
                break (next, found);
            }
            if share < 1e-3 {
                return None;
            }
            share *= 0.5;
        };
        (x, error) = (next, found);
        if share == 1.0 && step.amax() < 1e-8 {
            return Some(x);
        }
    }
    None
}
