use super::{
    SolidError, SolidMesh, Specimen,
    element::{Condensation, ElementLaw, Inverted, UNKNOWNS, Workspace},
    enclosed_volume::{FACE, FaceTable, FaceVolume},
    fibre::{Block, Fibres, MAX_UNKNOWNS},
    mesh::Grid,
    shape::{NODES, Shape},
    state::{SolidLoad, SolidState, set_local_frames},
};
use crate::{
    material::Rubber,
    sparse::{BlockPattern, Place},
};
use nalgebra::{Matrix3, Matrix3x6, Matrix6, Rotation3, UnitQuaternion, Vector3, Vector6};
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
struct Pair {
    nodes: [u8; 2],
    place: Place,
}

#[derive(Clone, Debug)]
struct Element {
    points: [u32; NODES],
    shape: u32,
    law: u8,
    /// Whether its first face lies on the bore.
    inner: bool,
    pairs: Vec<Pair>,
    /// Nodes on the cap.
    on_cap: Vec<u8>,
}

/// Sums over the body of a configuration.
#[derive(Clone, Debug, Default)]
pub(super) struct Forces {
    /// Internal less external forces on the unknowns, N (N m for turns): zero in equilibrium.
    pub residual: Vec<f64>,
    /// The same with the elements' pressures eliminated: the right-hand side of a Newton step.
    pub condensed: Vec<f64>,
    /// d volume/d unknowns.
    pub volume_gradient: Vec<f64>,
    /// Size of the forces that cancel, N.
    pub scale: f64,
    /// Largest |integral (J - 1 - q/kappa) dV| of an element over its volume.
    pub mismatch: f64,
    pub energy: f64,
    pub volume: f64,
}

/// A specimen, meshed: what does not change while it deforms, and the space for assembling.
pub(super) struct Body {
    pub specimen: Specimen,
    pub grid: Grid,
    pub pattern: BlockPattern,
    /// First scalar unknown of the cap's six.
    pub cap_unknown: usize,
    pub(super) follows: Vec<Follows>,
    /// What the frames of the beams' nodes follow.
    pub(super) turns: Vec<Follows>,
    elements: Vec<Element>,
    pub fibres: Fibres,
    shapes: Vec<Shape>,
    laws: Vec<ElementLaw>,
    face_table: FaceTable,
    /// Turn by one sector.
    sector: Matrix3<f64>,
    /// Frames of the points' unknowns (columns: outwards, around, along) at the configuration assembled last, and at the one whose
    /// tangent was. The tangent's components are kept as the frames turn: it stays good while the body turns.
    frames: Vec<Matrix3<f64>>,
    tangent_frames: Vec<Matrix3<f64>>,
    /// Frame of the cap's unknowns: its own while it is free.
    cap_frame: Matrix3<f64>,
    /// Mass of rubber that moves with each point, kg.
    masses: Vec<f64>,
    /// Area of the bore at the cap, of the part that is meshed, m^2.
    cap_area: f64,
    cap_block: u32,
    /// Blocks coupled with the cap's, its own included.
    beside_cap: Vec<u32>,
    workspace: Workspace,
    condensations: Vec<Condensation>,
    pub values: Vec<f64>,
    point_forces: Vec<[f64; 3]>,
    point_condensed: Vec<[f64; 3]>,
    point_volume: Vec<[f64; 3]>,
    /// Moments on the frames of the beams' nodes, each in its own frame.
    node_moments: Vec<[f64; 3]>,
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
            point_volume: vec![[0.0; 3]; grid.points.len()],
            node_moments: vec![[0.0; 3]; turns.len()],
            specimen: specimen.clone(),
            frames: vec![Matrix3::identity(); follows.len()],
            tangent_frames: vec![Matrix3::identity(); follows.len()],
            cap_frame: Matrix3::identity(),
            follows,
            turns,
            elements,
            fibres,
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

