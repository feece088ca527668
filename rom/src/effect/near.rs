use crate::{OutOfDomain, PoseEvaluation, PoseModel};

/// Evaluates a model at pressures (Pa) that may lie a little outside its domain, by its tangent at the nearest pressures inside.
///
/// Sensors read below zero and a stiffness below nominal asks for more pressure than was applied; an estimate must not stop there.
/// How far outside is told by [`overshoot`], so that a caller can refuse what is no longer near. `clamped` is room for one pressure a FREE.
pub fn evaluate_near<M: PoseModel + ?Sized>(
    model: &M,
    pressures: &[f64],
    clamped: &mut [f64],
    into: &mut PoseEvaluation,
) -> Result<(), OutOfDomain> {
    for ((inside, pressure), (lower, upper)) in clamped.iter_mut().zip(pressures).zip(model.domain()) {
        *inside = pressure.clamp(*lower, *upper);
    }
    model.evaluate(clamped, into)?;
    let mut chart = into.chart.to_array();
    for ((inside, pressure), column) in clamped.iter().zip(pressures).zip(&into.jacobian) {
        for (value, slope) in chart.iter_mut().zip(column) {
            *value += slope * (pressure - inside);
        }
    }
    into.chart = actuator::PoseChart::from_array(chart);
    Ok(())
}

/// How far (Pa) pressures lie outside a model's domain; zero inside.
pub fn overshoot<M: PoseModel + ?Sized>(model: &M, pressures: &[f64]) -> f64 {
    pressures
        .iter()
        .zip(model.domain())
        .map(|(pressure, (lower, upper))| (lower - pressure).max(pressure - upper))
        .fold(0.0, f64::max)
}
