use crate::{SolidMesh, TipLoad};
use actuator::Free;

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
    /// The mesh of a FREE.
    pub fn mesh(&self, free: &Free) -> SolidMesh {
        self.elements.map_or_else(|| SolidMesh::lean(free), SolidMesh::of_elements)
    }
}
