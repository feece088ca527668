use super::Content;
use crate::{
    columns::Columns,
    plot::Picture,
    table::{Table, short},
};
use actuator::units::{DEG, KPA, MM, MPA};
use rom::{ErrorStatistics, FreeModel, Model, ModelContent, ModuleModel, PoseModel};
use serde_json::{Value, json};
use std::path::Path;

impl Content for Model {
    fn text(&self, path: &Path) -> String {
        let kind = if self.as_free().is_some() { "FREE" } else { "module" };
        let mut text = format!(
            "{}: model of the {kind} \"{}\"\n  {}\n  map {}..., fitted by freeact {}\n\n",
            path.display(),
            self.provenance.description_name,
            self.provenance.settings,
            self.provenance.map_hash.get(..12).unwrap_or_default(),
            self.provenance.program_version
        );
        text += &match &self.content {
            ModelContent::Free(free) => free_text(free),
            ModelContent::Module(module) => module_text(module),
        };
        if self.effects.effects.is_empty() {
            return text + "\n  no effects beyond the finite elements\n";
        }
        text += "\nEffects beyond the finite elements\n\n";
        let mut table = Table::new(["<effect", "<acts on", "<FREEs", "<parameters"]);
        for effect in &self.effects.effects {
            let numbers = effect.kind.parameters().iter().zip(&effect.values);
            let numbers: Vec<String> =
                numbers.map(|(p, value)| format!("{} = {}", p.name, short(p.in_unit(*value)))).collect();
            table.row([
                effect.kind.name().into(),
                link(effect.kind.link()).into(),
                if effect.frees.is_empty() { "all".into() } else { free_numbers(&effect.frees) },
                numbers.join(", "),
            ]);
        }
        text + &table.text()
    }

    fn json(&self) -> Value {
        let effect = |effect: &rom::effect::Effect| {
            let numbers = effect.kind.parameters().iter().zip(&effect.values);
            let numbers: serde_json::Map<String, Value> =
                numbers.map(|(p, value)| (p.name.to_owned(), json!(p.in_unit(*value)))).collect();
            let frees: Vec<usize> = effect.frees.iter().map(|free| free + 1).collect();
            json!({ "name": effect.kind.name(), "link": effect.kind.link(), "frees": frees, "parameters": numbers })
        };
        let mut value = match &self.content {
            ModelContent::Free(free) => free_json(free),
            ModelContent::Module(module) => module_json(module),
        };
        value["content"] = json!("model");
        value["name"] = json!(self.provenance.description_name);
        value["settings"] = json!(self.provenance.settings);
        value["map_hash"] = json!(self.provenance.map_hash);
        value["program_version"] = json!(self.provenance.program_version);
        value["effects"] = self.effects.effects.iter().map(effect).collect();
        value
    }

    fn columns(&self) -> Option<Columns> {
        None
    }

    fn charts(&self) -> Vec<(String, Picture)> {
        Vec::new()
    }
}

/// Numbers of FREEs as people count them, from one.
pub fn free_numbers(frees: &[usize]) -> String {
    frees.iter().map(|free| (free + 1).to_string()).collect::<Vec<_>>().join(", ")
}

/// A link of the chain from command to pose read, in words.
pub fn link(link: rom::effect::Link) -> &'static str {
    match link {
        rom::effect::Link::Supply => "supply (command to pressure)",
        rom::effect::Link::Sensing => "sensing (pressure to pressure read)",
        rom::effect::Link::Mechanics => "mechanics (pressure to pose)",
        rom::effect::Link::Reading => "reading (pose to pose read)",
    }
}

const ERROR_HEAD: [&str; 5] = ["<error on states never fitted", "states", "rms", "95 % below", "worst"];

fn error_row(what: &str, errors: &ErrorStatistics, unit: f64) -> [String; 5] {
    let number = |value: f64| if errors.count == 0 { "–".into() } else { short(value / unit) };
    [what.into(), errors.count.to_string(), number(errors.rms), number(errors.p95), number(errors.worst)]
}

fn error_json(errors: &ErrorStatistics, unit: f64) -> Value {
    json!({ "states": errors.count, "rms": errors.rms / unit, "p95": errors.p95 / unit, "worst": errors.worst / unit })
}

