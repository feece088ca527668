//! What `blocked` found: a table, JSON, CSV and pictures.

use crate::{
    failure::Failure,
    map_csv::number,
    output,
    plot::{Chart, Mark, Series},
    table::{Table, short},
};
use actuator::{
    ConvexPolygon, TipPose, Wrench,
    units::{KPA, MM},
};
use fe::{BlockedForces, HeldState};
use serde_json::{Value, json};
use std::path::Path;

/// Wrenches at a pose, to be told of.
pub struct Report<'a> {
    name: &'a str,
    pose: &'a TipPose,
    forces: &'a BlockedForces,
    /// Greatest force and greatest moment, N and N m.
    size: [f64; 2],
}

/// Names in files, labels and units (N, N m) of the components of a wrench, in the order of [`Wrench::to_array`].
const COMPONENTS: [(&str, &str, f64); 6] = [
    ("fx_n", "force x (N)", 1.0),
    ("fy_n", "force y (N)", 1.0),
    ("fz_n", "force z (N)", 1.0),
    ("mx_nmm", "moment about x (N mm)", MM),
    ("my_nmm", "moment about y (N mm)", MM),
    ("mz_nmm", "moment about z (N mm)", MM),
];
/// Planes that are drawn: along and about the axis, forces across, moments across.
const PLANES: [([usize; 2], &str); 3] = [([2, 5], "fz-mz"), ([0, 1], "fx-fy"), ([3, 4], "mx-my")];
/// More FREEs than these have too many corners to list.
const MOST_CORNERS: usize = 12;
/// A set thinner than this share of the greatest force, or moment, is not drawn.
const FLAT: f64 = 1e-4;
/// Values below this share of the greatest force, or moment, are rounding of what is zero by symmetry.
const ROUNDING: f64 = 1e-9;

/// In the units of files.
fn scaled(wrench: Wrench) -> [f64; 6] {
    let values = wrench.to_array();
    std::array::from_fn(|k| values[k] / COMPONENTS[k].2)
}

fn named(wrench: Wrench) -> Value {
    let pairs =
        COMPONENTS.iter().zip(scaled(wrench)).map(|((name, ..), value)| ((*name).to_owned(), json!(value)));
    Value::Object(pairs.collect())
}

/// Points of a plane in the units of files.
fn in_plane(points: impl Iterator<Item = [f64; 2]>, plane: [usize; 2]) -> Vec<[f64; 2]> {
    points.map(|point| [0, 1].map(|i| point[i] / COMPONENTS[plane[i]].2)).collect()
}

/// Vertices of a set in the units of files.
fn vertices(set: &ConvexPolygon, plane: [usize; 2]) -> Vec<[f64; 2]> {
    in_plane(set.vertices.iter().copied(), plane)
}

/// Outline of a set as a line, in the units of files.
fn outline(set: &ConvexPolygon, plane: [usize; 2]) -> Vec<(f64, f64)> {
    in_plane(set.closed(), plane).into_iter().map(Into::into).collect()
}

fn status(state: &Option<HeldState>) -> &'static str {
    match state {
        None => "not found",
        Some(HeldState { negative_pivots: None, .. }) => "section",
        Some(state) if state.is_unstable() => "unstable",
        Some(_) => "stable",
    }
}

impl<'a> Report<'a> {
    pub fn new(name: &'a str, pose: &'a TipPose, forces: &'a BlockedForces) -> Self {
        let all = forces.states.iter().flatten().map(|state| state.wrench.to_array());
        let size = all.fold([0.0f64; 2], |[force, moment], values| {
            let most = |from: usize| values[from..from + 3].iter().fold(0.0f64, |most, v| most.max(v.abs()));
            [force.max(most(0)), moment.max(most(3))]
        });
        Report { name, pose, forces, size }
    }

    /// Writes the table, the JSON and the pictures; their names.
    pub fn write(&self, directory: &Path) -> Result<Vec<String>, Failure> {
        let mut files = vec!["wrenches.csv".to_owned(), "blocked.json".to_owned()];
        output::save(&directory.join(&files[0]), self.csv().as_bytes())?;
        for (plane, stem) in PLANES {
            if !self.is_flat(plane) {
                self.picture(plane).write(directory, stem)?;
                files.extend([format!("{stem}.svg"), format!("{stem}.png")]);
            }
        }
        let text = format!("{:#}\n", self.json(&files));
        output::save(&directory.join(&files[1]), text.as_bytes())?;
        Ok(files)
    }

