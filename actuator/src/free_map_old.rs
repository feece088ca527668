//! A FREE's map as files of earlier format versions hold it.

use crate::{Fidelity, Free, FreeMap, FreePath, FreeState, LoadedFree, MapAxis, Middle, PathEnd};
use serde::Deserialize;

#[derive(Deserialize)]
struct State1 {
    pressure: f64,
    axial_stretch: f64,
    expansion: f64,
    twist_per_length: f64,
    residual: f64,
}

#[derive(Deserialize)]
struct State2 {
    state: State1,
    middle: Option<Middle>,
}

#[derive(Deserialize)]
struct Path<S> {
    states: Vec<S>,
    end: PathEnd,
}

/// Of format version 1: of sections only.
#[derive(Deserialize)]
pub struct FreeMapVersion1 {
    free: Free,
    winding_angles: Vec<f64>,
    shear_moduli: Vec<f64>,
    pressures: Vec<f64>,
    paths: Vec<Option<Path<State1>>>,
    checks: Vec<(Free, Path<State1>)>,
    settings: String,
    source: (String, String),
}

/// Of format version 2: by sections or solids, over winding angle and shear modulus only, without loads, energy and errors.
#[derive(Deserialize)]
pub struct FreeMapVersion2 {
    free: Free,
    winding_angles: Vec<f64>,
    shear_moduli: Vec<f64>,
    pressures: Vec<f64>,
    paths: Vec<Option<Path<State2>>>,
    checks: Vec<(Free, Path<State2>)>,
    fidelity: Fidelity,
    settings: String,
    source: (String, String),
}

impl From<State1> for FreeState {
    fn from(old: State1) -> Self {
        FreeState {
            pressure: old.pressure,
            axial_stretch: old.axial_stretch,
            expansion: old.expansion,
            twist_per_length: old.twist_per_length,
            residual: old.residual,
            middle: None,
            section: None,
            mesh_error: None,
        }
    }
}

impl From<State2> for FreeState {
    fn from(old: State2) -> Self {
        FreeState { middle: old.middle, ..old.state.into() }
    }
}

impl<S: Into<FreeState>> From<Path<S>> for FreePath {
    fn from(old: Path<S>) -> Self {
        FreePath::solved(old.states.into_iter().map(S::into).collect(), old.end)
    }
}

impl From<FreeMapVersion1> for FreeMap {
    fn from(old: FreeMapVersion1) -> Self {
        let states = |path: Path<State1>| Path {
            states: path.states.into_iter().map(|state| State2 { state, middle: None }).collect(),
            end: path.end,
        };
        FreeMapVersion2 {
            free: old.free,
            winding_angles: old.winding_angles,
            shear_moduli: old.shear_moduli,
            pressures: old.pressures,
            paths: old.paths.into_iter().map(|path| path.map(states)).collect(),
            checks: old.checks.into_iter().map(|(free, path)| (free, states(path))).collect(),
            fidelity: Fidelity::Section,
            settings: old.settings,
            source: old.source,
        }
        .into()
    }
}

impl From<FreeMapVersion2> for FreeMap {
    fn from(old: FreeMapVersion2) -> Self {
        let checks = old.checks.into_iter();
        FreeMap {
            node: old.free.into(),
            axes: MapAxis::of_angles_and_moduli(old.winding_angles, old.shear_moduli),
            pressures: old.pressures,
            paths: old.paths.into_iter().map(|path| path.map(FreePath::from)).collect(),
            checks: checks.map(|(free, path)| (LoadedFree::from(free), path.into())).collect(),
            fidelity: old.fidelity,
            settings: old.settings,
            source: old.source,
        }
    }
}
