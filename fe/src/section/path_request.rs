use super::{SectionError, solver::check};
use actuator::EndLoad;

/// What a path of a section is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathRequest<'a> {
    /// Constant axial force and torque on the closed ends, present from zero pressure up.
    pub load: EndLoad,
    /// Pressures (Pa, rising) whose states are wanted, as far as they exist.
    pub pressures: &'a [f64],
    /// States beside those, evenly spaced in s = 1 - sqrt(1 - p/p_limit), up to the limit point.
    pub extra_states: usize,
    /// Where given, further states are put wherever the cubic in s through four neighbouring ones misses by more than this share of
    /// the greatest change of stretch, expansion or twist along the path.
    pub interpolation_tolerance: Option<f64>,
    /// Where given, the path goes on past the limit point by rising enclosed volume, up to this multiple of the volume there.
    pub beyond_limit: Option<f64>,
    /// Whether to solve the path on two coarser meshes as well, for an estimate of the errors.
    pub estimate_errors: bool,
}

/// Greatest multiple of the volume at the limit that can be asked for.
const MOST_BEYOND: f64 = 20.0;
/// Finest tolerance: states are exact to a residual of 1e-10 to 5e-9.
const FINEST_TOLERANCE: f64 = 1e-7;

impl PathRequest<'_> {
    pub(crate) fn check(&self) -> Result<(), SectionError> {
        let EndLoad { force, torque } = self.load;
        check("force", force, force.is_finite(), "it must be a number, in N")?;
        check("torque", torque, torque.is_finite(), "it must be a number, in N m")?;
        for pressure in self.pressures {
            check("pressure", *pressure, *pressure >= 0.0, "a path rises from zero, in Pa")?;
        }
        if let Some(tolerance) = self.interpolation_tolerance {
            let accepted = (FINEST_TOLERANCE..=1.0).contains(&tolerance);
            check("interpolation_tolerance", tolerance, accepted, "it must be a share from 1e-7 to 1")?;
        }
        if let Some(ratio) = self.beyond_limit {
            let accepted = ratio > 1.0 && ratio <= MOST_BEYOND;
            check(
                "beyond_limit",
                ratio,
                accepted,
                "it must be a multiple of the volume, above 1 and up to 20",
            )?;
        }
        Ok(())
    }
}
