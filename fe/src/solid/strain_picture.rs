//! The strain of the rubber where it can be seen: on a cross-section and on the outer surface, in small flat pieces.

use super::{newton::SolidSolver, shape::quadratic, state::SolidState, wall};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::TAU;

/// A small quadrilateral of the deformed rubber.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainFacet {
    /// Its corners in their order around it, m.
    pub corners: [[f64; 3]; 4],
    /// Greatest principal logarithmic strain in its middle.
    pub log_strain: f64,
}

impl SolidSolver {
    /// Greatest principal logarithmic strain over the cross-section whose undeformed height is nearest to `height`, m; each
    /// element in `pieces` x `pieces` facets. Of a sector the whole tube.
    pub fn cross_section_strains(&self, state: &SolidState, height: f64, pieces: usize) -> Vec<StrainFacet> {
        let grid = &self.body.grid;
        let step = self.body.specimen.tube.length / (grid.lines[2] - 1) as f64;
        let plane = ((height / step).round().max(0.0) as usize).min(grid.lines[2] - 1);
        let [through, around, _] = grid.elements;
        let faces = (0..around).flat_map(|j| (0..through).map(move |i| [i, j]));
        let faces =
            faces.map(|[i, j]| std::array::from_fn(|a| grid.point(2 * i + a % 3, 2 * j + a / 3, plane)));
        self.facets(state, faces, pieces)
    }

    /// Greatest principal logarithmic strain over the outer surface between two undeformed heights, m: the elements that reach into
    /// it, each in `pieces` x `pieces` facets with their corners counter-clockwise seen from outside. Of a sector the whole tube.
    pub fn surface_strains(&self, state: &SolidState, heights: [f64; 2], pieces: usize) -> Vec<StrainFacet> {
        let grid = &self.body.grid;
        let [_, around, along] = grid.elements;
        let step = self.body.specimen.tube.length / along as f64;
        let inside = move |k: &usize| (*k + 1) as f64 * step > heights[0] && (*k as f64) * step < heights[1];
        let faces = (0..along).filter(inside).flat_map(|k| (0..around).map(move |j| [j, k]));
        self.facets(state, faces.map(|at| grid.face_points(grid.lines[0] - 1, at)), pieces)
    }

    /// Share of the rubber between 40 and 60 % of the length whose greatest principal logarithmic strain is above `log_strain`.
    pub fn share_strained_above(&self, state: &SolidState, log_strain: f64) -> f64 {
        let length = self.body.specimen.tube.length;
        let (mut above, mut all) = (0.0, 0.0);
        for point in wall::points(&self.body, state) {
            if (point.reference[2] / length - 0.5).abs() <= 0.1 {
                all += point.weight;
                if wall::principal(&point.log_strain)[0] > log_strain {
                    above += point.weight;
                }
            }
        }
        above / all
    }

    fn facets(
        &self,
        state: &SolidState,
        faces: impl Iterator<Item = [u32; 9]>,
        pieces: usize,
    ) -> Vec<StrainFacet> {
        let tensors: Vec<_> = wall::points(&self.body, state).iter().map(|point| point.log_strain).collect();
        let strains: Vec<f64> =
            wall::at_nodes(&self.body, &tensors).iter().map(|tensor| wall::principal(tensor)[0]).collect();
        let faces: Vec<[u32; 9]> = faces.collect();
        let sectors = self.body.grid.sectors;
        let mut facets = Vec::with_capacity(faces.len() * pieces * pieces * sectors);
        let natural = |i: usize| 2.0 * i as f64 / pieces as f64 - 1.0;
        let half = 1.0 / pieces as f64;
        for times in 0..sectors {
            let angle = TAU * times as f64 / sectors as f64;
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            for face in &faces {
                let values = |at: [f64; 2]| {
                    let [first, second] = at.map(|x| quadratic(x).0);
                    move |a: usize| first[a % 3] * second[a / 3]
                };
                let place = |at: [f64; 2]| -> [f64; 3] {
                    let factor = values(at);
                    let sum: Vector3<f64> =
                        (0..9).map(|a| factor(a) * Vector3::from(state.positions[face[a] as usize])).sum();
                    (turn * sum).into()
                };
                for (i, j) in (0..pieces * pieces).map(|piece| (piece % pieces, piece / pieces)) {
                    let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                    let factor = values([natural(i) + half, natural(j) + half]);
                    facets.push(StrainFacet {
                        corners: corners.map(|(i, j)| place([natural(i), natural(j)])),
                        log_strain: (0..9).map(|a| factor(a) * strains[face[a] as usize]).sum(),
                    });
                }
            }
        }
        facets
    }
}

#[cfg(test)]
mod tests {
    use crate::{SolidLoad, SolidMesh, SolidSolver, Specimen};
    use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, Tube, Winding};

    #[test]
    fn a_sector_shows_the_whole_tube() {
        let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.3e-3, law: FibreLaw::Linear };
        let tube = Tube { length: 0.02, inner_radius: 4.76e-3, wall: 0.8e-3 };
        let winding = Winding::from_hoop(0.7, Handedness::Right, 6, fibre);
        let free = Free { tube, winding, elastomer: Elastomer::NeoHookean { shear_modulus: 0.393e6 } };
        let specimen = Specimen { bulk_ratio: 1e3, ..Specimen::from(&free) };
        let sums = [true, false].map(|cut| {
            let make = if cut { SolidSolver::sector } else { SolidSolver::new };
            let mut solver = make(&specimen, SolidMesh::new(12, 6)).unwrap();
            let rest = solver.rest();
            let state = solver.follow(&rest, 0.0, &[20e3], &SolidLoad::pressure, &mut |_, _| true).unwrap();
            assert!(
                solver
                    .cross_section_strains(&rest, 0.01, 3)
                    .iter()
                    .all(|facet| facet.log_strain.abs() < 1e-12)
            );
            let facets = solver.cross_section_strains(&state, 0.01, 3);
            let all = facets.len() as f64;
            let area: f64 = facets
                .iter()
                .map(|facet| {
                    let [a, b, c, d] = facet.corners.map(|at| [at[0], at[1]]);
                    let cross = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
                        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
                    };
                    0.5 * (cross(a, b, c) + cross(a, c, d))
                })
                .sum();
            // The volume of the rubber stays: area times stretch.
            let stretch = solver.deformation(&state).stretch_mid;
            assert!((area * stretch / tube.wall_area() - 1.0).abs() < 0.01, "{area}");
            let mean = facets.iter().map(|facet| facet.log_strain).sum::<f64>() / all;
            // The surface between two heights is those elements' and no others.
            let surface = solver.surface_strains(&state, [0.0, 0.005], 2);
            assert_eq!(surface.len(), 2 * 12 * 4);
            let above = [-1.0, 0.0, 10.0].map(|strain| solver.share_strained_above(&state, strain));
            assert!(above[0] == 1.0 && above[2] == 0.0, "{above:?}");
            [area, mean, surface.iter().map(|facet| facet.log_strain).sum::<f64>()]
        });
        for (sector, whole) in sums[0].iter().zip(sums[1]) {
            assert!((sector / whole - 1.0).abs() < 1e-6, "{sums:?}");
        }
    }
}
