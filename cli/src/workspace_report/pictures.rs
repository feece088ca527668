use crate::plot::{Chart, Mark, Picture, Series};
use actuator::{
    Case, Module,
    units::{DEG, MM},
};
use control::{Bounds, ReachableSet, Segments, Sideways, positions};
use rom::{OutOfDomain, PoseModel};

/// Steps of a case's curve.
const TRACK_STEPS: usize = 60;

/// Colours of outline and cut; those before them are the cases'.
const GREY: usize = 6;
const VIOLET: usize = 7;

/// Tip positions (m) along a case, from idle to full pressure.
pub struct Track {
    /// The case.
    pub case: Case,
    /// Part of the way and position.
    pub positions: Vec<(f64, [f64; 3])>,
}

/// The paper's cases of a module, each in even steps from the least to the greatest pressures.
///
/// # Errors
/// [`OutOfDomain`] where the model has no answer.
pub fn tracks(module: &Module, model: &impl PoseModel, bounds: &Bounds) -> Result<Vec<Track>, OutOfDomain> {
    let part = |step: usize| step as f64 / TRACK_STEPS as f64;
    let track = |case: Case| {
        let pressures: Vec<Vec<f64>> =
            (0..=TRACK_STEPS).map(|step| case.pressures(&bounds.lower, &bounds.upper, part(step))).collect();
        let positions = positions(model, &pressures)?;
        Ok(Track { case, positions: (0..=TRACK_STEPS).map(part).zip(positions).collect() })
    };
    Case::all(module).into_iter().map(track).collect()
}

/// A view along an axis: its name, the axes across and up, and whether the outline's coordinates are these the other way round.
const VIEWS: [(&str, usize, [usize; 2], bool); 3] =
    [("xy", 2, [0, 1], false), ("xz", 1, [0, 2], true), ("yz", 0, [1, 2], false)];

fn points(segments: Segments, swapped: bool) -> Vec<(f64, f64)> {
    let place = |[u, v]: [f64; 2]| if swapped { (v / MM, u / MM) } else { (u / MM, v / MM) };
    segments.into_iter().flat_map(|[a, b]| [place(a), place(b), (f64::NAN, f64::NAN)]).collect()
}

/// Outline of the set's shadow, of a cut through it, and the cases, from above and from two sides.
pub fn pictures(set: &ReachableSet, tracks: &[Track], name: &str) -> Vec<(String, Picture)> {
    let mut pictures = vec![];
    let letter = ["x", "y", "z"];
    for (stem, along, [across, up], swapped) in VIEWS {
        let title = format!("Reachable set seen along {}, simulated", letter[along]);
        let mut chart = Chart {
            // From the side the set is thin, and would be a line.
            equal_axes: along == 2,
            subtitle: name.to_owned(),
            ..Chart::new(title, format!("{} (mm)", letter[across]), format!("{} (mm)", letter[up]))
        };
        let middle = if along == 2 { 0.5 * (set.extent[2].0 + set.extent[2].1) } else { 0.0 };
        let (place, cut) = set.cut(along, middle);
        if !set.is_flat() {
            chart = chart
                .with(Series::new("outline", Mark::Line, points(set.shadow(along), swapped)).coloured(GREY))
                .with(
                    Series::new(
                        format!("cut at {} {:.1} mm", letter[along], place / MM),
                        Mark::Line,
                        points(cut, swapped),
                    )
                    .coloured(VIOLET),
                );
        }
        for (colour, track) in tracks.iter().enumerate() {
            let curve = track.positions.iter().map(|(_, at)| (at[across] / MM, at[up] / MM)).collect();
            chart = chart.with(Series::new(track.case.name, Mark::Line, curve).coloured(colour));
        }
        pictures.push((format!("workspace-{stem}"), chart.into()));
    }
    pictures
}

/// Reach over direction.
pub fn reach(sideways: &Sideways, name: &str) -> Picture {
    let points = sideways.reaches();
    let points = points.filter_map(|(direction, reach)| Some((direction / DEG, reach?.0 / MM))).collect();
    let chart = Chart::new(
        "Sideways reach, simulated",
        "direction from x, counter-clockwise seen from the tip (°)",
        "greatest distance from the axis (mm)",
    );
    Chart { subtitle: name.to_owned(), ..chart }.with(Series::new("", Mark::LinePoints, points)).into()
}
