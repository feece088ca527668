use crate::{
    axis::Axis,
    choice::Choice,
    columns::Columns,
    content::{self, Content},
    exit::Exit,
    failure::{Failure, Outcome},
    map_file::MapFile,
    output, parquet,
    solid_states::SolidStates,
    values::Values,
};
use actuator::{Fidelity, FreeParameter};
use fe::SolidSweep;
use std::path::{Path, PathBuf};

/// Tell what is in a map, model, recording or description
///
/// The kind is found out from the content, not from the name. Without a flag a table is printed.
///
/// The charts of a FREE's map show the pressure or the winding angle and one axis more; where another axis has several values they stand
/// at the description's own or the next to it, or at those chosen by --winding-angle, --shear-modulus-mpa, --axis and --at-kpa.
///
/// A solid map holds no fields: --vtu solves its paths again, checks that the states are the map's and writes them for ParaView
/// to DIR/ANGLE-deg-MODULUS-mpa: each state's rubber and fibres, and path.pvd to step through them, time being the pressure in
/// kPa. Of more than four paths a choice is asked for. Ctrl-C leaves complete files only.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact inspect paper.map
  freeact inspect paper.map --csv --out paper.csv
  freeact inspect paper.map --parquet paper.parquet --plot paper
  freeact inspect walls.map --plot thin --axis wall_mm=0.6 --at-kpa 20,40,60
  freeact inspect solid.map --vtu states --winding-angle 30 --at-kpa 20,40
  freeact inspect data/modules/buffinton-2020-30lr.toml --json")]
pub struct Inspect {
    /// The file
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// The rig of a CSV recording (default: rig.toml beside it)
    #[arg(long, value_name = "RIG.toml")]
    rig: Option<PathBuf>,

    /// Print the content as CSV: one row a state or sample
    #[arg(long)]
    csv: bool,

    /// Write the same columns as a Parquet file, for data frames
    #[arg(long, value_name = "FILE")]
    parquet: Option<PathBuf>,

    /// Write the table or CSV to a file instead of printing it
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Write charts, as SVG and PNG, into a directory
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,

    /// Solve the paths of a solid map again and write their states for ParaView (.vtu, .pvd) into a directory
    #[arg(long, value_name = "DIR")]
    vtu: Option<PathBuf>,

    /// Winding angles to draw or write, from the hoop direction, degrees: a list or first:last:step (default: all)
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    winding_angle: Option<Values>,

    /// Shear moduli to draw or write (default: all)
    #[arg(long, value_name = "MPA", allow_hyphen_values = true)]
    shear_modulus_mpa: Option<Values>,

    /// Values of another axis of the map to draw or write, as in wall_mm=0.8; may be given several times (default: all)
    #[arg(long, value_name = "NAME=VALUES")]
    axis: Vec<Axis>,

    /// Pressures: of the states to write (default: every state), and of the curves over the winding angle
    #[arg(long, value_name = "KPA", allow_hyphen_values = true)]
    at_kpa: Option<Values>,
}

impl Inspect {
    pub fn run(self, json: bool) -> Outcome {
        let content = content::open(&self.file, self.rig.as_deref())?;
        let choice = self.choice();
        if self.plot.is_none() && self.vtu.is_none() && choice != Choice::default() {
            return Err(Failure::usage(
                "--winding-angle, --shear-modulus-mpa, --axis and --at-kpa choose what --plot draws and --vtu writes: give one of them",
            ));
        }
        if let Some(directory) = &self.plot {
            self.draw(content.as_ref(), &choice, directory)?;
        }
        let states = match &self.vtu {
            Some(directory) => Some(self.write_states(content.as_ref(), directory)?),
            None => None,
        };
        if let Some(path) = &self.parquet {
            let columns = self.columns(content.as_ref(), "--parquet")?;
            output::replace(path, &mut |out| parquet::write(&columns, out))?;
        }
        let mut text = if self.csv {
            self.columns(content.as_ref(), "--csv")?.csv()
        } else if json {
            let mut value = content.json();
            if let Some(states) = &states {
                value["vtu"] = states.json();
            }
            format!("{value:#}\n")
        } else {
            content.text(&self.file)
        };
        if let Some(states) = &states {
            match self.csv {
                // What is printed is data.
                true => eprint!("{}", states.text()),
                false if json => {}
                false => text += &states.text(),
            }
        }
        output::write(&text, self.out.as_deref())?;
        for remark in states.iter().flat_map(SolidStates::remarks) {
            eprintln!("{remark}");
        }
        Ok(states.map_or(Exit::Done, |states| states.exit()))
    }

    fn choice(&self) -> Choice {
        let values = |values: &Option<Values>| values.as_ref().map(|values| values.0.clone());
        let always = [
            (FreeParameter::WindingAngle, values(&self.winding_angle)),
            (FreeParameter::ShearModulus, values(&self.shear_modulus_mpa)),
        ];
        let mut chosen: Vec<_> =
            always.into_iter().filter_map(|(parameter, values)| Some((parameter, values?))).collect();
        chosen.extend(self.axis.iter().map(|axis| (axis.parameter, axis.values.0.clone())));
        Choice { values: chosen, pressures: values(&self.at_kpa) }
    }

    fn draw(&self, content: &dyn Content, choice: &Choice, directory: &Path) -> Result<(), Failure> {
        let charts = match content.map() {
            Some(MapFile::Free(map)) => {
                let chosen = choice.restricted(map).map_err(|failure| failure.about(&self.file))?;
                MapFile::Free(chosen).charts()
            }
            _ if *choice != Choice::default() => {
                return Err(Failure::usage(format!(
                    "{}: only of a FREE's map can values be chosen to draw",
                    self.file.display()
                )));
            }
            _ => content.charts(),
        };
        if charts.is_empty() {
            return Err(Failure::usage(format!("{}: --plot has nothing to draw here", self.file.display())));
        }
        output::make_directory(directory)?;
        charts.iter().try_for_each(|(stem, picture)| picture.write(directory, stem))
    }

    fn columns(&self, content: &dyn Content, flag: &str) -> Result<Columns, Failure> {
        content.columns().ok_or_else(|| {
            Failure::usage(format!(
                "{}: {flag} applies to maps and recordings only; leave it out for a table",
                self.file.display()
            ))
        })
    }

    fn write_states(&self, content: &dyn Content, directory: &Path) -> Result<SolidStates, Failure> {
        let file = self.file.display();
        let (map, elements) = match content.map() {
            None => {
                return Err(Failure::usage(format!(
                    "{file}: --vtu applies to solid maps only; leave it out for a table"
                )));
            }
            Some(MapFile::Module(_)) => {
                return Err(Failure::refused(format!(
                    "{file}: --vtu: this is the map of a module; files are written of single FREEs only"
                )));
            }
            Some(MapFile::Free(map)) => match map.fidelity {
                Fidelity::Solid { elements } => (map, elements),
                Fidelity::Section | Fidelity::CappedSection => {
                    return Err(Failure::refused(format!(
                        "{file}: --vtu: this map is by section, without a tube to show; make one by `freeact map --fidelity solid`"
                    )));
                }
            },
        };
        let choice = self.choice();
        let sweep = SolidSweep { elements, ..SolidSweep::default() };
        let wanted = choice.wanted(map).map_err(|failure| failure.about(&self.file))?;
        SolidStates::write(map, &sweep, &wanted, directory)
    }
}
