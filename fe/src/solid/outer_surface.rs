use super::{newton::SolidSolver, state::SolidState};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// A point of a tube's outer surface, and how far a motion takes it outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bulge {
    /// Angle about the undeformed axis, rad, right-handed from x; along a line of points it does not wrap.
    pub around: f64,
    /// Undeformed height above the base, m.
    pub along: f64,
    /// Component of the motion along the deformed surface's outward normal, in the motion's own unit.
    pub outwards: f64,
}

impl SolidSolver {
    /// The outer surface of a state of a whole tube under a motion of all points of its mesh: by lines along the tube, one beside the other around
    /// it, each from base to tip.
    pub(crate) fn bulges(&self, state: &SolidState, motion: &[[f64; 3]]) -> Vec<Vec<Bulge>> {
        let grid = &self.body.grid;
        let [ni, nj, nk] = grid.lines;
        let point = |j: usize, k: usize| grid.point(ni - 1, j % nj, k) as usize;
        let at = |j: usize, k: usize| Vector3::from(state.positions[point(j, k)]);
        (0..nj)
            .map(|j| {
                let mut around: Option<f64> = None;
                (0..nk)
                    .map(|k| {
                        let [x, y, along] = grid.points[point(j, k)];
                        let angle = y.atan2(x);
                        let turns = around.map_or(0.0, |last| ((last - angle) / TAU).round());
                        let angle = angle + TAU * turns;
                        around = Some(angle);
                        // Counter-clockwise seen from outside: around, then along.
                        let beside = at(j + 1, k) - at(j + nj - 1, k);
                        let up = at(j, (k + 1).min(nk - 1)) - at(j, k.saturating_sub(1));
                        let outwards = beside.cross(&up).normalize().dot(&Vector3::from(motion[point(j, k)]));
                        Bulge { around: angle, along, outwards }
                    })
                    .collect()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SolidMesh, Specimen};
    use actuator::{
        Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding,
        units::{DEG, MM},
    };

    #[test]
    fn a_tube_that_swells_and_is_lifted_goes_outwards_by_what_it_swells() {
        let tube = Tube { length: 60.0 * MM, inner_radius: 4.76 * MM, wall: 0.8 * MM };
        let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.15 * MM, law: FibreLaw::Linear };
        let winding = Winding::from_hoop(60.0 * DEG, Handedness::Left, 6, fibre);
        let elastomer =
            Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus };
        let free = Free { tube, winding, elastomer };
        let solver = SolidSolver::new(&Specimen::from(&free), SolidMesh::new(12, 10)).unwrap();
        let state = solver.rest();
        let radius = tube.outer_radius();
        let motion: Vec<[f64; 3]> =
            state.positions.iter().map(|[x, y, _]| [x / radius, y / radius, 0.3]).collect();
        let lines = solver.bulges(&state, &motion);
        assert_eq!((lines.len(), lines[0].len()), (24, 21));
        for (line, bulge) in lines.iter().flat_map(|line| line.iter().map(move |bulge| (line, bulge))) {
            // Chords between neighbours of a node on both sides stand on the radius there; at the caps, where one is missing, they lean.
            let inside = bulge.along > 1e-9 && bulge.along < tube.length - 1e-9;
            assert!((bulge.outwards - 1.0).abs() < if inside { 1e-9 } else { 0.05 }, "{bulge:?}");
            // Left-handed threads run clockwise up the tube, by more than a turn.
            let turned = -bulge.along / (radius * (60.0 * DEG).tan());
            assert!((bulge.around - line[0].around - turned).abs() < 1e-9, "{bulge:?}");
        }
        assert!((lines[6][0].around.rem_euclid(TAU) - 0.25 * TAU).abs() < 1e-9);
    }
}
