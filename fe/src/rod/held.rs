use super::{
    equilibrium::{Configuration, Equilibrium, RodError},
    module::RodModule,
    path::Loads,
};
use crate::{NoEquilibrium, rigid_motion::Frame, tip_plate::Plate};
use actuator::PoseChart;
use nalgebra::UnitQuaternion;

/// A module whose tip plate is held at a pose: all six coordinates are given, the FREEs between the plates find their
/// equilibrium, and what they give to the plate ([`Equilibrium::wrenches`]) is the module's blocked force.
///
/// A FREE that pushes is a column under its own thrust: the equilibrium followed from rest may stop being stable, which
/// `state.negative_pivots` tells; it is not left.
pub struct HeldModule {
    rods: RodModule,
    start: Equilibrium,
}

/// Longest step of the plate: of its turns, rad, and of its shift, as a share of the module's length.
const PLATE_STEP: (f64, f64) = (0.1, 0.02);
/// Shortest step as a part of the way before it is given up.
const SHORTEST_STEP: f64 = 1e-4;

impl RodModule {
    /// The module with its plate held at a pose, brought there from rest without pressure.
    ///
    /// # Errors
    /// [`RodError::NoEquilibrium`] where the FREEs cannot follow the plate, [`RodError::OutsideSectionLaw`] where a law was not made for the
    /// pose.
    pub fn held(&self, pose: &PoseChart) -> Result<HeldModule, RodError> {
        let mut module = self.module.clone();
        module.tip.free_dof = [false; 6];
        let rods = RodModule::new(&module, self.laws.clone(), self.settings)?;
        let loads = Loads::at(&vec![0.0; self.laws.len()]);
        let mut shape = rods.rest()?.configuration;
        let (from, to) = (shape.plate.0, Plate::at_chart(pose).0);
        let way = to - from;
        let turn = way.fixed_rows::<3>(3).amax() / PLATE_STEP.0;
        let shift = way.fixed_rows::<3>(0).norm() / (PLATE_STEP.1 * module.length());
        let (mut done, mut step) = (0.0, 1.0 / turn.max(shift).max(1.0).ceil());
        while done < 1.0 {
            let goal = if done + step > 1.0 - 1e-9 { 1.0 } else { done + step };
            let plate = if goal < 1.0 { Plate(from + way * goal) } else { Plate(to) };
            match rods.newton(&carried(&shape, plate), &loads) {
                Ok(found) => (shape, done) = (found, goal),
                Err(residual) if step < SHORTEST_STEP => {
                    return Err(NoEquilibrium::there(&loads.pressures, residual, shape).into());
                }
                Err(_) => step *= 0.5,
            }
        }
        let start = rods.finish(shape, &loads)?;
        Ok(HeldModule { rods, start })
    }
}

/// The shape with its plate moved, its inner nodes taken along by their share of the way: where Newton's method starts.
fn carried(shape: &Configuration, plate: Plate) -> Configuration {
    let (before, after) = (shape.plate.frame(), plate.frame());
    let turn = (after.rotation * before.rotation.inverse()).scaled_axis();
    let shift = after.position - before.position;
    let move_nodes = |nodes: &Vec<Frame>| {
        let count = (nodes.len() + 1) as f64;
        let one = |(place, node): (usize, &Frame)| {
            let share = (place + 1) as f64 / count;
            let rotation = UnitQuaternion::from_scaled_axis(turn * share) * node.rotation;
            Frame { rotation, position: node.position + shift * share }
        };
        nodes.iter().enumerate().map(one).collect()
    };
    Configuration { plate, inner: shape.inner.iter().map(move_nodes).collect() }
}

impl HeldModule {
    /// The equilibrium without pressure.
    pub fn unpressurised(&self) -> &Equilibrium {
        &self.start
    }

    /// Equilibrium at pressures (Pa), followed from another one of this pose in a straight line of pressures.
    ///
    /// # Errors
    /// As of [`RodModule::solve_from`].
    pub fn solve_from(&self, start: &Equilibrium, pressures: &[f64]) -> Result<Equilibrium, RodError> {
        self.rods.solve_from(start, pressures)
    }

    /// Equilibrium at pressures (Pa), followed from zero pressure.
    ///
    /// # Errors
    /// As of [`RodModule::solve_from`].
    pub fn solve(&self, pressures: &[f64]) -> Result<Equilibrium, RodError> {
        self.solve_from(&self.start, pressures)
    }
}
