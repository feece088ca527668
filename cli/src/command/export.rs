use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    output,
};
use rom::Model;
use serde_json::json;
use std::path::PathBuf;

/// Write a model as an image that a controller evaluates in place
///
/// An image holds the splines, the domain, the error bars and the effects of a model in the bytes that the crate `evaluator` and its C
/// interface read without copying, allocation or operating system. It holds no provenance: keep the model.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  freeact export module.model --out module.img\n  freeact export module.model --single --c-array MODULE --out module.h"
)]
pub struct Export {
    /// The model
    #[arg(value_name = "X.model")]
    model: PathBuf,

    /// The image
    #[arg(long, value_name = "X.img")]
    out: PathBuf,

    /// Numbers in single precision (about 1e-6 of position, half the bytes)
    #[arg(long)]
    single: bool,

    /// Write a C header with the image as an aligned array of this name
    #[arg(long, value_name = "NAME")]
    c_array: Option<String>,
}

impl Export {
    pub fn run(self, json: bool) -> Outcome {
        let model = Model::read(&self.model)?;
        let image = if self.single { model.image::<f32>() } else { model.image::<f64>() };
        let image = image.map_err(|error| Failure::refused(error.to_string()).about(&self.model))?;
        let bytes = match &self.c_array {
            Some(name) => c_array(name, &image)?.into_bytes(),
            None => image.clone(),
        };
        output::save(&self.out, &bytes)?;
        let precision = if self.single { "single" } else { "double" };
        if json {
            output::print_json(&json!({
                "out": self.out, "image_bytes": image.len(), "precision": precision,
                "model": model.hash()?, "frees": model.frees(), "effects": model.effects.effects.len(),
            }));
        } else {
            output::print(&format!(
                "{}: image of {} bytes in {precision} precision, {} FREEs, {} effects\n",
                self.out.display(),
                image.len(),
                model.frees(),
                model.effects.effects.len()
            ));
        }
        Ok(Exit::Done)
    }
}

/// A C header that defines the bytes at an address that is a multiple of eight.
fn c_array(name: &str, image: &[u8]) -> Result<String, Failure> {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    if !(name.starts_with(letter) && name.chars().all(|c| letter(c) || c.is_ascii_digit())) {
        return Err(Failure::usage(format!(
            "--c-array {name}: is no name in C; begin with a letter and use letters, digits and underscores"
        )));
    }
    let rows: Vec<String> = image
        .chunks(24)
        .map(|row| row.iter().map(|byte| byte.to_string()).collect::<Vec<_>>().join(","))
        .collect();
    Ok(format!(
        "/* A model of freeact as an image; read it with freeact.h. */\n#include <stdalign.h>\n#include <stddef.h>\n\n\
         static const size_t {name}_SIZE = {};\nstatic const alignas(8) unsigned char {name}[{}] = {{\n{}\n}};\n",
        image.len(),
        image.len(),
        rows.join(",\n")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_c_would_refuse_are_refused_here() {
        for name in ["", "2nd", "a-b", "a b", "é"] {
            let error = c_array(name, &[1]).unwrap_err();
            assert!(error.paragraph().contains("is no name in C"), "{}", error.paragraph());
        }
        let text = c_array("_m2", &[7; 25]).unwrap();
        assert!(
            text.contains("unsigned char _m2[25]") && text.contains("7,7,\n7\n}")
                || text.contains("7,\n7\n}")
        );
    }
}
