use crate::{
    answers::{DeformationRows, TipRows},
    arrays,
    loaded::Loaded,
    model::Model,
};
use pyo3::{exceptions::PyValueError, prelude::*};
use std::sync::Arc;

/// An actuator in time: a model with what its effects remember. Begins rested.
#[pyclass(module = "freeact")]
pub struct State {
    loaded: Arc<Loaded>,
    memory: Vec<f64>,
}

impl State {
    /// Of a model, rested.
    pub fn of(loaded: &Arc<Loaded>) -> Self {
        let memory = vec![0.0; loaded.model.effects.of(loaded.model.frees()).memory()];
        State { loaded: loaded.clone(), memory }
    }
}

#[pymethods]
impl State {
    #[new]
    fn new(model: &Model) -> Self {
        State::of(&model.loaded)
    }

    /// Goes `step_s` seconds on with these pressures (Pa), (frees,), held over the step; what is read at its end: a Tip of a module, a
    /// Deformation of a single FREE.
    ///
    /// The pressures are commands, which the supply follows. With `measured=True` they are what the sensors read, and the
    /// supply takes no part. Raises ValueError for a step or pressure that is none; the memory has then not gone on.
    #[pyo3(signature = (step_s, pressures_pa, *, measured = false, jacobian = false))]
    fn step(
        &mut self,
        py: Python<'_>,
        step_s: f64,
        pressures_pa: &Bound<'_, PyAny>,
        measured: bool,
        jacobian: bool,
    ) -> PyResult<Py<PyAny>> {
        let frees = self.loaded.model.frees();
        let (mut pressures, lead) = arrays::read_pressures(pressures_pa, frees)?;
        if !lead.is_empty() {
            return Err(PyValueError::new_err("a step takes one pressure per FREE, shape (frees,)"));
        }
        if !(step_s >= 0.0 && step_s.is_finite()) {
            return Err(PyValueError::new_err(format!("a step of {step_s} s is none; it is zero or more")));
        }
        if pressures.iter().any(|pressure| !pressure.is_finite()) {
            return Err(PyValueError::new_err("a pressure is infinite or not a number"));
        }
        let chain = self.loaded.model.effects.of(frees);
        if measured {
            chain.unread_pressures(&mut pressures);
        } else {
            chain.supply(&mut self.memory, step_s, &mut pressures);
        }
        if let Some(tip) = &self.loaded.tip {
            let mut rows = TipRows::default();
            rows.push(&tip.evaluate(&chain, &mut self.memory, step_s, &pressures), frees);
            return Ok(Py::new(py, rows.arrays(py, &[], frees, jacobian)?)?.into_any());
        }
        let mut rows = DeformationRows::default();
        if let Some(free) = self.loaded.model.as_free() {
            let (angle, modulus) =
                (free.free().winding.angle_from_hoop(), free.free().elastomer.shear_modulus());
            let splines = free.splines();
            rows.push(&splines.evaluate_after(
                &chain,
                &mut self.memory,
                step_s,
                pressures[0],
                angle,
                modulus,
            ));
        }
        Ok(Py::new(py, rows.arrays(py, &[], jacobian)?)?.into_any())
    }

    /// Back to rest: everything is forgotten.
    fn reset(&mut self) {
        self.memory.fill(0.0);
    }
}
