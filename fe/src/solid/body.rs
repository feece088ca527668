use super::{
    SolidError, SolidMesh, Specimen,
    element::{Condensation, ElementLaw, Workspace},
    enclosed_volume::FaceTable,
    fibre::{Block, Fibres, ForeseenTensions},
    mesh::Grid,
    shape::{NODES, Shape},
    state::{SolidLoad, SolidState},
};
use crate::{
    material::Rubber,
    sparse::{BlockPattern, Place},
};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::{collections::HashMap, f64::consts::TAU};

/// What a point follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Follows {
    /// The clamped base.
    Base,
    /// The rigid cap.
    Cap,
    /// Three unknowns: the components of its displacement in its own frame (outwards, around, along). A sector's image has those
    /// of its master.
    Own(u32),
}

/// A pair of an element's nodes whose block of the tangent goes straight to the matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub nodes: [u8; 2],
    pub place: Place,
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub points: [u32; NODES],
    pub shape: u32,
    pub law: u8,
    /// Whether its first face lies on the bore.
    pub inner: bool,
    pub pairs: Vec<Pair>,
    /// Nodes on the cap.
    pub on_cap: Vec<u8>,
}

/// A specimen, meshed: what does not change while it deforms, and the space for assembling.
pub(super) struct Body {
    pub(super) specimen: Specimen,
    pub(super) grid: Grid,
    pub(super) pattern: BlockPattern,
    /// First scalar unknown of the cap's six.
    pub(super) cap_unknown: usize,
    pub(super) follows: Vec<Follows>,
    /// What the frames of the beams' nodes follow.
    pub(super) turns: Vec<Follows>,
    pub(super) elements: Vec<Element>,
    pub(super) fibres: Fibres,
    /// Tensions that the next tangent is to be taken with, if they are not those of the positions.
    pub(super) foreseen: Option<ForeseenTensions>,
    pub(super) shapes: Vec<Shape>,
    pub(super) laws: Vec<ElementLaw>,
    pub(super) face_table: FaceTable,
    /// Turn by one sector.
    pub(super) sector: Matrix3<f64>,
    /// Frames of the points' unknowns (columns: outwards, around, along) at the configuration assembled last, and at the one whose
    /// tangent was. The tangent's components are kept as the frames turn: it stays good while the body turns.
    pub(super) frames: Vec<Matrix3<f64>>,
    pub(super) tangent_frames: Vec<Matrix3<f64>>,
    /// Frame of the cap's unknowns: its own while it is free.
    pub(super) cap_frame: Matrix3<f64>,
    /// Mass of rubber that moves with each point, kg.
    pub(super) masses: Vec<f64>,
    /// Area of the bore at the cap, of the part that is meshed, m^2.
    pub(super) cap_area: f64,
    pub(super) cap_block: u32,
    /// Blocks coupled with the cap's, its own included.
    pub(super) beside_cap: Vec<u32>,
    pub(super) workspace: Workspace,
    pub(super) condensations: Vec<Condensation>,
    pub(super) values: Vec<f64>,
    pub(super) point_forces: Vec<[f64; 3]>,
    pub(super) point_condensed: Vec<[f64; 3]>,
    pub(super) point_pressed: Vec<[f64; 3]>,
    /// Moments on the frames of the beams' nodes, each in its own frame.
    pub(super) node_moments: Vec<[f64; 3]>,
}

/// The element's nodes in its own frame: turned back about the tube's axis and shifted to its first node's height.
fn own_frame(nodes: &[[f64; 3]; NODES]) -> [[f64; 3]; NODES] {
    let (sine, cosine) = nodes[0][1].atan2(nodes[0][0]).sin_cos();
    nodes.map(|[x, y, z]| [cosine * x + sine * y, cosine * y - sine * x, z - nodes[0][2]])
}

