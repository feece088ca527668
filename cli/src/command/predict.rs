use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    goal,
    map_csv::{self, number},
    output,
    pressures_csv::{Columns, Wanted},
    tip_model,
};
use actuator::units::{DEG, KPA, MM, MPA};
use rom::{FreeModel, Model, ModelContent, PoseModel, effect::Chain};
use serde_json::json;
use std::path::PathBuf;

/// Predict the pose (module) or the deformation (FREE) at given pressures
///
/// The table of pressures has a header and one row a state: p1_kpa, p2_kpa, ... for a module; p1_kpa (or pressure_kpa) for a
/// FREE, and if wanted winding_angle_deg and shear_modulus_mpa, by default the description's own. Other columns are left alone.
/// Effects of a corrected model act as they do at rest. Rows outside the model's domain get the status "outside" and no values.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  freeact predict --model module.model --pressures in.csv --out poses.csv")]
pub struct Predict {
    /// The model
    #[arg(long, value_name = "X.model")]
    model: PathBuf,

    /// The pressures
    #[arg(long, value_name = "IN.csv")]
    pressures: PathBuf,

    /// The predictions (default: printed)
    #[arg(long, value_name = "OUT.csv")]
    out: Option<PathBuf>,
}

/// A table of predictions, and how many of its rows have none.
struct Predictions {
    text: String,
    rows: usize,
    outside: usize,
    /// Why the first of them has none.
    first: String,
}

impl Predictions {
    fn under(head: &[String]) -> Self {
        Predictions { text: head.join(",") + "\n", rows: 0, outside: 0, first: String::new() }
    }

    fn row(&mut self, mut cells: Vec<String>, answer: Result<Vec<String>, String>, width: usize) {
        self.rows += 1;
        match answer {
            Ok(values) => cells.extend(values.into_iter().chain(["ok".to_owned()])),
            Err(reason) => {
                if self.outside == 0 {
                    self.first = format!("row {}: {reason}", self.rows);
                }
                self.outside += 1;
                cells.extend(vec![String::new(); width]);
                cells.push("outside".into());
            }
        }
        self.text += &(cells.join(",") + "\n");
    }
}

/// Error bars of a module's model against its finite elements: what 95 of 100 errors stay below.
const BARS: [&str; 2] = ["position_bar_mm", "rotation_bar_deg"];

impl Predict {
    pub fn run(self, json: bool) -> Outcome {
        let model = Model::read(&self.model)?;
        let bytes = std::fs::read(&self.pressures).map_err(Failure::at(&self.pressures))?;
        let predictions = match &model.content {
            ModelContent::Free(free) => self.free(free, &tip_model::at_rest(&model.effects), &bytes)?,
            ModelContent::Module(_) => self.module(&model, &bytes)?,
        };
        output::write(&predictions.text, self.out.as_deref())?;
        let Predictions { rows, outside, first, .. } = predictions;
        if json && self.out.is_some() {
            output::print_json(
                &json!({ "out": self.out, "rows": rows, "outside": outside, "first_outside": first }),
            );
        } else if outside > 0 {
            eprintln!("{outside} of {rows} rows are outside the model's domain; {first}");
        }
        Ok(if outside > 0 { Exit::Refused } else { Exit::Done })
    }

    fn module(&self, model: &Model, bytes: &[u8]) -> Result<Predictions, Failure> {
        let frees = model.frees();
        let names = map_csv::pressure_header(frees);
        let names: Vec<[&str; 1]> = names.iter().map(|name| [name.as_str()]).collect();
        let mut wanted = vec![Wanted { names: &["t_s"], optional: true }];
        wanted.extend(names.iter().map(|names| Wanted { names, optional: false }));
        let columns = Columns::parse(&self.pressures, bytes, &wanted, frees)?;
        let first = columns.names.len() - frees;
        let mut head = columns.names.clone();
        let steered = goal::module_of(model, &self.model)?;
        let has_bars = steered.error_bars(&vec![0.0; frees]).is_some();
        head.push(map_csv::POSE_HEADER.to_owned());
        head.extend(BARS.iter().filter(|_| has_bars).map(|name| (*name).to_owned()));
        head.push("status".to_owned());
        let answers = 7 + if has_bars { BARS.len() } else { 0 };
        let mut predictions = Predictions::under(&head);
        let module = steered.tip();
        let mut into = rom::PoseEvaluation::new(frees, 0);
        for row in &columns.rows {
            let pressures: Vec<f64> = row[first..].iter().map(|kpa| kpa * KPA).collect();
            let answer = module.evaluate(&pressures, &mut into);
            let answer = answer.map(|()| {
                let bars = steered
                    .error_bars(&pressures)
                    .map(|[position, rotation]| [position / MM, rotation / DEG]);
                let pose = map_csv::pose_cells(&into.chart.to_pose());
                pose.into_iter().chain(bars.into_iter().flatten().map(number)).collect()
            });
            let cells = row.iter().map(|value| number(*value)).collect();
            predictions.row(cells, answer.map_err(|error| error.to_string()), answers);
        }
        Ok(predictions)
    }

    fn free(&self, free: &FreeModel, effects: &Chain, bytes: &[u8]) -> Result<Predictions, Failure> {
        let wanted = [
            Wanted { names: &["t_s"], optional: true },
            Wanted { names: &["winding_angle_deg"], optional: true },
            Wanted { names: &["shear_modulus_mpa"], optional: true },
            Wanted { names: &["p1_kpa", "pressure_kpa"], optional: false },
        ];
        let columns = Columns::parse(&self.pressures, bytes, &wanted, 1)?;
        let angle = columns.place("winding_angle_deg");
        let modulus = columns.place("shear_modulus_mpa");
        let mut head = columns.names.clone();
        let own =
            ["axial_stretch", "expansion", "twist_per_length_deg_per_mm", "limit_pressure_kpa", "status"];
        head.extend(own.map(str::to_owned));
        let mut predictions = Predictions::under(&head);
        for row in &columns.rows {
            let mut pressures = [row[row.len() - 1] * KPA];
            tip_model::deform(effects, &mut pressures);
            let angle = angle.map_or(free.free().winding.angle_from_hoop(), |place| row[place] * DEG);
            let modulus = modulus.map_or(free.free().elastomer.shear_modulus(), |place| row[place] * MPA);
            let angle = angle + effects.winding_angle();
            let answer = free.evaluate(pressures[0], angle, modulus).and_then(|state| {
                let limit = free.limit_pressure(angle, modulus)?;
                Ok(vec![
                    number(state.axial_stretch),
                    number(state.expansion),
                    number(state.twist_per_length / DEG * MM),
                    limit.map(|limit| number(limit / KPA)).unwrap_or_default(),
                ])
            });
            let cells = row.iter().map(|value| number(*value)).collect();
            predictions.row(cells, answer.map_err(|error| error.to_string()), 4);
        }
        Ok(predictions)
    }
}
