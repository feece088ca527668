use crate::{
    content::Content,
    exit::Exit,
    failure::{Failure, Outcome},
    interrupt,
    map_file::MapFile,
    output,
    sweep::{self, Sweeping, Swept},
    table::{duration, short},
    values::Values,
};
use actuator::{
    Description, Free, FreeMap, Module, ModuleMap, Rig,
    units::{DEG, KPA, MPA},
};
use fe::{FreeSweep, ModuleSweep};
use serde_json::json;
use std::{path::PathBuf, str::FromStr, time::Instant};

/// Compute a pressure-to-deformation map by finite elements
///
/// Of a FREE: stretch, expansion and twist over winding angle, shear modulus and pressure, each path followed to its limit
/// pressure, above which there is no equilibrium. Of a module: tip poses over the pressures of its FREEs.
///
/// Ctrl-C keeps what is finished; --resume goes on from there. --shard computes a part, for several machines; `freeact merge`
/// joins the parts.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact map --of data/actuators/buffinton-2020.toml --out paper.map --winding-angles 10:80:10 --shear-moduli-mpa 0.2,0.393,0.6
  freeact map --of data/modules/buffinton-2020-30lr.toml --out module.map --nodes 7
  freeact map --of data/modules/buffinton-2020-30lr.toml --out part.1.map --shard 1/4")]
pub struct Map {
    /// Description of a FREE or a module
    #[arg(long, value_name = "FREE_OR_MODULE.toml")]
    of: PathBuf,

    /// The map
    #[arg(long, value_name = "M.map")]
    out: PathBuf,

    /// Winding angles from the hoop direction, degrees: a list or first:last:step (FREE; default: the description's own)
    #[arg(long, value_name = "DEG", value_parser = winding_angles, allow_hyphen_values = true)]
    winding_angles: Option<Values>,

    /// Shear moduli: a list or first:last:step (FREE; default: the description's own)
    #[arg(long, value_name = "MPA", value_parser = positive_list, allow_hyphen_values = true)]
    shear_moduli_mpa: Option<Values>,

    /// Greatest pressure (default: 70 for a FREE, the description's pressure_max_kpa for a module)
    #[arg(long, value_name = "KPA", value_parser = positive, allow_hyphen_values = true)]
    pressure_max_kpa: Option<f64>,

    /// Step between the pressures of a FREE's map
    #[arg(long, value_name = "KPA", value_parser = positive, default_value = "1", allow_hyphen_values = true)]
    pressure_step_kpa: f64,

    /// Pressures per FREE of a module's map (default: as many as make about 2500 nodes)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=1000))]
    nodes: Option<u64>,

    /// Paths (FREE) or states (module) between the nodes that a fit will be judged by
    #[arg(long, value_name = "N")]
    checks: Option<usize>,

    /// Chooses where those lie
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// What computes the states (default: section for a FREE, rod for a module)
    #[arg(long, value_enum)]
    fidelity: Option<Fidelity>,

    /// Compute part i of n only, counted from 1
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Part,

    /// Threads (default: one per processor)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=4096))]
    jobs: Option<u64>,

    /// Complete the map that is in --out already
    #[arg(long)]
    resume: bool,
}

/// What computes the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Fidelity {
    /// The cross-section far from the caps, with discrete fibres
    Section,
    /// A solid model of the whole tube with its caps
    Solid,
    /// Rods that bend, stretch and twist between rigid plates
    Rod,
}

/// A part of a sweep, written `i/n` and counted from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part(fe::Shard);

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<(usize, usize)> =
            text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, count)) if 1 <= index && index <= count => {
                Ok(Part(fe::Shard { index: index - 1, count }))
            }
            _ => Err("write i/n with i from 1 to n, as in 1/4".into()),
        }
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a positive number".into()),
    }
}

fn positive_list(text: &str) -> Result<Values, String> {
    let values: Values = text.parse()?;
    match values.0.iter().find(|value| **value <= 0.0) {
        Some(value) => Err(format!("{value} is not positive")),
        None => Ok(values),
    }
}

fn winding_angles(text: &str) -> Result<Values, String> {
    let values: Values = text.parse()?;
    match values.0.iter().find(|value| !(1.0..=89.5).contains(*value)) {
        Some(value) => Err(format!("{value} is not between 1 and 89.5 degrees from the hoop direction")),
        None => Ok(values),
    }
}

