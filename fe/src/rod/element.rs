use crate::rigid_motion::{Frame, LogVariation, joined};
use crate::{BendingLaw, BendingResponse, SectionLaw};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// What a length of FREE is made of.
#[derive(Clone, Copy)]
pub(super) struct ElementLaw<'a> {
    pub section: &'a dyn SectionLaw,
    /// +1 for a right-handed winding, -1 for a left-handed one.
    pub hand: f64,
    pub bending: &'a dyn BendingLaw,
    /// Factor on all that the bending law says.
    pub bending_scale: f64,
    /// For a FREE held by spacers: its place (m) in the nodes' frames. It passes through their holes and tilts there as the bundle
    /// turns: its stretch is the length between the holes, and only the sideways shift of the bundle shears it.
    pub held_at: Option<[f64; 2]>,
    /// Reference length of the element, m.
    pub length: f64,
    /// Caps next to it per reference length, 1/m.
    pub ends: f64,
}

/// A two-node element with helicoidal interpolation: d = log(H_a^-1 H_b), strain d/L, constant along it.
///
/// Energy `L [Phi(p, lambda, tau) + B (kx^2 + ky^2)/2 + C (kx gx + ky gy) + G (gx^2 + gy^2)/2]` with (gx, gy, lambda, kx, ky, tau) = d/L
/// and B, C, G functions of (p, lambda, tau): bending feeds force and torque. Whatever the length, it is exact for states of
/// constant strain: stretched, twisted, bent to a circle, or a helix of them.
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
    /// The part of the gradient that is proportional to the factor on the bending law.
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

    /// Bending law's answer, with the hand's sign and the factor.
    fn bend(&self, state: [f64; 3]) -> BendingResponse {
        let [pressure, stretch, twist] = state;
        let mut found = if self.held_at.is_some() {
            self.bending.respond_tied(pressure, stretch, twist, self.ends)
        } else {
            self.bending.respond(pressure, stretch, twist, self.ends)
        };
        let numbers =
            std::iter::once(&mut found.stiffness).chain(&mut found.slopes).chain(&mut found.curvatures);
        for [bending, coupling, shear] in numbers {
            *bending *= self.bending_scale;
            *coupling *= self.bending_scale * self.hand;
            *shear *= self.bending_scale;
        }
        found
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
        let bent = self.bend([pressure, stretch, twist]);
        // Quadratics of the strain that the bending stiffnesses multiply: value, gradient by d, constant second derivatives.
        let shears = self.shears();
        let curved = [3, 4].map(|i| Vector6::ith(i, 1.0));
        let mut quadratics = [(0.0, Vector6::zeros(), Matrix6::zeros()); 3];
        for (pairs, (value, gradient, second)) in
            [[curved, curved], [curved, shears], [shears, shears]].iter().zip(&mut quadratics)
        {
            for (one, other) in pairs[0].iter().zip(&pairs[1]) {
                let half = if one == other { 0.5 } else { 1.0 } / (length * length);
                *value += half * one.dot(&d) * other.dot(&d);
                *gradient += (one * other.dot(&d) + other * one.dot(&d)) * half;
                *second += (one * other.transpose() + other * one.transpose()) * half;
            }
        }
        let weighed = |weights: &[f64; 3]| -> f64 {
            weights.iter().zip(&quadratics).map(|(weight, (value, ..))| weight * value).sum()
        };
        let steer = |weights: &[f64; 3]| -> Vector6<f64> {
            weights.iter().zip(&quadratics).map(|(weight, (_, gradient, _))| gradient * *weight).sum()
        };
        let [by_stretch, by_twist] = &bent.slopes;
        let [stretch_twice, both, twist_twice] = &bent.curvatures;
        let (axis, turning) = self.axis(&d, section.force + weighed(by_stretch));
        let along = joined(axis, Vector3::zeros());
        let about = Vector6::ith(5, self.hand);
        // Bending adds to the section's force and torque where its stiffness depends on stretch and twist.
        let bending_force_of = |bent: &BendingResponse| {
            steer(&bent.stiffness) * length
                + along * weighed(&bent.slopes[0])
                + about * weighed(&bent.slopes[1])
        };
        let bending_force = bending_force_of(&bent);
        let force = bending_force + along * section.force + about * section.torque;
        let energy = length * (section.energy + weighed(&bent.stiffness));
        if !(energy.is_finite() && force.iter().all(|value| value.is_finite())) {
            return None;
        }
        let [[pulled, coupled], [_, turned]] = section.stiffness;
        let cross = |a: &Vector6<f64>, b: &Vector6<f64>| a * b.transpose() + b * a.transpose();
        let mut stiffness = along * along.transpose() * ((pulled + weighed(stretch_twice)) / length)
            + about * about.transpose() * ((turned + weighed(twist_twice)) / length)
            + cross(&along, &about) * ((coupled + weighed(both)) / length)
            + cross(&along, &steer(by_stretch))
            + cross(&about, &steer(by_twist));
        for (weight, (.., second)) in bent.stiffness.iter().zip(&quadratics) {
            stiffness += second * (weight * length);
        }
        let mut block = stiffness.fixed_view_mut::<3, 3>(0, 0);
        block += turning;

        let vary = LogVariation::new(&d, &force);
        let on_b = vary.right * stiffness + vary.right_slope;
        let on_a = vary.left * stiffness + vary.left_slope;
        let aa = on_a * vary.left.transpose();
        let bb = on_b * vary.right.transpose();
        let ba = -on_b * vary.left.transpose();
        let pull_nodes = |f: &Vector6<f64>| [-(vary.left * f), vary.right * f];
        let mut pressure_gradient = [Vector6::zeros(); 2];
        if with_pressure_gradient {
            let [axial, torsional] = self.section.pressure_slopes(pressure, stretch, twist);
            const STEP: f64 = 10.0;
            let [above, below] =
                [STEP, -STEP].map(|step| bending_force_of(&self.bend([pressure + step, stretch, twist])));
            let bent = (above - below) / (2.0 * STEP);
            pressure_gradient = pull_nodes(&(along * axial + about * torsional + bent));
        }
        Some(Element {
            energy,
            gradient: pull_nodes(&force),
            // The symmetric part is the second derivative of the energy; the rest vanishes with the node's residual.
            tangent: [(aa + aa.transpose()) * 0.5, ba.transpose(), (bb + bb.transpose()) * 0.5],
            bending_gradient: pull_nodes(&bending_force),
            pressure_gradient,
        })
    }
}

#[cfg(test)]
#[path = "element_tests.rs"]
mod tests;