impl Body {
    /// The whole specimen, or one of `sectors` equal sectors of it.
    pub fn new(specimen: &Specimen, mesh: SolidMesh, sectors: usize) -> Result<Self, SolidError> {
        specimen.check()?;
        let grid = Grid::new(specimen, mesh, sectors)?;
        let elastomers = [Some(specimen.elastomer), specimen.coat.map(|coat| coat.elastomer)];
        let laws: Vec<ElementLaw> = elastomers
            .into_iter()
            .flatten()
            .map(|elastomer| ElementLaw {
                material: Rubber::from(elastomer),
                bulk: specimen.bulk_ratio * elastomer.initial_shear_modulus(),
            })
            .collect();
        let last_plane = grid.lines[2] - 1;
        let mut own = 0;
        let mut follows = vec![Follows::Base; grid.points.len()];
        for point in 0..follows.len() {
            follows[point] = match (grid.plane(point), grid.master(point)) {
                (0, _) => Follows::Base,
                (plane, _) if plane == last_plane => Follows::Cap,
                (_, Some(master)) => follows[master],
                _ => {
                    own += 1;
                    Follows::Own(own - 1)
                }
            };
        }
        let fibres = specimen.fibres(&grid)?;
        // A fibre's ends are held by the caps.
        let mut turns = vec![Follows::Own(0); fibres.rotations.len()];
        for [base, tip] in &fibres.ends {
            turns[*base as usize] = Follows::Base;
            turns[*tip as usize] = Follows::Cap;
        }
        for turn in turns.iter_mut().filter(|turn| matches!(turn, Follows::Own(_))) {
            own += 1;
            *turn = Follows::Own(own - 1);
        }
        let cap_block = own;
        let mut sizes = vec![3u8; own as usize];
        sizes.push(6);

        let mut shapes = Vec::new();
        let mut known: HashMap<Vec<i64>, u32> = HashMap::new();
        let mut masses = vec![0.0; grid.points.len()];
        let mut elements = Vec::new();
        let resolution = 1e-9 * specimen.tube.outer_radius();
        for (index, place) in grid.element_places().enumerate() {
            let points = grid.element_points(place);
            let nodes = own_frame(&points.map(|point| grid.points[point as usize]));
            let key = nodes.as_flattened().iter().map(|x| (x / resolution).round() as i64).collect();
            let shape = match known.get(&key) {
                Some(&shape) => shape,
                None => {
                    shapes.push(Shape::new(&nodes, index)?);
                    known.insert(key, shapes.len() as u32 - 1);
                    shapes.len() as u32 - 1
                }
            };
            for (mass, point) in shapes[shape as usize].shares.iter().zip(points) {
                masses[point as usize] += specimen.density * mass;
            }
            elements.push(Element {
                points,
                shape,
                law: u8::from(grid.is_coat(place[0])),
                inner: place[0] == 0,
                pairs: vec![],
                on_cap: vec![],
            });
        }
        let coupled = |members: &mut dyn Iterator<Item = Follows>| {
            let mut clique: Vec<u32> = members
                .filter_map(|follows| match follows {
                    Follows::Base => None,
                    Follows::Cap => Some(cap_block),
                    Follows::Own(block) => Some(block),
                })
                .collect();
            clique.sort_unstable();
            clique.dedup();
            clique
        };
        let mut cliques: Vec<Vec<u32>> = elements
            .iter()
            .map(|element| coupled(&mut element.points.iter().map(|&point| follows[point as usize])))
            .collect();
        if !turns.is_empty() {
            cliques.extend(fibres.elements.iter().map(|fibre| {
                coupled(&mut fibre.blocks().iter().map(|block| match *block {
                    Block::Point(point) => follows[point as usize],
                    Block::Rotation(node) => turns[node as usize],
                }))
            }));
        }
        let mut beside_cap: Vec<u32> =
            cliques.iter().filter(|clique| clique.contains(&cap_block)).flatten().copied().collect();
        beside_cap.sort_unstable();
        beside_cap.dedup();
        let pattern = BlockPattern::new(&sizes, cliques.iter().map(|clique| &clique[..]));
        for element in &mut elements {
            let blocks = element.points.map(|point| match follows[point as usize] {
                Follows::Own(block) => Some(block),
                Follows::Base | Follows::Cap => None,
            });
            for a in 0..NODES {
                if follows[element.points[a] as usize] == Follows::Cap {
                    element.on_cap.push(a as u8);
                }
                for b in 0..=a {
                    if let (Some(row), Some(column)) = (blocks[a], blocks[b]) {
                        element
                            .pairs
                            .push(Pair { nodes: [a as u8, b as u8], place: pattern.place(row, column) });
                    }
                }
            }
        }
        let angle = TAU / sectors as f64;
        let sector = *Rotation3::from_axis_angle(&Vector3::z_axis(), angle).matrix();
        let mut body = Body {
            cap_unknown: pattern.first(cap_block),
            values: vec![0.0; pattern.len()],
            condensations: vec![Condensation::default(); elements.len()],
            point_forces: vec![[0.0; 3]; grid.points.len()],
            point_condensed: vec![[0.0; 3]; grid.points.len()],
            point_pressed: vec![[0.0; 3]; grid.points.len()],
            node_moments: vec![[0.0; 3]; turns.len()],
            specimen: specimen.clone(),
            frames: vec![Matrix3::identity(); follows.len()],
            tangent_frames: vec![Matrix3::identity(); follows.len()],
            cap_frame: Matrix3::identity(),
            follows,
            turns,
            elements,
            fibres,
            foreseen: None,
            shapes,
            laws,
            face_table: FaceTable::new(),
            sector,
            masses,
            cap_area: 0.0,
            cap_block,
            beside_cap,
            workspace: Workspace::default(),
            pattern,
            grid,
        };
        body.cap_area = body.bore_area_at_cap();
        Ok(body)
    }

