use crate::{SolidMesh, TipLoad};
use actuator::{Free, Module};

/// How finely a module of solids is modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidModuleSettings {
    /// Elements of each FREE through the wall, around and along; `None` for [`SolidMesh::lean`].
    pub elements: Option<[u32; 3]>,
    /// Loads on the tip plate besides weights.
    pub tip_load: TipLoad,
    /// Threads on which the FREEs are assembled and factorised; the answer does not depend on it.
    pub threads: usize,
}

impl Default for SolidModuleSettings {
    fn default() -> Self {
        SolidModuleSettings { elements: None, tip_load: TipLoad::default(), threads: 1 }
    }
}

impl SolidModuleSettings {
    /// In words, for a map.
    pub fn describe(&self, module: &Module) -> String {
        let mut meshes: Vec<String> = vec![];
        for placed in &module.frees {
            let SolidMesh { radial, around, along, .. } = self.mesh(&placed.free);
            let words = format!("{radial} x {around} x {along}");
            if !meshes.contains(&words) {
                meshes.push(words);
            }
        }
        format!(
            "solids between rigid plates, 27-node hexahedra with linear pressure; elements of a FREE through the wall, around, along: {}; \
             fibres as wide as described",
            meshes.join(", ")
        )
    }

    /// The mesh of a FREE.
    pub fn mesh(&self, free: &Free) -> SolidMesh {
        self.elements.map_or_else(|| SolidMesh::lean(free), SolidMesh::of_elements)
    }
}
