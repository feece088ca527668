use super::motion::{Frame, LogVariation, joined};
use crate::SectionLaw;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// What a length of FREE is made of.
#[derive(Clone, Copy)]
pub(super) struct ElementLaw<'a> {
    pub section: &'a dyn SectionLaw,
    /// +1 for a right-handed winding, -1 for a left-handed one.
    pub hand: f64,
    /// EI, N m^2.
    pub bending: f64,
    /// GA, N.
    pub shear: f64,
    /// For a FREE held by spacers: its place (m) in the nodes' frames. It passes through their holes and tilts there as the bundle
    /// turns: its stretch is the length between the holes, and only the sideways shift of the bundle shears it.
    pub held_at: Option<[f64; 2]>,
    /// Reference length of the element, m.
    pub length: f64,
}

/// A two-node element with helicoidal interpolation: d = log(H_a^-1 H_b), strain d/L, constant along it.
///
/// Energy `L [Phi(p, lambda, tau) + EI (kx^2 + ky^2)/2 + GA (gx^2 + gy^2)/2]` with (gx, gy, lambda, kx, ky, tau) = d/L. Whatever
/// the length, it is exact for states of constant strain: stretched, twisted, bent to a circle, or a helix of them.
///
/// Held by spacers at (x, y), with d = (t, w): lambda = |t|/L, as of the helix that a FREE beside the axis of a turning bundle is
/// on, gx = (t_x + y w_z)/L and gy = (t_y - x w_z)/L, the shift of the bundle. The turn about the bundle's axis is taken for the
/// one about the FREE's own, too much by a factor of 1/cos(tilt): one per cent at 8 degrees.
pub(super) struct Element {
    pub energy: f64,
    /// dE/dxi at both nodes.
    pub gradient: [Vector6<f64>; 2],
    /// Second derivatives of E(H_a exp xi_a, H_b exp xi_b): aa, ab, bb.
    pub tangent: [Matrix6<f64>; 3],
    /// The part of the gradient that is proportional to the bending stiffness.
    pub bending_gradient: [Vector6<f64>; 2],
    /// Derivative of the gradient with respect to the pressure.
    pub pressure_gradient: [Vector6<f64>; 2],
}

impl ElementLaw<'_> {
    /// Stretch and twist per length of the element, as its right-handed section sees them.
    pub fn strain(&self, d: &Vector6<f64>) -> [f64; 2] {
        let stretched = if self.held_at.is_some() { d.fixed_rows::<3>(0).norm() } else { d[2] };
        [stretched / self.length, self.hand * d[5] / self.length]
    }

    /// Direction in which the FREE is pulled, and the stiffness that its force has against turning it.
    fn axis(&self, d: &Vector6<f64>, force: f64) -> (Vector3<f64>, Matrix3<f64>) {
        if self.held_at.is_none() {
            return (Vector3::z(), Matrix3::zeros());
        }
        let along: Vector3<f64> = d.fixed_rows::<3>(0).into();
        let stretched = along.norm();
        let axis = along / stretched;
        (axis, (Matrix3::identity() - axis * axis.transpose()) * (force / stretched))
    }

    /// The combinations of d that shear the element.
    fn shears(&self) -> [Vector6<f64>; 2] {
        let [x, y] = self.held_at.unwrap_or_default();
        [Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, y), Vector6::new(0.0, 1.0, 0.0, 0.0, 0.0, -x)]
    }

    /// The element between two frames; `None` when the law has no answer there. The derivative with respect to the pressure
    /// is left at zero unless it is asked for.
    pub fn evaluate(
        &self,
        a: &Frame,
        b: &Frame,
        pressure: f64,
        with_pressure_gradient: bool,
    ) -> Option<Element> {
        let d = a.log_to(b);
        let length = self.length;
        let [stretch, twist] = self.strain(&d);
        let section = self.section.respond(pressure, stretch, twist);
        let [bending, shear] = [self.bending / length, self.shear / length];
        let bent = joined([0.0; 3].into(), [bending * d[3], bending * d[4], 0.0].into());
        let (axis, turning) = self.axis(&d, section.force);
        let along = joined(axis, Vector3::zeros());
        let mut force = bent + along * section.force;
        force[5] += self.hand * section.torque;
        let mut stiffness = Matrix6::from_diagonal(&Vector6::new(0.0, 0.0, 0.0, bending, bending, 0.0));
        let mut energy = length * section.energy + 0.5 * bending * (d[3] * d[3] + d[4] * d[4]);
        for direction in self.shears() {
            let sheared = direction.dot(&d);
            energy += 0.5 * shear * sheared * sheared;
            force += direction * (shear * sheared);
            stiffness += direction * direction.transpose() * shear;
        }
        if !(energy.is_finite() && force.iter().all(|value| value.is_finite())) {
            return None;
        }
        let mut block = stiffness.fixed_view_mut::<3, 3>(0, 0);
        block += axis * axis.transpose() * (section.stiffness[0][0] / length) + turning;
        let coupling = along * (self.hand * section.stiffness[0][1] / length);
        let mut column = stiffness.column_mut(5);
        column += coupling;
        let mut row = stiffness.row_mut(5);
        row += coupling.transpose();
        stiffness[(5, 5)] += section.stiffness[1][1] / length;

        let vary = LogVariation::new(&d, &force);
        let on_b = vary.right * stiffness + vary.right_slope;
        let on_a = vary.left * stiffness + vary.left_slope;
        let aa = on_a * vary.left.transpose();
        let bb = on_b * vary.right.transpose();
        let ba = -on_b * vary.left.transpose();
        let pull = |f: &Vector6<f64>| [-(vary.left * f), vary.right * f];
        let mut pressure_gradient = [Vector6::zeros(); 2];
        if with_pressure_gradient {
            let [axial, torsional] = self.section.pressure_slopes(pressure, stretch, twist);
            let mut by_pressure = along * axial;
            by_pressure[5] += self.hand * torsional;
            pressure_gradient = pull(&by_pressure);
        }
        Some(Element {
            energy,
            gradient: pull(&force),
            // The symmetric part is the second derivative of the energy; the rest vanishes with the node's residual.
            tangent: [(aa + aa.transpose()) * 0.5, ba.transpose(), (bb + bb.transpose()) * 0.5],
            bending_gradient: pull(&bent),
            pressure_gradient,
        })
    }
}