fn free_text(free: &FreeModel) -> String {
    let errors = free.errors();
    let mut table = Table::new(ERROR_HEAD);
    for (where_, set) in
        [("", &errors.held_out), (", below 0.9 of the limit", &errors.held_out_below_nine_tenths)]
    {
        table.row(error_row(&format!("axial stretch{where_}"), &set.axial_stretch, 1.0));
        table.row(error_row(&format!("expansion b/B{where_}"), &set.expansion, 1.0));
        table.row(error_row(
            &format!("twist, % of its path's greatest{where_}"),
            &set.twist_per_length,
            0.01,
        ));
    }
    table.row(error_row("limit pressure, %", &errors.limit_pressure, 0.01));
    let span = |nodes: &[f64], unit: f64| match nodes {
        [one] => short(one / unit),
        nodes => {
            let (first, last) = (nodes.first().copied().unwrap_or(0.0), nodes.last().copied().unwrap_or(0.0));
            format!("{} to {}", short(first / unit), short(last / unit))
        }
    };
    let mut text = format!(
        "  winding angle {}° from the hoop, shear modulus {} MPa, pressure up to 98 % of the limit\n\n{}",
        span(free.winding_angles(), DEG),
        span(free.shear_moduli(), MPA),
        table.text()
    );
    let held = free.bar_coverage();
    if held.states > 0 {
        let share = |count: usize| short(100.0 * count as f64 / held.states as f64);
        text += &format!(
            "\n  error bars, set to hold 95 %: hold for {} % of stretches, {} % of expansions and {} % of twists of {} states that did not set them\n",
            share(held.axial_stretch),
            share(held.expansion),
            share(held.twist_per_length),
            held.states
        );
    }
    text
}

fn free_json(free: &FreeModel) -> Value {
    let errors = free.errors();
    let set = |set: &rom::DeformationErrors| {
        json!({
            "axial_stretch": error_json(&set.axial_stretch, 1.0),
            "expansion": error_json(&set.expansion, 1.0),
            "twist_relative": error_json(&set.twist_per_length, 1.0),
        })
    };
    json!({
        "kind": "free",
        "winding_angles_deg": free.winding_angles().iter().map(|angle| angle / DEG).collect::<Vec<_>>(),
        "shear_moduli_mpa": free.shear_moduli().iter().map(|modulus| modulus / MPA).collect::<Vec<_>>(),
        "held_out": set(&errors.held_out),
        "held_out_below_nine_tenths": set(&errors.held_out_below_nine_tenths),
        "limit_pressure_relative": error_json(&errors.limit_pressure, 1.0),
        "outside": errors.outside,
    })
}

fn module_text(module: &ModuleModel) -> String {
    let errors = module.errors();
    let mut domain = Table::new(["FREE", "from (kPa)", "to (kPa)", "limit pressure (kPa)"]);
    for (i, ((lower, upper), limit)) in module.domain().iter().zip(module.limit_pressures()).enumerate() {
        let limit = limit.map_or("none met".into(), |limit| short(limit / KPA));
        domain.row([(i + 1).to_string(), short(lower / KPA), short(upper / KPA), limit]);
    }
    let mut table = Table::new(ERROR_HEAD);
    table.row(error_row("position (mm)", &errors.position, MM));
    table.row(error_row("rotation (°)", &errors.rotation, DEG));
    let mut text = format!("{}\n{}", domain.text(), table.text());
    if errors.bars.states > 0 {
        let share = |held: usize| short(100.0 * held as f64 / errors.bars.states as f64);
        text += &format!(
            "\n  error bars, set to hold 95 %: hold for {} % of positions and {} % of rotations of {} states that did not set them\n",
            share(errors.bars.position),
            share(errors.bars.rotation),
            errors.bars.states
        );
    }
    let unstable = module.unstable_nodes();
    if unstable > 0 {
        text += &format!(
            "\n  {unstable} of {} nodes have no stable state: the domain ends before them\n",
            module.splines().grid().node_count()
        );
    }
    if errors.unstable > 0 {
        text += &format!("  {} states for checks are unstable and were not judged\n", errors.unstable);
    }
    if errors.outside > 0 {
        text +=
            &format!("  {} states for checks lie outside the domain and were not judged\n", errors.outside);
    }
    text
}

fn module_json(module: &ModuleModel) -> Value {
    let errors = module.errors();
    json!({
        "kind": "module",
        "domain_kpa": module.domain().iter().map(|(low, high)| [low / KPA, high / KPA]).collect::<Vec<_>>(),
        "limit_pressures_kpa": module.limit_pressures().iter().map(|p| p.map(|p| p / KPA)).collect::<Vec<_>>(),
        "held_out": { "position_mm": error_json(&errors.position, MM), "rotation_deg": error_json(&errors.rotation, DEG) },
        "outside": errors.outside,
        "unstable_nodes": module.unstable_nodes(),
        "error_bars": { "states": errors.bars.states, "position_held": errors.bars.position,
            "rotation_held": errors.bars.rotation },
    })
}