/// A map with nothing computed, and what computes it.
enum Plan {
    Free(FreeSweep, FreeMap),
    Module(ModuleSweep, ModuleMap),
}

impl Map {
    pub fn run(self, json: bool) -> Outcome {
        let rig = Rig::read(&self.of)?;
        let plan = self.plan(&rig)?;
        let start = Instant::now();
        let jobs = self.jobs.map_or_else(sweep::processors, |jobs| jobs as usize);
        let sweeping = Sweeping { shard: self.shard.0, jobs, save: Some(&self.out) };
        let (mut map, swept) = match plan {
            Plan::Free(sweep, mut map) => {
                map = self.resumed(MapFile::Free(map))?.into_free()?;
                let swept = sweeping.free(&sweep, &mut map)?;
                (MapFile::Free(map), swept)
            }
            Plan::Module(sweep, mut map) => {
                map = self.resumed(MapFile::Module(map))?.into_module()?;
                let swept = sweeping.module(&sweep, &mut map)?;
                (MapFile::Module(map), swept)
            }
        };
        map.sort_checks();
        map.write(&self.out)?;
        self.tell(&map, &swept, start.elapsed().as_secs_f64(), json);
        Ok(match map.computed() {
            _ if interrupt::is_asked() => Exit::Interrupted,
            _ if !swept.failed.is_empty() => Exit::NotConverged,
            _ => Exit::Done,
        })
    }

    fn plan(&self, rig: &Rig) -> Result<Plan, Failure> {
        let usage = |message: &str| Err(Failure::usage(format!("{}: {message}", self.of.display())));
        match (&rig.description, self.fidelity) {
            (_, Some(Fidelity::Solid)) => Err(Failure::refused(
                "--fidelity solid: there is no solid model in this version; leave it out for the section (FREE) or the \
                 rods (module)",
            )),
            (Description::Free(_), Some(Fidelity::Rod)) => {
                usage("--fidelity rod is for modules; a single FREE's map is made by --fidelity section")
            }
            (Description::Module(_), Some(Fidelity::Section)) => {
                usage("--fidelity section is for single FREEs; a module's map is made by --fidelity rod")
            }
            (Description::Free(_), _) if self.nodes.is_some() => {
                usage("--nodes is for modules; a FREE's pressures are set by --pressure-step-kpa")
            }
            (Description::Free(free), _) => self.plan_free(rig, *free),
            (Description::Module(_), _)
                if self.winding_angles.is_some() || self.shear_moduli_mpa.is_some() =>
            {
                usage(
                    "--winding-angles and --shear-moduli-mpa are for single FREEs; a module has those of its description",
                )
            }
            (Description::Module(module), _) => self.plan_module(rig, module),
        }
    }

    fn plan_free(&self, rig: &Rig, free: Free) -> Result<Plan, Failure> {
        let axis = |values: &Option<Values>, flag: &str, unit: f64, own: f64| -> Result<Vec<f64>, Failure> {
            match values {
                None => Ok(vec![own]),
                Some(values) => Ok(values
                    .rising(flag)
                    .map_err(Failure::usage)?
                    .iter()
                    .map(|value| value * unit)
                    .collect()),
            }
        };
        let angles = axis(&self.winding_angles, "--winding-angles", DEG, free.winding.angle_from_hoop())?;
        let moduli = axis(&self.shear_moduli_mpa, "--shear-moduli-mpa", MPA, free.elastomer.shear_modulus())?;
        let greatest = self.pressure_max_kpa.unwrap_or(70.0);
        let step = self.pressure_step_kpa.min(greatest);
        let pressures: Values = format!("0:{greatest}:{step}").parse().map_err(Failure::usage)?;
        let pressures = pressures.0.iter().map(|kpa| kpa * KPA).collect();
        let mut sweep = FreeSweep { seed: self.seed, ..FreeSweep::default() };
        sweep.checks = self.checks.unwrap_or(sweep.checks);
        let map = sweep::plan_free(&sweep, rig, free, [angles, moduli, pressures])?;
        Ok(Plan::Free(sweep, map))
    }