    /// Area inside the bore's edge on the cap, as the faces' interpolation has it: `1/2 integral (x cross dx)`.
    fn bore_area_at_cap(&self) -> f64 {
        use super::shape::{GAUSS, quadratic};
        let top = self.grid.lines[2] - 1;
        let mut area = 0.0;
        for j in 0..self.grid.elements[1] {
            let nodes = [0, 1, 2].map(|n| self.grid.points[self.grid.point(0, 2 * j + n, top) as usize]);
            for (at, weight) in GAUSS {
                let (values, slopes) = quadratic(at);
                let sum = |w: &[f64; 3], i: usize| (0..3).map(|n| w[n] * nodes[n][i]).sum::<f64>();
                area +=
                    0.5 * weight * (sum(&values, 0) * sum(&slopes, 1) - sum(&values, 1) * sum(&slopes, 0));
            }
        }
        area
    }

    /// Points, undeformed shape and rubber of an element.
    pub fn element(&self, index: usize) -> (&[u32; NODES], &Shape, &ElementLaw) {
        let Element { points, shape, law, .. } = &self.elements[index];
        (points, &self.shapes[*shape as usize], &self.laws[*law as usize])
    }

    /// Turn by one sector.
    pub fn sector(&self) -> &Matrix3<f64> {
        &self.sector
    }

    /// The blocks of unknowns line by line along the tube: from there minimum degree finds better orders on finer meshes.
    pub fn order_by_lines(&self) -> Vec<u32> {
        let [ni, nj, nk] = self.grid.lines;
        let mut order = vec![];
        for line in 0..ni * nj {
            order.extend((0..nk).filter_map(|k| match self.follows[k * ni * nj + line] {
                Follows::Own(block) if self.grid.master(k * ni * nj + line).is_none() => Some(block),
                _ => None,
            }));
        }
        let blocks = self.pattern.blocks() as u32;
        order.extend(order.len() as u32..blocks);
        order
    }

    /// The undeformed body.
    pub fn rest(&self) -> SolidState {
        SolidState {
            positions: self.grid.points.clone(),
            pressures: vec![[0.0; 4]; self.elements.len()],
            rotations: self.fibres.rotations.clone(),
            cap: Vector3::new(0.0, 0.0, self.specimen.tube.length),
            cap_rotation: UnitQuaternion::identity(),
            load: SolidLoad::default(),
            energy: 0.0,
            volume: 0.0,
            residual: 0.0,
        }
    }

