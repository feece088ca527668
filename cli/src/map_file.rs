//! A map as it lies on disk: of a FREE or of a module.

use crate::failure::Failure;
use actuator::{
    FreeMap, FreeMapVersion1, FreeMapVersion2, LoadedFree, ModuleMap, ModuleMapVersion3, artefact,
};
use serde::{Deserialize, Serialize};
use std::{fs, path::Path};

/// A map of either kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum MapFile {
    /// Of a single FREE over winding angle, shear modulus and what else was asked for.
    Free(FreeMap),
    /// Of a module over the pressures of its FREEs.
    Module(ModuleMap),
}

/// The same in files of format version 1.
#[derive(Deserialize)]
enum MapFileVersion1 {
    Free(FreeMapVersion1),
    Module(ModuleMapVersion3),
}

/// The same in files of format version 2.
#[derive(Deserialize)]
enum MapFileVersion2 {
    Free(FreeMapVersion2),
    Module(ModuleMapVersion3),
}

/// The same in files of format version 3.
#[derive(Deserialize)]
enum MapFileVersion3 {
    Free(FreeMap),
    Module(ModuleMapVersion3),
}

impl From<MapFileVersion3> for MapFile {
    fn from(old: MapFileVersion3) -> Self {
        match old {
            MapFileVersion3::Free(map) => MapFile::Free(map),
            MapFileVersion3::Module(map) => MapFile::Module(map.into()),
        }
    }
}

impl From<MapFileVersion2> for MapFile {
    fn from(old: MapFileVersion2) -> Self {
        match old {
            MapFileVersion2::Free(map) => MapFile::Free(map.into()),
            MapFileVersion2::Module(map) => MapFile::Module(map.into()),
        }
    }
}

impl From<MapFileVersion1> for MapFile {
    fn from(old: MapFileVersion1) -> Self {
        match old {
            MapFileVersion1::Free(map) => MapFile::Free(map.into()),
            MapFileVersion1::Module(map) => MapFile::Module(map.into()),
        }
    }
}

