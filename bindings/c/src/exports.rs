//! The functions of `freeact.h`, in both precisions.

use crate::{
    Code,
    answer::{Deformation, Pose},
    facts::Facts,
    guard::guard,
    model::{Model, Room},
    pointer,
};
use core::ffi::{CStr, c_char};

/// Version of the calls, as `FREEACT_ABI`.
const ABI: u32 = 1;

/// The version of the calls; another than the header's `FREEACT_ABI` is not to be called.
#[unsafe(no_mangle)]
pub extern "C" fn freeact_abi() -> u32 {
    ABI
}

/// The version of freeact, as text.
#[unsafe(no_mangle)]
pub extern "C" fn freeact_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => panic!("a version holds no zero"),
        };
    VERSION.as_ptr()
}

/// The newest version of images that are read.
#[unsafe(no_mangle)]
pub extern "C" fn freeact_image_version() -> u32 {
    evaluator::VERSION
}

/// What a code means and what helps, as text that stays.
#[unsafe(no_mangle)]
pub extern "C" fn freeact_error_text(code: i32) -> *const c_char {
    Code::from_number(code).map_or(c"no code of freeact", Code::text).as_ptr()
}

/// The functions of one precision. What each promises, and asks for, is in `freeact.h`.
macro_rules! exports {
    ($number:ty, $open:ident, $describe:ident, $reset:ident, $supply:ident, $unread:ident, $tip:ident, $free:ident,
     $clearance:ident, $error_bars:ident, $greatest_pressure:ident) => {
        /// Opens an image where it lies.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $open(model: *mut Room, image: *const u8, bytes: usize) -> i32 {
            // SAFETY: the caller's promise.
            guard(|| unsafe { Model::<$number>::open(model, image, bytes) })
        }

        /// What a model is of, and where it answers.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $describe(model: *const Room, facts: *mut Facts<$number>) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                // SAFETY: the caller's promise.
                unsafe { pointer::put(facts, Facts::of(model)) }
            })
        }

        /// Memory of an actuator that has rested.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $reset(model: *const Room, memory: *mut $number, length: usize) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                // SAFETY: the caller's promise.
                unsafe { pointer::memory(memory, length, model.memory()) }?.fill(0.0);
                Ok(())
            })
        }

        /// Commands to pressures in the FREEs.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $supply(
            model: *const Room,
            memory: *mut $number,
            length: usize,
            step: $number,
            pressures: *mut $number,
            frees: usize,
        ) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                // SAFETY: the caller's promise.
                let mut copy = unsafe { pointer::pressures(pressures, frees, model.frees()) }?;
                {
                    // SAFETY: the caller's promise.
                    let memory = unsafe { pointer::memory(memory, length, model.memory()) }?;
                    model.supply(memory, step, &mut copy[..frees])?;
                }
                // SAFETY: as many were read there.
                unsafe { pointer::put_all(pressures, &copy[..frees]) }
            })
        }

        /// Pressures read to pressures in the FREEs.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $unread(model: *const Room, pressures: *mut $number, frees: usize) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                // SAFETY: the caller's promise.
                let mut copy = unsafe { pointer::pressures(pressures, frees, model.frees()) }?;
                model.unread(&mut copy[..frees]);
                // SAFETY: as many were read there.
                unsafe { pointer::put_all(pressures, &copy[..frees]) }
            })
        }

        /// Tip pose of a module.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $tip(
            model: *const Room,
            memory: *mut $number,
            length: usize,
            step: $number,
            pressures: *const $number,
            frees: usize,
            pose: *mut Pose<$number>,
        ) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                model.module()?;
                pointer::check(pose)?;
                // SAFETY: the caller's promise.
                let copy = unsafe { pointer::pressures(pressures, frees, model.frees()) }?;
                let found = {
                    // SAFETY: the caller's promise.
                    let memory = unsafe { pointer::memory(memory, length, model.memory()) }?;
                    model.tip(memory, step, &copy[..frees])?
                };
                // SAFETY: the caller's promise.
                unsafe { pointer::put(pose, found) }
            })
        }

        /// Deformation of a FREE.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $free(
            model: *const Room,
            memory: *mut $number,
            length: usize,
            step: $number,
            pressure: $number,
            winding_angle: $number,
            shear_modulus: $number,
            deformation: *mut Deformation<$number>,
        ) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                model.free()?;
                pointer::check(deformation)?;
                let at = [pressure, winding_angle, shear_modulus];
                if !at.iter().all(|number| number.is_finite()) {
                    return Err(Code::NotFinite);
                }
                let found = {
                    // SAFETY: the caller's promise.
                    let memory = unsafe { pointer::memory(memory, length, model.memory()) }?;
                    model.deformation(memory, step, at)?
                };
                // SAFETY: the caller's promise.
                unsafe { pointer::put(deformation, found) }
            })
        }

        /// How far every pressure of a module may change at once.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $clearance(
            model: *const Room,
            pressures: *const $number,
            frees: usize,
            clearance: *mut $number,
        ) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                // SAFETY: the caller's promise.
                let copy = unsafe { pointer::pressures(pressures, frees, model.frees()) }?;
                let found = model.clearance(&copy[..frees])?;
                // SAFETY: the caller's promise.
                unsafe { pointer::put(clearance, found) }
            })
        }

        /// Error bars of a module.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $error_bars(
            model: *const Room,
            pressures: *const $number,
            frees: usize,
            bars: *mut [$number; 2],
        ) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                // SAFETY: the caller's promise.
                let copy = unsafe { pointer::pressures(pressures, frees, model.frees()) }?;
                let found = model.error_bars(&copy[..frees])?;
                // SAFETY: the caller's promise.
                unsafe { pointer::put(bars, found) }
            })
        }

        /// Greatest pressure of a FREE.
        ///
        /// # Safety
        /// As in `freeact.h`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $greatest_pressure(
            model: *const Room,
            winding_angle: $number,
            shear_modulus: $number,
            pressure: *mut $number,
        ) -> i32 {
            guard(|| {
                // SAFETY: the caller's promise.
                let model = unsafe { Model::<$number>::of(model) }?;
                let found = model.greatest_pressure(winding_angle, shear_modulus)?;
                // SAFETY: the caller's promise.
                unsafe { pointer::put(pressure, found) }
            })
        }
    };
}

exports!(
    f64,
    freeact_open_f64,
    freeact_describe_f64,
    freeact_reset_f64,
    freeact_supply_f64,
    freeact_unread_f64,
    freeact_tip_f64,
    freeact_free_f64,
    freeact_clearance_f64,
    freeact_error_bars_f64,
    freeact_greatest_pressure_f64
);
exports!(
    f32,
    freeact_open_f32,
    freeact_describe_f32,
    freeact_reset_f32,
    freeact_supply_f32,
    freeact_unread_f32,
    freeact_tip_f32,
    freeact_free_f32,
    freeact_clearance_f32,
    freeact_error_bars_f32,
    freeact_greatest_pressure_f32
);
