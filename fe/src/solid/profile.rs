use super::{newton::SolidSolver, state::SolidState};

/// One plane of nodes across the tube: what it does of what a cap lets it do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Height above the base before loading, m.
    pub height: f64,
    /// Height now, mean over the plane, m.
    pub raised: f64,
    /// Radius of the bore over that before loading, mean over the plane.
    pub bore: f64,
    /// Turn about the axis since loading against the plane below, rad, mean over the plane; counter-clockwise seen from the tip looking
    /// back.
    pub turn: f64,
}

impl SolidSolver {
    /// What a state does along the tube, from base to tip. Radii and turns are taken about the axis: meant for FREEs that stay
    /// straight.
    pub fn profile(&self, state: &SolidState) -> Vec<Plane> {
        let grid = &self.body.grid;
        let [ni, nj, nk] = grid.lines;
        let own = if grid.sectors > 1 { nj - 1 } else { nj };
        let mut profile: Vec<Plane> = Vec::with_capacity(nk);
        for k in 0..nk {
            let mut plane = Plane { height: grid.points[k * ni * nj][2], raised: 0.0, bore: 0.0, turn: 0.0 };
            for j in 0..own {
                let radius = |positions: &[[f64; 3]]| {
                    let [x, y, _] = positions[grid.point(0, j, k) as usize];
                    x.hypot(y)
                };
                plane.bore += radius(&state.positions) / radius(&grid.points) / own as f64;
                for i in 0..ni {
                    plane.raised += state.positions[grid.point(i, j, k) as usize][2] / (own * ni) as f64;
                    let between = |positions: &[[f64; 3]]| {
                        let [x, y, _] = positions[grid.point(i, j, k.saturating_sub(1)) as usize];
                        let [u, v, _] = positions[grid.point(i, j, k) as usize];
                        (x * v - y * u).atan2(x * u + y * v)
                    };
                    plane.turn += (between(&state.positions) - between(&grid.points)) / (own * ni) as f64;
                }
            }
            profile.push(plane);
        }
        profile
    }
}
