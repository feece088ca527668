use crate::{
    CapResponse, SolidError, SolidLoad, SolidMesh, SolidSolver, SolidState, Specimen,
    contact::Tube,
    rigid_motion::Frame,
    tip_plate::{at_arm, shifted},
};
use actuator::{Module, PlacedFree, units::STANDARD_GRAVITY};
use nalgebra::{Matrix6, Vector3};

/// A FREE of a module as a solid, and where it stands on the plates.
pub(super) struct JoinedFree {
    pub solver: SolidSolver,
    /// Its tangent as the plate feels it, of the configuration linearised last.
    pub response: Option<CapResponse>,
    /// Place of its axis on both plates, m.
    axis: Vector3<f64>,
    /// Its own length less the module's, m: by this it is too long where all are put between the plates.
    surplus: f64,
    /// Its own length, m.
    length: f64,
    gravity: Vector3<f64>,
}

impl JoinedFree {
    pub fn new(module: &Module, placed: &PlacedFree, mesh: SolidMesh) -> Result<Self, SolidError> {
        let (free, base) = (&placed.free, &module.base);
        let density = base.free_mass / (free.tube.wall_area() * free.tube.length);
        let specimen = Specimen { density, ..Specimen::from(free) };
        let [x, y] = placed.position;
        Ok(JoinedFree {
            solver: SolidSolver::new(&specimen, mesh)?,
            response: None,
            axis: Vector3::new(x, y, 0.0),
            length: free.tube.length,
            surplus: free.tube.length - module.length(),
            gravity: Vector3::from(base.gravity) * STANDARD_GRAVITY,
        })
    }

    /// Place of its axis on both plates, m.
    pub fn axis(&self) -> Vector3<f64> {
        self.axis
    }

    /// Place of the cap in the plate's frame, where a part of the way from rest has been made: FREEs of unequal lengths are put
    /// between the plates on it.
    fn arm(&self, part: f64) -> Vector3<f64> {
        self.axis + Vector3::z() * (self.surplus * (1.0 - part))
    }

    /// The cap in the FREE's own frame, whose origin is on the base plate.
    pub fn cap(&self, plate: &Frame, part: f64) -> Frame {
        let cap = shifted(plate, &self.arm(part));
        Frame { position: cap.position - self.axis, ..cap }
    }

    /// The tube as straight pieces between its planes of points, on the base plate.
    pub fn tube(&self, state: &SolidState) -> Tube {
        let line = self.solver.centreline(state);
        Tube {
            points: line.iter().map(|(middle, _)| middle + self.axis).collect(),
            radii: line.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1)).collect(),
            piece: self.length / (line.len() - 1) as f64,
        }
    }

    /// Motion of the cap for a motion of the plate, each in its own frame's directions.
    pub fn lever(&self, part: f64) -> Matrix6<f64> {
        at_arm(&self.arm(part))
    }

    /// Shift of the cap in the plate's frame per part of the way from rest, m.
    pub fn closing(&self) -> Vector3<f64> {
        Vector3::z() * -self.surplus
    }

    pub fn load(&self, pressure: f64, part: f64) -> SolidLoad {
        SolidSolver::joined_load(pressure, self.gravity * part)
    }
}