impl MapFile {
    /// Reads a map, of this format version or an earlier one.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = fs::read(path).map_err(Failure::at(path))?;
        Ok(match artefact::version(&bytes) {
            Some(1) => artefact::from_bytes::<MapFileVersion1>(path, artefact::MAP_VERSION_1, &bytes)?.into(),
            Some(2) => artefact::from_bytes::<MapFileVersion2>(path, artefact::MAP_VERSION_2, &bytes)?.into(),
            Some(3) => artefact::from_bytes::<MapFileVersion3>(path, artefact::MAP_VERSION_3, &bytes)?.into(),
            _ => artefact::from_bytes(path, artefact::MAP, &bytes)?,
        })
    }

    /// Writes a map, atomically.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        Ok(artefact::write(path, artefact::MAP, self)?)
    }

    /// The map of a FREE, which it must be.
    pub fn into_free(self) -> Result<FreeMap, Failure> {
        match self {
            MapFile::Free(map) => Ok(map),
            MapFile::Module(_) => {
                Err(Failure::file("this is the map of a module, where that of a FREE is needed"))
            }
        }
    }

    /// The map of a module, which it must be.
    pub fn into_module(self) -> Result<ModuleMap, Failure> {
        match self {
            MapFile::Module(map) => Ok(map),
            MapFile::Free(_) => {
                Err(Failure::file("this is the map of a FREE, where that of a module is needed"))
            }
        }
    }

    /// Name and text of the description it was made from.
    pub fn source(&self) -> &(String, String) {
        match self {
            MapFile::Free(map) => &map.source,
            MapFile::Module(map) => &map.source,
        }
    }

    /// Number of nodes computed, and of all.
    pub fn computed(&self) -> (usize, usize) {
        match self {
            MapFile::Free(map) => (map.paths.iter().flatten().count(), map.paths.len()),
            MapFile::Module(map) => (map.states.iter().flatten().count(), map.states.len()),
        }
    }

    /// Greatest relative residual of the states kept.
    pub fn worst_residual(&self) -> f64 {
        let residuals: Vec<f64> = match self {
            MapFile::Free(map) => {
                map.paths.iter().flatten().flat_map(|path| &path.states).map(|state| state.residual).collect()
            }
            MapFile::Module(map) => map.states.iter().flatten().map(|state| state.residual).collect(),
        };
        residuals.into_iter().fold(0.0, f64::max)
    }

    /// Why the two are not parts of one sweep, where they are not: the first thing that differs.
    pub fn difference(&self, other: &MapFile) -> Option<&'static str> {
        let named = |map: &FreeMap| map.named_axes().to_vec();
        let first = |differences: &[(bool, &'static str)]| differences.iter().find(|d| d.0).map(|d| d.1);
        match (self, other) {
            (MapFile::Free(a), MapFile::Free(b)) => first(&[
                (a.node != b.node, "the FREEs"),
                (a.fidelity != b.fidelity, "the fidelities"),
                (named(a) != named(b), "the named axes"),
                (a.winding_angles() != b.winding_angles(), "the winding angles"),
                (a.shear_moduli() != b.shear_moduli(), "the shear moduli"),
                (a.pressures != b.pressures, "the pressures"),
                (a.settings != b.settings, "the settings of the finite elements"),
            ]),
            (MapFile::Module(a), MapFile::Module(b)) => first(&[
                (a.module != b.module, "the modules"),
                (a.limits != b.limits, "the limits"),
                (a.pressures != b.pressures, "the pressures"),
                (a.parameters != b.parameters, "the parameters whose slopes are kept"),
                (a.settings != b.settings, "the settings of the finite elements"),
            ]),
            _ => Some("the kinds (one is of a FREE, the other of a module)"),
        }
    }

    /// Puts the checks in an order of their own, so that the parts of a sweep join to the map that one run makes.
    pub fn sort_checks(&mut self) {
        match self {
            MapFile::Free(map) => map.checks.sort_by(|(a, _), (b, _)| {
                let axes = &map.axes;
                let at = |node: &LoadedFree| -> Vec<f64> {
                    axes.iter().filter_map(|axis| axis.parameter.of(node)).collect()
                };
                in_order(&at(a), &at(b))
            }),
            MapFile::Module(map) => map.checks.sort_by(|a, b| in_order(&a.pressures, &b.pressures)),
        }
    }

    /// Takes over what the other has computed and this one has not. `Err` where both have a node and disagree on it.
    pub fn absorb(&mut self, other: MapFile) -> Result<(), &'static str> {
        match (&mut *self, other) {
            (MapFile::Free(mine), MapFile::Free(other)) => {
                fill(&mut mine.paths, other.paths)?;
                join(&mut mine.checks, other.checks);
            }
            (MapFile::Module(mine), MapFile::Module(other)) => {
                fill(&mut mine.states, other.states)?;
                join(&mut mine.checks, other.checks);
                fill(&mut mine.limit_pressures, other.limit_pressures)?;
            }
            _ => return Err("the kinds differ"),
        }
        self.sort_checks();
        Ok(())
    }
}

fn in_order(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    let differing = a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
    differing.unwrap_or(std::cmp::Ordering::Equal)
}

fn fill<T: PartialEq>(mine: &mut [Option<T>], others: Vec<Option<T>>) -> Result<(), &'static str> {
    for (mine, other) in mine.iter_mut().zip(others) {
        match (&*mine, &other) {
            (Some(a), Some(b)) if a != b => return Err("a node is in both, with different results"),
            (None, Some(_)) => *mine = other,
            _ => {}
        }
    }
    Ok(())
}

fn join<T: PartialEq>(mine: &mut Vec<T>, others: Vec<T>) {
    for other in others {
        if !mine.contains(&other) {
            mine.push(other);
        }
    }
}

#[cfg(test)]
pub mod samples {
    use super::*;
    use actuator::*;
    use std::path::Path;

