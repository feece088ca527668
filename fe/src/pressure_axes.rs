use crate::ModuleSweepError;
use actuator::units::KPA;

/// Whether there is an axis of pressures (Pa) for each of `frees` FREEs and no more, of two or more that rise from zero.
///
/// # Errors
/// [`ModuleSweepError::Axis`] of the first that makes no sense.
pub(crate) fn check_axes(frees: usize, pressures: &[Vec<f64>]) -> Result<(), ModuleSweepError> {
    for free in 0..frees.max(pressures.len()) {
        let error = |problem: &str| Err(ModuleSweepError::Axis { free, problem: problem.to_owned() });
        let Some(axis) = pressures.get(free) else { return error("are missing; give nodes for every FREE") };
        if free >= frees {
            return error("there is no such FREE in the module");
        }
        let rising = axis.windows(2).all(|pair| pair[1] > pair[0]) && axis.iter().all(|p| p.is_finite());
        if axis.len() < 2 || axis[0] != 0.0 || !rising {
            let nodes: Vec<String> = axis.iter().map(|p| (p / KPA).to_string()).collect();
            return error(&format!("must be two or more, rising from zero, not {}", nodes.join(", ")));
        }
    }
    Ok(())
}