    /// Residual and, if asked for, the tangent (into `values`) of a configuration under a load.
    pub fn assemble(
        &mut self,
        state: &SolidState,
        load: &SolidLoad,
        with_tangent: bool,
        forces: &mut Forces,
    ) -> Result<(), Inverted> {
        for sums in [
            &mut self.point_forces,
            &mut self.point_condensed,
            &mut self.point_volume,
            &mut self.node_moments,
        ] {
            sums.fill([0.0; 3]);
        }
        set_local_frames(&self.grid, &state.positions, &mut self.frames);
        let cap_free = load.held == [false; 6];
        self.cap_frame =
            if cap_free { *state.cap_rotation.to_rotation_matrix().matrix() } else { Matrix3::identity() };
        if with_tangent {
            self.values.fill(0.0);
            self.tangent_frames.copy_from_slice(&self.frames);
        }
        let (mut energy, mut volume, mut squares, mut mismatch) = (0.0, 0.0, 0.0, 0.0f64);
        let mut scatter = Scatter {
            values: &mut self.values,
            pattern: &self.pattern,
            follows: &self.follows,
            frames: &self.frames,
            cap_frame: self.cap_frame,
            cap_block: self.cap_block,
            positions: &state.positions,
            cap: state.cap,
            cap_tangent: Matrix6::zeros(),
        };
        for (index, element) in self.elements.iter().enumerate() {
            let (law, shape) = (&self.laws[element.law as usize], &self.shapes[element.shape as usize]);
            let work = &mut self.workspace;
            let condensation = &mut self.condensations[index];
            let positions: [f64; UNKNOWNS] =
                std::array::from_fn(|q| state.positions[element.points[q % NODES] as usize][q / NODES]);
            energy +=
                work.evaluate(law, shape, &positions, &state.pressures[index], condensation, with_tangent)?;
            mismatch = mismatch.max(condensation.mismatch[0].abs() / shape.volume());
            let mut share = [0.0; UNKNOWNS];
            condensation.condense(law, shape, &mut share);
            squares += work.residual.iter().map(|value| value * value).sum::<f64>();
            for (a, &point) in element.points.iter().enumerate() {
                for i in 0..3 {
                    self.point_forces[point as usize][i] += work.residual[i * NODES + a];
                    self.point_condensed[point as usize][i] += share[i * NODES + a];
                }
            }
            if element.inner {
                const ON_BORE: [usize; FACE] = [0, 3, 6, 9, 12, 15, 18, 21, 24];
                let nodes = ON_BORE.map(|a| state.positions[element.points[a] as usize]);
                let pressed = with_tangent && load.pressure != 0.0;
                let face = FaceVolume::new(&self.face_table, &nodes, pressed);
                volume += face.volume;
                for (a, gradient) in ON_BORE.into_iter().zip(face.gradient) {
                    let sum = &mut self.point_volume[element.points[a] as usize];
                    sum.iter_mut().zip(gradient).for_each(|(sum, value)| *sum += value);
                }
                if pressed {
                    // Blocks (x, y), (x, z) and (y, z) of the tangent: e_ikm with m = z, y and x.
                    for (block, m, sign) in [(1, 2, -1.0), (2, 1, 1.0), (4, 0, -1.0)] {
                        let block = &mut work.tangent[block * NODES * NODES..(block + 1) * NODES * NODES];
                        for (a, row) in ON_BORE.into_iter().enumerate() {
                            for (b, column) in ON_BORE.into_iter().enumerate() {
                                block[column * NODES + row] += sign * load.pressure * face.tangent[a][b][m];
                            }
                        }
                    }
                }
            }
            if with_tangent {
                scatter.add_element(element, work);
            }
        }
        let (mut gradient, mut tangent) = ([0.0; MAX_UNKNOWNS], [0.0; MAX_UNKNOWNS * MAX_UNKNOWNS]);
        for fibre in &self.fibres.elements {
            energy += fibre
                .evaluate(&state.positions, &state.rotations, &mut gradient, &mut tangent)
                .ok_or(Inverted)?;
            let blocks = fibre.blocks();
            let unknowns = 3 * blocks.len();
            squares += gradient[..unknowns].iter().map(|value| value * value).sum::<f64>();
            let members: [Member; MAX_UNKNOWNS / 3] = std::array::from_fn(|a| match blocks.get(a) {
                Some(&Block::Point(point)) => scatter.member(point),
                Some(&Block::Rotation(node)) => {
                    scatter.turning(self.turns[node as usize], node, &state.rotations[node as usize])
                }
                None => Member {
                    follows: Follows::Base,
                    index: 0,
                    lever: Matrix3x6::zeros(),
                    frame: Matrix3::identity(),
                },
            });
            for (a, block) in blocks.iter().enumerate() {
                for i in 0..3 {
                    let value = gradient[3 * a + i];
                    match *block {
                        Block::Point(point) => self.point_forces[point as usize][i] += value,
                        Block::Rotation(node) => self.node_moments[node as usize][i] += value,
                    }
                }
                if !with_tangent {
                    continue;
                }
                for b in 0..=a {
                    let block = Matrix3::from_fn(|i, k| tangent[(3 * b + k) * unknowns + 3 * a + i]);
                    scatter.add(&members[a], &members[b], &block);
                }
            }
        }
        let cap_tangent = scatter.cap_tangent;
        self.reduce(state, load, with_tangent.then_some(cap_tangent), forces);
        forces.energy = energy;
        forces.volume += volume;
        forces.scale = squares.sqrt();
        forces.mismatch = mismatch;
        Ok(())
    }

