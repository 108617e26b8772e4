//! What the page of the explorer computes: lines `name=value` in, JSON out.
//!
//! These two functions are the whole boundary to JavaScript, without generated glue.

mod model;
mod text;

use std::cell::RefCell;

pub use model::answer;

thread_local! {
    static BUFFER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Where a question of so many bytes has to be written, or an answer can be read.
#[unsafe(no_mangle)]
pub extern "C" fn buffer(length: usize) -> *mut u8 {
    BUFFER.with_borrow_mut(|buffer| {
        buffer.resize(length, 0);
        buffer.as_mut_ptr()
    })
}

/// Replaces the question by its answer, and returns the number of bytes.
#[unsafe(no_mangle)]
pub extern "C" fn compute() -> usize {
    BUFFER.with_borrow_mut(|buffer| {
        *buffer = answer(&String::from_utf8_lossy(buffer)).into_bytes();
        buffer.len()
    })
}
