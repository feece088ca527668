//! A reachable set as text, JSON, tables and pictures.

mod boundary;
mod pictures;
mod points;

pub use boundary::areas;
pub use pictures::{Track, pictures, tracks};
pub use points::{Point, points, write_points};

use crate::{
    exit::Exit,
    failure::Failure,
    goal::Steered,
    map_csv::number,
    output,
    table::{Table, short},
};
use actuator::units::{DEG, KPA, MM};
use control::{Bounds, ReachError, ReachSettings, ReachableSet, Surface, scattered_pressures};
use points::CUBIC;
use serde_json::{Value, json};
use std::path::Path;

/// mm^2 in m^2.
const SQUARE: f64 = MM * MM;
/// mm^3 in m^3.
pub const CUBE: f64 = SQUARE * MM;
/// States at scattered pressures with which a set is checked.
const CHECKS: usize = 5000;

/// Least and greatest x, y, z, m.
type Extent = [(f64, f64); 3];

/// An error of the reachable set on its way to the user.
pub fn failure(error: ReachError) -> Failure {
    match error {
        ReachError::Stopped => Failure::interrupted(),
        ReachError::Setting { .. } => Failure::usage(format!("{error}")),
        other => Failure::new(Exit::Refused, other),
    }
}

/// What is told of a reachable set.
pub struct Report {
    name: String,
    bounds: Bounds,
    levels: Vec<(ReachSettings, f64, Extent)>,
    set: ReachableSet,
    surface: Surface,
    tracks: Vec<Track>,
    /// Least, middle and greatest manipulability and condition number of the points.
    manipulability: [f64; 3],
    condition: [f64; 3],
    points: usize,
    missed: usize,
}

/// Least, middle and greatest.
fn spread(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let at = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
    [at(0), at(values.len() / 2), at(values.len().saturating_sub(1))]
}

impl Report {
    /// Of sets computed each finer than the one before.
    pub fn of(
        module: &Steered<'_>,
        bounds: &Bounds,
        points: &[Point],
        levels: &[(ReachSettings, ReachableSet)],
    ) -> Result<Self, Failure> {
        let outside = |error: rom::OutOfDomain| Failure::refused(error.to_string());
        let Some((_, set)) = levels.last() else { return Err(Failure::usage("no fineness is given")) };
        let tip = module.tip();
        let scattered = control::positions(&tip, &scattered_pressures(bounds, CHECKS)).map_err(outside)?;
        let surface = set.surface();
        let tracks = tracks(module.module(), &tip, bounds).map_err(outside)?;
        Ok(Report {
            name: module.name().to_owned(),
            bounds: bounds.clone(),
            levels: levels.iter().map(|(settings, set)| (*settings, set.volume(), set.extent)).collect(),
            set: set.clone(),
            surface,
            tracks,
            manipulability: spread(
                points.iter().map(|point| point.dexterity.manipulability / CUBIC).collect(),
            ),
            condition: spread(points.iter().map(|point| point.dexterity.condition).collect()),
            points: points.len(),
            missed: set.count_missed(scattered.iter()),
        })
    }

    /// Writes everything but the points.
    pub fn write(&self, out: &Path) -> Result<(), Failure> {
        boundary::write(&self.surface, &self.set.sideways, self.bounds.lower.len(), out)?;
        let mut text = "case,part,x_mm,y_mm,z_mm\n".to_owned();
        for track in &self.tracks {
            for (part, at) in &track.positions {
                let [x, y, z] = at.map(|metres| number(metres / MM));
                text += &format!("{},{},{x},{y},{z}\n", track.case.name, number(*part));
            }
        }
        output::save(&out.join("cases.csv"), text.as_bytes())?;
        for (stem, picture) in pictures(&self.set, &self.tracks, &self.name) {
            picture.write(out, &stem)?;
        }
        if !self.set.is_flat() {
            pictures::reach(&self.set.sideways, &self.name).write(out, "workspace-reach")?;
        }
        Ok(())
    }

    /// Change of a number from the set half as fine.
    fn change(&self, of: impl Fn(f64, &Extent) -> f64) -> f64 {
        match &self.levels[..] {
            [.., (_, volume, extent), (_, finer_volume, finer_extent)] => {
                (of(*finer_volume, finer_extent) - of(*volume, extent)).abs()
            }
            _ => f64::NAN,
        }
    }

    fn volume_error(&self) -> f64 {
        self.change(|volume, _| volume)
    }

    fn extent_error(&self, axis: usize) -> f64 {
        self.change(|_, extent| extent[axis].0).max(self.change(|_, extent| extent[axis].1))
    }

    /// Least and greatest reach sideways, m.
    fn reach(&self) -> Option<(f64, f64)> {
        let reaches = self.set.sideways.reaches().map(|(_, reach)| reach.map_or(0.0, |(reach, _)| reach));
        let ends = reaches.fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
        (!self.set.is_flat()).then_some(ends)
    }