    /// From forces on points to forces on unknowns, with the loads on the cap and the cap's own tangent.
    fn reduce(
        &mut self,
        state: &SolidState,
        load: &SolidLoad,
        cap_tangent: Option<Matrix6<f64>>,
        forces: &mut Forces,
    ) {
        let dimension = self.pattern.dimension();
        for vector in [&mut forces.residual, &mut forces.condensed, &mut forces.volume_gradient] {
            vector.clear();
            vector.resize(dimension, 0.0);
        }
        let mut turning = Matrix3::zeros();
        let mut on_cap = [Vector6::zeros(); 3];
        for (point, follows) in self.follows.iter().enumerate() {
            let volume = Vector3::from(self.point_volume[point]);
            let outside = load.pressure * volume + self.masses[point] * load.gravity;
            let residual = Vector3::from(self.point_forces[point]) - outside;
            let frame = &self.frames[point];
            let share =
                frame * self.tangent_frames[point].tr_mul(&Vector3::from(self.point_condensed[point]));
            let all = [residual, residual + share, volume];
            match *follows {
                Follows::Base => {}
                Follows::Own(block) => {
                    let vectors = [&mut forces.residual, &mut forces.condensed, &mut forces.volume_gradient];
                    for (vector, force) in vectors.into_iter().zip(all) {
                        let force = frame.tr_mul(&force);
                        for i in 0..3 {
                            vector[self.pattern.first(block) + i] += force[i];
                        }
                    }
                }
                Follows::Cap => {
                    let arm = Vector3::from(state.positions[point]) - state.cap;
                    for (sum, force) in on_cap.iter_mut().zip(all) {
                        *sum += joined(force, arm.cross(&force));
                    }
                    turning += second_turn(all[0], arm);
                }
            }
        }
        for ((turns, moment), rotation) in self.turns.iter().zip(&self.node_moments).zip(&state.rotations) {
            match *turns {
                Follows::Base => {}
                Follows::Own(block) => {
                    for vector in [&mut forces.residual, &mut forces.condensed] {
                        for i in 0..3 {
                            vector[self.pattern.first(block) + i] += moment[i];
                        }
                    }
                }
                Follows::Cap => {
                    let moment = joined(Vector3::zeros(), rotation * Vector3::from(*moment));
                    on_cap[0] += moment;
                    on_cap[1] += moment;
                }
            }
        }
        // The cap's share of the volume is area (c . n)/3, and a turn by w moves n by w x n.
        let normal = state.cap_rotation * Vector3::z();
        let third = self.cap_area / 3.0;
        let cap_volume = third * joined(normal, normal.cross(&state.cap));
        forces.volume = third * state.cap.dot(&normal);
        let share = 1.0 / self.grid.sectors as f64;
        let outside = share * joined(load.force + self.specimen.cap_mass * load.gravity, load.moment)
            + load.pressure * cap_volume;
        on_cap[0] -= outside;
        on_cap[1] -= outside;
        on_cap[2] += cap_volume;
        let vectors = [&mut forces.residual, &mut forces.condensed, &mut forces.volume_gradient];
        for (vector, sum) in vectors.into_iter().zip(on_cap) {
            let (force, moment) = (sum.fixed_rows::<3>(0), sum.fixed_rows::<3>(3));
            let sum = joined(self.cap_frame.tr_mul(&force), self.cap_frame.tr_mul(&moment));
            vector[self.cap_unknown..self.cap_unknown + 6].copy_from_slice(sum.as_slice());
        }
        if let Some(mut tangent) = cap_tangent {
            turning -= load.pressure * third * second_turn(normal, state.cap);
            let coupled = load.pressure * third * normal.cross_matrix();
            let mut block = tangent.fixed_view_mut::<3, 3>(3, 3);
            block += turning;
            let mut block = tangent.fixed_view_mut::<3, 3>(0, 3);
            block += coupled;
            let mut block = tangent.fixed_view_mut::<3, 3>(3, 0);
            block += coupled.transpose();
            let mut frame = Matrix6::zeros();
            frame.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.cap_frame);
            frame.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.cap_frame);
            let tangent = frame.tr_mul(&tangent) * frame;
            let place = self.pattern.place(self.cap_block, self.cap_block);
            for i in 0..6 {
                for j in 0..6 {
                    self.values[place.index(i, j)] += tangent[(i, j)];
                }
            }
        }
    }

    /// Adds dead forces on the cap (force and moment) and gravity to forces on the unknowns.
    pub fn add_dead_loads(&self, [force, moment]: [Vector3<f64>; 2], gravity: Vector3<f64>, on: &mut [f64]) {
        let share = 1.0 / self.grid.sectors as f64;
        let force = self.cap_frame.tr_mul(&(force + self.specimen.cap_mass * gravity));
        let cap = share * joined(force, self.cap_frame.tr_mul(&moment));
        for (value, add) in on[self.cap_unknown..].iter_mut().zip(cap.iter()) {
            *value += add;
        }
        if gravity == Vector3::zeros() {
            return;
        }
        for (point, follows) in self.follows.iter().enumerate() {
            let weight = self.masses[point] * gravity;
            let (first, weight) = match *follows {
                Follows::Base => continue,
                Follows::Own(block) => (self.pattern.first(block), self.frames[point].tr_mul(&weight)),
                // The moment of the rubber on the cap is left to Newton's method.
                Follows::Cap => (self.cap_unknown, self.cap_frame.tr_mul(&weight)),
            };
            (0..3).for_each(|i| on[first + i] += weight[i]);
        }
    }

    /// Adds `factor` times dead forces in space, on all points of their own and on the cap's middle, to forces on the unknowns.
    pub fn add_point_forces(&self, factor: f64, (points, cap): (&[[f64; 3]], Vector3<f64>), on: &mut [f64]) {
        for ((follows, frame), force) in self.follows.iter().zip(&self.frames).zip(points) {
            if let Follows::Own(block) = *follows {
                let first = self.pattern.first(block);
                let force = factor * frame.tr_mul(&Vector3::from(*force));
                (0..3).for_each(|i| on[first + i] += force[i]);
            }
        }
        let force = factor * self.cap_frame.tr_mul(&cap);
        (0..3).for_each(|i| on[self.cap_unknown + i] += force[i]);
    }

    /// Replaces the equations of held motions of the cap by themselves: rows and columns zero, one on the diagonal.
    pub fn take_out_held(&mut self, held: [bool; 6]) {
        for direction in (0..6).filter(|&direction| held[direction]) {
            for &block in &self.beside_cap {
                let place = self.pattern.place(self.cap_block, block);
                for k in 0..self.pattern.size(block) {
                    self.values[place.index(direction, k)] = 0.0;
                    if block == self.cap_block {
                        self.values[place.index(k, direction)] = 0.0;
                    }
                }
            }
            let place = self.pattern.place(self.cap_block, self.cap_block);
            self.values[place.index(direction, direction)] = 1.0;
        }
    }
}

