use crate::{Code, pointer};
use bytemuck::Pod;
use evaluator::{Content, FreeSplines, Image, Real, TipModel};

/// Words of a model in the caller's hands.
const WORDS: usize = 256;

/// Room for a model, as C sees it: `freeact_model_f64` and `freeact_model_f32`.
#[repr(C)]
pub struct Room {
    words: [u64; WORDS],
}

/// What is in it. The mark comes first, whatever the rest is.
#[repr(C)]
pub struct Model<T: 'static> {
    /// Tells an opened model of this precision from anything else.
    mark: u64,
    /// The image lies in bytes that the caller promised to keep.
    image: Image<'static, T>,
}

const _: () = assert!(size_of::<Model<f64>>() <= size_of::<Room>());
const _: () = assert!(align_of::<Model<f64>>() <= align_of::<Room>());
const _: () = assert!(size_of::<Model<f32>>() <= size_of::<Room>());
const _: () = assert!(align_of::<Model<f32>>() <= align_of::<Room>());

const fn mark<T>() -> u64 {
    u64::from_le_bytes(*b"FREEopen") + size_of::<T>() as u64
}

impl<T: Real + Pod> Model<T> {
    /// Opens the image at a pointer; the room is then a model. Where that fails it is none.
    ///
    /// # Safety
    /// There is room for a model at `room`. The image's bytes are there and stay as they are as long as the model is used.
    pub unsafe fn open(room: *mut Room, image: *const u8, bytes: usize) -> Result<(), Code> {
        pointer::check(room)?;
        // SAFETY: aligned, not null, with room by the caller's promise. What was open here is no more, whatever comes.
        unsafe { room.cast::<u64>().write(0) };
        // SAFETY: the caller's promise.
        let bytes = unsafe { pointer::bytes(image, bytes) }?;
        let model = Model { mark: mark::<T>(), image: Image::read(bytes)? };
        // SAFETY: as above; a model is not larger than its room, nor more strictly aligned (asserted where it is defined).
        unsafe { room.cast::<Model<T>>().write(model) };
        Ok(())
    }

    /// The model in a room.
    ///
    /// # Safety
    /// The room was opened in this precision, or its first bytes were set to zero, and nobody opens it again for `'a`. The image
    /// is still there.
    pub unsafe fn of<'a>(room: *const Room) -> Result<&'a Self, Code> {
        pointer::check(room)?;
        let model = room.cast::<Model<T>>();
        // SAFETY: the mark is a plain number within the room, aligned as the room is.
        let found = unsafe { (&raw const (*model).mark).read() };
        if found != mark::<T>() {
            return Err(Code::NotOpen);
        }
        // SAFETY: with this mark it was written by `open`, by the caller's promise.
        Ok(unsafe { &*model })
    }

    /// The image.
    pub fn image(&self) -> &Image<'static, T> {
        &self.image
    }

    /// The model as that of a module.
    pub fn module(&self) -> Result<&TipModel<T, &'static [T]>, Code> {
        match &self.image.content {
            Content::Module(tip) => Ok(tip),
            Content::Free { .. } => Err(Code::WrongKind),
        }
    }

    /// The model as that of a FREE.
    pub fn free(&self) -> Result<&FreeSplines<T, &'static [T]>, Code> {
        match &self.image.content {
            Content::Free { splines, .. } => Ok(splines),
            Content::Module(_) => Err(Code::WrongKind),
        }
    }

    /// Number of FREEs.
    pub fn frees(&self) -> usize {
        self.module().map_or(1, |tip| tip.splines.domain().len())
    }
}
