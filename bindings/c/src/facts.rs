use crate::Model;
use bytemuck::Pod;
use evaluator::{Content, MAX_AXES, Real};

/// What a model is of, and where it answers: `freeact_facts_f64` and `freeact_facts_f32`.
#[repr(C)]
pub struct Facts<T> {
    /// 1 of a single FREE, 2 of a module.
    kind: u32,
    /// Number of FREEs.
    frees: u32,
    /// Numbers of memory that the effects need.
    memory: u32,
    /// Whether there are error bars.
    has_error_bars: u32,
    /// Least pressure of each FREE, Pa.
    least_pressure_pa: [T; MAX_AXES],
    /// Greatest, Pa; of a single FREE that at its own angle and modulus, zero where the model does not know these.
    greatest_pressure_pa: [T; MAX_AXES],
    /// A single FREE's own angle from the hoop, and the least and greatest that the model knows, rad.
    winding_angle_rad: [T; 3],
    /// Its own shear modulus, and the least and greatest, Pa.
    shear_modulus_pa: [T; 3],
}

impl<T: Real + Pod> Facts<T> {
    /// The facts of a model.
    pub fn of(model: &Model<T>) -> Self {
        // An image holds less effects and FREEs than there are 32-bit numbers.
        let memory = model.image().effects.chain().memory() as u32;
        let mut facts = Facts {
            kind: evaluator::MODULE,
            frees: model.frees() as u32,
            memory,
            has_error_bars: 0,
            least_pressure_pa: [T::ZERO; MAX_AXES],
            greatest_pressure_pa: [T::ZERO; MAX_AXES],
            winding_angle_rad: [T::ZERO; 3],
            shear_modulus_pa: [T::ZERO; 3],
        };
        match &model.image().content {
            Content::Module(tip) => {
                facts.has_error_bars = u32::from(!tip.splines.bars().is_empty());
                for (free, (least, greatest)) in tip.splines.domain().iter().enumerate() {
                    facts.least_pressure_pa[free] = *least;
                    facts.greatest_pressure_pa[free] = *greatest;
                }
            }
            Content::Free { splines, winding_angle, shear_modulus } => {
                facts.kind = evaluator::FREE;
                let (angles, moduli) = splines.axes();
                let ((least, greatest), (softest, stiffest)) = (angles.range(), moduli.range());
                facts.winding_angle_rad = [*winding_angle, least, greatest];
                facts.shear_modulus_pa = [*shear_modulus, softest, stiffest];
                // A map need not hold the FREE's own angle and modulus.
                let greatest = splines.greatest_pressure(*winding_angle, *shear_modulus);
                facts.greatest_pressure_pa[0] = greatest.unwrap_or(T::ZERO);
            }
        }
        facts
    }
}