fn joined(force: Vector3<f64>, moment: Vector3<f64>) -> Vector6<f64> {
    Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
}

/// Second derivative of `f . (exp(w) r)` by the turn w at zero, symmetric: (f r^T + r f^T)/2 - (f . r).
fn second_turn(f: Vector3<f64>, r: Vector3<f64>) -> Matrix3<f64> {
    0.5 * (f * r.transpose() + r * f.transpose()) - Matrix3::identity() * f.dot(&r)
}

/// A point, or the frame of a beam's node, in the assembly of the tangent.
#[derive(Clone, Copy)]
struct Member {
    follows: Follows,
    /// Tells members apart.
    index: u32,
    /// Its motion by the cap's, if it follows that.
    lever: Matrix3x6<f64>,
    /// Of its unknowns.
    frame: Matrix3<f64>,
}

/// Where blocks of the tangent go.
struct Scatter<'a> {
    values: &'a mut [f64],
    pattern: &'a BlockPattern,
    follows: &'a [Follows],
    frames: &'a [Matrix3<f64>],
    cap_frame: Matrix3<f64>,
    cap_block: u32,
    positions: &'a [[f64; 3]],
    cap: Vector3<f64>,
    /// Of the cap with itself, in space.
    cap_tangent: Matrix6<f64>,
}

