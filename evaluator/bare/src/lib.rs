//! The evaluator where there is no operating system, no std and no allocator.
//!
//! This library names none, and brings its own answer to a panic: with an `extern crate std` or `alloc` anywhere below it, it
//! would not build. `tests/tests/bare.rs` links it to `start.c` without the C library and compares its answers.
#![no_std]

use core::{panic::PanicInfo, slice};
use evaluator::{Content, Image, Real};

/// Numbers of memory that effects may take here.
const MEMORY: usize = 1000;
/// Numbers of an answer: position and rotation with derivatives along four pressures, or stretch, expansion and twist with theirs.
const ANSWER: usize = 31;

unsafe extern "C" {
    /// Ends the program.
    safe fn bare_panicked() -> !;
}

#[panic_handler]
fn panicked(_: &PanicInfo<'_>) -> ! {
    bare_panicked()
}

/// The last of some steps of 10 ms; `None` where the image is none or has no answer.
fn answer<T: Real + bytemuck::Pod>(image: &[u8], pressures: &[T]) -> Option<[T; ANSWER]> {
    let image = Image::<T>::read(image).ok()?;
    let chain = image.effects.chain();
    let mut memory = [T::ZERO; MEMORY];
    let memory = memory.get_mut(..chain.memory())?;
    let (mut answer, mut into) = ([T::ZERO; ANSWER], 0);
    let mut put = |numbers: &[T]| {
        answer[into..into + numbers.len()].copy_from_slice(numbers);
        into += numbers.len();
    };
    let step = T::constant(0.01);
    match &image.content {
        Content::Module(tip) => {
            let frees = tip.splines.domain().len().min(4);
            let mut last = None;
            for pressures in pressures.chunks_exact(frees) {
                last = Some(tip.evaluate(&chain, memory, step, pressures).ok()?);
            }
            let last = last?;
            put(&last.pose.position);
            put(&last.pose.rotation);
            put(last.jacobian[..frees].as_flattened());
        }
        Content::Free { splines, winding_angle, shear_modulus } => {
            let mut last = None;
            for pressure in pressures {
                let (angle, modulus) = (*winding_angle, *shear_modulus);
                last = Some(splines.evaluate_after(&chain, memory, step, *pressure, angle, modulus).ok()?);
            }
            let last = last?;
            put(&[last.axial_stretch, last.expansion, last.twist_per_length]);
            put(last.jacobian.as_flattened());
        }
    }
    Some(answer)
}

/// # Safety
/// As [`bare_f64`].
unsafe fn answer_at<T: Real + bytemuck::Pod>(
    image: *const u8,
    bytes: usize,
    pressures: *const T,
    count: usize,
    into: *mut [T; ANSWER],
) -> i32 {
    // SAFETY: the caller's promise.
    let (image, pressures) =
        unsafe { (slice::from_raw_parts(image, bytes), slice::from_raw_parts(pressures, count)) };
    match answer(image, pressures) {
        Some(found) => {
            // SAFETY: the caller's promise.
            unsafe { into.write(found) };
            0
        }
        None => 1,
    }
}

/// Answers of an image in double precision; 0 where it has them.
///
/// # Safety
/// `image` points at `bytes` bytes, `pressures` at `count` numbers, `into` at room for 31.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bare_f64(
    image: *const u8,
    bytes: usize,
    pressures: *const f64,
    count: usize,
    into: *mut [f64; ANSWER],
) -> i32 {
    // SAFETY: the caller's promise.
    unsafe { answer_at(image, bytes, pressures, count, into) }
}

/// As [`bare_f64`], in single precision.
///
/// # Safety
/// As [`bare_f64`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bare_f32(
    image: *const u8,
    bytes: usize,
    pressures: *const f32,
    count: usize,
    into: *mut [f32; ANSWER],
) -> i32 {
    // SAFETY: the caller's promise.
    unsafe { answer_at(image, bytes, pressures, count, into) }
}
