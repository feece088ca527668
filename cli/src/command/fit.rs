use crate::{
    content::Content,
    exit::Exit,
    failure::{Failure, Outcome},
    map_file::MapFile,
    output,
};
use rom::{FreeModel, Model, ModelContent, ModuleModel, Provenance};
use serde_json::json;
use std::path::PathBuf;

/// Fit a model to a map: splines that a controller can evaluate
///
/// The model's error is measured on states of the finite elements that took no part in the fit, printed, and kept in the model.
/// Outside its domain (beyond the map, or too near a limit pressure) the model refuses to answer.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  freeact fit module.map --out module.model")]
pub struct Fit {
    /// The map
    #[arg(value_name = "M.map")]
    map: PathBuf,

    /// The model
    #[arg(long, value_name = "X.model")]
    out: PathBuf,
}

impl Fit {
    pub fn run(self, json: bool) -> Outcome {
        let map = MapFile::read(&self.map)?;
        let model = fit(&map).map_err(|failure| failure.about(&self.map))?;
        model.write(&self.out)?;
        if json {
            let mut value = model.json();
            value["out"] = json!(self.out);
            output::print_json(&value);
        } else {
            output::print(&model.text(&self.out));
        }
        Ok(Exit::Done)
    }
}

/// The model of a map.
pub fn fit(map: &MapFile) -> Result<Model, Failure> {
    let (content, settings) = match map {
        MapFile::Free(map) => {
            (ModelContent::Free(FreeModel::fit(map).map_err(Failure::file)?), &map.settings)
        }
        MapFile::Module(map) => {
            (ModelContent::Module(ModuleModel::fit(map).map_err(Failure::file)?), &map.settings)
        }
    };
    let provenance = Provenance::new(map, map.source(), settings)?;
    Ok(Model::new(content, provenance))
}
