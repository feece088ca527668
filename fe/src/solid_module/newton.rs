use super::{
    equations::{Loads, Sums},
    equilibrium::SolidShape,
    module::SolidModule,
};
use crate::Lost;

/// Relative residual of a converged state.
const TOLERANCE: f64 = 1e-9;
/// A residual below this that a step does not halve is what rounding leaves.
const ROUNDING: f64 = 1e-8;
/// Tangents on the way to one state.
const TANGENTS: usize = 7;
/// Error below which an old tangent does: stiff fibres that have turned since it was taken pass for stiffness against soft motions.
const CHORD: f64 = 1e-6;
/// Steps with an old tangent go on while each leaves at most this share of the error.
const CHORD_SHARE: f64 = 0.3;
/// A step may let the residual grow so much before it is shortened: the fibres answer to its curvature, and the next step corrects that.
const GROWTH: f64 = 20.0;
/// Parts of a step that are tried.
const TRIES: usize = 6;

/// A configuration in equilibrium.
pub(super) struct Found {
    pub shape: SolidShape,
    /// Tangents that it took beside the one there was.
    pub tangents: usize,
}

impl SolidModule {
    /// The equilibrium near `guess`. `has_tangent`: whether the tangent factorised last was taken nearby.
    pub(super) fn equilibrate(
        &mut self,
        guess: SolidShape,
        loads: &Loads,
        has_tangent: bool,
    ) -> Result<Found, Lost> {
        let mut shape = guess;
        let mut sums = self.assemble(&shape, loads, false)?;
        let (mut tangents, mut renew, mut stalled, mut steps) = (0, !has_tangent, false, 0);
        // A first guess may have small forces far from where they vanish: bending is soft. It takes one step at least.
        while steps == 0 || sums.error >= TOLERANCE && !stalled {
            steps += 1;
            if renew || sums.error > CHORD {
                if tangents == TANGENTS {
                    return Err(Lost(sums.error));
                }
                tangents += 1;
                sums = self.assemble(&shape, loads, true)?;
                self.factorise(&shape, loads, &sums)?;
            }
            let (next, found) = self.line(&shape, loads, &sums)?;
            renew = found.error > CHORD_SHARE * sums.error;
            stalled = sums.error < ROUNDING && found.error > 0.5 * sums.error;
            (shape, sums) = (next, found);
        }
        Ok(Found { shape, tangents })
    }

    /// A step of Newton's method: the longest part of it of those tried that does not let the residual run away, else the best of
    /// them.
    fn line(&mut self, shape: &SolidShape, loads: &Loads, sums: &Sums) -> Result<(SolidShape, Sums), Lost> {
        let (plate, motions) = self.step(shape, loads, sums)?;
        let mut best: Option<(SolidShape, Sums, f64)> = None;
        let mut part = 1.0;
        let mut last = part;
        for _ in 0..TRIES {
            last = part;
            let trial = self.moved(shape, (&plate, &motions), part, loads);
            if let Ok(found) = self.assemble(&trial, loads, false)
                && best.as_ref().is_none_or(|(_, best, _)| found.error < best.error)
            {
                best = Some((trial, found, part));
            }
            match &best {
                Some((_, found, _)) if found.error < GROWTH * sums.error.max(1e-4) => break,
                _ => part *= 0.5,
            }
        }
        let (next, mut found, part) = best.ok_or(Lost(f64::NAN))?;
        if part != last {
            // The FREEs hold the sums of the last trial, and what was foreseen for it.
            self.each(|_, free| free.solver.forget_foreseen());
            found = self.assemble(&next, loads, false)?;
        }
        Ok((next, found))
    }
}
