use super::motion::{Frame, LogVariation, joined};
use crate::SectionLaw;
use nalgebra::{Matrix6, Vector6};

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
    /// Reference length of the element, m.
    pub length: f64,
}

/// A two-node element with helicoidal interpolation: d = log(H_a^-1 H_b), strain d/L, constant along it.
///
/// Energy `L [Phi(p, lambda, tau) + EI (kx^2 + ky^2)/2 + GA (gx^2 + gy^2)/2]` with (gx, gy, lambda, kx, ky, tau) = d/L. Whatever
/// the length, it is exact for states of constant strain: stretched, twisted, bent to a circle, or a helix of them.
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
        [d[2] / self.length, self.hand * d[5] / self.length]
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
        let mut force = bent;
        force[0] = shear * d[0];
        force[1] = shear * d[1];
        force[2] = section.force;
        force[5] = self.hand * section.torque;
        let energy = length * section.energy
            + 0.5 * bending * (d[3] * d[3] + d[4] * d[4])
            + 0.5 * shear * (d[0] * d[0] + d[1] * d[1]);
        if !(energy.is_finite() && force.iter().all(|value| value.is_finite())) {
            return None;
        }
        let mut stiffness = Matrix6::from_diagonal(&Vector6::new(shear, shear, 0.0, bending, bending, 0.0));
        stiffness[(2, 2)] = section.stiffness[0][0] / length;
        stiffness[(2, 5)] = self.hand * section.stiffness[0][1] / length;
        stiffness[(5, 2)] = stiffness[(2, 5)];
        stiffness[(5, 5)] = section.stiffness[1][1] / length;

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
            let mut by_pressure = Vector6::zeros();
            by_pressure[2] = axial;
            by_pressure[5] = self.hand * torsional;
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
