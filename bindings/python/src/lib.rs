//! Models of FREE actuators in Python: `import freeact`. The reference is `freeact.pyi`.

mod answers;
mod arrays;
mod loaded;
mod model;
mod state;

use pyo3::{create_exception, exceptions::PyValueError, prelude::*};

create_exception!(
    freeact,
    ModelError,
    PyValueError,
    "A file is no model, or none for this version of freeact."
);

/// Models of FREE actuators (fibre-reinforced elastomeric enclosures), evaluated on numpy arrays.
#[pymodule]
mod freeact {
    #[pymodule_export]
    use super::{
        ModelError,
        answers::{Deformation, Tip},
        model::Model,
        state::State,
    };

    #[pymodule_export]
    const OK: u8 = super::answers::OK;
    #[pymodule_export]
    const OUTSIDE_PRESSURE: u8 = super::answers::OUTSIDE_PRESSURE;
    #[pymodule_export]
    const UNSTABLE: u8 = super::answers::UNSTABLE;
    #[pymodule_export]
    const OUTSIDE_ANGLE: u8 = super::answers::OUTSIDE_ANGLE;
    #[pymodule_export]
    const OUTSIDE_MODULUS: u8 = super::answers::OUTSIDE_MODULUS;
}
