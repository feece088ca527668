use crate::{
    axis::Axis,
    content::Content,
    elements::Elements,
    exit::Exit,
    failure::{Failure, Outcome},
    interrupt,
    lasting::Lasting,
    map_file::MapFile,
    output,
    part::Part,
    plan::Plan,
    refinement::{self, Next},
    sweep::{self, Swept},
    table::{duration, short},
    values::{Values, positive, positive_list, ratio, share, winding_angles},
};
use actuator::{
    Description, FreeParameter, MapAxis, Module, Rig,
    units::{KPA, MM},
};
use fe::{
    CappedSweep, FreeSweep, FreeSweepError, ModuleSweep, PathError, Shard, SolidError, SolidModuleSettings,
    SolidSweep,
};
use serde_json::json;
use std::{path::PathBuf, time::Instant};

/// Compute a pressure-to-deformation map by finite elements
///
/// Of a FREE: stretch, expansion and twist over winding angle, shear modulus and pressure, each path followed to its limit
/// pressure, above which there is no equilibrium. Of a module: tip poses over the pressures of its FREEs.
///
/// --fidelity solid computes a FREE as a whole tube between its caps, in seconds a path: stretch and twist are then from
/// cap to cap, those of the middle stand beside them, and a path ends at --pressure-max-kpa if it meets no limit before.
/// Its states as files for ParaView are written by `freeact inspect M.map --vtu DIR`. Of a module without spacers it takes every FREE as
/// a whole tube between the plates, in seconds a state and half a gigabyte a thread; a map of rods is otherwise the same.
///
/// --caps corrects the sections for rigid caps at the FREE's length by the end extension and end twist of a few solids: states are then
/// from cap to cap as a solid's are. Their limit pressure stays the section's; that of a FREE between caps is higher.
///
/// Finished points are kept as they come in M.map.points, until the map is there: after Ctrl-C or a kill, --resume goes on from
/// them. --shard computes a part, for several machines; `freeact merge` joins the parts.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  freeact map --of data/actuators/buffinton-2020.toml --out paper.map --winding-angles 10:80:10 --shear-moduli-mpa 0.2,0.393,0.6
  freeact map --of data/actuators/buffinton-2020.toml --out solid.map --fidelity solid --winding-angles 20:60:10
  freeact map --of data/actuators/buffinton-2020.toml --out capped.map --caps --winding-angles 20:60:10
  freeact map --of data/actuators/buffinton-2020.toml --out walls.map --axis wall_mm=0.6:1.0:0.1 --axis fibres=4,6,8
  freeact map --of data/modules/buffinton-2020-30lr.toml --out module.map --nodes 7
  freeact map --of bundle.toml --out bundle.map --fidelity solid --nodes 4
  freeact map --of data/modules/buffinton-2020-30lr.toml --out part.1.map --shard 1/4
  freeact map --of data/actuators/buffinton-2020.toml --out finer.map --store lab/points --winding-angles 10:80:5")]
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

    /// A further axis of a FREE's map, by its name in files, as in wall_mm=0.6:1.0:0.2; may be given several times. There are wall_mm,
    /// inner_diameter_mm, alpha (of an Ogden rubber), fibres, fibre_ea_newton, fibre_diameter_mm, axial_force_n and torque_nmm
    #[arg(long, value_name = "NAME=VALUES")]
    axis: Vec<Axis>,

    /// Greatest pressure (default: 70 for a FREE, the description's pressure_max_kpa for a module)
    #[arg(long, value_name = "KPA", value_parser = positive, allow_hyphen_values = true)]
    pressure_max_kpa: Option<f64>,

    /// Step between the pressures of a FREE's map (default: 1 for the section, 5 for a solid)
    #[arg(long, value_name = "KPA", value_parser = positive, allow_hyphen_values = true)]
    pressure_step_kpa: Option<f64>,

    /// Put further states of a section wherever a cubic through four neighbouring ones misses by more than this share of the greatest
    /// change along the path (default: 1e-5)
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    interpolation_tolerance: Option<f64>,

    /// Follow a section past its limit pressure as well, up to this multiple of the volume enclosed there; such states are marked
    /// unstable, and no fit takes them
    #[arg(long, value_name = "RATIO", value_parser = ratio, allow_hyphen_values = true)]
    beyond_limit: Option<f64>,

    /// Pressures per FREE of a module's map (default: as many as make about 2500 nodes)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=1000))]
    nodes: Option<u64>,

    /// Take as many pressures per FREE as a fit needs to be this good: 95 % of the states for checks within so many millimetres
    #[arg(long, value_name = "MM", value_parser = positive, allow_hyphen_values = true, conflicts_with = "nodes")]
    fit_error_mm: Option<f64>,

    /// Compute every node of a module's map, also those that its symmetry makes of others
    #[arg(long)]
    no_symmetry: bool,

    /// Paths (FREE) or states (module) between the nodes that a fit will be judged by (2 for solids)
    #[arg(long, value_name = "N")]
    checks: Option<usize>,

    /// Chooses where those lie
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// What computes the states (default: section for a FREE, rod for a module)
    #[arg(long, value_enum)]
    fidelity: Option<Fidelity>,

    /// Correct sections for the rigid caps of a FREE of the description's length (FREE, --fidelity section)
    #[arg(long)]
    caps: bool,

    /// Elements of a solid, of each FREE in a module of solids, or of the solids that --caps takes, 18 outer radii long, through the wall, around and along the tube (default: 2, four for each fibre, and as many along as keep
    /// them well shaped; in a module 1, two for each fibre)
    #[arg(long, value_name = "RADIAL,AROUND,ALONG")]
    elements: Option<Elements>,

    /// Compute part i of n only, counted from 1
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Part,

    /// Threads (default: one per processor)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=4096))]
    jobs: Option<u64>,

    /// Complete what an earlier run with this --out has left
    #[arg(long)]
    resume: bool,

    /// Keep finished points in this folder for good and take those that are there, whichever map they were computed for; several
    /// runs may share it at once (default: the name of --out and .points, until the map is complete)
    #[arg(long, value_name = "DIR")]
    store: Option<PathBuf>,
}

