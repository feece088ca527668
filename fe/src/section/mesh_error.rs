use actuator::{FreePath, FreeState, MeshError, PathEnd};

/// Order of convergence that the estimate counts on: the threads' edges leave some 1.4 to 2 of the four that the wall has. With one,
/// Richardson's divisor 2^order - 1 is 1, and the error of the finer of two meshes is their whole difference.
const ORDER: i32 = 1;

/// What of a coarser mesh a state is compared with: the state at the same pressure; of the limit state, or where the coarser mesh has
/// no such state any more, the limit state.
fn counterpart<'a>(state: &FreeState, is_limit: bool, coarser: &'a FreePath) -> Option<&'a FreeState> {
    let limit = coarser.states.last().filter(|_| coarser.end == PathEnd::LimitPoint);
    if is_limit {
        return limit;
    }
    let same = |other: &&FreeState| (other.pressure - state.pressure).abs() <= 1e-9 * state.pressure;
    coarser.states.iter().find(same).or(limit)
}

/// Puts into a path what the same path on two coarser meshes says of its errors.
///
/// One mesh has half as many elements every way, the other half as many through the wall only. The sum of both differences is no less
/// than what the wall's elements change, nor than what those around it change, even where these cancel in the first mesh; and an error is
/// never less than at a lower pressure, for where it changes its sign the differences do so elsewhere.
pub(crate) fn estimate(path: &mut FreePath, coarser: &[FreePath; 2]) {
    let divisor = f64::from(2i32.pow(ORDER.unsigned_abs()) - 1);
    let limit = path.limit_pressure();
    path.limit_error = limit.and_then(|limit| {
        let of = |coarser: &FreePath| Some((limit - coarser.limit_pressure()?).abs() / divisor);
        coarser.iter().map(of).sum()
    });
    let last = path.states.len().saturating_sub(1);
    let mut greatest = [0.0f64; 3];
    for (index, state) in path.states.iter_mut().enumerate() {
        let is_limit = index == last && limit.is_some();
        let mut sum = Some([0.0; 3]);
        for coarser in coarser {
            sum = sum.zip(counterpart(state, is_limit, coarser)).map(|(sum, other)| {
                let (fine, coarse) = (state.deformation(), other.deformation());
                std::array::from_fn(|q| sum[q] + (fine[q] - coarse[q]).abs() / divisor)
            });
        }
        let Some(sum) = sum else { continue };
        greatest = std::array::from_fn(|q| greatest[q].max(sum[q]));
        let [axial_stretch, expansion, twist_per_length] = greatest;
        state.mesh_error = Some(MeshError { axial_stretch, expansion, twist_per_length });
    }
}
