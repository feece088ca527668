//! Which of a map's paths and states are meant: by values of its axes and by pressures.

use crate::{failure::Failure, map_csv::number, table::short};
use actuator::{
    FreeMap, FreeParameter, FreePath, LoadedFree, MapAxis,
    units::{DEG, KPA},
};

/// More paths than these take minutes and gigabytes: they must be asked for.
const MOST_UNASKED: usize = 4;
/// What counts as the value meant, relatively: tables tell four figures.
const MEANT: f64 = 5e-4;

/// Which of a map's states are wanted; `None` for all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// Values of the axes, in the units of their names; all of those that are not here.
    pub values: Vec<(FreeParameter, Vec<f64>)>,
    /// Pressures, kPa.
    pub pressures: Option<Vec<f64>>,
}

/// A path of the map whose states are wanted.
#[derive(Debug)]
pub struct Wanted<'a> {
    pub node: LoadedFree,
    /// Name of the folder.
    pub name: String,
    pub path: &'a FreePath,
    /// Numbers of the states.
    pub states: Vec<usize>,
    /// Pressures asked for that the path does not reach, kPa.
    pub beyond: Vec<f64>,
}

fn is_meant(value: f64, asked: f64) -> bool {
    (value - asked).abs() <= MEANT * asked.abs()
}

/// Numbers between commas.
pub fn list(values: impl Iterator<Item = f64>) -> String {
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
        let chosen = self.places(map)?;
        let asked = |axis: &MapAxis| self.asked(axis);
        let nodes = self.nodes(map, &chosen);
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

    /// The map with the chosen values of its axes and the chosen ones of the pressures asked for.
    ///
    /// # Errors
    /// What the map does not have.
    pub fn restricted(&self, map: &FreeMap) -> Result<FreeMap, Failure> {
        let chosen = self.places(map)?;
        let mut restricted = map.clone();
        for (axis, chosen) in restricted.axes.iter_mut().zip(&chosen) {
            axis.values = chosen.iter().map(|&place| axis.values[place]).collect();
        }
        restricted.paths = self.nodes(map, &chosen).map(|node| map.paths[node].clone()).collect();
        if let Some(asked) = &self.pressures {
            restricted
                .pressures
                .retain(|pressure| asked.iter().any(|asked| is_meant(pressure / KPA, *asked)));
            if restricted.pressures.is_empty() {
                return Err(Failure::usage(format!(
                    "--at-kpa: none of the map's pressures is {} kPa; it has {}",
                    list(asked.iter().copied()),
                    list(map.pressures.iter().map(|pressure| pressure / KPA))
                )));
            }
        }
        Ok(restricted)
    }

    /// Places on each axis that are chosen.
    fn places(&self, map: &FreeMap) -> Result<Vec<Vec<usize>>, Failure> {
        if let Some((parameter, _)) = self.values.iter().find(|(chosen, _)| map.values(*chosen).is_empty()) {
            return Err(Failure::usage(format!("{}: the map has no such axis", flag(*parameter))));
        }
        map.axes.iter().map(|axis| places(axis, self.asked(axis))).collect()
    }

    fn asked(&self, axis: &MapAxis) -> Option<&Vec<f64>> {
        self.values.iter().find(|(chosen, _)| *chosen == axis.parameter).map(|(_, values)| values)
    }

    /// Nodes at those places.
    fn nodes<'a>(&self, map: &'a FreeMap, chosen: &'a [Vec<usize>]) -> impl Iterator<Item = usize> + 'a {
        (0..map.node_count()).filter(move |node| {
            let coordinates = map.coordinates(*node);
            let places = coordinates.iter().zip(&map.axes).zip(chosen);
            places.into_iter().all(|((value, axis), chosen)| chosen.iter().any(|&i| axis.values[i] == *value))
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exit::Exit;
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
}