    fn plan_module(&self, rig: &Rig, module: &Module) -> Result<Plan, Failure> {
        let mut sweep = ModuleSweep { seed: self.seed, ..ModuleSweep::default() };
        sweep.checks = self.checks.unwrap_or(sweep.checks);
        let nodes = self.nodes.map_or_else(|| sweep::usual_nodes(module.frees.len()), |nodes| nodes as usize);
        let greatest =
            rig.limits.pressure_max.iter().map(|own| self.pressure_max_kpa.map_or(*own, |kpa| kpa * KPA));
        let greatest: Vec<f64> = greatest.collect();
        let map = sweep::plan_module(rig, module, &greatest, nodes, &sweep)?;
        for (free, (wanted, axis)) in greatest.iter().zip(&map.pressures).enumerate() {
            let last = axis.last().copied().unwrap_or(0.0);
            if last < *wanted {
                eprintln!(
                    "FREE {}: mapped to {} kPa instead of {} kPa, nine tenths of its limit pressure",
                    free + 1,
                    short(last / KPA),
                    short(wanted / KPA)
                );
            }
        }
        Ok(Plan::Module(sweep, map))
    }

    /// The map with what an earlier run has left.
    fn resumed(&self, mut map: MapFile) -> Result<MapFile, Failure> {
        let out = self.out.display();
        if !self.out.exists() {
            return match self.resume {
                true => Err(Failure::refused(format!(
                    "{out}: there is no map to resume; leave out --resume to begin one"
                ))),
                false => Ok(map),
            };
        }
        if !self.resume {
            // An unfinished map of this very sweep may hold hours of work; anything else is replaced, as everywhere.
            return match MapFile::read(&self.out) {
                Ok(earlier)
                    if map.difference(&earlier).is_none() && earlier.computed().0 < earlier.computed().1 =>
                {
                    let (computed, nodes) = earlier.computed();
                    Err(Failure::refused(format!(
                        "{out} holds {computed} of {nodes} nodes of this sweep; give --resume to complete it, or remove it"
                    )))
                }
                _ => Ok(map),
            };
        }
        let earlier = MapFile::read(&self.out)?;
        if let Some(what) = map.difference(&earlier) {
            return Err(Failure::refused(format!(
                "{out} is a map of another sweep: {what} differ; give the settings it was begun with, or another --out"
            )));
        }
        map.absorb(earlier).map_err(Failure::refused)?;
        Ok(map)
    }

    fn tell(&self, map: &MapFile, swept: &Swept, seconds: f64, json: bool) {
        let (computed, nodes) = map.computed();
        if json {
            let mut value = map.json();
            value["out"] = json!(self.out);
            value["seconds"] = json!(seconds);
            value["failed"] = json!(swept.failed);
            return output::print_json(&value);
        }
        let missing = match nodes - computed {
            0 => String::new(),
            missing if interrupt::is_asked() => format!(", {missing} left; go on with --resume"),
            missing if self.shard.0 != fe::Shard::WHOLE => format!(", {missing} left to the other parts"),
            missing => format!(", {missing} did not converge"),
        };
        output::print(&format!(
            "{}\n  {computed} of {nodes} nodes in {}{missing}; worst residual {} (relative)\n",
            map.text(&self.out),
            duration(seconds),
            short(map.worst_residual())
        ));
        for failed in swept.failed.iter().take(10) {
            eprintln!("not converged: {failed}");
        }
        if swept.failed.len() > 10 {
            eprintln!("and {} more", swept.failed.len() - 10);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_counted_from_one() {
        assert_eq!("2/4".parse::<Part>().unwrap().0, fe::Shard { index: 1, count: 4 });
        for wrong in ["0/4", "5/4", "1", "a/b", "-1/2", "1/0"] {
            assert!(wrong.parse::<Part>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn angles_and_moduli_are_checked_before_anything_is_computed() {
        assert!(winding_angles("0,20").unwrap_err().contains("0 is not between"));
        assert!(winding_angles("80:10:10").is_err());
        assert_eq!(winding_angles("10:30:10").unwrap().0, [10.0, 20.0, 30.0]);
        assert!(positive_list("0.2,-1").is_err() && positive("-5").is_err() && positive("inf").is_err());
    }
}
