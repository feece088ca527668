use super::Content;
use crate::{
    columns::Columns,
    plot::Picture,
    table::{Table, short},
};
use actuator::{Description, Elastomer, FibreLaw, Handedness, OgdenForm, Rig, units::*};
use serde_json::json;
use std::path::Path;

impl Content for Rig {
    fn text(&self, path: &Path) -> String {
        let kind = match &self.description {
            Description::Free(_) => "a single FREE".to_owned(),
            Description::Module(module) => format!("a module of {} FREEs", module.frees.len()),
        };
        let mut text = format!("{}: \"{}\", {kind}\n\n", path.display(), self.name);
        let mut table = Table::new([
            "FREE",
            "x (mm)",
            "y (mm)",
            "length (mm)",
            "inner dia. (mm)",
            "wall (mm)",
            "winding (° from hoop)",
            "<hand",
            "fibres",
            "EA (N)",
            "<fibres carry",
            "<rubber",
            "pressure max (kPa)",
        ]);
        for (i, free) in self.frees().iter().enumerate() {
            let position = match &self.description {
                Description::Free(_) => [0.0; 2],
                Description::Module(module) => module.frees[i].position,
            };
            table.row([
                (i + 1).to_string(),
                short(position[0] / MM),
                short(position[1] / MM),
                short(free.tube.length / MM),
                short(2.0 * free.tube.inner_radius / MM),
                short(free.tube.wall / MM),
                short(free.winding.angle_from_hoop() / DEG),
                hand(free.winding.handedness).into(),
                free.winding.fibres.to_string(),
                short(free.winding.fibre.axial_stiffness),
                law(free.winding.fibre.law).into(),
                rubber(&free.elastomer),
                short(self.limits.pressure_max[i] / KPA),
            ]);
        }
        text += &table.text();
        text += &format!(
            "\n  pressure rate at most {} kPa/s, idle pressure {} kPa\n",
            short(self.limits.pressure_rate / KPA),
            short(self.limits.idle_pressure / KPA)
        );
        if let Description::Module(module) = &self.description {
            let names = ["x", "y", "z", "rx", "ry", "rz"].iter().zip(module.tip.free_dof);
            let moving: Vec<&str> = names.filter(|(_, free)| *free).map(|(name, _)| *name).collect();
            let [gx, gy, gz] = module.base.gravity;
            text += &match module.spacers {
                0 => "  no spacers: each FREE goes its own way from plate to plate\n".to_owned(),
                spacers => format!("  {spacers} rigid spacers tie the FREEs together between the plates\n"),
            };
            text += &format!(
                "  tip plate {} g, payload {} g, free to move in {}; each FREE {} g; gravity along ({gx}, {gy}, {gz})\n",
                short(module.tip.plate_mass / GRAM),
                short(module.tip.payload / GRAM),
                moving.join(", "),
                short(module.base.free_mass / GRAM),
            );
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let frees = self.frees();
        let free = |(i, free): (usize, &actuator::Free)| {
            json!({
                "length_mm": free.tube.length / MM,
                "inner_diameter_mm": 2.0 * free.tube.inner_radius / MM,
                "wall_mm": free.tube.wall / MM,
                "winding_angle_deg": free.winding.angle_from_hoop() / DEG,
                "handedness": hand(free.winding.handedness),
                "fibres": free.winding.fibres,
                "fibre_ea_newton": free.winding.fibre.axial_stiffness,
                "shear_modulus_mpa": free.elastomer.shear_modulus() / MPA,
                "pressure_max_kpa": self.limits.pressure_max[i] / KPA,
            })
        };
        let kind = if matches!(self.description, Description::Free(_)) { "free" } else { "module" };
        let spacers = match &self.description {
            Description::Free(_) => None,
            Description::Module(module) => Some(module.spacers),
        };
        json!({
            "spacers": spacers,
            "content": "description", "kind": kind, "name": self.name,
            "frees": frees.iter().enumerate().map(free).collect::<Vec<_>>(),
            "pressure_rate_kpa_s": self.limits.pressure_rate / KPA,
            "idle_pressure_kpa": self.limits.idle_pressure / KPA,
        })
    }

    fn columns(&self) -> Option<Columns> {
        None
    }

    fn charts(&self) -> Vec<(String, Picture)> {
        Vec::new()
    }
}

fn hand(handedness: Handedness) -> &'static str {
    match handedness {
        Handedness::Right => "right",
        Handedness::Left => "left",
    }
}

fn law(law: FibreLaw) -> &'static str {
    match law {
        FibreLaw::Linear => "tension and compression",
        FibreLaw::TensionOnly => "tension only",
    }
}

fn rubber(elastomer: &Elastomer) -> String {
    let mpa = |value: f64| short(value / MPA);
    let mu = mpa(elastomer.shear_modulus());
    match elastomer {
        Elastomer::NeoHookean { .. } => format!("neo-Hookean, µ {mu} MPa"),
        Elastomer::Ogden { alpha, form: OgdenForm::InitialModulus, .. } => {
            format!("Ogden, µ {mu} MPa, α {alpha}")
        }
        Elastomer::Ogden { alpha, form: OgdenForm::Printed, .. } => {
            format!("Ogden as printed (2µ/α), µ {mu} MPa, α {alpha}")
        }
        Elastomer::OgdenSeries { terms } => {
            let terms = terms.as_slice().iter();
            let each =
                terms.map(|term| format!("{} MPa at α {}", mpa(term.shear_modulus), short(term.alpha)));
            format!("Ogden, µ {mu} MPa = {}", each.collect::<Vec<_>>().join(" + "))
        }
        Elastomer::MooneyRivlin { c10, c01 } => {
            format!("Mooney-Rivlin, c10 {}, c01 {} MPa (µ {mu} MPa)", mpa(*c10), mpa(*c01))
        }
        Elastomer::Yeoh { c10, c20, c30 } => {
            format!("Yeoh, c10 {}, c20 {}, c30 {} MPa (µ {mu} MPa)", mpa(*c10), mpa(*c20), mpa(*c30))
        }
        Elastomer::Gent { locking_invariant, .. } => {
            format!("Gent, µ {mu} MPa, Jm {}", short(*locking_invariant))
        }
        Elastomer::ArrudaBoyce { locking_stretch, .. } => {
            format!("Arruda-Boyce, µ {mu} MPa, locking at {}", short(*locking_stretch))
        }
        Elastomer::StVenantKirchhoff { .. } => format!("St Venant-Kirchhoff, µ {mu} MPa"),
        Elastomer::LinearElastic { .. } => format!("linear elastic, µ {mu} MPa"),
    }
}