    fn frees(&self) -> usize {
        self.bounds.lower.len()
    }

    /// In words and tables.
    pub fn text(&self, out: &Path) -> String {
        let kpa = |values: &[f64]| values.iter().map(|p| short(p / KPA)).collect::<Vec<_>>().join(", ");
        let mut text = format!(
            "Reachable set of {} between pressures of {} and {} kPa, simulated\n\n",
            self.name,
            kpa(&self.bounds.lower),
            kpa(&self.bounds.upper)
        );
        let mut table = Table::new(["<", "least (mm)", "greatest (mm)", "change at half the fineness (mm)"]);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let (low, high) = self.set.extent[axis];
            let error = short(self.extent_error(axis) / MM);
            table.row([name.into(), format!("{:.2}", low / MM), format!("{:.2}", high / MM), error]);
        }
        text += &table.text();
        if self.set.is_flat() {
            text += "\n  The set is flat and has no volume: fewer than three FREEs move it, or its tip is guided.\n";
            return text + &format!("\n{} points in {}\n", self.points, out.display());
        }
        text += "\n";
        let mut table = Table::new(["steps a pressure", "cells", "volume (cm³)"]);
        for (settings, volume, _) in &self.levels {
            let volume = format!("{:.4}", volume / CUBE / 1e3);
            table.row([settings.steps.to_string(), settings.cells.to_string(), volume]);
        }
        text += &table.text();
        text += &format!(
            "\n  volume                 {:.3} cm³, ± {} by the last doubling\n",
            self.set.volume() / CUBE / 1e3,
            short(self.volume_error() / CUBE / 1e3)
        );
        if let Some((low, high)) = self.reach() {
            text +=
                &format!("  sideways reach         {:.2} to {:.2} mm, by direction\n", low / MM, high / MM);
        }
        let areas = areas(&self.surface, self.frees());
        let all: f64 = areas.iter().map(|(_, area)| area).sum();
        let inner: f64 = areas.iter().filter(|(free, _)| *free > 2).map(|(_, area)| area).sum();
        text += &format!(
            "  boundary               {:.1} cm², {:.1} % of it from pressures between their limits, where the map is singular\n",
            all / SQUARE / 100.0,
            100.0 * inner / all
        );
        let [least, middle, greatest] = self.manipulability.map(short);
        text += &format!("  manipulability         {least} to {greatest} mm³/kPa³, middle {middle}\n");
        let [least, middle, _] = self.condition.map(short);
        text += &format!("  condition number       from {least}, middle {middle}\n");
        text += &format!(
            "  check                  {} of {CHECKS} poses at scattered pressures lie more than a cell outside\n",
            self.missed
        );
        text + &format!("\n{} points, boundary and pictures in {}\n", self.points, out.display())
    }

    /// For programs.
    pub fn json(&self, out: &Path) -> Value {
        let pair = |(low, high): (f64, f64), unit: f64| json!([low / unit, high / unit]);
        let axis = |axis: usize| json!({ "mm": pair(self.set.extent[axis], MM), "change_mm": self.extent_error(axis) / MM });
        let bounds = self.bounds.lower.iter().zip(&self.bounds.upper);
        let spread = |[least, middle, greatest]: [f64; 3]| {
            // JSON has no infinity: null where a direction cannot be gone.
            let finite = |value: f64| Some(value).filter(|value| value.is_finite());
            json!({ "least": finite(least), "median": finite(middle), "greatest": finite(greatest) })
        };
        let levels = self.levels.iter().map(|(settings, volume, _)| {
            json!({ "steps": settings.steps, "cells": settings.cells, "volume_mm3": volume / CUBE })
        });
        let sideways = self.set.sideways.reaches().map(|(direction, reach)| {
            json!({
                "direction_deg": direction / DEG,
                "reach_mm": reach.map(|(reach, _)| reach / MM), "z_mm": reach.map(|(_, z)| z / MM),
            })
        });
        let areas = areas(&self.surface, self.frees());
        let areas = areas
            .into_iter()
            .map(|(free, area)| json!({ "free_pressures": free, "area_mm2": area / SQUARE }));
        json!({
            "name": self.name, "simulated": true, "out": out,
            "bounds_kpa": bounds.map(|(low, high)| pair((*low, *high), KPA)).collect::<Vec<_>>(),
            "flat": self.set.is_flat(),
            "extent": { "x": axis(0), "y": axis(1), "z": axis(2) },
            "volume_mm3": self.set.volume() / CUBE, "volume_error_mm3": self.volume_error() / CUBE,
            "levels": levels.collect::<Vec<_>>(), "spacing_mm": self.set.spacing.map(|spacing| spacing / MM),
            "boundary": areas.collect::<Vec<_>>(), "reach": sideways.collect::<Vec<_>>(),
            "points": self.points,
            "manipulability_mm3_per_kpa3": spread(self.manipulability), "condition_number": spread(self.condition),
            "check": { "states": CHECKS, "outside": self.missed },
        })
    }
}
