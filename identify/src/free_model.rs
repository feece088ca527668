use crate::FreeResponse;
use rom::{FreeModel, OutOfDomain};

impl FreeResponse for FreeModel {
    fn respond(
        &self,
        pressure: f64,
        winding_angle: f64,
        shear_modulus: f64,
    ) -> Result<[f64; 3], OutOfDomain> {
        let (lower, upper) = self.domain(winding_angle, shear_modulus);
        match self.evaluate(pressure, winding_angle, shear_modulus) {
            Ok(state) => Ok([state.axial_stretch, state.expansion, state.twist_per_length]),
            Err(_) => Err(OutOfDomain::Pressure { free: 0, pressure, lower, upper }),
        }
    }

    fn domain(&self, winding_angle: f64, shear_modulus: f64) -> (f64, f64) {
        // Outside the map's angles and moduli there is no pressure that is answered.
        (0.0, self.greatest_pressure(winding_angle, shear_modulus).unwrap_or(0.0))
    }

    fn winding_angles(&self) -> (f64, f64) {
        let nodes = FreeModel::winding_angles(self);
        let own = self.free().winding.angle_from_hoop();
        (nodes.first().copied().unwrap_or(own), nodes.last().copied().unwrap_or(own))
    }
}