    /// Volume of the part of the undeformed body that moves with each point, m^3.
    pub fn point_volumes(&self) -> Vec<f64> {
        let mut volumes = vec![0.0; self.grid.points.len()];
        for element in &self.elements {
            for (share, point) in self.shapes[element.shape as usize].shares.iter().zip(element.points) {
                volumes[point as usize] += share;
            }
        }
        volumes
    }

    /// Puts the points of base and cap and the images of a sector where they belong.
    pub fn settle(&self, state: &mut SolidState) {
        let top = Vector3::new(0.0, 0.0, self.specimen.tube.length);
        for point in 0..self.follows.len() {
            match self.follows[point] {
                Follows::Base => state.positions[point] = self.grid.points[point],
                Follows::Cap => {
                    let arm = Vector3::from(self.grid.points[point]) - top;
                    state.positions[point] = (state.cap + state.cap_rotation * arm).into();
                }
                Follows::Own(_) => {
                    if let Some(master) = self.grid.master(point) {
                        state.positions[point] =
                            (self.sector * Vector3::from(state.positions[master])).into();
                    }
                }
            }
        }
        for (node, turns) in self.turns.iter().enumerate() {
            match turns {
                Follows::Base => state.rotations[node] = self.fibres.rotations[node],
                Follows::Cap => state.rotations[node] = state.cap_rotation * self.fibres.rotations[node],
                Follows::Own(_) => {}
            }
        }
    }

    /// Turns of the frames of the beams' nodes for a step of the unknowns, each in its own frame.
    pub fn turns_of(&self, step: &[f64]) -> Vec<Vector3<f64>> {
        self.turns
            .iter()
            .map(|turns| match *turns {
                Follows::Own(block) => {
                    let first = self.pattern.first(block);
                    Vector3::new(step[first], step[first + 1], step[first + 2])
                }
                // Settled with base and cap.
                Follows::Base | Follows::Cap => Vector3::zeros(),
            })
            .collect()
    }

    /// Displacements of all points (in space) for a step of the unknowns, and the cap's.
    pub fn displacements(&self, state: &SolidState, step: &[f64]) -> (Vec<[f64; 3]>, [Vector3<f64>; 2]) {
        let at = |first: usize| Vector3::new(step[first], step[first + 1], step[first + 2]);
        let cap = [0, 3].map(|half| self.cap_frame * at(self.cap_unknown + half));
        let points = self
            .follows
            .iter()
            .zip(&state.positions)
            .zip(&self.frames)
            .map(|((follows, place), frame)| match *follows {
                Follows::Base => [0.0; 3],
                Follows::Cap => (cap[0] + cap[1].cross(&(Vector3::from(*place) - state.cap))).into(),
                Follows::Own(block) => (frame * at(self.pattern.first(block))).into(),
            })
            .collect();
        (points, cap)
    }

    /// Changes of the elements' pressures that go with displacements of the points.
    ///
    /// With their present mismatch of volume, or for an infinitesimal change of an equilibrium without.
    pub fn pressure_steps(&self, displacements: &[[f64; 3]], with_mismatch: bool) -> Vec<[f64; 4]> {
        // The coupling was taken in the frames of the tangent.
        let displacements: Vec<[f64; 3]> = displacements
            .iter()
            .zip(self.frames.iter().zip(&self.tangent_frames))
            .map(|(u, (now, then))| (then * now.tr_mul(&Vector3::from(*u))).into())
            .collect();
        self.elements
            .iter()
            .zip(&self.condensations)
            .map(|(element, condensation)| {
                let step =
                    std::array::from_fn(|q| displacements[element.points[q % NODES] as usize][q / NODES]);
                let law = &self.laws[element.law as usize];
                condensation.pressure_step(law, &self.shapes[element.shape as usize], &step, with_mismatch)
            })
            .collect()
    }
}