    /// A FREE with two angles, the second with a limit point; made of numbers, not computed.
    pub fn free_map() -> FreeMap {
        let text = include_str!("../../data/actuators/buffinton-2020.toml").to_owned();
        let rig = Rig::parse(Path::new("buffinton-2020.toml"), text.clone()).unwrap();
        let free = rig.frees()[0];
        let state = |pressure: f64, stretch: f64| FreeState {
            pressure,
            axial_stretch: stretch,
            expansion: 1.0 + 1e-6 * pressure,
            twist_per_length: -30.0 * 1e-5 * pressure,
            residual: 1e-12,
            middle: None,
            section: None,
            mesh_error: None,
        };
        let open =
            FreePath::solved(vec![state(0.0, 1.0), state(2e4, 1.02), state(4e4, 1.06)], PathEnd::Range);
        let limited =
            FreePath::solved(vec![state(0.0, 1.0), state(2e4, 0.99), state(3e4, 0.98)], PathEnd::LimitPoint);
        FreeMap {
            node: free.into(),
            axes: MapAxis::of_angles_and_moduli(vec![20f64.to_radians(), 70f64.to_radians()], vec![0.393e6]),
            pressures: vec![0.0, 2e4, 4e4],
            paths: vec![Some(open), Some(limited)],
            checks: vec![],
            fidelity: Fidelity::Section,
            settings: "none".into(),
            source: ("sample".into(), text),
        }
    }

    /// The same as if a solid had computed it, its middle doing more than the whole.
    pub fn solid_map() -> FreeMap {
        let mut map = free_map();
        map.fidelity = Fidelity::Solid { elements: None };
        for state in map.paths.iter_mut().flatten().flat_map(|path| &mut path.states) {
            let middle = Middle {
                axial_stretch: 1.0 + 1.1 * (state.axial_stretch - 1.0),
                twist_per_length: 1.1 * state.twist_per_length,
            };
            state.middle = Some(middle);
        }
        map
    }

    /// The 30 degree module of the paper with poses from a formula, smooth enough to fit; `softness` scales them.
    pub fn smooth_module_map(softness: f64) -> ModuleMap {
        let text = include_str!("../../data/modules/buffinton-2020-30lr.toml").to_owned();
        let rig = Rig::parse(Path::new("buffinton-2020-30lr.toml"), text.clone()).unwrap();
        let Description::Module(module) = rig.description else { panic!("a module") };
        let axis: Vec<f64> = (0..4).map(|i| f64::from(i) * 50e3 / 3.0).collect();
        let pressures = vec![axis; module.frees.len()];
        let mut map = ModuleMap {
            parameters: vec![MapParameter::Payload],
            states: vec![],
            checks: vec![],
            limit_pressures: vec![None; module.frees.len()],
            settings: "a formula".into(),
            source: (rig.name, text),
            limits: rig.limits,
            module,
            pressures,
        };
        let state = |pressures: Vec<f64>| {
            let mut chart = PoseChart { position: [0.0, 0.0, 0.175], ..PoseChart::default() };
            for (placed, pressure) in map.module.frees.iter().zip(&pressures) {
                let q = softness * (pressure / 50e3 + 0.2 * (pressure / 50e3).powi(2));
                chart.twist -= placed.free.winding.handedness.sign() * 0.8 * q;
                chart.bend[0] += 20.0 * placed.position[1] * q;
                chart.bend[1] -= 20.0 * placed.position[0] * q;
                chart.position[0] -= 1.5 * placed.position[0] * q;
                chart.position[1] -= 1.5 * placed.position[1] * q;
                chart.position[2] += 0.003 * q;
            }
            ModuleState { chart, slopes: vec![[1e-3; 6]], negative_pivots: 0, residual: 1e-12, gap: None }
        };
        map.states = (0..map.node_count()).map(|node| Some(state(map.node_pressures(node)))).collect();
        map
    }

