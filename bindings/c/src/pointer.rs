//! What a caller's pointers lead to, after all of them that can be checked was checked.

use crate::Code;
use core::slice;
use evaluator::{MAX_AXES, Real};

/// Refuses a pointer that is null or not aligned.
pub fn check<P>(pointer: *const P) -> Result<(), Code> {
    if pointer.is_null() {
        Err(Code::NullPointer)
    } else if !pointer.is_aligned() {
        Err(Code::Misaligned)
    } else {
        Ok(())
    }
}

/// The bytes at a pointer.
///
/// # Safety
/// They are there, and stay as they are for `'a`.
pub unsafe fn bytes<'a>(pointer: *const u8, count: usize) -> Result<&'a [u8], Code> {
    check(pointer)?;
    if isize::try_from(count).is_err() {
        return Err(Code::ImageLength);
    }
    // SAFETY: neither null nor too long, and there by the caller's promise.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

/// A copy of one pressure a FREE, all of them finite.
///
/// # Safety
/// There are `count` numbers.
pub unsafe fn pressures<T: Real>(
    pointer: *const T,
    count: usize,
    frees: usize,
) -> Result<[T; MAX_AXES], Code> {
    check(pointer)?;
    if count != frees {
        return Err(Code::WrongCount);
    }
    let mut copy = [T::ZERO; MAX_AXES];
    for (index, pressure) in copy.iter_mut().enumerate().take(count) {
        // SAFETY: aligned, and one of the numbers that are there by the caller's promise.
        *pressure = unsafe { pointer.add(index).read() };
    }
    if copy.iter().all(|pressure| pressure.is_finite()) { Ok(copy) } else { Err(Code::NotFinite) }
}

/// The effects' memory: the first `needed` of `count` numbers. Of none that are needed the pointer may be anything.
///
/// # Safety
/// They are there, and nobody else touches them for `'a`.
pub unsafe fn memory<'a, T>(pointer: *mut T, count: usize, needed: usize) -> Result<&'a mut [T], Code> {
    if needed == 0 {
        return Ok(&mut []);
    }
    check(pointer)?;
    if count < needed {
        return Err(Code::ShortMemory);
    }
    // SAFETY: aligned, not null, and there by the caller's promise; a model's memory is far shorter than memory can be.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, needed) })
}

/// Puts a value where a pointer leads.
///
/// # Safety
/// There is room for it.
pub unsafe fn put<V>(pointer: *mut V, value: V) -> Result<(), Code> {
    check(pointer)?;
    // SAFETY: aligned, not null, with room by the caller's promise.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Puts numbers where a pointer leads.
///
/// # Safety
/// There is room for them.
pub unsafe fn put_all<T: Copy>(pointer: *mut T, values: &[T]) -> Result<(), Code> {
    check(pointer)?;
    for (index, value) in values.iter().enumerate() {
        // SAFETY: aligned, not null, with room by the caller's promise.
        unsafe { pointer.add(index).write(*value) };
    }
    Ok(())
}
