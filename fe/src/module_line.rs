use actuator::{ModuleCheck, ModuleMap, ModuleState, ModuleSymmetry, grid_places};

/// A unit of work of a module's map: nodes along the pressure of the last FREE, each followed from the one before, or a check.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleLine {
    /// Pressures of its states, Pa.
    pub pressures: Vec<Vec<f64>>,
    /// Their nodes; none for a check.
    nodes: Vec<usize>,
}

/// The node to which a motion carries one.
fn image(map: &ModuleMap, motion: &ModuleSymmetry, node: usize) -> usize {
    let places = grid_places(map.pressures.iter().map(Vec::len), node);
    let moved = motion.carry(&places).into_iter().zip(&map.pressures);
    moved.fold(0, |node, (place, axis)| node * axis.len() + place)
}

/// Puts the images of all states into the map where these are missing.
pub(crate) fn spread(symmetries: &[ModuleSymmetry], map: &mut ModuleMap) {
    for node in 0..map.node_count() {
        for motion in symmetries {
            let image = image(map, motion, node);
            if map.states[image].is_none() {
                map.states[image] = map.states[node].as_ref().map(|state| motion.state(state));
            }
        }
    }
}

impl ModuleLine {
    /// All lines of a map: of the nodes those that no motion carries to one before them, then the checks at `checks` (Pa).
    pub(crate) fn all(map: &ModuleMap, symmetries: &[ModuleSymmetry], checks: &[Vec<f64>]) -> Vec<Self> {
        let length = map.pressures.last().map_or(1, Vec::len);
        let line = |first: usize| {
            let is_first = |node: &usize| symmetries.iter().all(|motion| image(map, motion, *node) >= *node);
            let nodes: Vec<usize> = (first..first + length).filter(is_first).collect();
            let pressures = nodes.iter().map(|node| map.node_pressures(*node)).collect();
            ModuleLine { pressures, nodes }
        };
        let lines = (0..map.node_count()).step_by(length).map(line).filter(|line| !line.nodes.is_empty());
        let checks = checks.iter().map(|check| ModuleLine { pressures: vec![check.clone()], nodes: vec![] });
        lines.chain(checks).collect()
    }

    /// Whether states of it are not in the map.
    pub fn is_missing(&self, map: &ModuleMap) -> bool {
        if self.nodes.is_empty() {
            return map.checks.iter().all(|check| !self.pressures.contains(&check.pressures));
        }
        self.nodes.iter().any(|node| map.states[*node].is_none())
    }

    /// Puts the state of a place on the line into the map; its images are not there before [`ModuleSweep::spread`](crate::ModuleSweep::spread).
    pub fn put(&self, place: usize, state: ModuleState, map: &mut ModuleMap) {
        match self.nodes.get(place) {
            Some(node) => map.states[*node] = Some(state),
            None => map.checks.push(ModuleCheck { pressures: self.pressures[place].clone(), state }),
        }
    }
}
