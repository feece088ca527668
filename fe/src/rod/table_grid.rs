use actuator::{Free, FreePath, FreeState};

/// Nodes of a section table: of the wall's enclosed volume per reference length in pi B^2 (B the outer radius at rest), of its stretch, and of
/// its twist over a length of B.
#[derive(Clone, Debug, PartialEq)]
pub struct TableGrid {
    /// Least and greatest volume, and the number of nodes between and including them.
    pub volume: (f64, f64, usize),
    /// The wall's own volume (A/B)^2, from which others are followed.
    pub own_volume: f64,
    /// Least and greatest axial stretch, and the number of nodes.
    pub stretch: (f64, f64, usize),
    /// Greatest twist, rad, and the number of nodes from zero to it: the bare wall's mirror image has the opposite twist.
    pub twist: (f64, usize),
}

/// Spacing of the table: volume over the tube's own, stretch, twist times the outer radius.
const SPACING: [f64; 3] = [0.08, 0.04, 0.08];
/// Least volume over the tube's own: threads that are pulled tight squeeze it.
const LEAST_VOLUME: f64 = 0.4;
/// Most nodes a direction.
const MOST_NODES: usize = 60;

impl TableGrid {
    /// The grid for a FREE used in modules up to a pressure (Pa), from its own free path: its stretch and its twist with margins on all
    /// sides (others pull it, push it and turn it), its volume from squeezed to one and a half times what it gains. States of the path above
    /// the pressure and within 2 % of its limit do not count.
    pub fn for_free(free: &Free, path: &FreePath, pressure_max: f64) -> Self {
        let (a, b) = (free.tube.inner_radius, free.tube.outer_radius());
        let own_volume = (a / b).powi(2);
        let below = path.limit_pressure().map_or(pressure_max, |limit| pressure_max.min(0.98 * limit));
        let within = || path.states.iter().filter(|state| state.pressure <= below);
        let greatest = |start: f64, of: &dyn Fn(&FreeState) -> f64| within().map(of).fold(start, f64::max);
        let (shortest, longest) =
            (-greatest(-1.0, &|state| -state.axial_stretch), greatest(1.0, &|state| state.axial_stretch));
        // Held in a bundle, a FREE is bent by the others: an arm of a diameter, a bend of a radian in ten diameters.
        let margin = 0.12 + 0.25 * (longest - shortest);
        let stretch = (shortest - margin, longest + margin);
        let twist = 1.25 * b * greatest(0.0, &|state| state.twist_per_length.abs()) + 0.25;
        // The rubber keeps its volume: b^2 lambda = V/pi + B^2 - A^2.
        let fullest =
            greatest(own_volume, &|state| state.expansion.powi(2) * state.axial_stretch - 1.0 + own_volume);
        let volume = (LEAST_VOLUME * own_volume, 1.2 * own_volume + 1.5 * (fullest - own_volume));
        let count = |(low, high): (f64, f64), spacing: f64| {
            (((high - low) / spacing).ceil() as usize + 1).clamp(5, MOST_NODES)
        };
        TableGrid {
            volume: (volume.0, volume.1, count(volume, SPACING[0] * own_volume)),
            own_volume,
            stretch: (stretch.0, stretch.1, count(stretch, SPACING[1])),
            twist: (twist, count((0.0, twist), SPACING[2])),
        }
    }

    /// The nodes of twist as an axis.
    pub(super) fn twists(&self) -> (f64, f64, usize) {
        (0.0, self.twist.0, self.twist.1)
    }

    /// The `index`-th node of an axis.
    pub(super) fn node((low, high, count): (f64, f64, usize), index: usize) -> f64 {
        low + (high - low) * index as f64 / (count - 1) as f64
    }

    pub(super) fn is_sound(&self) -> bool {
        let range =
            |(low, high, count): (f64, f64, usize)| count >= 2 && high > low && (high - low).is_finite();
        let rising = range(self.volume) && range(self.stretch) && range(self.twists());
        rising && self.volume.0 > 0.0 && self.stretch.0 > 0.0
    }
}
