use crate::{
    ModelError,
    answers::{Deformation, DeformationRows, Tip, TipRows},
    arrays,
    loaded::Loaded,
    state::State,
};
use actuator::artefact::ArtefactError;
use evaluator::TipModel;
use pyo3::{exceptions::PyTypeError, prelude::*};
use rom::{FreeModel, ModelError as Unreadable};
use std::{path::PathBuf, sync::Arc};

/// A kilopascal.
const KPA: f64 = 1e3;

/// A model of a single FREE or of a module, from a file that `freeact fit` or `freeact identify` wrote.
///
/// SI units, gauge pressures; the base frame has +z from the base plate to the tip plate. Effects act as they do at rest; those with
/// a memory (hysteresis, lag, creep, ...) act in a State. A model is never changed: threads may share it.
#[pyclass(frozen, module = "freeact")]
pub struct Model {
    pub(crate) loaded: Arc<Loaded>,
}

impl Model {
    fn tip_model(&self) -> PyResult<&TipModel<f64, Vec<f64>>> {
        self.loaded.tip.as_ref().ok_or_else(|| {
            PyTypeError::new_err("this is the model of a single FREE, which has no tip; use deform()")
        })
    }

    fn free_model(&self) -> PyResult<&FreeModel> {
        self.loaded.model.as_free().ok_or_else(|| {
            PyTypeError::new_err("this is the model of a module; a single FREE is asked for. Use tip()")
        })
    }
}