impl Scatter<'_> {
    fn add_element(&mut self, element: &Element, work: &Workspace) {
        let frames = element.points.map(|point| self.frames[point as usize]);
        for pair in &element.pairs {
            let [a, b] = pair.nodes.map(usize::from);
            let block = frames[a].tr_mul(&work.block(a, b)) * frames[b];
            for k in 0..3 {
                for i in 0..3 {
                    self.values[pair.place.index(i, k)] += block[(i, k)];
                }
            }
        }
        for &a in &element.on_cap {
            for b in 0..NODES as u8 {
                if b <= a || !element.on_cap.contains(&b) {
                    let [a, b] = [a, b].map(usize::from);
                    let block = work.block(a, b);
                    let [a, b] = [a, b].map(|a| self.member(element.points[a]));
                    self.add(&a, &b, &block);
                }
            }
        }
    }

    /// A point: a step of the cap moves those on it by [1, -[r]x].
    fn member(&self, point: u32) -> Member {
        let follows = self.follows[point as usize];
        let mut lever = Matrix3x6::zeros();
        if follows == Follows::Cap {
            let arm = Vector3::from(self.positions[point as usize]) - self.cap;
            lever.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
            lever.fixed_view_mut::<3, 3>(0, 3).copy_from(&-arm.cross_matrix());
        }
        Member { follows, index: point, lever, frame: self.frames[point as usize] }
    }

    /// The frame R of a beam's node: a turn W of the cap is R^T W in the frame of one held by it, to all orders.
    fn turning(&self, follows: Follows, node: u32, rotation: &UnitQuaternion<f64>) -> Member {
        let mut lever = Matrix3x6::zeros();
        if follows == Follows::Cap {
            let back = rotation.inverse().to_rotation_matrix();
            lever.fixed_view_mut::<3, 3>(0, 3).copy_from(back.matrix());
        }
        let index = self.follows.len() as u32 + node;
        Member { follows, index, lever, frame: Matrix3::identity() }
    }

    /// Adds the block between two members (points in space) and, where they differ, its transpose between them the other way round.
    fn add(&mut self, p: &Member, q: &Member, block: &Matrix3<f64>) {
        let same = p.index == q.index;
        match (p.follows, q.follows) {
            (Follows::Base, _) | (_, Follows::Base) => {}
            (Follows::Cap, Follows::Cap) => {
                let sum = p.lever.tr_mul(block) * q.lever;
                self.cap_tangent += if same { sum } else { sum + sum.transpose() };
            }
            (Follows::Cap, Follows::Own(b)) => {
                let block = p.lever.tr_mul(&(block * q.frame));
                let place = self.pattern.place(self.cap_block, b);
                for (half, rows) in
                    [0, 3].into_iter().zip([block.fixed_rows::<3>(0), block.fixed_rows::<3>(3)])
                {
                    let rows = self.cap_frame.tr_mul(&rows);
                    for i in 0..3 {
                        for k in 0..3 {
                            self.values[place.index(half + i, k)] += rows[(i, k)];
                        }
                    }
                }
            }
            (Follows::Own(_), Follows::Cap) => self.add(q, p, &block.transpose()),
            (Follows::Own(a), Follows::Own(b)) => {
                let block = p.frame.tr_mul(block) * q.frame;
                let place = self.pattern.place(a, b);
                for i in 0..3 {
                    for k in 0..3 {
                        self.values[place.index(i, k)] += block[(i, k)];
                        if a == b && !same {
                            self.values[place.index(k, i)] += block[(i, k)];
                        }
                    }
                }
            }
        }
    }
}
