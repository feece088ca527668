//! The states of a solid map as files of ParaView: a map keeps no fields, so its paths are solved again.

use crate::{
    exit::Exit,
    failure::Failure,
    interrupt,
    map_csv::number,
    output,
    progress::Progress,
    table::{Table, short},
};
use actuator::{
    FreeMap, FreeParameter, FreePath, FreeState, LoadedFree, MapAxis,
    units::{DEG, KPA, MPA},
};
use fe::{SolidError, SolidSolver, SolidState, SolidSweep};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// More paths than these take minutes and gigabytes: they must be asked for.
const MOST_UNASKED: usize = 4;
/// What counts as the value meant, relatively: tables tell four figures.
const MEANT: f64 = 5e-4;
/// How well a state solved again agrees with the map's, relatively.
const AGREES: f64 = 1e-6;
/// Twist times outer radius below which it is rounding: that of a tube that does not turn.
const NO_TWIST: f64 = 1e-9;

/// Which of a map's states are wanted; `None` for all.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// Values of the axes, in the units of their names; all of those that are not here.
    pub values: Vec<(FreeParameter, Vec<f64>)>,
    /// Pressures, kPa.
    pub pressures: Option<Vec<f64>>,
}

/// A path of the map whose states are wanted.
#[derive(Debug)]
pub struct Wanted<'a> {
    node: LoadedFree,
    /// Name of the folder.
    name: String,
    path: &'a FreePath,
    /// Numbers of the states.
    states: Vec<usize>,
    /// Pressures asked for that the path does not reach, kPa.
    beyond: Vec<f64>,
}

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

fn is_meant(value: f64, asked: f64) -> bool {
    (value - asked).abs() <= MEANT * asked.abs()
}

fn list(values: impl Iterator<Item = f64>) -> String {
    values.map(short).collect::<Vec<_>>().join(", ")
}

/// The flag of `inspect` that chooses on an axis.
fn flag(parameter: FreeParameter) -> String {
    match parameter {
        FreeParameter::WindingAngle => "--winding-angle".to_owned(),
        FreeParameter::ShearModulus => "--shear-modulus-mpa".to_owned(),
        other => format!("--axis {}", other.name()),
    }
}

