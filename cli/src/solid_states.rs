//! The states of a solid map as files of ParaView: a map keeps no fields, so its paths are solved again.

use crate::{
    choice::{Wanted, list},
    exit::Exit,
    failure::Failure,
    interrupt, output,
    progress::Progress,
    table::{Table, short},
};
use actuator::{
    FreeMap, FreeState, LoadedFree,
    units::{DEG, KPA, MPA},
};
use fe::{SolidError, SolidSolver, SolidState, SolidSweep};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// How well a state solved again agrees with the map's, relatively.
const AGREES: f64 = 1e-6;
/// Twist times outer radius below which it is rounding: that of a tube that does not turn.
const NO_TWIST: f64 = 1e-9;

/// The state of a path that was written.
struct Written {
    number: usize,
    pressure: f64,
    files: Vec<String>,
    strains: fe::Strains,
}

/// What became of a path.
struct Shown {
    node: LoadedFree,
    collection: PathBuf,
    written: Vec<Written>,
    beyond: Vec<f64>,
    /// Where it differs from the map, in words.
    difference: Option<String>,
    error: Option<SolidError>,
}

/// What was written.
pub struct SolidStates {
    paths: Vec<Shown>,
    left: usize,
}

/// Greatest difference between two states, as a multiple of what is allowed, and of what.
fn difference(ours: &FreeState, stored: &FreeState, radius: f64) -> (f64, &'static str) {
    let relative = |a: f64, b: f64, least: f64| (a - b).abs() / (AGREES * b.abs() + least);
    let twist = |a: f64, b: f64| relative(a, b, NO_TWIST / radius);
    let mut all = vec![
        (relative(ours.pressure, stored.pressure, f64::MIN_POSITIVE), "the pressure"),
        (relative(ours.axial_stretch, stored.axial_stretch, 0.0), "the axial stretch"),
        (relative(ours.expansion, stored.expansion, 0.0), "the expansion"),
        (twist(ours.twist_per_length, stored.twist_per_length), "the twist"),
    ];
    if let (Some(ours), Some(stored)) = (ours.middle, stored.middle) {
        all.push((relative(ours.axial_stretch, stored.axial_stretch, 0.0), "the middle's axial stretch"));
        all.push((twist(ours.twist_per_length, stored.twist_per_length), "the middle's twist"));
    }
    all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, ""))
}

/// Writes a state's files, and the collection of all that are there by now.
fn write_state(
    shown: &mut Shown,
    folder: &Path,
    number: usize,
    (solver, state): (&SolidSolver, &SolidState),
) -> Result<(), Failure> {
    let rubber = format!("state-{number:03}.vtu");
    output::replace(&folder.join(&rubber), &mut |out| solver.write_vtu(state, &[], out))?;
    let mut files = vec![rubber];
    if solver.has_fibres() {
        let fibres = format!("state-{number:03}-fibres.vtu");
        output::replace(&folder.join(&fibres), &mut |out| solver.write_fibres_vtu(state, out).map(drop))?;
        files.push(fibres);
    }
    let pressure = state.load().pressure;
    shown.written.push(Written { number, pressure, files, strains: solver.strains(state) });
    // Pressures rise along a map's path, which ends at its limit point.
    let frames: Vec<_> =
        shown.written.iter().map(|state| (state.pressure / KPA, state.files.clone())).collect();
    output::replace(&shown.collection, &mut |out| fe::vtk::write_pvd(&frames, out))
}

/// Solves a path again, up to its last state that is wanted, and writes those.
fn show(
    wanted: &Wanted<'_>,
    sweep: &SolidSweep,
    pressures: &[f64],
    directory: &Path,
    step: &mut dyn FnMut(),
) -> Result<Shown, Failure> {
    let node = wanted.node;
    let folder = directory.join(&wanted.name);
    output::make_directory(&folder)?;
    let collection = folder.join("path.pvd");
    let mut shown = Shown {
        node,
        collection,
        written: vec![],
        beyond: wanted.beyond.clone(),
        difference: None,
        error: None,
    };
    let stored = &wanted.path.states;
    let (mut place, mut failure, mut worst) = (0, Ok(()), (1.0, String::new()));
    let step = std::cell::RefCell::new(step);
    let mut told = || {
        (step.borrow_mut())();
        !interrupt::is_asked()
    };
    let found = sweep.path_seen(&node, pressures, &mut told, &mut |solver, state, report| {
        let at = format!("state {place}, {} kPa", short(report.pressure / KPA));
        match stored.get(place).map(|stored| difference(report, stored, node.free.tube.outer_radius())) {
            None => worst = (f64::INFINITY, format!("{at} is none of the map's")),
            Some((off, what)) if off > worst.0 => {
                worst = (off, format!("{what} of {at} by {:.1e} (relative)", off * AGREES));
            }
            Some(_) => {}
        }
        if wanted.states.contains(&place) {
            failure = write_state(&mut shown, &folder, place, (solver, state));
            (step.borrow_mut())();
        }
        place += 1;
        failure.is_ok() && !interrupt::is_asked() && wanted.states.iter().any(|&state| state >= place)
    });
    failure?;
    match found {
        // Stopped where enough was seen.
        Err(SolidError::Stopped) => {}
        Err(error) => shown.error = Some(error),
        Ok(path) if path.states.len() < stored.len() && wanted.states.iter().any(|&i| i >= place) => {
            worst.1 = format!("the path has {} states, in the map {}", path.states.len(), stored.len());
        }
        Ok(_) => {}
    }
    shown.difference = Some(worst.1).filter(|words| !words.is_empty());
    Ok(shown)
}

