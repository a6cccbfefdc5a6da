//! The front panel in a Worker of a web page: a session behind functions that JavaScript can call.
//!
//! The Worker (`crates/panel/page/worker/engine.js`) copies the text of a request into memory from [`allocate`], calls
//! [`request`], and copies the answer from the pointers and lengths of [`text_pointer`] and its neighbours. The module
//! imports two functions of the Worker: a clock, and a receiver of the message of a panic.
//!
//! All code of the WebAssembly form that is not checked by the compiler is in this file. It also compiles for other
//! targets, where tests call the same functions.

#![deny(unsafe_op_in_unsafe_fn)]

use std::cell::RefCell;
use std::ptr;
use std::slice;

use patchcord_panel::{Answer, Session, SessionOptions};

/// Milliseconds after which a request stops its run: less than the time between two pictures at 60 per second.
const BUDGET: f64 = 12.0;

/// A session and its last answer.
struct Engine {
    /// The session.
    session: Session,
    /// The answer to the last request.
    answer: Answer,
}

thread_local! {
    /// The only session of the module. It begins with the first request.
    static ENGINE: RefCell<Option<Engine>> = const { RefCell::new(None) };
}

/// The functions that the Worker provides.
#[cfg(target_family = "wasm")]
mod host {
    #[link(wasm_import_module = "host")]
    unsafe extern "C" {
        /// Milliseconds since any fixed instant.
        pub(crate) safe fn now() -> f64;
        /// Takes the message of a panic: `length` bytes at `pointer`.
        pub(crate) fn fail(pointer: *const u8, length: usize);
    }
}

/// The same functions for tests on other targets.
#[cfg(not(target_family = "wasm"))]
mod host {
    use std::sync::LazyLock;
    use std::time::Instant;

    /// Milliseconds since the first call.
    pub(crate) fn now() -> f64 {
        static START: LazyLock<Instant> = LazyLock::new(Instant::now);
        START.elapsed().as_secs_f64() * 1e3
    }

    /// Ignores the message, because the test prints it.
    pub(crate) unsafe fn fail(_: *const u8, _: usize) {}
}

/// Memory for `length` bytes, which the caller may fill. It stays allocated until [`release`].
#[unsafe(no_mangle)]
pub extern "C" fn allocate(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Frees memory from [`allocate`].
///
/// # Safety
///
/// The pointer is the result of [`allocate`] with the same length, and has not been released.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn release(pointer: *mut u8, length: usize) {
    // SAFETY: `allocate` made a boxed slice of this length, and the caller passes each pointer once.
    drop(unsafe { Box::from_raw(ptr::slice_from_raw_parts_mut(pointer, length)) });
}

/// Passes a request to the session. The functions below give its answer until the next request.
///
/// # Safety
///
/// The pointer is the result of [`allocate`] with the same length, and has not been released. The bytes are UTF-8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn request(pointer: *const u8, length: usize) {
    // SAFETY: the memory is initialised by `allocate`, and the caller does not change it during the call.
    let bytes = unsafe { slice::from_raw_parts(pointer, length) };
    let text = String::from_utf8_lossy(bytes);
    ENGINE.with_borrow_mut(|engine| {
        let engine = engine.get_or_insert_with(Engine::new);
        let end = host::now() + BUDGET;
        engine.answer = engine.session.request(&text, &mut || host::now() >= end);
    });
}

/// Where the text of the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn text_pointer() -> *const u8 {
    of_answer(|answer| answer.text.as_ptr(), ptr::null())
}

/// Length of the text of the answer in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn text_length() -> usize {
    of_answer(|answer| answer.text.len(), 0)
}

/// Where the frame of the answer is; null if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn frame_pointer() -> *const u8 {
    of_answer(|answer| answer.frame.as_ref().map_or(ptr::null(), Vec::as_ptr), ptr::null())
}

/// Length of the frame of the answer in bytes; 0 if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn frame_length() -> usize {
    of_answer(|answer| answer.frame.as_ref().map_or(0, Vec::len), 0)
}

/// A property of the last answer. Without a request there is no answer.
fn of_answer<T>(property: impl FnOnce(&Answer) -> T, without: T) -> T {
    ENGINE.with_borrow(|engine| match engine {
        Some(engine) => property(&engine.answer),
        None => without,
    })
}

impl Engine {
    /// A session without files. From now on, the Worker gets the message of a panic.
    fn new() -> Engine {
        std::panic::set_hook(Box::new(|panic| report(&panic.to_string())));
        let session = Session::new(SessionOptions { folder: None });
        Engine { session, answer: Answer { text: String::new(), frame: None } }
    }
}

/// Passes the message of a panic to the Worker.
fn report(message: &str) {
    // SAFETY: the Worker copies the bytes before it returns.
    unsafe { host::fail(message.as_ptr(), message.len()) };
}

#[cfg(test)]
mod tests;