    fn csv(&self) -> String {
        let count = self.forces.pressures.len();
        let head = (1..=count).map(|i| format!("p{i}_kpa"));
        let head = head.chain(COMPONENTS.iter().map(|(name, ..)| (*name).to_owned()));
        let mut text = head.chain(["status".to_owned()]).collect::<Vec<_>>().join(",") + "\n";
        for (node, state) in self.forces.states.iter().enumerate() {
            let pressures = self.forces.node_pressures(node).into_iter().map(|p| number(p / KPA));
            let wrench = match state {
                Some(state) => self.cleaned(state.wrench).map(number),
                None => std::array::from_fn(|_| String::new()),
            };
            let cells = pressures.chain(wrench).chain([status(state).to_owned()]);
            text += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
        text
    }

    /// In the units of files, without rounding.
    fn cleaned(&self, wrench: Wrench) -> [f64; 6] {
        let (size, mut values) = (self.size, scaled(wrench));
        for (k, value) in values.iter_mut().enumerate() {
            if (*value * COMPONENTS[k].2).abs() < ROUNDING * size[usize::from(k > 2)] {
                *value = 0.0;
            }
        }
        values
    }

    /// Whether the set has no extent along either axis of a plane.
    fn is_flat(&self, plane: [usize; 2]) -> bool {
        let shadow = self.forces.shadow(plane);
        (0..2).any(|i| {
            let (low, high) = shadow.extent(i);
            // Of a single vertex it is zero, of none minus infinity.
            high - low <= FLAT * self.size[usize::from(plane[i] > 2)]
        })
    }

    fn picture(&self, plane: [usize; 2]) -> Chart {
        let [x, y] = plane.map(|k| COMPONENTS[k].1);
        let mut chart = Chart::new(format!("Blocked forces of {}", self.name), x, y);
        chart.subtitle = self.pose_text();
        let states = self.forces.states.iter().flatten().map(|state| scaled(state.wrench));
        let points: Vec<(f64, f64)> = states.map(|values| (values[plane[0]], values[plane[1]])).collect();
        let rest = scaled(self.forces.linear.base);
        let reachable = outline(&self.forces.shadow(plane), plane);
        let linear = outline(&self.forces.linear.shadow(plane), plane);
        // A single FREE has a curve, not a set.
        let alone = self.forces.pressures.len() == 1;
        let (mark, name) = if alone { (Mark::LinePoints, "computed") } else { (Mark::Dots, "combinations") };
        chart = chart.with(Series::new(name, mark, points).coloured(5));
        if !alone {
            chart = chart.with(Series::new("their hull", Mark::Line, reachable).coloured(0));
        }
        chart
            .with(Series::new("linear", Mark::Dashed, linear).coloured(1))
            .with(Series::new("no pressure", Mark::Rings, vec![(rest[plane[0]], rest[plane[1]])]).coloured(6))
    }

    fn pose_text(&self) -> String {
        let position = self.pose.position;
        let [w, i, j, k] = self.pose.wxyz();
        let at = [position.x, position.y, position.z].map(|m| short(m / MM)).join(", ");
        let turned =
            if w == 1.0 { String::new() } else { format!(", rotation {w:.4}, {i:.4}, {j:.4}, {k:.4}") };
        let top =
            self.forces.pressures.iter().map(|axis| short(axis.last().copied().unwrap_or_default() / KPA));
        format!("plate held at {at} mm{turned}; up to {} kPa", top.collect::<Vec<_>>().join(", "))
    }

    /// How many combinations have a status.
    fn count(&self, wanted: &str) -> usize {
        self.forces.states.iter().filter(|state| status(state) == wanted).count()
    }

    /// For programs.
    pub fn json(&self, files: &[String]) -> Value {
        let forces = self.forces;
        let top: Vec<f64> =
            forces.pressures.iter().map(|axis| axis.last().copied().unwrap_or_default()).collect();
        let generators = forces.linear.generators.iter().zip(&top);
        let generators: Vec<Value> = generators
            .map(|(generator, top)| json!({ "pressure_max_kpa": top / KPA, "per_kpa": named(*generator * (KPA / top)) }))
            .collect();
        let corners = if top.len() <= MOST_CORNERS { forces.linear.corners() } else { Vec::new() };
        let corners: Vec<Value> = corners
            .into_iter()
            .map(|(shares, wrench)| {
                let pressures: Vec<f64> =
                    shares.iter().zip(&top).map(|(share, top)| share * top / KPA).collect();
                json!({ "pressures_kpa": pressures, "linear": named(wrench) })
            })
            .collect();
        let planes = (0..6).flat_map(|a| (a + 1..6).map(move |b| [a, b]));
        let shadows: Vec<Value> = planes
            .map(|plane| {
                let units = COMPONENTS[plane[0]].2 * COMPONENTS[plane[1]].2;
                let [linear, reachable] = [forces.linear.shadow(plane), forces.shadow(plane)];
                json!({
                    "components": plane.map(|k| COMPONENTS[k].0),
                    "linear_area": linear.area() / units, "reachable_area": reachable.area() / units,
                    "linear_vertices": vertices(&linear, plane), "reachable_vertices": vertices(&reachable, plane),
                })
            })
            .collect();
        let position = self.pose.position;
        json!({
            "name": self.name,
            "pose": {
                "position_mm": [position.x / MM, position.y / MM, position.z / MM], "rotation_wxyz": self.pose.wxyz(),
            },
            "acts_on": "the tip plate, about its centre, in the base frame",
            "frees_are": if forces.frees.is_some() { "independent" } else { "tied by spacers" },
            "states": forces.states.len(), "not_found": self.count("not found"), "unstable": self.count("unstable"),
            "without_pressure": named(forces.linear.base), "generators": generators, "corners": corners,
            "linear_force_volume_n3": forces.linear.volume([0, 1, 2]),
            "linear_moment_volume_nmm3": forces.linear.volume([3, 4, 5]) / MM.powi(3),
            "greatest_departure_of_linear": named(forces.departure()),
            "greatest_departure_from_sum_of_frees": named(forces.coupling()),
            "shadows": shadows, "files": files,
        })
    }

    /// For reading.
    pub fn text(&self, directory: &Path, files: &[String]) -> String {
        let forces = self.forces;
        let mut text = format!(
            "{}, {}\nWrench of the FREEs on the plate, about its centre, in the base frame.\n\n",
            self.name,
            self.pose_text()
        );
        let heads = ["<", "fx (N)", "fy (N)", "fz (N)", "mx (N mm)", "my (N mm)", "mz (N mm)"];
        let cells = |what: String, wrench: Wrench| {
            std::iter::once(what).chain(self.cleaned(wrench).map(short)).collect::<Vec<_>>()
        };
        let mut table = Table::new(heads);
        table.row_of(cells("without pressure".into(), forces.linear.base));
        for (free, (generator, axis)) in forces.linear.generators.iter().zip(&forces.pressures).enumerate() {
            let top = axis.last().copied().unwrap_or_default() / KPA;
            table.row_of(cells(format!("FREE {}, linear, {} kPa", free + 1, short(top)), *generator));
            if let Some(frees) = &forces.frees
                && let [Some(first), .., Some(last)] = &frees[free][..]
            {
                table.row_of(cells(
                    format!("FREE {}, {} kPa", free + 1, short(top)),
                    last.wrench - first.wrench,
                ));
            }
        }
        table.row_of(cells("linear misses by at most".into(), forces.departure()));
        if forces.frees.is_none() {
            table.row_of(cells("sum of single FREEs misses by".into(), forces.coupling()));
        }
        text += &table.text();
        let mut areas = Table::new(["<plane", "<area in", "linear", "computed (hull)", "ratio"]);
        for (plane, stem) in
            PLANES.into_iter().filter(|(plane, _)| forces.pressures.len() > 1 && !self.is_flat(*plane))
        {
            let units = COMPONENTS[plane[0]].2 * COMPONENTS[plane[1]].2;
            let [linear, reachable] =
                [forces.linear.shadow(plane), forces.shadow(plane)].map(|set| set.area() / units);
            let unit = match plane {
                [_, b] if b < 3 => "N²",
                [a, _] if a > 2 => "(N mm)²",
                _ => "N · N mm",
            };
            areas.row([stem.into(), unit.into(), short(linear), short(reachable), short(linear / reachable)]);
        }
        if forces.pressures.len() > 1 {
            text += &format!("\n{}", areas.text());
        }
        if self.count("unstable") > 0 {
            text += &format!(
                "\nIn {} of {} states a FREE is unstable: under its own thrust it would buckle sideways and give less. By the bare tubes' stiffness \
                 a FREE that pulls more than its shear stiffness counts too, which is too early: --bending solids tells.\n",
                self.count("unstable"),
                forces.states.len()
            );
        }
        if self.count("not found") > 0 {
            text += &format!(
                "\nNo equilibrium was found for {} of {} combinations; the sets are those of the others.\n",
                self.count("not found"),
                forces.states.len()
            );
        }
        text + &format!("\n{}: {}\n", directory.display(), files.join(", "))
    }
}
