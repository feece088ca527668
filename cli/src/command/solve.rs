use crate::{
    exit::Exit,
    failure::{Failure, Outcome},
    goal, output, solution,
    values::numbers,
};
use actuator::{
    TipPose,
    units::{KPA, MM},
};
use control::{Preference, SolveInput, Solver, Status, Target};
use rom::Model;
use std::{path::PathBuf, time::Instant};

/// Find pressures that bring the tip of a module to a target
///
/// The nearest pose is sought within the pressures that the description and the limit pressures allow. Where several pressures
/// reach the target, --prefer chooses among them. A target out of reach gets the nearest reachable pose, the distance that is
/// left and the bounds that hold it (exit code 3).
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact solve --model module.model --target-mm 5,-3,178
  freeact solve --model module.model --target-mm 5,-3,178 --prefer least-change --from-kpa 10,10,10,10 --json")]
pub struct Solve {
    /// The model of a module
    #[arg(long, value_name = "X.model")]
    model: PathBuf,

    /// Where the centre of the tip plate shall be, in the base frame
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    target_mm: [f64; 3],

    /// How the tip plate shall be turned: quaternion from its frame to the base frame (default: left free)
    #[arg(long, value_name = "W,X,Y,Z", value_parser = rotation, allow_hyphen_values = true)]
    rotation: Option<[f64; 4]>,

    /// Pressures of now: where the search begins and what changes are counted from
    #[arg(long, value_name = "P1,P2,..", allow_hyphen_values = true)]
    from_kpa: Option<crate::values::Values>,

    /// Which pressures to take where several reach the target
    #[arg(long, value_enum, default_value_t)]
    prefer: Prefer,

    /// Distance to keep from limit pressures, beyond the 2 % that the model keeps itself
    #[arg(long, value_name = "KPA", default_value = "0")]
    limit_margin_kpa: f64,
}

/// A choice among pressures that reach the same target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Prefer {
    /// The least pressures
    #[default]
    LeastPressure,
    /// The least change from --from-kpa
    LeastChange,
    /// The greatest distance from all bounds
    Margin,
}

impl From<Prefer> for Preference {
    fn from(prefer: Prefer) -> Self {
        match prefer {
            Prefer::LeastPressure => Preference::LeastPressure,
            Prefer::LeastChange => Preference::LeastChange,
            Prefer::Margin => Preference::Margin,
        }
    }
}

pub(super) fn rotation(text: &str) -> Result<[f64; 4], String> {
    let wxyz = numbers::<4>(text)?;
    match TipPose::from_parts([0.0; 3], wxyz) {
        Some(pose) => Ok(pose.wxyz()),
        None => Err("the quaternion has no direction; no rotation is 1,0,0,0".into()),
    }
}

impl Solve {
    pub fn run(self, json: bool) -> Outcome {
        let model = Model::read(&self.model)?;
        let module = goal::module_of(&model, &self.model)?;
        let from = goal::pressures(self.from_kpa.as_ref(), model.frees(), "--from-kpa")?;
        if self.prefer == Prefer::LeastChange && from.is_none() {
            return Err(Failure::usage(
                "--prefer least-change needs --from-kpa, the pressures to change from",
            ));
        }
        let target = Target {
            position: self.target_mm.map(|mm| mm * MM),
            rotation: self.rotation,
            position_weight: 1.0,
            rotation_weight: if self.rotation.is_some() { module.length() } else { 0.0 },
        };
        let bounds = module.bounds(self.limit_margin_kpa * KPA)?;
        let input = SolveInput { preference: self.prefer.into(), from, ..SolveInput::new(target, bounds) };
        let tip = module.tip();
        let mut solver = Solver::new(&tip);
        let start = Instant::now();
        let found = solver.solve(&input);
        let seconds = start.elapsed().as_secs_f64();
        match json {
            true => output::print_json(&solution::json(&found, seconds)),
            false => output::print(&solution::text(&found, seconds)),
        }
        Ok(match found.status {
            Status::Reached => Exit::Done,
            Status::Unreachable => Exit::Unreachable,
            Status::Refused => Exit::Refused,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_is_a_direction() {
        assert_eq!(rotation("2,0,0,0").unwrap(), [1.0, 0.0, 0.0, 0.0]);
        assert!(rotation("0,0,0,0").unwrap_err().contains("no direction"));
        assert!(rotation("1,0,0").is_err() && rotation("1,0,0,nan").is_err());
    }
}
