//! The front panel in a Worker of a web page: functions that JavaScript can call.
//!
//! There are two modules. With the feature `panel`, a module has a session of the panel, and the function `request`. With
//! the feature `compare`, it has a comparison with measured data, and the function `compare_request`.
//!
//! The Worker (`crates/panel/page/worker/engine.js`) copies the text of a request into memory from [`allocate`], calls one
//! of these functions, and copies the answer from the pointers and lengths of [`text_pointer`] and its neighbours. A
//! module imports functions of the Worker: a receiver of the message of a panic, a clock for the panel, and a receiver of
//! partial responses for a comparison.
//!
//! All code of the WebAssembly form that is not checked by the compiler is in this file. It also compiles for other
//! targets, where tests call the same functions.

#![deny(unsafe_op_in_unsafe_fn)]

use std::borrow::Cow;
use std::cell::RefCell;
use std::ptr;
use std::slice;
use std::sync::Once;

#[cfg(feature = "compare")]
use patchcord_compare::{Comparison, ComparisonOptions};
#[cfg(feature = "panel")]
use patchcord_panel::{Session, SessionOptions};

#[cfg(not(any(feature = "panel", feature = "compare")))]
compile_error!("a module needs one of the features \"panel\" and \"compare\"");

/// Milliseconds after which a request stops its run: less than the time between two pictures at 60 per second.
#[cfg(feature = "panel")]
const BUDGET: f64 = 12.0;

/// The answer to a request.
struct Answer {
    /// Its text.
    text: String,
    /// Its frame, if there is one.
    frame: Option<Vec<u8>>,
}

thread_local! {
    /// The answer to the last request; `None` before the first one.
    static ANSWER: RefCell<Option<Answer>> = const { RefCell::new(None) };
}

#[cfg(feature = "panel")]
thread_local! {
    /// The only session of the module, without files. It begins with the first request.
    static SESSION: RefCell<Session> = RefCell::new(Session::new(SessionOptions { folder: None }));
}

#[cfg(feature = "compare")]
thread_local! {
    /// The only comparison of the module, without files and on one thread. It begins with the first request. The page
    /// cancels a search by the end of the Worker.
    static COMPARISON: RefCell<Comparison> =
        RefCell::new(Comparison::new(ComparisonOptions { threads: Some(1), ..ComparisonOptions::default() }));
}

/// The functions that the Worker provides.
#[cfg(target_family = "wasm")]
mod host {
    #[link(wasm_import_module = "host")]
    unsafe extern "C" {
        /// Milliseconds since any fixed instant.
        #[cfg(feature = "panel")]
        pub(crate) safe fn now() -> f64;
        /// Takes the message of a panic: `length` bytes at `pointer`.
        pub(crate) fn fail(pointer: *const u8, length: usize);
        /// Takes a partial response: `length` bytes at `pointer`.
        #[cfg(feature = "compare")]
        pub(crate) fn partial(pointer: *const u8, length: usize);
    }
}

/// The same functions for tests on other targets.
#[cfg(not(target_family = "wasm"))]
mod host {
    use std::sync::{Mutex, PoisonError};

    /// The messages of panics so far.
    pub(crate) static FAILURES: Mutex<Vec<String>> = Mutex::new(Vec::new());

    /// The partial responses so far.
    #[cfg(feature = "compare")]
    pub(crate) static PARTIAL: Mutex<Vec<String>> = Mutex::new(Vec::new());

    /// Milliseconds since the first call.
    #[cfg(feature = "panel")]
    pub(crate) fn now() -> f64 {
        use std::sync::LazyLock;
        use std::time::Instant;

        static START: LazyLock<Instant> = LazyLock::new(Instant::now);
        START.elapsed().as_secs_f64() * 1e3
    }

    /// Prints the message of a panic, and keeps it.
    ///
    /// # Safety
    ///
    /// There are `length` bytes of UTF-8 at the pointer.
    pub(crate) unsafe fn fail(pointer: *const u8, length: usize) {
        // SAFETY: the caller has the bytes.
        let text = unsafe { super::text_at(pointer, length) };
        eprintln!("{text}");
        keep(&FAILURES, &text);
    }

    /// Keeps a partial response.
    ///
    /// # Safety
    ///
    /// There are `length` bytes of UTF-8 at the pointer.
    #[cfg(feature = "compare")]
    pub(crate) unsafe fn partial(pointer: *const u8, length: usize) {
        // SAFETY: the caller has the bytes.
        keep(&PARTIAL, &unsafe { super::text_at(pointer, length) });
    }

    /// Adds a text to a list.
    fn keep(list: &Mutex<Vec<String>>, text: &str) {
        list.lock().unwrap_or_else(PoisonError::into_inner).push(text.to_owned());
    }
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
#[cfg(feature = "panel")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn request(pointer: *const u8, length: usize) {
    report_panics();
    // SAFETY: the memory is initialised by `allocate`, and the caller does not change it during the call.
    let text = unsafe { text_at(pointer, length) };
    let end = host::now() + BUDGET;
    let answer = SESSION.with_borrow_mut(|session| session.request(&text, &mut || host::now() >= end));
    ANSWER.set(Some(Answer { text: answer.text, frame: answer.frame }));
}

/// Passes a request to the comparison. Meanwhile the Worker gets its partial responses. The functions below give the
/// final response until the next request.
///
/// # Safety
///
/// The pointer is the result of [`allocate`] with the same length, and has not been released. The bytes are UTF-8.
#[cfg(feature = "compare")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn compare_request(pointer: *const u8, length: usize) {
    report_panics();
    // SAFETY: the memory is initialised by `allocate`, and the caller does not change it during the call.
    let text = unsafe { text_at(pointer, length) };
    let mut report = |partial: &str| {
        // SAFETY: the Worker copies the bytes before it returns.
        unsafe { host::partial(partial.as_ptr(), partial.len()) }
    };
    let text = COMPARISON.with_borrow_mut(|comparison| comparison.request(&text, &mut report));
    ANSWER.set(Some(Answer { text, frame: None }));
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
    ANSWER.with_borrow(|answer| answer.as_ref().map_or(without, property))
}

/// The text at a pointer. Bytes that are not UTF-8 are replaced.
///
/// # Safety
///
/// There are `length` initialised bytes at the pointer, which do not change as long as the result is in use.
unsafe fn text_at<'a>(pointer: *const u8, length: usize) -> Cow<'a, str> {
    // SAFETY: the caller has the bytes.
    String::from_utf8_lossy(unsafe { slice::from_raw_parts(pointer, length) })
}

/// From now on, the Worker gets the message of a panic.
fn report_panics() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        std::panic::set_hook(Box::new(|panic| {
            let message = panic.to_string();
            // SAFETY: the Worker copies the bytes before it returns.
            unsafe { host::fail(message.as_ptr(), message.len()) };
        }));
    });
}

#[cfg(test)]
mod tests;
