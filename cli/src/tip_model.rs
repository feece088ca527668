//! A module's model as steering sees it: pressures to tip pose, nothing else.

use rom::{ModuleModel, OutOfDomain, PoseEvaluation, PoseModel};
use std::cell::RefCell;

/// A module's model without the slopes that only identification asks for.
pub struct TipModel<'m> {
    module: &'m ModuleModel,
    room: RefCell<PoseEvaluation>,
}

impl<'m> TipModel<'m> {
    /// Of a module.
    pub fn new(module: &'m ModuleModel) -> Self {
        TipModel { module, room: RefCell::new(module.workspace()) }
    }
}

impl PoseModel for TipModel<'_> {
    fn domain(&self) -> &[(f64, f64)] {
        self.module.domain()
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        let mut room = self.room.borrow_mut();
        self.module.evaluate(pressures, &mut room)?;
        into.chart = room.chart;
        into.jacobian.copy_from_slice(&room.jacobian);
        Ok(())
    }
}