impl SolidStates {
    /// Solves paths of a map again and writes their states below `directory`.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn write(
        map: &FreeMap,
        sweep: &SolidSweep,
        wanted: &[Wanted<'_>],
        directory: &Path,
    ) -> Result<Self, Failure> {
        let solved = |wanted: &Wanted<'_>| {
            let last = wanted.path.states.last().map_or(0.0, |state| state.pressure);
            map.pressures.iter().filter(|pressure| (f64::MIN_POSITIVE..=last).contains(pressure)).count()
        };
        let total: usize = wanted.iter().map(|wanted| solved(wanted) + wanted.states.len()).sum();
        let bar = Progress::bar("solving and writing states");
        let mut done = 0;
        let mut step = || {
            done += 1;
            bar.at(done.min(total), total);
        };
        let mut paths = Vec::with_capacity(wanted.len());
        for wanted in wanted {
            // The only state asked for may be on another path.
            if wanted.states.is_empty() {
                continue;
            }
            if interrupt::is_asked() {
                break;
            }
            paths.push(show(wanted, sweep, &map.pressures, directory, &mut step)?);
        }
        let written: usize = paths.iter().map(|path| path.written.len()).sum();
        let asked: usize = wanted.iter().map(|wanted| wanted.states.len()).sum();
        Ok(SolidStates { paths, left: asked - written })
    }

    /// How it ended.
    pub fn exit(&self) -> Exit {
        match self {
            _ if interrupt::is_asked() => Exit::Interrupted,
            _ if self.paths.iter().any(|path| path.error.is_some()) => Exit::NotConverged,
            _ if self.paths.iter().any(|path| path.difference.is_some()) => Exit::Disagrees,
            _ => Exit::Done,
        }
    }

    /// What was written, for people.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for path in &self.paths {
            let agrees = match (&path.error, &path.difference) {
                (None, None) => ", as in the map",
                _ => "",
            };
            text += &format!("\n{}: {} states{agrees}\n\n", path.collection.display(), path.written.len());
            let mut table = Table::new([
                "state",
                "pressure (kPa)",
                "greatest log strain",
                "least",
                "away from the caps: greatest",
                "least",
                "<file",
            ]);
            for state in &path.written {
                let strains = &state.strains;
                let [greatest, least, greatest_mid, least_mid] =
                    [strains.greatest, strains.least, strains.greatest_mid, strains.least_mid]
                        .map(|strain| format!("{:.4}", (1e4 * strain.log_strain).round() / 1e4 + 0.0));
                let file = state.files.first().cloned().unwrap_or_default();
                let pressure = short(state.pressure / KPA);
                table.row([
                    state.number.to_string(),
                    pressure,
                    greatest,
                    least,
                    greatest_mid,
                    least_mid,
                    file,
                ]);
            }
            text += &table.text();
        }
        text
    }

    /// What did not go as it should, a line each.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        for path in &self.paths {
            let of = path.collection.display();
            if let Some(difference) = &path.difference {
                remarks.push(format!(
                    "{of}: solved again, the path differs from the map: {difference}; the map is by another version of freeact: \
                     make it again by `freeact map`"
                ));
            }
            if let Some(error) = &path.error {
                remarks.push(format!("{of}: not converged: {error}"));
            }
            if !path.beyond.is_empty() {
                let pressures = list(path.beyond.iter().copied());
                remarks.push(format!("{of}: the path has no state at {pressures} kPa"));
            }
        }
        if interrupt::is_asked() {
            remarks.push(format!("{} states left; what was written is complete", self.left));
        }
        remarks
    }

    /// The same for programs.
    pub fn json(&self) -> Value {
        let state = |state: &Written| {
            let strains = &state.strains;
            json!({
                "state": state.number, "pressure_kpa": state.pressure / KPA, "files": state.files,
                "greatest_log_strain": strains.greatest.log_strain, "least_log_strain": strains.least.log_strain,
                "mid_greatest_log_strain": strains.greatest_mid.log_strain,
                "mid_least_log_strain": strains.least_mid.log_strain,
            })
        };
        let path = |path: &Shown| {
            json!({
                "winding_angle_deg": path.node.free.winding.angle_from_hoop() / DEG,
                "shear_modulus_mpa": path.node.free.elastomer.shear_modulus() / MPA,
                "collection": path.collection, "difference": path.difference,
                "error": path.error.as_ref().map(SolidError::to_string), "no_state_at_kpa": path.beyond,
                "states": path.written.iter().map(state).collect::<Vec<_>>(),
            })
        };
        json!({ "left": self.left, "paths": self.paths.iter().map(path).collect::<Vec<_>>() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map_file::samples::solid_map;

    #[test]
    fn states_differ_by_more_than_a_millionth() {
        let stored = solid_map().paths[0].clone().unwrap().states[1];
        assert_eq!(difference(&stored, &stored, 5e-3).0, 0.0);
        let (off, what) =
            difference(&FreeState { expansion: stored.expansion * (1.0 + 3e-6), ..stored }, &stored, 5e-3);
        assert!((off - 3.0).abs() < 1e-6 && what == "the expansion", "{off} {what}");
        let mut turned = stored;
        turned.middle.as_mut().unwrap().twist_per_length *= 1.0 + 2e-6;
        let (off, what) = difference(&turned, &stored, 5e-3);
        assert!(off > 1.8 && what == "the middle's twist", "{off} {what}");
        // A tube that does not turn.
        let still = FreeState { twist_per_length: 0.0, ..stored };
        assert!(difference(&FreeState { twist_per_length: 1e-10, ..still }, &still, 5e-3).0 < 1.0);
    }
}