/// What computes the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Fidelity {
    /// The cross-section far from the caps, with discrete fibres
    Section,
    /// A solid model of whole tubes with their caps or plates
    Solid,
    /// Rods that bend, stretch and twist between rigid plates
    Rod,
}

impl Map {
    pub fn run(self, json: bool) -> Outcome {
        let rig = Rig::read(&self.of)?;
        let plan = self.plan(&rig)?;
        let start = Instant::now();
        let jobs = self.jobs.map_or_else(sweep::processors, |jobs| jobs as usize);
        let lasting = Lasting { out: &self.out, store: self.store.as_deref(), resume: self.resume };
        let (mut map, mut swept) = lasting.complete(plan, self.shard.0, jobs)?;
        if let (Some(error), Description::Module(module)) = (self.fit_error_mm, &rig.description) {
            while let Some(plan) = self.refined(&rig, module, &map, error * MM)? {
                let (finer, more) = lasting.complete(plan, self.shard.0, jobs)?;
                map = finer;
                swept = Swept {
                    found: swept.found + more.found,
                    computed: swept.computed + more.computed,
                    ..more
                };
            }
        }
        self.tell(&map, &swept, start.elapsed().as_secs_f64(), json);
        Ok(match map.computed() {
            _ if interrupt::is_asked() => Exit::Interrupted,
            _ if !swept.failed.is_empty() => Exit::NotConverged,
            _ => Exit::Done,
        })
    }

