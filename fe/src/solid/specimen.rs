use super::{SolidError, fibre::Fibres, mesh::Grid};
use actuator::{Elastomer, Free, Tube, Winding};

/// A layer of rubber over tube and fibres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// Thickness, m.
    pub thickness: f64,
    /// Its rubber.
    pub elastomer: Elastomer,
}

/// What a fibre resists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FibreModel {
    /// Stretch alone.
    #[default]
    Truss,
    /// Stretch, bending and twist, as a round bar of its diameter whose ends are clamped to the caps.
    Beam,
}

/// A FREE as a body: everything that the drawing says, and what a real one has beyond it.
#[derive(Clone, Debug, PartialEq)]
pub struct Specimen {
    /// The tube; rigid caps close it at z = 0 and z = length.
    pub tube: Tube,
    /// Its rubber.
    pub elastomer: Elastomer,
    /// Families of fibres on the tube's outer surface; none for a bare tube.
    pub windings: Vec<Winding>,
    /// What the fibres resist.
    pub fibre_model: FibreModel,
    /// Rubber over the fibres.
    pub coat: Option<Coat>,
    /// Place of the bore's axis in the tube's cross-section at the base and at the tip, m: zero for a concentric bore. The wall
    /// is thinnest where the bore is shifted to.
    pub bore_offset: [[f64; 2]; 2],
    /// Wall thickness at the tip over the one at the base, the bore unchanged: 1 for an even tube.
    pub wall_taper: f64,
    /// Bulk over shear modulus of the rubber.
    pub bulk_ratio: f64,
    /// Mass density of the rubber, kg/m^3; natural rubber 920 to 960.
    pub density: f64,
    /// Mass of the tip's cap, kg.
    pub cap_mass: f64,
}

/// Bulk over shear modulus of natural rubber is 2,000 to 5,000; at 10^4 a bare tube is within 1e-5 of the incompressible one.
const BULK_RATIO: f64 = 1e4;

impl From<&Free> for Specimen {
    fn from(free: &Free) -> Self {
        Specimen {
            tube: free.tube,
            elastomer: free.elastomer,
            windings: if free.winding.fibres == 0 { vec![] } else { vec![free.winding] },
            fibre_model: FibreModel::Truss,
            coat: None,
            bore_offset: [[0.0; 2]; 2],
            wall_taper: 1.0,
            bulk_ratio: BULK_RATIO,
            density: 930.0,
            cap_mass: 0.0,
        }
    }
}

impl Specimen {
    /// Checks every number.
    ///
    /// # Errors
    /// [`SolidError::Invalid`] with the number and what would be accepted.
    pub fn check(&self) -> Result<(), SolidError> {
        let Tube { length, inner_radius, wall } = self.tube;
        let positive = |field, value: f64| {
            (value.is_finite() && value > 0.0).then_some(()).ok_or(SolidError::Invalid {
                field,
                value,
                requirement: "it must be positive",
            })
        };
        positive("the tube's length (m)", length)?;
        positive("the tube's inner radius (m)", inner_radius)?;
        positive("the wall (m)", wall)?;
        positive("the initial shear modulus (Pa)", self.elastomer.initial_shear_modulus())?;
        positive("the wall taper", self.wall_taper)?;
        let refuse = |field, value, requirement| Err(SolidError::Invalid { field, value, requirement });
        if wall > inner_radius * 100.0 {
            return refuse(
                "the wall (m)",
                wall,
                "it may be at most 100 times the inner radius: is the unit right?",
            );
        }
        if !(1.0..=1e7).contains(&self.bulk_ratio) {
            return refuse("bulk over shear modulus", self.bulk_ratio, "it must lie between 1 and 1e7");
        }
        if !(self.density >= 0.0 && self.cap_mass >= 0.0) {
            return refuse("a mass", self.density.min(self.cap_mass), "it must not be negative");
        }
        for offset in self.bore_offset {
            let shift = offset[0].hypot(offset[1]);
            if shift.is_nan() || shift >= 0.95 * wall * self.wall_taper.min(1.0) {
                return refuse(
                    "the bore's offset (m)",
                    shift,
                    "the bore must stay inside the tube by 5 % of the wall",
                );
            }
        }
        if let Some(coat) = self.coat {
            positive("the coat's thickness (m)", coat.thickness)?;
            positive("the coat's initial shear modulus (Pa)", coat.elastomer.initial_shear_modulus())?;
        }
        for winding in &self.windings {
            let angle = winding.angle_from_hoop().to_degrees();
            if !(1.0..=90.0).contains(&angle) {
                return refuse(
                    "the winding angle from the hoop (deg)",
                    angle,
                    "a solid takes 1 to 90: at 0 the fibres are rings that never reach the caps",
                );
            }
            positive("the fibres' axial stiffness EA (N)", winding.fibre.axial_stiffness)?;
            if winding.fibres == 0 {
                return refuse(
                    "the number of fibres of a family",
                    0.0,
                    "leave the family out, or give it a fibre",
                );
            }
        }
        Ok(())
    }

    /// Its fibres in a mesh.
    pub(super) fn fibres(&self, grid: &Grid) -> Result<Fibres, SolidError> {
        match self.fibre_model {
            FibreModel::Truss => Fibres::trusses(self, grid),
            FibreModel::Beam => Fibres::beams(self, grid),
        }
    }

    /// Turn of the first family's fibres per length along the tube, signed by its hand, rad/m; zero for a bare tube.
    pub(super) fn turn_per_length(&self) -> f64 {
        self.windings.first().map_or(0.0, |winding| {
            winding.handedness.sign() * winding.turn_per_length(self.tube.outer_radius())
        })
    }

    /// Whether a turn by one fibre pitch carries the whole specimen into itself: one family, even wall. The number of pitches; a
    /// bare tube is the same at every turn, and is cut in six.
    pub(super) fn cyclic_order(&self) -> Option<usize> {
        let even = self.bore_offset == [[0.0; 2]; 2];
        match &self.windings[..] {
            [winding] if even => Some(winding.fibres as usize),
            [] if even => Some(6),
            _ => None,
        }
    }
}
