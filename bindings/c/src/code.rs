use core::ffi::CStr;
use evaluator::{ImageError, OutsideFree, OutsideModule};

/// How a call ended; the numbers are those of `freeact.h` and never change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// It has its answer.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// A pointer is not aligned for what it points at.
    Misaligned = 2,
    /// The model was not opened, or not in this precision.
    NotOpen = 3,
    /// Asked a FREE what only a module answers, or the other way round.
    WrongKind = 4,
    /// Not as many pressures as FREEs.
    WrongCount = 5,
    /// The memory has fewer numbers than the model's effects need.
    ShortMemory = 6,
    /// A number given is infinite or none.
    NotFinite = 7,
    /// A step in time is negative.
    NegativeStep = 8,
    /// See [`ImageError::NoImage`].
    NoImage = 10,
    /// See [`ImageError::Version`].
    ImageVersion = 11,
    /// See [`ImageError::Precision`].
    ImagePrecision = 12,
    /// See [`ImageError::Address`].
    ImageAddress = 13,
    /// See [`ImageError::Endian`].
    ImageEndian = 14,
    /// See [`ImageError::Length`].
    ImageLength = 15,
    /// See [`ImageError::Checksum`].
    ImageChecksum = 16,
    /// See [`ImageError::UnknownEffect`].
    ImageUnknownEffect = 17,
    /// See [`ImageError::Content`].
    ImageContent = 18,
    /// A pressure outside the domain.
    OutsidePressure = 20,
    /// Pressures beyond the stable states.
    Unstable = 21,
    /// A winding angle outside the domain.
    OutsideAngle = 22,
    /// A shear modulus outside the domain.
    OutsideModulus = 23,
    /// The model was made without states to judge it by.
    NoErrorBars = 24,
    /// A defect of the library.
    Panicked = 30,
}

impl Code {
    const ALL: [Code; 24] = [
        Code::Ok,
        Code::NullPointer,
        Code::Misaligned,
        Code::NotOpen,
        Code::WrongKind,
        Code::WrongCount,
        Code::ShortMemory,
        Code::NotFinite,
        Code::NegativeStep,
        Code::NoImage,
        Code::ImageVersion,
        Code::ImagePrecision,
        Code::ImageAddress,
        Code::ImageEndian,
        Code::ImageLength,
        Code::ImageChecksum,
        Code::ImageUnknownEffect,
        Code::ImageContent,
        Code::OutsidePressure,
        Code::Unstable,
        Code::OutsideAngle,
        Code::OutsideModulus,
        Code::NoErrorBars,
        Code::Panicked,
    ];

    /// The code of a number.
    pub fn from_number(number: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|code| *code as i32 == number)
    }

    /// What it means and what helps.
    pub fn text(self) -> &'static CStr {
        match self {
            Code::Ok => c"done",
            Code::NullPointer => c"a pointer is null",
            Code::Misaligned => c"a pointer is not aligned for what it points at",
            Code::NotOpen => c"the model is not open in this precision; call freeact_open first",
            Code::WrongKind => {
                c"a single FREE is asked what only a module answers, or a module what only a FREE answers"
            }
            Code::WrongCount => c"there are not as many pressures as the model has FREEs",
            Code::ShortMemory => c"the memory has fewer numbers than the facts of the model ask for",
            Code::NotFinite => c"a number is infinite or not a number",
            Code::NegativeStep => c"the step in time is negative",
            Code::NoImage => c"not a freeact image; make one with `freeact export`",
            Code::ImageVersion => c"the image is of a version that this library does not know; use a newer one",
            Code::ImagePrecision => c"the image is of the other precision; export it again, or open it in its own",
            Code::ImageAddress => {
                c"the image does not lie at an address that is a multiple of the size of its numbers; align it to 8 bytes"
            }
            Code::ImageEndian => c"this processor is big-endian, images are little-endian",
            Code::ImageLength => c"the image ends early or goes on too long; fetch a whole copy",
            Code::ImageChecksum => c"the image is damaged: its checksum does not match",
            Code::ImageUnknownEffect => c"the image has an effect that this library does not know; use a newer one",
            Code::ImageContent => c"the image does not hold together; export it again",
            Code::OutsidePressure => c"a pressure is outside the model's domain",
            Code::Unstable => {
                c"the pressures are beyond the stable states that the finite elements found: the module buckles on the way, or has no equilibrium there"
            }
            Code::OutsideAngle => c"the winding angle is outside the model's domain",
            Code::OutsideModulus => c"the shear modulus is outside the model's domain",
            Code::NoErrorBars => c"the model was made without states to judge it by, so that it has no error bars",
            Code::Panicked => c"a defect of freeact: the call was given up; please report it",
        }
    }
}

impl From<ImageError> for Code {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::NoImage => Code::NoImage,
            ImageError::Version(_) => Code::ImageVersion,
            ImageError::Precision(_) => Code::ImagePrecision,
            ImageError::Address => Code::ImageAddress,
            ImageError::Endian => Code::ImageEndian,
            ImageError::Length => Code::ImageLength,
            ImageError::Checksum => Code::ImageChecksum,
            ImageError::UnknownEffect(_) => Code::ImageUnknownEffect,
            ImageError::Content(_) => Code::ImageContent,
        }
    }
}

impl<T> From<OutsideModule<T>> for Code {
    fn from(outside: OutsideModule<T>) -> Self {
        match outside {
            OutsideModule::Pressure { .. } => Code::OutsidePressure,
            OutsideModule::Unstable { .. } => Code::Unstable,
        }
    }
}

impl<T> From<OutsideFree<T>> for Code {
    fn from(outside: OutsideFree<T>) -> Self {
        match outside {
            OutsideFree::Pressure { .. } => Code::OutsidePressure,
            OutsideFree::WindingAngle { .. } => Code::OutsideAngle,
            OutsideFree::ShearModulus { .. } => Code::OutsideModulus,
        }
    }
}
