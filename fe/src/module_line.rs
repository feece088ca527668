use actuator::{ModuleCheck, ModuleMap, ModuleState, ModuleSymmetry};

/// A unit of work of a module's map: nodes along the pressure of the last FREE, each followed from the one before, or a check.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleLine {
    /// Pressures of its states, Pa.
    pub pressures: Vec<Vec<f64>>,
    /// Their nodes; none for a check.
    nodes: Vec<usize>,
}

/// Where on each axis a node lies.
fn places(map: &ModuleMap, mut node: usize) -> Vec<usize> {
    let mut places: Vec<usize> = vec![0; map.pressures.len()];
    for (place, axis) in places.iter_mut().zip(&map.pressures).rev() {
        *place = node % axis.len();
        node /= axis.len();
    }
    places
}

/// The node to which a motion carries one.
fn image(map: &ModuleMap, motion: &ModuleSymmetry, node: usize) -> usize {
    let moved = motion.carry(&places(map, node)).into_iter().zip(&map.pressures);
    moved.fold(0, |node, (place, axis)| node * axis.len() + place)
}

fn spread_from(node: usize, symmetries: &[ModuleSymmetry], map: &mut ModuleMap) {
    for motion in symmetries {
        let image = image(map, motion, node);
        if map.states[image].is_none() {
            map.states[image] = map.states[node].as_ref().map(|state| motion.state(state));
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

    /// Puts the state of a place on the line into the map, and its images where these are missing.
    pub(crate) fn put(
        &self,
        place: usize,
        state: ModuleState,
        symmetries: &[ModuleSymmetry],
        map: &mut ModuleMap,
    ) {
        let Some(node) = self.nodes.get(place) else {
            map.checks.push(ModuleCheck { pressures: self.pressures[place].clone(), state });
            return;
        };
        map.states[*node] = Some(state);
        spread_from(*node, symmetries, map);
    }

    /// Puts the images of all states into the map where these are missing.
    pub(crate) fn spread(symmetries: &[ModuleSymmetry], map: &mut ModuleMap) {
        (0..map.node_count()).for_each(|node| spread_from(node, symmetries, map));
    }
}