    /// A module of one FREE with three pressures, the last one not computed.
    pub fn module_map() -> ModuleMap {
        let free = free_map().node.free;
        let state = |twist: f64| ModuleState {
            chart: PoseChart { twist, bend: [0.0; 2], position: [0.0, 0.0, 0.13] },
            slopes: vec![],
            negative_pivots: u32::from(twist > 0.0),
            residual: 1e-12,
            gap: (twist > 0.0).then_some(-1e-3),
        };
        ModuleMap {
            module: Module {
                frees: vec![PlacedFree { free, position: [0.0; 2] }],
                tip: Tip { plate_mass: 0.0, payload: 0.0, free_dof: [true; 6] },
                base: Base { gravity: [0.0; 3], free_mass: 0.0 },
                spacers: 0,
            },
            limits: Limits { pressure_max: vec![5e4], pressure_rate: 2e5, idle_pressure: 0.0 },
            parameters: vec![],
            pressures: vec![vec![0.0, 2e4, 4e4]],
            states: vec![Some(state(0.0)), Some(state(std::f64::consts::PI)), None],
            checks: vec![],
            limit_pressures: vec![None],
            settings: "none".into(),
            source: ("sample".into(), String::new()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_of_the_first_format_are_read() {
        let reference = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/maps").join(name);
        let (free, module) = (reference("buffinton-2020.map"), reference("buffinton-2020-30lr.map"));
        for path in [&free, &module] {
            assert_eq!(artefact::version(&fs::read(path).unwrap()), Some(1));
        }
        let map = MapFile::read(&free).unwrap().into_free().unwrap();
        assert_eq!(map.fidelity, actuator::Fidelity::Section);
        assert!(map.is_complete() && map.settings.contains("section"));
        let states = || map.paths.iter().flatten().flat_map(|path| &path.states);
        assert!(states().all(|state| state.middle.is_none() && state.residual < 1e-8));
        assert!(states().all(|state| (0.5..4.0).contains(&state.axial_stretch) && state.expansion > 0.9));
        let map = MapFile::read(&module).unwrap();
        assert_eq!(map.computed().0, map.computed().1);

        // By solids, in the second format.
        let second = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/version-2.map");
        assert_eq!(artefact::version(&fs::read(&second).unwrap()), Some(2));
        let solid = MapFile::read(&second).unwrap().into_free().unwrap();
        assert_eq!(solid.fidelity, actuator::Fidelity::Solid { elements: Some([1, 12, 60]) });
        assert_eq!((solid.paths.len(), solid.checks.len(), solid.pressures.len()), (2, 1, 5));
        let last = solid.path(1, 0).unwrap().states[4];
        assert!(last.pressure == 2e4 && (last.axial_stretch - 0.9989).abs() < 5e-5 && last.residual < 1e-8);
        assert!((last.middle.unwrap().axial_stretch - 0.9981).abs() < 5e-5);

        // Of a module, in the third: nothing is known of its gaps.
        let third = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/version-3.map");
        assert_eq!(artefact::version(&fs::read(&third).unwrap()), Some(3));
        let pair = MapFile::read(&third).unwrap().into_module().unwrap();
        assert!(pair.is_complete() && pair.checks.len() == 2 && pair.source.0 == "pair");
        assert!(pair.states.iter().flatten().all(|state| state.gap.is_none() && state.slopes.len() == 3));
        let turned = pair.states[2].as_ref().unwrap();
        assert!((turned.chart.position[2] - 59.01e-3).abs() < 1e-5 && turned.residual < 1e-9);

        // What is read is written in the present format, and read again as the same.
        let folder = tempfile::tempdir().unwrap();
        let again = folder.path().join("again.map");
        map.write(&again).unwrap();
        assert_eq!(artefact::version(&fs::read(&again).unwrap()), Some(artefact::MAP.version));
        assert_eq!(MapFile::read(&again).unwrap(), map);
    }

    #[test]
    fn parts_of_a_sweep_join_and_strangers_do_not() {
        let whole = samples::free_map();
        let part = |keep: usize| {
            let mut part = whole.clone();
            part.paths.iter_mut().enumerate().filter(|(i, _)| *i != keep).for_each(|(_, path)| *path = None);
            MapFile::Free(part)
        };
        let mut joined = part(0);
        assert_eq!(joined.computed(), (1, 2));
        assert_eq!(joined.difference(&part(1)), None);
        joined.absorb(part(1)).unwrap();
        assert_eq!(joined, MapFile::Free(whole.clone()));

        let mut softer = whole.clone();
        softer.axes[1].values[0] *= 0.5;
        assert_eq!(joined.difference(&MapFile::Free(softer)), Some("the shear moduli"));
        assert!(joined.difference(&MapFile::Module(samples::module_map())).unwrap().contains("kinds"));
        let mut other = whole;
        if let Some(path) = &mut other.paths[0] {
            path.states[1].expansion += 1e-3;
        }
        assert!(joined.absorb(MapFile::Free(other)).unwrap_err().contains("different results"));
    }
}
