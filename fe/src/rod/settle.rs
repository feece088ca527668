use super::{
    equilibrium::{Configuration, Equilibrium, RodError},
    mode::{BucklingMode, Stiffened},
    module::RodModule,
    path::{Loads, moved, step_length},
    system::System,
};
use crate::NoEquilibrium;
use std::f64::consts::PI;

/// Steps downhill before it is given up.
const STEPS: usize = 400;
/// Steps after which the tangent is taken as it is, once.
const TRIED: usize = 8;
/// Residual from which on Newton's method ends the way.
const NEAR: f64 = 1e-4;

impl RodModule {
    /// The stable equilibrium that a module comes to from an unstable one, pushed off along a mode by `offset` (m; its sign chooses the
    /// side) and then left to itself: every step lowers the energy, as of a module that moves slowly through something thick.
    ///
    /// Steps are Newton's with as much of the metric of modes added to the tangent as makes it positive definite.
    ///
    /// # Errors
    /// [`RodError`] where none is found, or it lies outside the section laws; [`RodError::BentOver`] where the tip bends by more than pi.
    pub fn settle(
        &self,
        from: &Equilibrium,
        along: &BucklingMode,
        offset: f64,
    ) -> Result<Equilibrium, RodError> {
        let loads = Loads::at(&from.pressures);
        let chains = self.chains(1.0);
        let mut shape = self.displaced(&from.configuration, along, offset);
        let (force, radius) = self.reference;
        let mut residual = f64::INFINITY;
        let mut spring = self.soft_spring();
        for step in 0..STEPS {
            let Some(system) = self.assemble(&chains, &shape, &loads, false) else { break };
            residual = system.residual;
            // Along a bent valley steps stay short to the end: Newton's method, which may climb, is tried now and then.
            if step % TRIED == 0 {
                spring = 0.0;
            }
            let Some(stiffened) = self.stiffened(&shape, &system, &loads, spring) else { break };
            if stiffened.spring == 0.0 && residual < NEAR {
                // Close to a fork it may yet go back to the equilibrium that was left.
                if let Ok(near) = self.newton(&shape, &loads) {
                    let found = self.finish(near, &loads)?;
                    if !found.state.is_buckled() && found.energy <= from.energy {
                        return within_chart(found);
                    }
                }
            }
            let (plate, inner) = stiffened.factored.newton_step(&self.tip);
            let length = step_length(&plate, &inner, &stiffened.factored, &chains);
            let trial = moved(&shape, &plate, &inner, length);
            let system_energy = system.energy;
            let slope = |shape: &Configuration, system: &System| {
                self.slope_along(&chains, shape, system, (&plate, &inner)) * length
            };
            let lower = self.assemble(&chains, &trial, &loads, false).is_some_and(|found| {
                // Where rounding hides the change of the energy, the mean of its slopes tells it.
                let change = found.energy - system.energy;
                let hidden = change.abs() < 1e-11 * (system.energy.abs() + force * radius);
                let change =
                    if hidden { 0.5 * (slope(&shape, &system) + slope(&trial, &found)) } else { change };
                change < 0.0
            });
            // A step along a bent valley climbs its side; one more from there tells whether it led on.
            let corrected = || {
                let system = self.assemble(&chains, &trial, &loads, false)?;
                let Stiffened { factored, .. } = self.stiffened(&trial, &system, &loads, stiffened.spring)?;
                let (plate, inner) = factored.newton_step(&self.tip);
                let length = step_length(&plate, &inner, &factored, &chains);
                let next = moved(&trial, &plate, &inner, length);
                let found = self.assemble(&chains, &next, &loads, false)?;
                (found.energy - system_energy < -1e-14 * (system_energy.abs() + force * radius))
                    .then_some(next)
            };
            let next = if lower { Some(trial.clone()) } else { corrected() };
            if let Some(next) = next {
                shape = next;
                spring = 0.2 * stiffened.spring;
                if spring < self.soft_spring() {
                    spring = 0.0;
                }
            } else {
                spring = 5.0 * stiffened.spring.max(self.soft_spring());
            }
        }
        Err(NoEquilibrium::there(&from.pressures, residual, shape).into())
    }
}

/// A bend beyond pi is the same rotation as another one below: the chart of poses ends there.
fn within_chart(found: Equilibrium) -> Result<Equilibrium, RodError> {
    let [x, y] = found.state.chart.bend;
    let bend = x.hypot(y);
    if bend < PI {
        return Ok(found);
    }
    Err(RodError::BentOver { pressures: found.pressures, bend, last: Box::new(found.configuration) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RodSettings, rod::specimens::*};

    #[test]
    fn a_bend_beyond_the_chart_is_refused_in_words() {
        let found = analytic(&left_right([0.0; 3]), RodSettings::default()).rest().unwrap();
        let bent = |bend: [f64; 2]| {
            let mut found = found.clone();
            found.state.chart.bend = bend;
            within_chart(found)
        };
        assert!(bent([2.2, -2.2]).is_ok());
        let error = bent([2.3, -2.3]).unwrap_err();
        assert!(matches!(error, RodError::BentOver { bend, .. } if (bend - 2.3 * 2f64.sqrt()).abs() < 1e-15));
        assert!(error.to_string().contains("bent by 186 deg"), "{error}");
    }
}