    fn plan(&self, rig: &Rig) -> Result<Plan, Failure> {
        let usage = |message: &str| Err(Failure::usage(format!("{}: {message}", self.of.display())));
        let is_section =
            matches!(rig.description, Description::Free(_)) && self.fidelity != Some(Fidelity::Solid);
        let of_sections = self.interpolation_tolerance.or(self.beyond_limit);
        match (&rig.description, self.fidelity) {
            _ if of_sections.is_some() && !is_section => usage(
                "--interpolation-tolerance and --beyond-limit are for the sections of single FREEs; leave them out",
            ),
            (Description::Free(_), Some(Fidelity::Rod)) => usage(
                "--fidelity rod is for modules; a single FREE's map is made by --fidelity section or solid",
            ),
            (Description::Module(_), Some(Fidelity::Section)) => usage(
                "--fidelity section is for single FREEs; a module's map is made by --fidelity rod or solid",
            ),
            (Description::Free(_), _) if self.no_symmetry => {
                usage("--no-symmetry is for modules; leave it out")
            }
            (Description::Free(_), _) if self.fit_error_mm.is_some() => {
                usage("--fit-error-mm is for modules; leave it out")
            }
            _ if self.fit_error_mm.is_some() && (self.shard.0 != Shard::WHOLE || self.resume) => usage(
                "--fit-error-mm makes several maps, each from the errors of the one before: leave out --shard and --resume, and name \
                 a --store to keep finished points of all",
            ),
            (Description::Free(_), _) if self.nodes.is_some() => {
                usage("--nodes is for modules; a FREE's pressures are set by --pressure-step-kpa")
            }
            (Description::Module(_), _) if self.caps => {
                usage("--caps is for single FREEs; the FREEs of a module's map are rods without end effects")
            }
            (_, Some(Fidelity::Solid)) if self.caps => usage(
                "--caps is for sections; a solid has its caps: leave one of --caps and --fidelity solid out",
            ),
            (_, fidelity) if self.elements.is_some() && !self.caps && fidelity != Some(Fidelity::Solid) => {
                usage("--elements is for solids; give --fidelity solid or --caps with it, or leave it out")
            }
            (Description::Free(_), Some(Fidelity::Solid)) => self.plan_solid(rig),
            (Description::Free(_), _) if self.caps => self.plan_capped(rig),
            (Description::Free(_), _) => self.plan_free(rig),
            (Description::Module(_), _)
                if self.winding_angles.is_some() || self.shear_moduli_mpa.is_some() =>
            {
                usage(
                    "--winding-angles and --shear-moduli-mpa are for single FREEs; a module has those of its description",
                )
            }
            (Description::Module(module), _) => {
                let usual = match self.fit_error_mm {
                    Some(_) => refinement::FIRST,
                    None => sweep::usual_nodes(module.frees.len()),
                };
                let nodes = self.nodes.map_or(usual, |nodes| nodes as usize);
                self.plan_module(rig, module, &vec![nodes; module.frees.len()])
            }
        }
    }

    fn plan_free(&self, rig: &Rig) -> Result<Plan, Failure> {
        let usual = FreeSweep::default();
        let mut sweep = FreeSweep {
            seed: self.seed,
            interpolation_tolerance: self.interpolation_tolerance.or(usual.interpolation_tolerance),
            beyond_limit: self.beyond_limit,
            ..usual
        };
        sweep.checks = self.checks.unwrap_or(sweep.checks);
        let map = sweep::plan_free(&sweep, rig, self.axes()?, self.pressures(1.0)?)?;
        Ok(Plan::Section(sweep, map))
    }

    fn plan_capped(&self, rig: &Rig) -> Result<Plan, Failure> {
        let mut sweep = CappedSweep::default();
        (sweep.solid.elements, sweep.section.seed) = (self.elements.map(|elements| elements.0), self.seed);
        sweep.section.checks = self.checks.unwrap_or(sweep.section.checks);
        let source = (rig.name.clone(), rig.text.clone());
        let planned = sweep.empty_map(rig.frees()[0].into(), self.axes()?, self.pressures(1.0)?, source);
        Ok(Plan::Capped(sweep, planned.map_err(|error| self.unplanned_solid(error, rig))?))
    }

    fn plan_solid(&self, rig: &Rig) -> Result<Plan, Failure> {
        let mut sweep = SolidSweep {
            elements: self.elements.map(|elements| elements.0),
            seed: self.seed,
            ..SolidSweep::default()
        };
        sweep.checks = self.checks.unwrap_or(sweep.checks);
        let source = (rig.name.clone(), rig.text.clone());
        let planned = sweep.empty_map(rig.frees()[0].into(), self.axes()?, self.pressures(5.0)?, source);
        Ok(Plan::Solid(sweep, planned.map_err(|error| self.unplanned_solid(error, rig))?))
    }

    /// Why a sweep with solids cannot be begun. Of a mesh that was given the command line is at fault, not the description.
    fn unplanned_solid(&self, error: FreeSweepError, rig: &Rig) -> Failure {
        match &error {
            FreeSweepError::Free { source: PathError::Solid(SolidError::Invalid { field, .. }), .. }
                if self.elements.is_some() && field.contains("elements") =>
            {
                Failure::usage(format!("--elements: {error}"))
            }
            _ => sweep::unplanned(error, rig),
        }
    }

    /// The axes asked for (SI).
    fn axes(&self) -> Result<Vec<MapAxis>, Failure> {
        let own = [
            (FreeParameter::WindingAngle, &self.winding_angles),
            (FreeParameter::ShearModulus, &self.shear_moduli_mpa),
        ];
        let own = own
            .into_iter()
            .filter_map(|(parameter, values)| Some(Axis { parameter, values: values.as_ref()?.clone() }));
        let axes: Vec<Axis> = own.chain(self.axis.iter().cloned()).collect();
        axes.iter().map(|axis| axis.rising().map_err(Failure::usage)).collect()
    }

