use crate::{
    FreeModel, ModuleModel,
    effect::{Chain, EffectError},
    stored_model::StoredModel,
    stored_model_old::{StoredModelVersion1, StoredModelVersion2},
};
use actuator::artefact::{self, ArtefactError};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What a model answers for. There is one a program, so that the variants need not be of like size.
#[expect(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq)]
pub enum ModelContent {
    /// A single FREE.
    Free(FreeModel),
    /// Several between two plates.
    Module(ModuleModel),
}

/// Where a model comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Checksum (BLAKE3, hexadecimal) of the map it was fitted from, as in the map's file.
    pub map_hash: String,
    /// Name of the description of the actuator.
    pub description_name: String,
    /// Text of the description.
    pub description_text: String,
    /// Settings of the finite elements, in words.
    pub settings: String,
    /// Version of the program that fitted it.
    pub program_version: String,
}

/// A model: splines fitted from a map, effects found beyond it, and where it comes from. The content of a `.model` file.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The splines, with their error on states that were never fitted.
    pub content: ModelContent,
    /// Effects beyond the finite elements; none in a model fresh from a fit.
    pub effects: Chain,
    /// Where it comes from.
    pub provenance: Provenance,
}

/// Why a model file cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file is not there, not a model, damaged or too new.
    #[error(transparent)]
    Artefact(#[from] ArtefactError),
    /// The file is whole but says something that cannot be.
    #[error("{path}: the model {problem}; make it again with `freeact fit`", path = path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: InvalidModel,
    },
    /// The model cannot be put into bytes.
    #[error("the model cannot be written: {0}")]
    Unwritable(String),
}

/// What can be wrong with a model whose file is whole.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InvalidModel {
    /// Its splines are not splines.
    #[error("holds a spline that is none: {0}")]
    Spline(#[from] crate::SplineError),
    /// A FREE's parts do not fit each other.
    #[error("is not one of a FREE: {0}")]
    Free(#[from] crate::FreeFitError),
    /// A module's parts do not fit each other.
    #[error("is not one of a module: {0}")]
    Module(#[from] crate::ModuleFitError),
    /// A part that does not fit.
    #[error("does not hold together: {0}")]
    Inconsistent(&'static str),
    /// An effect that this program does not have.
    #[error("has an effect `{0}` that this program does not know; use a newer freeact, or")]
    UnknownEffect(String),
    /// Parameters of an effect that are not this program's.
    #[error(
        "gives effect `{effect}` the parameters [{found}], this program knows [{expected}]; use a newer freeact, or"
    )]
    EffectParameters {
        /// The effect.
        effect: String,
        /// Names in the file.
        found: String,
        /// Names known.
        expected: String,
    },
    /// An effect with numbers that it cannot have.
    #[error("has an effect that cannot be: {0}")]
    Effect(#[from] EffectError),
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Where the checksum stands in the bytes of a map or a model (see [`actuator::artefact`]).
const CHECKSUM: std::ops::Range<usize> = 12..44;

impl Provenance {
    /// Provenance of a model of this map. `map` is what the map's file holds, so that the hash is the file's checksum; `source` is
    /// name and text of the description.
    pub fn new<T: Serialize>(map: &T, source: &(String, String), settings: &str) -> Result<Self, ModelError> {
        let bytes = artefact::to_bytes(artefact::MAP, map).map_err(ModelError::Unwritable)?;
        Ok(Provenance {
            map_hash: hexadecimal(&bytes[CHECKSUM]),
            description_name: source.0.clone(),
            description_text: source.1.clone(),
            settings: settings.to_owned(),
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
        })
    }
}

impl Model {
    /// A model without effects.
    pub fn new(content: ModelContent, provenance: Provenance) -> Self {
        Model { content, effects: Chain::default(), provenance }
    }

    /// Number of FREEs.
    pub fn frees(&self) -> usize {
        match &self.content {
            ModelContent::Free(_) => 1,
            ModelContent::Module(module) => module.module().frees.len(),
        }
    }

    /// The model of a module, where it is one.
    pub fn as_module(&self) -> Option<&ModuleModel> {
        match &self.content {
            ModelContent::Free(_) => None,
            ModelContent::Module(module) => Some(module),
        }
    }

    /// The model of a FREE, where it is one.
    pub fn as_free(&self) -> Option<&FreeModel> {
        match &self.content {
            ModelContent::Free(free) => Some(free),
            ModelContent::Module(_) => None,
        }
    }

    /// The bytes of a model file.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ModelError> {
        artefact::to_bytes(artefact::MODEL, &StoredModel::from(self)).map_err(ModelError::Unwritable)
    }

    /// Checksum of the model file (BLAKE3, hexadecimal): the model's identity in logs.
    pub fn hash(&self) -> Result<String, ModelError> {
        Ok(hexadecimal(&self.to_bytes()?[CHECKSUM]))
    }

    /// Writes the model, atomically.
    pub fn write(&self, path: &Path) -> Result<(), ModelError> {
        Ok(artefact::write(path, artefact::MODEL, &StoredModel::from(self))?)
    }

    /// Reads a model and checks all that evaluations rest on.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        let io_error = |source| ArtefactError::Io { path: path.to_owned(), source };
        Self::from_bytes(path, &std::fs::read(path).map_err(io_error)?)
    }

    /// Reads a model from the bytes of a file; `path` is for messages.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, ModelError> {
        let is_model = bytes.starts_with(&artefact::MODEL.magic);
        let stored = match artefact::version(bytes).filter(|_| is_model) {
            Some(1) => StoredModel::try_from(artefact::from_bytes::<StoredModelVersion1>(
                path,
                artefact::MODEL_VERSION_1,
                bytes,
            )?),
            Some(2) => {
                let old: StoredModelVersion2 = artefact::from_bytes(path, artefact::MODEL_VERSION_2, bytes)?;
                Ok(old.into())
            }
            _ => Ok(artefact::from_bytes(path, artefact::MODEL, bytes)?),
        };
        stored
            .and_then(Model::try_from)
            .map_err(|problem| ModelError::Invalid { path: path.to_owned(), problem })
    }
}

#[cfg(test)]
mod tests;
