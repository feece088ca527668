use actuator::{MapParameter, Module, PoseChart, TipPose, payload_curvature};
use nalgebra::Vector3;
use rom::effect::{Chain, evaluate_near, hanging_mass, overshoot};
use rom::{OutOfDomain, PoseEvaluation, PoseModel};

/// Greatest number of quantities seen of a deformation: a pose has six.
pub const OUTPUTS: usize = 6;

/// What a base model answers to pressures, before loads and frames: numbers, their derivatives, their slopes.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// The numbers: a pose chart, or twist (rad), change of length (m) and outer diameter (m) of a FREE.
    pub values: [f64; OUTPUTS],
    /// d(values)/d(pressure of FREE i), per Pa.
    pub by_pressure: Vec<[f64; OUTPUTS]>,
    /// Slopes that the base model carries, in its own order.
    pub slopes: Vec<[f64; OUTPUTS]>,
    /// How far (Pa) the pressures were outside the model's domain.
    pub overshoot: f64,
}

impl Response {
    /// Room for a mechanics of `frees` FREEs and `slopes` slopes.
    pub fn new(frees: usize, slopes: usize) -> Self {
        Response {
            values: [0.0; OUTPUTS],
            by_pressure: vec![[0.0; OUTPUTS]; frees],
            slopes: vec![[0.0; OUTPUTS]; slopes],
            overshoot: 0.0,
        }
    }
}

/// What was seen at one sample, or would be seen by a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// A pose, with the branch of its twist (rad).
    Pose(TipPose, f64),
    /// Twist (rad), change of length (m), outer diameter (m) of a single FREE; NaN = not measured.
    Free([f64; 3]),
}

impl Seen {
    /// Difference of a prediction from what was measured (`self`), NaN where not measured. For poses: position (m) and rotation vector (rad), both
    /// in the half-turned frame of the measured pose, in which they are smooth functions of the pressures however far the module turns.
    pub fn difference(&self, predicted: &Seen) -> [f64; OUTPUTS] {
        match (self, predicted) {
            (Seen::Pose(measured, twist), Seen::Pose(predicted, _)) => {
                let (sine, cosine) = (0.5 * twist).sin_cos();
                let about_z = |v: Vector3<f64>, s: f64| [cosine * v.x - s * v.y, s * v.x + cosine * v.y, v.z];
                let shift = about_z(predicted.position - measured.position, -sine);
                let turn = about_z((measured.rotation.inverse() * predicted.rotation).scaled_axis(), sine);
                [shift[0], shift[1], shift[2], turn[0], turn[1], turn[2]]
            }
            (Seen::Free(measured), Seen::Free(predicted)) => {
                let mut out = [f64::NAN; OUTPUTS];
                for ((out, measured), predicted) in out.iter_mut().zip(measured).zip(predicted) {
                    *out = predicted - measured;
                }
                out
            }
            _ => [f64::NAN; OUTPUTS],
        }
    }
}

/// A base model as identification needs it: pressures to deformation, and how static effects enter.
pub trait Mechanics: Sync {
    /// Number of FREEs.
    fn frees(&self) -> usize;
    /// Room for a response.
    fn room(&self) -> Response;
    /// Answers the pressures (Pa), near its domain too. Static effects that need another evaluation of the model are taken from the chain.
    fn respond(&self, chain: &Chain, pressures: &[f64], into: &mut Response) -> Result<(), OutOfDomain>;
    /// What is seen: the response with the chain's loads, angles and frames, these linearised about those of `respond`.
    fn observe(&self, chain: &Chain, response: &Response) -> Seen;
    /// Greatest deformation that counts as the full stroke, in the order of [`Seen::difference`]; scale of relative errors.
    fn length(&self) -> f64;
}

/// A module's reduced-order model.
pub struct ModuleMechanics<'a> {
    model: &'a (dyn PoseModel + Sync),
    payload: Option<usize>,
    payload_curvature: Option<usize>,
    bending: Option<usize>,
    slopes: usize,
    hanging_mass: f64,
    length: f64,
}

impl<'a> ModuleMechanics<'a> {
    /// A model of this module, whose evaluations carry the slopes of `parameters`.
    pub fn new(model: &'a (dyn PoseModel + Sync), parameters: &[MapParameter], module: &Module) -> Self {
        let at = |wanted| parameters.iter().position(|parameter| *parameter == wanted);
        ModuleMechanics {
            model,
            payload: at(MapParameter::Payload),
            payload_curvature: at(MapParameter::PayloadCurvature),
            bending: at(MapParameter::BendingStiffness),
            slopes: parameters.len(),
            hanging_mass: hanging_mass(module),
            length: module.length(),
        }
    }

    /// Whether the model carries the slope of a parameter.
    pub fn has(&self, parameter: MapParameter) -> bool {
        match parameter {
            MapParameter::Payload => self.payload.is_some(),
            MapParameter::PayloadCurvature => self.payload_curvature.is_some(),
            MapParameter::BendingStiffness => self.bending.is_some(),
        }
    }
}

