use super::Content;
use crate::{columns::Columns, map_file::MapFile, plot::Picture};
use serde_json::json;
use std::path::Path;

impl Content for MapFile {
    fn text(&self, path: &Path) -> String {
        self.content().text(path)
    }

    fn json(&self) -> serde_json::Value {
        let (computed, nodes) = self.computed();
        let mut value = self.content().json();
        value["complete"] = json!(computed == nodes);
        value["computed"] = json!(computed);
        value["missing"] = json!(nodes - computed);
        value["worst_residual"] = json!(self.worst_residual());
        value
    }

    fn columns(&self) -> Option<Columns> {
        self.content().columns()
    }

    fn charts(&self) -> Vec<(String, Picture)> {
        self.content().charts()
    }

    fn map(&self) -> Option<&MapFile> {
        Some(self)
    }
}

impl MapFile {
    fn content(&self) -> &dyn Content {
        match self {
            MapFile::Free(map) => map,
            MapFile::Module(map) => map,
        }
    }
}
