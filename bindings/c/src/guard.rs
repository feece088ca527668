//! No panic leaves the library.

use crate::Code;

/// The number of a call's code. A panic inside is one of the codes where there is std to catch it.
#[cfg(feature = "std")]
pub fn guard(call: impl FnOnce() -> Result<(), Code>) -> i32 {
    // What a call leaves behind when it is given up is plain numbers in the caller's memory.
    let ended = std::panic::catch_unwind(std::panic::AssertUnwindSafe(call));
    ended.unwrap_or(Err(Code::Panicked)).err().unwrap_or(Code::Ok) as i32
}

/// The number of a call's code.
#[cfg(not(feature = "std"))]
pub fn guard(call: impl FnOnce() -> Result<(), Code>) -> i32 {
    call().err().unwrap_or(Code::Ok) as i32
}

#[cfg(not(feature = "std"))]
unsafe extern "C" {
    /// The program's answer to a panic, which must not return.
    safe fn freeact_panicked() -> !;
}

#[cfg(not(any(feature = "std", test)))]
#[panic_handler]
fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
    freeact_panicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_code() {
        assert_eq!(guard(|| Ok(())), 0);
        assert_eq!(guard(|| Err(Code::NotOpen)), Code::NotOpen as i32);
        assert_eq!(guard(|| panic!("seen by nobody")), Code::Panicked as i32);
    }
}