impl Mechanics for ModuleMechanics<'_> {
    fn frees(&self) -> usize {
        self.model.domain().len()
    }

    fn room(&self) -> Response {
        Response::new(self.frees(), self.slopes)
    }

    fn respond(&self, _: &Chain, pressures: &[f64], into: &mut Response) -> Result<(), OutOfDomain> {
        let mut evaluation = PoseEvaluation {
            chart: PoseChart::default(),
            jacobian: std::mem::take(&mut into.by_pressure),
            slopes: std::mem::take(&mut into.slopes),
        };
        let mut clamped = vec![0.0; pressures.len()];
        let outcome = evaluate_near(self.model, pressures, &mut clamped, &mut evaluation);
        into.values = evaluation.chart.to_array();
        into.by_pressure = evaluation.jacobian;
        into.slopes = evaluation.slopes;
        into.overshoot = overshoot(self.model, pressures);
        outcome
    }

    fn observe(&self, chain: &Chain, response: &Response) -> Seen {
        let loads = chain.loads(self.hanging_mass);
        let mut values = response.values;
        let changes = [
            (self.payload, loads.mass),
            (self.payload_curvature, payload_curvature(loads.mass)),
            (self.bending, loads.bending_stiffness),
        ];
        for (slope, change) in changes {
            let Some(slope) = slope else { continue };
            for (value, slope) in values.iter_mut().zip(&response.slopes[slope]) {
                *value += slope * change;
            }
        }
        let chart = chain.bend(&PoseChart::from_array(values));
        Seen::Pose(chain.read_pose(&chart.to_pose()), chart.twist)
    }

    fn length(&self) -> f64 {
        self.length
    }
}

/// A single FREE's model: gauge pressure (Pa), winding angle from the hoop (rad) and shear modulus (Pa) to deformation.
pub trait FreeResponse: Sync {
    /// Axial stretch, expansion b/B and twist per reference length (rad/m, sign of the FREE's own hand).
    fn respond(&self, pressure: f64, winding_angle: f64, shear_modulus: f64)
    -> Result<[f64; 3], OutOfDomain>;
    /// Pressures (Pa) answered at this angle and modulus.
    fn domain(&self, winding_angle: f64, shear_modulus: f64) -> (f64, f64);
    /// Winding angles (rad) answered.
    fn winding_angles(&self) -> (f64, f64);
}

/// A single FREE, cap to cap.
pub struct FreeMechanics<'a> {
    model: &'a dyn FreeResponse,
    free: actuator::Free,
}

impl<'a> FreeMechanics<'a> {
    /// A model of this FREE.
    pub fn new(model: &'a dyn FreeResponse, free: actuator::Free) -> Self {
        FreeMechanics { model, free }
    }

    /// Outer diameter of the FREE at rest, m.
    pub fn outer_diameter(&self) -> f64 {
        2.0 * self.free.tube.outer_radius()
    }

    /// Twist (rad), change of length (m), outer diameter (m); beyond the domain along the tangent at its edge.
    fn deformation(&self, pressure: f64, angle: f64) -> Result<[f64; 3], OutOfDomain> {
        let tube = self.free.tube;
        let modulus = self.free.elastomer.shear_modulus();
        let (lowest, highest) = self.model.winding_angles();
        let angle = angle.clamp(lowest, highest);
        let (lower, upper) = self.model.domain(angle, modulus);
        let at = |pressure| -> Result<[f64; 3], OutOfDomain> {
            let [stretch, expansion, twist] = self.model.respond(pressure, angle, modulus)?;
            Ok([twist * tube.length, (stretch - 1.0) * tube.length, expansion * 2.0 * tube.outer_radius()])
        };
        let inside = pressure.clamp(lower, upper);
        let value = at(inside)?;
        if inside == pressure {
            return Ok(value);
        }
        let step = 1e-3 * (upper - lower) * if pressure > upper { -1.0 } else { 1.0 };
        let beside = at(inside + step)?;
        let mut out = value;
        for ((out, value), beside) in out.iter_mut().zip(value).zip(beside) {
            *out += (beside - value) / step * (pressure - inside);
        }
        Ok(out)
    }
}

/// Widens the three numbers of a FREE to the room of a pose.
fn widened(values: [f64; 3]) -> [f64; OUTPUTS] {
    [values[0], values[1], values[2], 0.0, 0.0, 0.0]
}

impl Mechanics for FreeMechanics<'_> {
    fn frees(&self) -> usize {
        1
    }

    fn room(&self) -> Response {
        Response::new(1, 2)
    }

    fn respond(&self, chain: &Chain, pressures: &[f64], into: &mut Response) -> Result<(), OutOfDomain> {
        // Steps of differences: small against the map's curvature, large against its rounding.
        const PRESSURE_STEP: f64 = 10.0;
        const ANGLE_STEP: f64 = 1e-3;
        let change = chain.winding_angle();
        let angle = self.free.winding.angle_from_hoop() + change;
        let pressure = pressures[0];
        let value = self.deformation(pressure, angle)?;
        let slope = |up: [f64; 3], down: [f64; 3], step: f64| {
            widened(std::array::from_fn(|k| (up[k] - down[k]) / (2.0 * step)))
        };
        let p = PRESSURE_STEP;
        into.by_pressure[0] =
            slope(self.deformation(pressure + p, angle)?, self.deformation(pressure - p, angle)?, p);
        let a = ANGLE_STEP;
        into.slopes[0] =
            slope(self.deformation(pressure, angle + a)?, self.deformation(pressure, angle - a)?, a);
        // The second slot carries the change of angle at which the response was taken.
        into.slopes[1][0] = change;
        into.values = widened(value);
        let (lower, upper) = self.model.domain(angle, self.free.elastomer.shear_modulus());
        into.overshoot = (lower - pressure).max(pressure - upper).max(0.0);
        Ok(())
    }

    fn observe(&self, chain: &Chain, response: &Response) -> Seen {
        let change = chain.winding_angle() - response.slopes[1][0];
        Seen::Free(std::array::from_fn(|k| response.values[k] + response.slopes[0][k] * change))
    }

    fn length(&self) -> f64 {
        self.free.tube.length
    }
}