    /// Pressures of a FREE's map, Pa; their `usual_step` is in kPa.
    fn pressures(&self, usual_step: f64) -> Result<Vec<f64>, Failure> {
        let greatest = self.pressure_max_kpa.unwrap_or(70.0);
        let step = self.pressure_step_kpa.unwrap_or(usual_step).min(greatest);
        let pressures: Values = format!("0:{greatest}:{step}").parse().map_err(Failure::usage)?;
        Ok(pressures.0.iter().map(|kpa| kpa * KPA).collect())
    }

    /// The finer map that comes after one; `None` where its fit errs by no more than `error` (m), or a finer one would be too large.
    fn refined(
        &self,
        rig: &Rig,
        module: &Module,
        map: &MapFile,
        error: f64,
    ) -> Result<Option<Plan>, Failure> {
        let (MapFile::Module(map), false) = (map, interrupt::is_asked()) else { return Ok(None) };
        let next = refinement::judge(map, error).map_err(|failure| failure.about(&self.out))?;
        let (Next::Enough(found) | Next::Refine(found, _) | Next::TooMany(found)) = next;
        eprintln!("{}", refinement::told(map, found, error));
        match next {
            Next::Enough(_) => Ok(None),
            Next::Refine(_, counts) => self.plan_module(rig, module, &counts).map(Some),
            Next::TooMany(_) => {
                eprintln!("a finer map would have too many nodes; this one is kept");
                Ok(None)
            }
        }
    }

    fn plan_module(&self, rig: &Rig, module: &Module, nodes: &[usize]) -> Result<Plan, Failure> {
        let mut sweep =
            ModuleSweep { seed: self.seed, use_symmetry: !self.no_symmetry, ..ModuleSweep::default() };
        if self.fidelity == Some(Fidelity::Solid) {
            let elements = self.elements.map(|elements| elements.0);
            sweep.solids = Some(SolidModuleSettings { elements, ..SolidModuleSettings::default() });
        }
        sweep.checks = self.checks.unwrap_or(sweep.checks);
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

    fn tell(&self, map: &MapFile, swept: &Swept, seconds: f64, json: bool) {
        let (computed, nodes) = map.computed();
        if json {
            let mut value = map.json();
            value["out"] = json!(self.out);
            value["seconds"] = json!(seconds);
            value["points_found"] = json!(swept.found);
            value["points_computed"] = json!(swept.computed);
            value["failed"] = json!(swept.failed);
            if let Some(caps) = swept.caps {
                value["end_effects"] =
                    json!({ "computed": caps.end_effects, "difference_between_moduli": caps.difference });
            }
            return output::print_json(&value);
        }
        let missing = match nodes - computed {
            0 => String::new(),
            missing if interrupt::is_asked() => format!(", {missing} left; go on with --resume"),
            missing if self.shard.0 != fe::Shard::WHOLE => format!(", {missing} left to the other parts"),
            missing => format!(", {missing} did not converge"),
        };
        let before = match (swept.found, &map) {
            (0, _) => String::new(),
            (found, MapFile::Free(_)) => format!(" ({found} paths were there before)"),
            (found, MapFile::Module(_)) => format!(" ({found} rows were there before)"),
        };
        output::print(&format!(
            "{}\n  {computed} of {nodes} nodes in {}{before}{missing}; worst residual {} (relative)\n",
            map.text(&self.out),
            duration(seconds),
            short(map.worst_residual())
        ));
        if let Some(caps) = swept.caps {
            output::print(&format!(
                "  end effects from {} solids; those of the first and the last shear modulus differ by up to {} % of the greatest\n",
                caps.end_effects,
                short(100.0 * caps.difference)
            ));
        }
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
    fn angles_and_moduli_are_checked_before_anything_is_computed() {
        assert!(winding_angles("0,20").unwrap_err().contains("0 is not between"));
        assert!(winding_angles("80:10:10").is_err());
        assert_eq!(winding_angles("10:30:10").unwrap().0, [10.0, 20.0, 30.0]);
        assert!(share("1e-5") == Ok(1e-5) && share("0").is_err() && share("nan").is_err());
        assert!(ratio("1.5") == Ok(1.5) && ratio("1").is_err() && ratio("inf").is_err());
        assert!(positive_list("0.2,-1").is_err() && positive("-5").is_err() && positive("inf").is_err());
    }
}
