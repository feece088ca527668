use super::{
    body::{Body, Follows},
    element::{Inverted, PAIRS, UNKNOWNS},
    enclosed_volume::{FACE, FaceVolume},
    face_pressure::FacePressure,
    fibre::{Block, MAX_UNKNOWNS},
    scatter::{Member, Scatter},
    shape::NODES,
    state::{SolidLoad, SolidState, set_local_frames},
};
use nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};

/// Sums over the body of a configuration.
#[derive(Clone, Debug, Default)]
pub(super) struct Forces {
    /// Internal less external forces on the unknowns, N (N m for turns): zero in equilibrium.
    pub residual: Vec<f64>,
    /// The same with the elements' pressures eliminated: the right-hand side of a Newton step.
    pub condensed: Vec<f64>,
    /// Forces on the unknowns per unit of pressure, m^2: with closed ends the derivative of the volume.
    pub by_pressure: Vec<f64>,
    /// Size of the forces that cancel, N.
    pub scale: f64,
    /// Largest |integral (J - 1 - q/kappa) dV| of an element over its volume.
    pub mismatch: f64,
    pub energy: f64,
    pub volume: f64,
}

impl Body {
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
            &mut self.point_pressed,
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
                let face = FaceVolume::new(&self.face_table, &nodes, pressed && !load.open_ends);
                volume += face.volume;
                let open = load.open_ends.then(|| FacePressure::new(&self.face_table, &nodes));
                let gradient = open.as_ref().map_or(&face.gradient, |open| &open.forces);
                for (a, gradient) in ON_BORE.into_iter().zip(gradient) {
                    let sum = &mut self.point_pressed[element.points[a] as usize];
                    sum.iter_mut().zip(gradient).for_each(|(sum, value)| *sum += value);
                }
                if let (true, Some(open)) = (pressed, &open) {
                    for (&(i, k), block) in PAIRS.iter().zip(work.tangent.chunks_exact_mut(NODES * NODES)) {
                        for (a, row) in ON_BORE.into_iter().enumerate() {
                            for (b, column) in ON_BORE.into_iter().enumerate() {
                                // The tangent is kept symmetric; what is left out vanishes but at free edges.
                                let both = open.tangent[a][b][i][k] + open.tangent[b][a][k][i];
                                block[column * NODES + row] -= 0.5 * load.pressure * both;
                            }
                        }
                    }
                } else if pressed {
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
        for (index, fibre) in self.fibres.elements.iter().enumerate() {
            energy += fibre
                .evaluate(&state.positions, &state.rotations, &mut gradient, &mut tangent)
                .ok_or(Inverted)?;
            if let (true, Some(foreseen)) = (with_tangent, &self.foreseen) {
                foreseen.put_into(index, fibre, &state.positions, &mut tangent).ok_or(Inverted)?;
            }
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
        for vector in [&mut forces.residual, &mut forces.condensed, &mut forces.by_pressure] {
            vector.clear();
            vector.resize(dimension, 0.0);
        }
        let mut turning = Matrix3::zeros();
        let mut on_cap = [Vector6::zeros(); 3];
        for (point, follows) in self.follows.iter().enumerate() {
            let volume = Vector3::from(self.point_pressed[point]);
            let outside = load.pressure * volume + self.masses[point] * load.gravity;
            let residual = Vector3::from(self.point_forces[point]) - outside;
            let frame = &self.frames[point];
            let share =
                frame * self.tangent_frames[point].tr_mul(&Vector3::from(self.point_condensed[point]));
            let all = [residual, residual + share, volume];
            match *follows {
                Follows::Base => {}
                Follows::Own(block) => {
                    let vectors = [&mut forces.residual, &mut forces.condensed, &mut forces.by_pressure];
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
        let pressed = if load.open_ends { 0.0 } else { load.pressure };
        let cap_volume = third * joined(normal, normal.cross(&state.cap));
        forces.volume = third * state.cap.dot(&normal);
        let share = 1.0 / self.grid.sectors as f64;
        let outside = share * joined(load.force + self.specimen.cap_mass * load.gravity, load.moment)
            + pressed * cap_volume;
        on_cap[0] -= outside;
        on_cap[1] -= outside;
        if !load.open_ends {
            on_cap[2] += cap_volume;
        }
        let vectors = [&mut forces.residual, &mut forces.condensed, &mut forces.by_pressure];
        for (vector, sum) in vectors.into_iter().zip(on_cap) {
            let (force, moment) = (sum.fixed_rows::<3>(0), sum.fixed_rows::<3>(3));
            let sum = joined(self.cap_frame.tr_mul(&force), self.cap_frame.tr_mul(&moment));
            vector[self.cap_unknown..self.cap_unknown + 6].copy_from_slice(sum.as_slice());
        }
        if let Some(mut tangent) = cap_tangent {
            turning -= pressed * third * second_turn(normal, state.cap);
            let coupled = pressed * third * normal.cross_matrix();
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

    /// Work of the load's gravity on the rubber on its way from the undeformed body, J; without the cap's own mass.
    pub fn weight_work(&self, state: &SolidState) -> f64 {
        let moved =
            |point: usize| Vector3::from(state.positions[point]) - Vector3::from(self.grid.points[point]);
        let gravity = state.load.gravity;
        self.masses.iter().enumerate().map(|(point, mass)| mass * gravity.dot(&moved(point))).sum()
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