#[pymethods]
impl Model {
    /// Reads a .model file. Raises OSError where it cannot be read, ModelError where it is none.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let model = rom::Model::read(&path).map_err(|error| match &error {
            // FileNotFoundError and its like, by the kind.
            Unreadable::Artefact(ArtefactError::Io { source, .. }) => {
                std::io::Error::new(source.kind(), error.to_string()).into()
            }
            _ => ModelError::new_err(error.to_string()),
        })?;
        Ok(Model { loaded: Arc::new(Loaded::new(model)) })
    }

    /// Number of FREEs; 1 of a single FREE.
    #[getter]
    fn frees(&self) -> usize {
        self.loaded.model.frees()
    }

    /// "module" or "free".
    #[getter]
    fn kind(&self) -> &'static str {
        if self.loaded.tip.is_some() { "module" } else { "free" }
    }

    /// Names of the effects beyond the finite elements, in the order in which they act.
    #[getter]
    fn effects(&self) -> Vec<&'static str> {
        self.loaded.model.effects.effects.iter().map(|effect| effect.kind.name()).collect()
    }

    /// Least and greatest pressure (kPa) of each FREE that the splines answer, after the effects: (frees, 2). Of a single FREE at its own
    /// winding angle and shear modulus (NaN where the model does not reach these).
    #[getter]
    fn domain_kpa<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values = match (&self.loaded.tip, self.loaded.model.as_free()) {
            (Some(tip), _) => {
                let domain = tip.splines.domain().iter();
                domain.flat_map(|(lower, upper)| [lower / KPA, upper / KPA]).collect()
            }
            (None, Some(free)) => {
                let own = free.free();
                let greatest =
                    free.greatest_pressure(own.winding.angle_from_hoop(), own.elastomer.shear_modulus());
                vec![0.0, greatest.map_or(f64::NAN, |pascal| pascal / KPA)]
            }
            (None, None) => Vec::new(),
        };
        arrays::doubles(py, &values, &[values.len() / 2], &[2])
    }

    /// Of a single FREE: its own winding angle from the hoop, the model's least and its greatest, rad.
    #[getter]
    fn winding_angle_rad(&self) -> PyResult<(f64, f64, f64)> {
        let free = self.free_model()?;
        let (least, greatest) = free.splines().axes().0.range();
        Ok((free.free().winding.angle_from_hoop(), least, greatest))
    }

    /// Of a single FREE: its own shear modulus, the model's least and its greatest, Pa.
    #[getter]
    fn shear_modulus_pa(&self) -> PyResult<(f64, f64, f64)> {
        let free = self.free_model()?;
        let (least, greatest) = free.splines().axes().1.range();
        Ok((free.free().elastomer.shear_modulus(), least, greatest))
    }

    /// Poses of a module's tip at commanded pressures (Pa), (..., frees), that are held. Where the model has no answer the row is NaN and its
    /// status tells why.
    #[pyo3(signature = (pressures_pa, *, jacobian = false))]
    fn tip(&self, py: Python<'_>, pressures_pa: &Bound<'_, PyAny>, jacobian: bool) -> PyResult<Tip> {
        let (tip, frees) = (self.tip_model()?, self.frees());
        let (pressures, lead) = arrays::read_pressures(pressures_pa, frees)?;
        let rows = py.detach(|| {
            let mut rows = TipRows::default();
            for commands in pressures.chunks_exact(frees) {
                rows.push(&self.loaded.pose(tip, commands), frees);
            }
            rows
        });
        rows.arrays(py, &lead, frees, jacobian)
    }

    /// Deformation of a single FREE at commanded pressures (Pa) that are held, winding angles from the hoop (rad) and shear moduli (Pa), by
    /// default its own; broadcast against each other. Where the model has no answer there is NaN and the status tells why.
    #[pyo3(signature = (pressure_pa, winding_angle_rad = None, shear_modulus_pa = None, *, jacobian = false))]
    fn deform(
        &self,
        py: Python<'_>,
        pressure_pa: &Bound<'_, PyAny>,
        winding_angle_rad: Option<&Bound<'_, PyAny>>,
        shear_modulus_pa: Option<&Bound<'_, PyAny>>,
        jacobian: bool,
    ) -> PyResult<Deformation> {
        let free = self.free_model()?;
        let own = free.free();
        let angle = own.winding.angle_from_hoop().into_pyobject(py)?.into_any();
        let modulus = own.elastomer.shear_modulus().into_pyobject(py)?.into_any();
        let given = [pressure_pa, winding_angle_rad.unwrap_or(&angle), shear_modulus_pa.unwrap_or(&modulus)];
        let ([pressures, angles, moduli], shape) = arrays::read_together(given)?;
        let rows = py.detach(|| {
            let mut rows = DeformationRows::default();
            for ((pressure, angle), modulus) in pressures.iter().zip(&angles).zip(&moduli) {
                rows.push(&self.loaded.deformation(free, [*pressure, *angle, *modulus]));
            }
            rows
        });
        rows.arrays(py, &shape, jacobian)
    }

    /// How much (Pa) every pressure that a module's splines answer may change at once without leaving the domain, negative outside, at
    /// commanded pressures (Pa), (..., frees): (...).
    fn clearance<'py>(
        &self,
        py: Python<'py>,
        pressures_pa: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let tip = self.tip_model()?;
        let (pressures, lead) = arrays::read_pressures(pressures_pa, self.frees())?;
        let rows = pressures.chunks_exact(self.frees());
        let values: Vec<f64> =
            rows.map(|commands| tip.splines.clearance(&self.loaded.answered(commands))).collect();
        arrays::doubles(py, &values, &lead, &[])
    }

    /// What 95 of 100 errors against the finite elements stay below around commanded pressures (Pa), (..., frees): of the position (m) and the
    /// rotation (rad), (..., 2). None where the model was made without states to judge it by.
    fn error_bars<'py>(
        &self,
        py: Python<'py>,
        pressures_pa: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let tip = self.tip_model()?;
        let (pressures, lead) = arrays::read_pressures(pressures_pa, self.frees())?;
        if tip.splines.bars().is_empty() {
            return Ok(None);
        }
        let rows = pressures.chunks_exact(self.frees());
        let bars = rows.filter_map(|commands| tip.splines.error_bars(&self.loaded.answered(commands)));
        let values: Vec<f64> = bars.flatten().collect();
        arrays::doubles(py, &values, &lead, &[2]).map(Some)
    }

    /// An actuator of this model that has rested, to be stepped through time.
    fn state(&self) -> State {
        State::of(&self.loaded)
    }

    fn __repr__(&self) -> String {
        let name = &self.loaded.model.provenance.description_name;
        format!("<freeact.Model of the {} {name:?}, {} FREEs>", self.kind(), self.frees())
    }
}