/// Places on an axis of the map that are meant by `asked`; all where nothing is.
fn places(axis: &MapAxis, asked: Option<&Vec<f64>>) -> Result<Vec<usize>, Failure> {
    let (flag, unit, axis) = (flag(axis.parameter), axis.parameter.unit(), &axis.values);
    let Some(asked) = asked else { return Ok((0..axis.len()).collect()) };
    let mut places = Vec::with_capacity(asked.len());
    for &value in asked {
        let off = |i: &usize| (axis[*i] / unit - value).abs();
        let nearest = (0..axis.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        match nearest.filter(|i| is_meant(axis[*i] / unit, value)) {
            Some(place) => places.push(place),
            None => {
                let has = list(axis.iter().map(|value| value / unit));
                return Err(Failure::usage(format!("{flag}: {value} is not in the map, which has {has}")));
            }
        }
    }
    places.sort_unstable();
    places.dedup();
    Ok(places)
}

impl Choice {
    /// The paths that are meant.
    ///
    /// # Errors
    /// What the map does not have, or too many paths where none was chosen.
    pub fn wanted<'a>(&self, map: &'a FreeMap) -> Result<Vec<Wanted<'a>>, Failure> {
        if let Some((parameter, _)) = self.values.iter().find(|(chosen, _)| map.values(*chosen).is_empty()) {
            return Err(Failure::usage(format!("{}: the map has no such axis", flag(*parameter))));
        }
        let asked = |axis: &MapAxis| {
            self.values.iter().find(|(chosen, _)| *chosen == axis.parameter).map(|(_, values)| values)
        };
        let chosen: Vec<Vec<usize>> =
            map.axes.iter().map(|axis| places(axis, asked(axis))).collect::<Result<_, _>>()?;
        let is_chosen = |node: &usize| {
            let coordinates = map.coordinates(*node);
            let places = coordinates.iter().zip(&map.axes).zip(&chosen);
            places.into_iter().all(|((value, axis), chosen)| chosen.iter().any(|&i| axis.values[i] == *value))
        };
        let nodes = (0..map.node_count()).filter(is_chosen);
        let paths: Vec<_> = nodes.filter_map(|node| Some((node, map.paths[node].as_ref()?))).collect();
        let all_asked = !self.values.is_empty()
            && map.axes.iter().all(|axis| axis.values.len() == 1 || asked(axis).is_some());
        if paths.is_empty() {
            return Err(Failure::refused(
                "--vtu: none of these paths is computed; complete the map by `freeact map --resume`",
            ));
        }
        if paths.len() > MOST_UNASKED && !all_asked {
            let of = |axis: &MapAxis| {
                let values = list(axis.values.iter().map(|value| value / axis.parameter.unit()));
                format!("{} (of {values})", flag(axis.parameter))
            };
            let choices: Vec<String> = map.axes.iter().rev().map(of).collect();
            return Err(Failure::usage(format!(
                "--vtu: these are {} paths, each solved again and megabytes a state; choose by {}",
                paths.len(),
                choices.join(" and "),
            )));
        }
        let wanted = paths.into_iter().map(|(index, path)| {
            let coordinates = map.coordinates(index);
            let node = map.at(&coordinates).map_err(Failure::file)?;
            let mut name = String::new();
            for (value, axis) in coordinates.iter().zip(&map.axes).rev() {
                let value = number(value / axis.parameter.unit());
                name += &match axis.parameter {
                    FreeParameter::ShearModulus => format!("{value}-mpa"),
                    FreeParameter::WindingAngle => String::new(),
                    other => format!("-{}-{value}", other.name()),
                };
            }
            let name = format!("{}-deg-{name}", number(node.free.winding.angle_from_hoop() / DEG));
            let (states, beyond) = self.states(path);
            Ok(Wanted { node, name, path, states, beyond })
        });
        let wanted: Vec<_> = wanted.collect::<Result<_, Failure>>()?;
        if wanted.iter().all(|wanted| wanted.states.is_empty()) {
            let reaches = |wanted: &Wanted<'_>| wanted.path.states.last().map_or(0.0, |state| state.pressure);
            let of = wanted.iter().max_by(|a, b| reaches(a).total_cmp(&reaches(b)));
            let has = list(of.iter().flat_map(|of| &of.path.states).map(|state| state.pressure / KPA));
            return Err(Failure::usage(format!(
                "--at-kpa: no path has a state at {} kPa; there are states at {has}",
                list(self.pressures.iter().flatten().copied()),
            )));
        }
        Ok(wanted)
    }

    /// Numbers of a path's states that are wanted, and the pressures that it has no state for.
    fn states(&self, path: &FreePath) -> (Vec<usize>, Vec<f64>) {
        let Some(pressures) = &self.pressures else {
            return ((0..path.states.len()).collect(), Vec::new());
        };
        let (mut states, mut beyond) = (Vec::new(), Vec::new());
        for &asked in pressures {
            let off = |i: &usize| (path.states[*i].pressure / KPA - asked).abs();
            let nearest = (0..path.states.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
            match nearest.filter(|i| is_meant(path.states[*i].pressure / KPA, asked)) {
                Some(state) => states.push(state),
                None => beyond.push(asked),
            }
        }
        states.sort_unstable();
        states.dedup();
        (states, beyond)
    }
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
    output::replace(&shown.collection, &mut |out| fe::write_pvd(&frames, out))
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

    fn message(choice: &Choice, map: &FreeMap) -> (Exit, String) {
        let failure = choice.wanted(map).unwrap_err();
        (failure.exit, failure.paragraph())
    }

    #[test]
    fn many_paths_must_be_asked_for() {
        let mut map = solid_map();
        assert_eq!(Choice::default().wanted(&map).unwrap().len(), 2);
        map.axes[0].values = (1..=6).map(|i| f64::from(10 * i).to_radians()).collect();
        map.paths = vec![map.paths[0].clone(); 6];
        let (exit, words) = message(&Choice::default(), &map);
        assert!(exit == Exit::Usage && words.contains("these are 6 paths"), "{words}");
        assert!(words.contains("--winding-angle (of 10.00, 20.00, 30.00"), "{words}");
        let angle = FreeParameter::WindingAngle;
        let chosen = |angles: &[f64]| Choice { values: vec![(angle, angles.to_vec())], ..Choice::default() };
        let all: Vec<f64> = (1..=6).map(|i| f64::from(10 * i)).collect();
        assert_eq!(chosen(&all).wanted(&map).unwrap().len(), 6);
        let one = chosen(&[30.0]);
        let one = one.wanted(&map).unwrap();
        assert!(one.len() == 1 && (one[0].node.free.winding.angle_from_hoop() / DEG - 30.0).abs() < 1e-9);
        assert!(message(&chosen(&[31.0]), &map).1.contains("31 is not in the map"));
        // With the moduli left open there are more again.
        map.axes[1].values = vec![0.2e6, 0.4e6];
        map.paths = vec![map.paths[0].clone(); 12];
        assert!(message(&chosen(&[10.0, 20.0, 30.0]), &map).1.contains("these are 6 paths"));
        map.paths = vec![None; 12];
        assert_eq!(message(&one_of_each(), &map).0, Exit::Refused);
    }

    fn one_of_each() -> Choice {
        let values =
            vec![(FreeParameter::WindingAngle, vec![10.0]), (FreeParameter::ShearModulus, vec![0.2])];
        Choice { values, pressures: None }
    }

    #[test]
    fn pressures_are_those_of_the_states() {
        let map = solid_map();
        let at = |kpa: &[f64]| Choice { pressures: Some(kpa.to_vec()), ..Choice::default() };
        // The second path ends at 30 kPa.
        let choice = at(&[40.0, 0.0]);
        let wanted = choice.wanted(&map).unwrap();
        assert_eq!((&wanted[0].states[..], wanted[0].beyond.len()), (&[0, 2][..], 0));
        assert_eq!((&wanted[1].states[..], &wanted[1].beyond[..]), (&[0][..], &[40.0][..]));
        let (exit, words) = message(&at(&[25.0]), &map);
        assert!(exit == Exit::Usage && words.contains("no path has a state at 25.00 kPa"), "{words}");
        assert!(words.contains("0, 20.00, 40.00"), "{words}");
    }

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
